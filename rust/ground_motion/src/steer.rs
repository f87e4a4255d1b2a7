//! Directions of steered wheels on the ground.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::Vector3;

use super::contact::{Footing, Row, Side, Tread, carried, in_body};
use six_wheel_kinematics::steering::{ANGLE_TOLERANCE, SteeringRange};
use six_wheel_kinematics::wheels::Direction;
use six_wheel_numerics::error::{Error, ErrorKind, number};
use six_wheel_terrain::suspension::{Chain, MAX_WHEELS, Placed};

/// Turns after which an angle is bracketed instead: from where its touching point goes Newton's method squares what is
/// missing, but on a wheel that almost rests.
const TURNS: usize = 12;

/// Steps of a search for a bracket, to either side.
const STEPS: u32 = 48;

/// Halvings and turns inside a bracket: twice what an interval of doubles takes.
const HALVINGS: usize = 128;

/// Angles of the steering joints at which the centres of wheels go where these point, in the plan of the body, forwards or
/// backwards: the same rule without a ground. A joint whose wheels rest keeps what it has.
pub(crate) fn steer_in_plan(
    chain: &Chain,
    straight: &Placed<'_>,
    rates: &Row,
    angles: &mut [f64; MAX_WHEELS],
) -> Result<(), Error> {
    let mut aims = [const { None }; MAX_WHEELS];
    for (wheel, aim) in aims.iter_mut().enumerate().take(chain.wheels().len()) {
        *aim = Aim::in_plan(straight, wheel, rates);
    }
    for (joint, angle) in angles.iter_mut().enumerate().take(chain.steering().len()) {
        let together = Together { aims: &aims, joint, touching: false };
        if together.ways() == [0.0; 2] {
            *angle = together.within(chain, *angle)?;
        } else {
            *angle = together.turned(chain, 0.0)?;
        }
    }
    Ok(())
}

/// Turns every steered wheel to where its touching point goes, forwards or backwards, whichever is nearer to where
/// it points; one that rests stays. Wheels of one joint do so on average.
pub(crate) fn steer(
    chain: &Chain,
    footing: &Footing<'_>,
    rates: &Row,
    angles: &mut [f64; MAX_WHEELS],
) -> Result<(), Error> {
    let Some(placed) = in_body(chain, footing.joints, footing.steering) else {
        return Ok(());
    };
    let mut aims = [const { None }; MAX_WHEELS];
    for (wheel, aim) in aims.iter_mut().enumerate().take(chain.wheels().len()) {
        *aim = Aim::new(chain, footing, &placed, wheel, rates);
    }
    for (joint, (angle, &present)) in angles.iter_mut().zip(footing.steering).enumerate() {
        let of = |aim: &&Aim| aim.joint == joint;
        let touching = aims.iter().flatten().filter(of).any(|aim| aim.touches);
        let together = Together { aims: &aims, joint, touching };
        if together.all().next().is_some() {
            *angle = together.turned(chain, present)?;
        }
    }
    Ok(())
}

/// The angle, or half a turn from it, inside the range of a steering joint.
fn within(chain: &Chain, joint: usize, wheel: usize, angle: f64) -> Result<f64, Error> {
    let range: SteeringRange = chain.steering()[joint];
    let fits = |angle: &f64| *angle >= range.lower - ANGLE_TOLERANCE && *angle <= range.upper + ANGLE_TOLERANCE;
    let found = [angle, angle - PI, angle + PI].into_iter().find(fits);
    found.map(|angle| range.clip(angle)).ok_or_else(|| {
        let (name, lower, upper) = (&chain.wheels()[wheel].name, range.lower, range.upper);
        let rule = format!("let {name} steer within ({lower:?}, {upper:?})");
        Error::value("command", rule, number(angle)).of_kind(ErrorKind::Infeasible)
    })
}

/// A vector that turns with a wheel about its steering axis: what of it lies along the axis, what stands across, and that a quarter
/// turn on.
#[derive(Clone, Copy)]
struct Turned {
    along: Vector3<f64>,
    across: Vector3<f64>,
    on: Vector3<f64>,
}

impl Turned {
    fn new(axis: Vector3<f64>, vector: Vector3<f64>) -> Self {
        let along = axis * axis.dot(&vector);
        Self { along, across: vector - along, on: axis.cross(&vector) }
    }

    /// The vector, and its derivative, at an angle.
    fn at(&self, (sin, cos): (f64, f64)) -> [Vector3<f64>; 2] {
        [self.along + self.across * cos + self.on * sin, self.on * cos - self.across * sin]
    }
}

