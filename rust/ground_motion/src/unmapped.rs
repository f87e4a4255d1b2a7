//! Contacts where no map says how the ground lies.
//!
//! The joint angles give the places of the wheels in the body. A plane is fitted to the lowest points of the rims, and the wheels
//! together move along it: exactly on a plane, on average over any other ground, so that an error of height on the way up is
//! undone on the way down. The velocity of a single wheel is that of its centre, as in `traction`: it has a part across that
//! plane where the joints and the body turn.

use nalgebra::Vector3;

use super::contact::{Contact, ContactPlane, Contacts, carried};
use crate::rates::contact_rows::COLUMNS;
use crate::rates::point_rows::{Row, in_body, point_rows};
use six_wheel_kinematics::geometry::Direction;
use six_wheel_terrain::suspension::{Chain, MAX_FREE, MAX_WHEELS, Placed};

/// Rounds in which the plane and the contacts on it are found; each leaves less than a hundredth of the error.
const ROUNDS: usize = 6;

/// Change of the plane's slopes at which it is found.
const FOUND: f64 = 1e-15;

/// Sine of the steepest slope, against the plane of all wheels, that one of them is taken to climb.
const STEEPEST: f64 = 0.98;

/// Share of the spread of the wheels below which they stand in a line.
const LINE: f64 = 1e-9;

/// Wheels on ground of which nothing is known: how their joints place them, and the plane they stand on.
#[derive(Debug)]
pub struct Unmapped<'a> {
    placed: Placed<'a>,
    /// Of the plane, in the body.
    normal: Vector3<f64>,
    /// Mean velocity of the centres across the plane, by the rates: on flat ground of any slope they have none.
    together: Row,
}

/// Motion of wheels over a step.
#[derive(Clone, Copy, Debug)]
pub struct Climb<'a> {
    /// Motion of body and free angles over a step, as far as it is known; None: slopes are as before.
    pub motion: Option<&'a Row>,
    /// Rotation of every wheel over it [rad]; NaN where one has no encoder.
    pub turned: &'a [f64],
    /// Climb of every centre against the plane, as a sine.
    pub slopes: &'a [f64; MAX_WHEELS],
    /// Standard deviation of the measured displacement of a centre across the plane [m]. Slopes are means over a distance of many
    /// times this, so that its noise does not make wheels climb: readings at the ends of steps cancel in them.
    pub doubt: f64,
}

/// Contacts without a map.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    /// The contacts.
    pub contacts: Contacts,
    /// Of the contact angle of every wheel.
    pub at: [Direction; MAX_WHEELS],
    /// Slopes with those of this motion among them.
    pub slopes: [f64; MAX_WHEELS],
}

/// Way over which slopes are averaged, as a multiple of the doubt: their noise is the inverse of it.
pub const MEMORY: f64 = 25.0;

impl<'a> Unmapped<'a> {
    /// At these free angles and steering angles [rad]. None where a differential does not reach, or the wheels stand
    /// in a line.
    pub fn new(chain: &'a Chain, joints: &[f64], steering: &[f64]) -> Option<Self> {
        let placed = in_body(chain, joints, steering)?;
        let normal = plane(chain, &placed)?;
        let mut together = [0.0; COLUMNS];
        let count = chain.wheels().len();
        for wheel in 0..count {
            let ([row], _) = point_rows(&placed, wheel, placed.wheel(wheel).centre, [normal]);
            for (sum, part) in together.iter_mut().zip(row) {
                *sum += part / count as f64;
            }
        }
        Some(Self { placed, normal, together })
    }

    /// Their contacts.
    pub fn contacts(&self, chain: &Chain, climb: &Climb<'_>) -> Found {
        let mut found = Found {
            contacts: Contacts::none(chain, [false; MAX_FREE]),
            at: [Direction::from(0.0); MAX_WHEELS],
            slopes: *climb.slopes,
        };
        for (wheel, mount) in chain.wheels().iter().enumerate() {
            let frame = self.placed.wheel(wheel);
            let mut plane = ContactPlane::new(frame, self.normal, mount.radius);
            let slope = &mut found.slopes[wheel];
            if let Some(motion) = climb.motion {
                let (way, turn) = carried(&self.placed, wheel, motion);
                let rolled = mount.radius * (climb.turned[wheel] + turn.dot(&plane.frame.axle));
                *slope = plane.slope(way, rolled, *slope, climb.doubt);
            }
            plane.climb(*slope);
            found.at[wheel] = plane.at;
            let mut contact = Contact::new(&self.placed, wheel, &plane, true);
            contact.rows[0] = self.together;
            contact.swivel[0] = 0.0;
            found.contacts.wheels[wheel] = contact;
        }
        found
    }
}

