//! Admissible twists of a rover: no side slip, and every steering angle inside its range.
//!
//! In twist space the fixed wheels leave a subspace. Each steered wheel whose range is narrower than half
//! a turn leaves a double wedge of it, between the two planes on which it rolls exactly at an end of its
//! range. The admissible set is their intersection: a union of polyhedral cones.

pub(crate) mod faces;
mod keep;
#[cfg(test)]
pub(crate) mod tests;

use nalgebra::Vector3;

use self::faces::Faces;
pub use self::keep::Keep;
use crate::geometry::Twist;
use crate::rover_data::{Bank, Mount, RoverData};
use crate::steering::SteeringRange;
use crate::wheels::{Direction, Wheel};
use six_wheel_numerics::error::{Error, ErrorKind, finite, numbers, radians, short};

/// Side slip that passes as rounding, as a share of the fastest pivot's speed: 1 nm per metre driven.
pub const SLIP_TOLERANCE: f64 = 1e-9;

/// Intervals of turning radius narrower than this are two names of one limit [share of the size].
const SAME_RADIUS: f64 = 1e-9;

/// Cause that keeps a rover from a twist.
#[derive(Clone, Copy, Debug)]
enum InfeasibilityCause {
    /// The unsteered wheels of a bank slide sideways [m/s].
    Slip { bank: usize, slip: f64 },
    /// A wheel cannot steer to where it has to be, and slides sideways at the end of its range [rad, m/s].
    Range { wheel: usize, angle: f64, slip: f64 },
}

impl RoverData {
    /// Fails unless the rover can make the twist: finite, without side slip, inside the steering ranges.
    pub fn check(&self, twist: Twist, steering_rates: Option<&[f64]>) -> Result<(), Error> {
        let fastest = self.check_speeds(twist, steering_rates)?;
        match self.obstacle(twist, steering_rates, SLIP_TOLERANCE * fastest) {
            Some(obstacle) => Err(self.explained(obstacle, twist)),
            None => Ok(()),
        }
    }

    /// True if the rover can make a twist. Fails if it is not finite.
    #[inline]
    pub fn admissible(&self, twist: Twist) -> Result<bool, Error> {
        let fastest = self.check_speeds(twist, None)?;
        Ok(self.obstacle(twist, None, SLIP_TOLERANCE * fastest).is_none())
    }

    /// The same, a twist that is not finite being impossible.
    pub(crate) fn is_possible(&self, twist: Twist) -> bool {
        self.check_speeds(twist, None)
            .is_ok_and(|fastest| self.obstacle(twist, None, SLIP_TOLERANCE * fastest).is_none())
    }

    /// Cause that keeps the rover from a twist. Slides of at most `tolerance` [m/s] count as none.
    fn obstacle(&self, twist: Twist, steering_rates: Option<&[f64]>, tolerance: f64) -> Option<InfeasibilityCause> {
        let vector = Vector3::from(twist);
        for (bank, Bank { row, .. }) in self.banks.iter().enumerate() {
            let slip = row.dot(&vector).abs();
            if slip > tolerance {
                return Some(InfeasibilityCause::Slip { bank, slip });
            }
        }
        self.steered().iter().enumerate().find_map(|(joint, &i)| {
            let rate = steering_rates.map_or(0.0, |rates| rates[joint]);
            self.out_of_range(i, twist, rate, tolerance)
        })
    }

    fn explained(&self, obstacle: InfeasibilityCause, twist: Twist) -> Error {
        let rule = match obstacle {
            InfeasibilityCause::Slip { bank, slip } => {
                let names: Vec<_> =
                    self.banks[bank].wheels.iter().map(|&i| format!("{:?}", self.wheels()[i].name)).collect();
                format!(
                    "let the unsteered wheels {} roll without side slip (they would slide at {} m/s; \
                     project() finds a twist that does not)",
                    names.join(", "),
                    short(slip)
                )
            }
            InfeasibilityCause::Range { wheel, angle, slip } => {
                let wheel = &self.wheels()[wheel];
                let range = wheel.steering().unwrap_or_default();
                format!(
                    "let wheel {:?} steer within {range} (at {} it would slide at {} m/s; \
                     project() finds a twist that does not)",
                    wheel.name,
                    radians(angle),
                    short(slip)
                )
            }
        };
        infeasible(rule, twist)
    }

    /// Fails unless the twist and every wheel speed are finite; a bound of the fastest pivot's speed [m/s].
    pub fn check_speeds(&self, twist: Twist, steering_rates: Option<&[f64]>) -> Result<f64, Error> {
        finite("twist", &<[f64; 3]>::from(twist))?;
        let fastest = self.fastest(twist, steering_rates);
        // Twice: the length of a velocity against its larger component.
        if !self.wheels().iter().all(|wheel| (2.0 * fastest / wheel.radius).is_finite()) {
            return Err(infeasible("keep every wheel speed finite", twist).of_kind(ErrorKind::Value));
        }
        Ok(fastest)
    }