/// Sideways velocity of a steered wheel as a function of its angle.
///
/// With the velocity `v` of its centre, the rotation `w` of its carrier, its axle `a` and the normal `n` of the ground the
/// touching point is at `-r (n - (a . n) a) / q`, `q^2 = 1 - (a . n)^2`, from the centre, and goes sideways with `s`:
///
/// ```text
/// q s = a . (v - n (n . v) + r q (n x w))
/// ```
///
/// Without the last term, or where the ground is upright to the wheel, that is a sine of the steering angle. The last term has
/// the other sign where the far side of the rim touches.
struct Aim {
    wheel: usize,
    joint: usize,
    touches: bool,
    axle: Turned,
    /// From the steering axis to the centre [m].
    centre: Turned,
    normal: Vector3<f64>,
    /// Of the centre at angle 0 [m/s], and of the carrier [rad/s].
    velocity: Vector3<f64>,
    turn: Vector3<f64>,
    /// `r n x w`, or minus that [m/s].
    rim: Vector3<f64>,
}

impl Aim {
    fn new(chain: &Chain, footing: &Footing<'_>, placed: &Placed<'_>, wheel: usize, rates: &Row) -> Option<Self> {
        let (joint, axis, pivot) = placed.steering_axes(wheel).next()?;
        let frame = placed.wheel(wheel);
        let normal = footing.rotation().inverse() * Vector3::from(footing.normals[wheel]);
        let (velocity, turn) = carried(placed, wheel, rates);
        let tread =
            Tread { frame, normal, radius: chain.wheels()[wheel].radius, at: Direction::from(footing.angles[wheel]) };
        let radius = match tread.side() {
            Side::Near => tread.radius,
            Side::Far => -tread.radius,
        };
        Some(Self {
            wheel,
            joint,
            touches: footing.touching[wheel],
            axle: Turned::new(axis, frame.axle),
            centre: Turned::new(axis, frame.centre - pivot),
            normal,
            velocity,
            turn,
            rim: normal.cross(&turn) * radius,
        })
    }

    /// The same without a ground, for rates of the body in plan: how its centre goes along its axle.
    fn in_plan(straight: &Placed<'_>, wheel: usize, rates: &Row) -> Option<Self> {
        let (joint, axis, pivot) = straight.steering_axes(wheel).next()?;
        let frame = straight.wheel(wheel);
        let turn = Vector3::z() * rates[5];
        let level = Vector3::new(frame.centre.x, frame.centre.y, 0.0);
        Some(Self {
            wheel,
            joint,
            touches: false,
            axle: Turned::new(axis, frame.axle),
            centre: Turned::new(axis, frame.centre - pivot),
            normal: Vector3::zeros(),
            velocity: Vector3::new(rates[0], rates[1], 0.0) + turn.cross(&level),
            turn,
            rim: Vector3::zeros(),
        })
    }

    /// `q s` [m/s], and its derivative by the angle.
    fn aside(&self, angle: f64) -> [f64; 2] {
        let turned = angle.sin_cos();
        let ([axle, axle_on], [centre, centre_on]) = (self.axle.at(turned), self.centre.at(turned));
        let start = self.centre.along + self.centre.across;
        let velocity = self.velocity + self.turn.cross(&(centre - start));
        let change = self.turn.cross(&centre_on);
        let (tilt, tilt_on) = (axle.dot(&self.normal), axle_on.dot(&self.normal));
        let (up, up_on) = (self.normal.dot(&velocity), self.normal.dot(&change));
        let share = (1.0 - tilt * tilt).max(0.0).sqrt();
        let (rim, rim_on) = (axle.dot(&self.rim), axle_on.dot(&self.rim));
        [
            axle.dot(&velocity) - tilt * up + share * rim,
            axle_on.dot(&velocity) + axle.dot(&change) - tilt_on * up - tilt * up_on + share * rim_on
                - tilt * tilt_on / share * rim,
        ]
    }

    /// Velocity of the touching point at angle 0, as if it were touched at the same height all around: along the axle,
    /// and a quarter turn on from it [m/s].
    fn ways(&self) -> [f64; 2] {
        let axle = self.axle.along + self.axle.across;
        let tilt = axle.dot(&self.normal);
        let share = (1.0 - tilt * tilt).max(0.0).sqrt();
        let way = self.velocity - self.normal * self.normal.dot(&self.velocity) + self.rim * share;
        [axle.dot(&way), self.axle.on.dot(&way)]
    }