impl Contacts {
    /// The same with one row of side slip for all wheels that do not steer, their mean: what their axles are apart they
    /// slide in any turn, as in the wheel equation of a rover seen from above.
    #[must_use]
    pub fn sharing_sides(mut self) -> Self {
        let alike = |contact: &Contact| contact.touching && contact.steering.is_none();
        let wheels = &self.wheels[..self.count];
        let count = wheels.iter().filter(|contact| alike(contact)).count() as f64;
        let mut mean = [0.0; COLUMNS];
        for contact in wheels.iter().filter(|contact| alike(contact)) {
            for (sum, part) in mean.iter_mut().zip(contact.rows[2]) {
                *sum += part / count;
            }
        }
        for contact in self.wheels[..self.count].iter_mut().filter(|one| alike(one)) {
            contact.rows[2] = mean;
        }
        self
    }
}

impl ContactPlane {
    /// Climb of the centre against the plane, averaged over the distance that is remembered: its way across over the
    /// way along the rim, which errs least.
    fn slope(&self, way: Vector3<f64>, rolled: f64, before: f64, doubt: f64) -> f64 {
        let up = -self.centre_to_contact() / self.radius;
        let rolled = match rolled.is_nan() {
            true => way.dot(&self.tangent()),
            false => rolled,
        };
        if rolled == 0.0 {
            return before;
        }
        // A displacement that is not longer than its standard deviation counts for less than its length.
        let length = rolled * rolled / (rolled.abs() + doubt);
        let kept = match doubt > 0.0 {
            true => (-length / (MEMORY * doubt)).exp(),
            false => 0.0,
        };
        (kept * before + (1.0 - kept) * way.dot(&up) / rolled).clamp(-STEEPEST, STEEPEST)
    }

    /// Turns the contact up a slope, which is a sine.
    fn climb(&mut self, slope: f64) {
        let up = -self.centre_to_contact() / self.radius;
        let (Direction { sin, cos }, level) = (self.at, (1.0 - slope * slope).sqrt());
        self.at = Direction { sin: sin * level + cos * slope, cos: cos * level - sin * slope };
        // The ground tilts with it about the axle, and keeps its slope along that.
        let share = self.normal.dot(&up);
        self.normal -= up * share;
        self.normal -= self.centre_to_contact() * (share / self.radius);
    }
}

/// The normal of the plane, in the body, through the touching points of wheels that stand on it.
fn plane(chain: &Chain, placed: &Placed<'_>) -> Option<Vector3<f64>> {
    let mut points = [Vector3::zeros(); MAX_WHEELS];
    let count = chain.wheels().len();
    for (wheel, point) in points[..count].iter_mut().enumerate() {
        *point = placed.wheel(wheel).centre;
    }
    let mut slopes = through(&points[..count])?;
    for _ in 0..ROUNDS {
        let normal = Vector3::new(-slopes[0], -slopes[1], 1.0).normalize();
        for (wheel, point) in points[..count].iter_mut().enumerate() {
            let frame = placed.wheel(wheel);
            let plane = ContactPlane::new(frame, normal, chain.wheels()[wheel].radius);
            *point = frame.centre + plane.centre_to_contact();
        }
        let next = through(&points[..count])?;
        let change = (next[0] - slopes[0]).abs().max((next[1] - slopes[1]).abs());
        slopes = next;
        if change <= FOUND {
            break;
        }
    }
    Some(Vector3::new(-slopes[0], -slopes[1], 1.0).normalize())
}

/// Slopes along x and y of the plane nearest to points, in least squares of the heights. None if they lie in a line.
fn through(points: &[Vector3<f64>]) -> Option<[f64; 2]> {
    let mean = points.iter().sum::<Vector3<f64>>() / points.len() as f64;
    let [mut xx, mut xy, mut yy, mut xz, mut yz] = [0.0; 5];
    for point in points {
        let at = point - mean;
        xx += at.x * at.x;
        xy += at.x * at.y;
        yy += at.y * at.y;
        xz += at.x * at.z;
        yz += at.y * at.z;
    }
    let size = xx * yy - xy * xy;
    let known = size > LINE * (xx + yy) * (xx + yy);
    known.then(|| [(yy * xz - xy * yz) / size, (xx * yz - xy * xz) / size])
}