    /// The steered wheels that may be off the way of their pivots, at the ends of their ranges, and their joints.
    fn at_an_end<'a>(&'a self, steering: &'a [f64]) -> impl Iterator<Item = (usize, usize)> + 'a {
        let steered = self.steered().iter().copied().enumerate();
        steered.filter(|&(joint, i)| {
            let wheel = &self.wheels()[i];
            let inside = |range: SteeringRange| range.lower < steering[joint] && steering[joint] < range.upper;
            wheel.trail != 0.0 || !wheel.steering().is_some_and(inside)
        })
    }

    /// Side slip of the worst wheel at these steering angles, those of [`RoverData::solve`] [m/s]: 0 if the rover can
    /// make the twist.
    pub fn scrub(&self, twist: Twist, steering: &[f64]) -> f64 {
        let vector = Vector3::from(twist);
        let fixed = self.banks.iter().map(|bank| bank.row.dot(&vector).abs());
        let slip = |(joint, i): (usize, usize)| {
            let wheel: &Wheel = &self.wheels()[i];
            wheel.side_slip(steering[joint], twist, 0.0).abs()
        };
        let steered = self.at_an_end(steering).map(slip);
        fixed.chain(steered).fold(0.0, f64::max)
    }

    /// Wheels that miss the way of their pivots roll only as far as they point along it [rad/s].
    pub fn slow_down(&self, twist: Twist, steering: &[f64], speeds: &mut [f64]) {
        for (joint, i) in self.at_an_end(steering) {
            let wheel = &self.wheels()[i];
            let direction = Direction::from(wheel.heading + steering[joint]);
            let rolling = wheel.rows(direction).rolling;
            speeds[i] = rolling.dot(&Vector3::from(twist)) / wheel.radius;
        }
    }

    /// Cause, if the wheel cannot steer to the angle that the twist requires.
    fn out_of_range(&self, i: usize, twist: Twist, rate: f64, tolerance: f64) -> Option<InfeasibilityCause> {
        let wheel = &self.wheels()[i];
        let Mount::Steered(range, heading) = self.mounts[i] else {
            return None;
        };
        if range.is_full() && wheel.trail == 0.0 {
            return None;
        }
        let choice = wheel.choice(range, heading, twist, rate, 0.0);
        let angle = choice.command(choice.nearest()).angle;
        let at_an_end = angle == range.lower || angle == range.upper;
        if !at_an_end && wheel.trail == 0.0 {
            return None;
        }
        let slip = wheel.side_slip(angle, twist, rate).abs();
        (slip > tolerance).then_some(InfeasibilityCause::Range { wheel: i, angle, slip })
    }

    /// Bound of the speed of every pivot and contact, to a factor of two [m/s].
    fn fastest(&self, twist: Twist, steering_rates: Option<&[f64]>) -> f64 {
        let mut fastest: f64 = 0.0;
        for wheel in self.wheels() {
            let u = twist.at(wheel.x, wheel.y);
            let offset = wheel.scrub.abs() + wheel.trail.abs();
            let rate = steering_rates.unwrap_or_default().iter().fold(0.0, |a: f64, b| a.max(b.abs()));
            // `max` would drop a NaN, the sum does not.
            let speed = u.x.abs() + u.y.abs() + offset * (twist.omega.abs() + rate);
            fastest = if speed > fastest || speed.is_nan() { speed } else { fastest };
        }
        fastest
    }