    /// Speeds of which this is made [m/s].
    fn size(&self) -> f64 {
        self.velocity.norm() + self.rim.norm() + self.turn.cross(&self.centre.on).norm()
    }
}

/// The wheels of a joint.
struct Together<'a> {
    aims: &'a [Option<Aim>; MAX_WHEELS],
    joint: usize,
    /// True if one of them touches: then only those that do count.
    touching: bool,
}

impl Together<'_> {
    fn all(&self) -> impl Iterator<Item = &Aim> {
        let counts = |aim: &&Aim| aim.joint == self.joint && (aim.touches || !self.touching);
        self.aims.iter().flatten().filter(counts)
    }

    /// True if a centre lies off the axis.
    fn beside(&self) -> bool {
        self.all().any(|aim| aim.centre.on != Vector3::zeros())
    }

    fn aside(&self, angle: f64) -> [f64; 2] {
        self.all().fold([0.0; 2], |[sum, slope], aim| {
            let [aside, by] = aim.aside(angle);
            [sum + aside, slope + by]
        })
    }

    /// Sum of the velocities of the touching points: see [`Aim::ways`].
    fn ways(&self) -> [f64; 2] {
        self.all().fold([0.0; 2], |[aside, back], aim| {
            let [one, other] = aim.ways();
            [aside + one, back + other]
        })
    }

    /// The angle inside the range of the joint at which nothing goes sideways, from the one that it has.
    fn turned(&self, chain: &Chain, present: f64) -> Result<f64, Error> {
        let never = || {
            let name = self.all().next().map(|aim| &chain.wheels()[aim.wheel].name);
            let rule = format!("let {} roll at some angle", name.map_or("", |name| name));
            Error::value("command", rule, "one at which it slips at any").of_kind(ErrorKind::Infeasible)
        };
        let asked = present + self.aimed().ok_or_else(never)?;
        let angle = self.within(chain, asked)?;
        // Half a turn from there is the same but for wheels beside their axis.
        if angle == asked || !self.beside() {
            return Ok(angle);
        }
        let again = self.root(angle - present).ok_or_else(never)?;
        self.within(chain, present + again)
    }

    fn within(&self, chain: &Chain, angle: f64) -> Result<f64, Error> {
        let wheel = self.all().next().map_or(0, |aim| aim.wheel);
        within(chain, self.joint, wheel, angle)
    }

    /// The angle at which nothing goes sideways, nearest to where the touching points go.
    fn aimed(&self) -> Option<f64> {
        let [aside, back] = self.ways();
        if aside == 0.0 && back == 0.0 {
            return Some(0.0);
        }
        // The quarter turn on from the axle, to the left, is behind.
        let start = if back > 0.0 { (-aside).atan2(back) } else { aside.atan2(-back) };
        let root = self.root(start)?;
        // What was within a quarter turn at first need not be so now.
        let over = root.abs() > FRAC_PI_2 && !self.beside();
        Some(if over { root - PI.copysign(root) } else { root })
    }

    /// The root near an angle.
    fn root(&self, start: f64) -> Option<f64> {
        let nothing = 4.0 * f64::EPSILON * self.all().map(Aim::size).sum::<f64>();
        let (mut angle, mut last) = (start, 0.5);
        for _ in 0..TURNS {
            let [aside, by] = self.aside(angle);
            let step = -aside / by;
            if aside.abs() <= nothing || step.abs() <= 4.0 * f64::EPSILON {
                return Some(angle);
            }
            if step.is_nan() || step.abs() > 0.5 * last {
                break;
            }
            angle += step;
            last = step.abs();
        }
        self.bracketed(start)
    }

    /// The root nearest to an angle, by looking to either side of it. Half a turn from an angle the sign is the other but
    /// for wheels beside their axis: only those may have none.
    fn bracketed(&self, start: f64) -> Option<f64> {
        let width = PI / f64::from(STEPS);
        let value = |angle: f64| self.aside(angle)[0];
        let mut ends = [value(start); 2];
        for step in 1..=STEPS {
            for (end, sign) in ends.iter_mut().zip([1.0, -1.0]) {
                let [near, far] = [step - 1, step].map(|k| start + sign * width * f64::from(k));
                let found = value(far);
                if (found > 0.0) != (*end > 0.0) {
                    return Some(self.inside(near, far, *end > 0.0));
                }
                *end = found;
            }
        }
        None
    }

    /// The root between two angles at which the sign differs: Newton's method where it more than halves the
    /// interval, halves elsewhere.
    fn inside(&self, near: f64, far: f64, positive: bool) -> f64 {
        let [mut near, mut far] = [near, far];
        let mut angle = 0.5 * (near + far);
        let (mut last, mut before) = ((far - near).abs(), (far - near).abs());
        for _ in 0..HALVINGS {
            let [aside, by] = self.aside(angle);
            if aside == 0.0 {
                break;
            }
            if (aside > 0.0) == positive {
                near = angle;
            } else {
                far = angle;
            }
            let (newton, half) = (angle - aside / by, 0.5 * (near + far));
            let inside = (newton - near) * (newton - far) < 0.0;
            let next = if inside && (newton - angle).abs() <= 0.5 * before { newton } else { half };
            (before, last) = (last, (next - angle).abs());
            angle = next;
            if last <= 2.0 * f64::EPSILON {
                break;
            }
        }
        angle
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{COLUMNS, Contacts};
    use six_wheel_terrain::suspension::{MAX_FREE, RockerBogie};

    fn chains() -> Result<Vec<Chain>, Error> {
        let half_turn = SteeringRange { lower: -PI, upper: PI };
        let mut chains = vec![Chain::pivoting_axles(1.91, 1.64, 0.119, 0.325, half_turn, Default::default())?];
        for rover in [RockerBogie::rocky7()?, RockerBogie::perseverance()?, RockerBogie::curiosity()?] {
            let mut dimensions = *rover.dimensions();
            dimensions.steering = half_turn;
            chains.push(RockerBogie::new(dimensions)?.chain().clone());
        }
        Ok(chains)
    }

    /// Numbers between -1 and 1 that look random.
    fn noise(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    #[test]
    fn steered_wheels_roll_whatever_they_stand_on() -> Result<(), Error> {
        let (mut seed, mut beside) = (1, 0);
        for chain in chains()? {
            let (wheels, joints) = (chain.wheels().len(), chain.joints().len());
            for number in 0..4000 {
                let angles: [f64; MAX_FREE] = std::array::from_fn(|_| 0.3 * noise(&mut seed));
                let steering: [f64; MAX_WHEELS] = std::array::from_fn(|_| 0.5 * noise(&mut seed));
                let normals: [[f64; 3]; MAX_WHEELS] = std::array::from_fn(|_| {
                    let upwards = [noise(&mut seed), noise(&mut seed), 0.7];
                    Vector3::from(upwards).normalize().into()
                });
                let footing = Footing {
                    attitude: std::array::from_fn(|_| 0.3 * noise(&mut seed)),
                    joints: &angles[..joints],
                    steering: &steering[..chain.steering().len()],
                    // Near sides and far ones.
                    angles: &[f64::from(number % 2) * PI; MAX_WHEELS],
                    normals: &normals[..wheels],
                    touching: [true; MAX_WHEELS],
                    stopped: [false; MAX_FREE],
                };
                // Turning as fast as driving: rims that go as fast as centres.
                let rates: [f64; COLUMNS] = std::array::from_fn(|k| noise(&mut seed) * if k < 3 { 0.2 } else { 1.0 });
                let mut found = [0.0; MAX_WHEELS];
                if let Err(error) = steer(&chain, &footing, &rates, &mut found) {
                    assert!(wheels == 4, "{error}");
                    beside += 1;
                    continue;
                }
                let found = &found[..chain.steering().len()];
                let contacts = Contacts::new(&chain, &footing, Some(found));
                let placed = in_body(&chain, footing.joints, found);
                let (Some(contacts), Some(placed)) = (contacts, placed) else {
                    continue;
                };
                let mut sums = [0.0; MAX_WHEELS];
                for (wheel, contact) in contacts.wheels[..wheels].iter().enumerate() {
                    let Some(joint) = contact.steering else {
                        continue;
                    };
                    // To the left of where it rolls: on the far side of a rim that is the wheel's right.
                    let left = Vector3::new(contact.side[0], contact.side[1], contact.side[2]);
                    let share = left.dot(&placed.wheel(wheel).axle);
                    let aside: f64 = contact.side.iter().zip(&rates).map(|(a, b)| a * b).sum();
                    sums[joint] += share * aside;
                }
                // Rounding of speeds of some metres per second.
                assert!(sums.iter().all(|sum| sum.abs() < 1e-14), "{sums:?}");
            }
        }
        // Nothing is known to hold wheels on one axle from slipping at any angle; few do.
        assert!(beside < 40, "{beside}");
        Ok(())
    }
}