    /// The nearest twist the rover can make, preserving what `keep` says; an admissible one is unchanged. The faces of the
    /// admissible set are asked for where they are needed.
    pub(crate) fn project_by<'f>(
        &self,
        faces: impl Fn() -> &'f Faces,
        twist: Twist,
        keep: Keep,
    ) -> Result<Twist, Error> {
        let fastest = self.check_speeds(twist, None)?;
        if self.obstacle(twist, None, SLIP_TOLERANCE * fastest).is_none() {
            return Ok(twist);
        }
        let nearest = |keep: Keep| {
            faces().nearest(self, twist, keep).ok_or_else(|| {
                let kept = if keep == Keep::Speed { "speed" } else { "yaw rate" };
                infeasible(format!("have a possible twist of the same {kept} beside it"), twist)
            })
        };
        let found = match keep {
            Keep::Speed => nearest(keep).map(|found| Twist { vx: twist.vx, ..found }),
            Keep::YawRate => nearest(keep).map(|found| Twist { omega: twist.omega, ..found }),
            Keep::Nearest => nearest(keep),
            Keep::Curvature => match faces().nearest(self, twist, keep) {
                Some(found) => Ok(Twist { vy: found.vy, ..twist }),
                None => nearest(Keep::Nearest).map(|found| shrink(found, twist)),
            },
        }?;
        // Squares of very large twists are not.
        if <[f64; 3]>::from(found).iter().all(|part| part.is_finite()) {
            return Ok(found);
        }
        let rule = "be small enough for a possible twist beside it";
        Err(infeasible(rule, twist).of_kind(ErrorKind::Value))
    }

    /// The planes on which a steered wheel rolls exactly at an end of its range, with its joint.
    fn limit_planes(&self) -> Vec<(usize, [Vector3<f64>; 2])> {
        let ends = |(joint, &i): (usize, &usize)| {
            let wheel = &self.wheels()[i];
            let range =
                wheel.steering().filter(|range| !range.is_full() || wheel.trail != 0.0 && !range.is_endless())?;
            let row = |angle: f64| wheel.rows(Direction::from(wheel.heading + angle)).side_slip;
            Some((joint, [row(range.lower), row(range.upper)]))
        };
        self.steered().iter().enumerate().filter_map(ends).collect()
    }

    fn limit_rows(&self) -> Vec<Vector3<f64>> {
        let planes = self.limit_planes();
        planes.into_iter().flat_map(|(_, rows)| rows).collect()
    }

    /// Smallest radius from which on every turn is possible, and largest up to which every one is.
    pub(crate) fn turning_limits(&self) -> (f64, f64) {
        let line = match self.banks.as_slice() {
            [] => Vector3::new(0.0, 1.0, 0.0),
            [bank] => bank.row,
            _ => return (f64::INFINITY, 0.0),
        };
        // Turning about P + R n, P = m e the foot of the origin: R times straight plus one turn about P.
        let straight = Vector3::new(line.y, -line.x, 0.0);
        let spin = Vector3::new(-line.z * line.x, -line.z * line.y, 1.0);
        let possible = |twist: Vector3<f64>| self.is_possible(twist.into());
        let mut ends: Vec<f64> = self.limit_rows().iter().map(|row| -row.dot(&spin) / row.dot(&straight)).collect();
        for wheel in self.steered().iter().map(|&i| &self.wheels()[i]) {
            ends.extend(trail_radii(wheel, straight.into(), spin.into()));
        }
        ends.retain(|radius| radius.is_finite());
        ends.sort_by(f64::total_cmp);
        ends.dedup_by(|b, a| (*b - *a).abs() <= SAME_RADIUS * self.size);
        let (Some(&first), Some(&last)) = (ends.first(), ends.last()) else {
            let all = possible(straight) && possible(spin);
            return if all { (0.0, f64::INFINITY) } else { (f64::INFINITY, 0.0) };
        };
        // The line of radii, cut at the limits, closes at infinity: one piece holds the straight line.
        let beyond = first.abs().max(last.abs()) + self.size;
        let straight_on = [-beyond, beyond].map(|radius| possible(spin + straight * radius));
        let mut min_radius: f64 = 0.0;
        let mut spin_radius = f64::INFINITY;
        for pair in ends.windows(2) {
            if !possible(spin + straight * f64::midpoint(pair[0], pair[1])) {
                min_radius = min_radius.max(pair[0].abs()).max(pair[1].abs());
                let holds_zero = pair[0] < 0.0 && pair[1] > 0.0;
                let inner = if holds_zero { 0.0 } else { pair[0].abs().min(pair[1].abs()) };
                spin_radius = spin_radius.min(inner);
            }
        }
        for (end, possible) in [(first, straight_on[0]), (-last, straight_on[1])] {
            if !possible {
                min_radius = f64::INFINITY;
                spin_radius = spin_radius.min((-end).max(0.0));
            }
        }
        (min_radius, spin_radius)
    }
}

/// Radii at which the pivot of a wheel with trail moves just as fast as its contact swings about it: between
/// them no steering angle stops the side slip.
fn trail_radii(wheel: &Wheel, straight: Twist, spin: Twist) -> [f64; 2] {
    if wheel.trail == 0.0 {
        return [f64::NAN; 2];
    }
    // |spin + R straight| = trail at the pivot, and |straight| = 1.
    let (along, about) = (straight.at(wheel.x, wheel.y), spin.at(wheel.x, wheel.y));
    let middle = -along.dot(&about);
    let distance = about - along * along.dot(&about);
    let half_width = (wheel.trail * wheel.trail - distance.norm_squared()).sqrt();
    [middle - half_width, middle + half_width]
}

/// Scales a twist so that neither its forward speed nor its yaw rate exceeds the wanted one.
fn shrink(found: Twist, wanted: Twist) -> Twist {
    let share = |found: f64, wanted: f64| {
        if found.abs() <= wanted.abs() { 1.0 } else { wanted.abs() / found.abs() }
    };
    let scale = share(found.vx, wanted.vx).min(share(found.omega, wanted.omega));
    Twist::from(Vector3::from(found) * scale)
}

fn infeasible(rule: impl Into<String>, twist: Twist) -> Error {
    Error::value("twist", rule, numbers(&<[f64; 3]>::from(twist))).of_kind(ErrorKind::Infeasible)
}
