//! Contacts on ground without a map.
//!
//! The joint angles give the positions of the wheels in the body. A plane is fitted to the lowest points of the rims,
//! and the mean of the wheels' centres moves along it: exact on a plane, right on average elsewhere, since errors of
//! height on a climb and on the following descent cancel. A single wheel's centre also moves across that plane where
//! joints and body turn; its contact angle follows from the direction of its velocity, as in `traction`.

use nalgebra::Vector3;

use super::contact::{Contact, ContactPlane, Contacts, carried};
use crate::rates::contact_rows::COLUMNS;
use crate::rates::point_rows::{Row, in_body, point_rows};
use six_wheel_kinematics::geometry::Direction;
use six_wheel_terrain::suspension::{Chain, MAX_FREE, MAX_WHEELS, Placed};

/// Rounds of the fixed point of the plane and the contacts on it; each leaves less than a hundredth of the error.
const ROUNDS: usize = 6;

/// Change of the plane's slopes below which the rounds end.
const FOUND: f64 = 1e-15;

/// Sine of the steepest slope, against the plane of all wheels, that one of them is taken to climb.
const STEEPEST: f64 = 0.98;

/// Share of the spread of the wheels below which they stand in a line.
const LINE: f64 = 1e-9;

/// Wheels on ground without a map: their positions in the body, and the plane that they stand on.
#[derive(Debug)]
pub struct Unmapped<'a> {
    placed: Placed<'a>,
    /// Unit normal of the plane, in the body.
    normal: Vector3<f64>,
    /// Derivatives by the rates of the mean velocity of the centres across the plane, which is 0 on flat ground of any
    /// slope.
    mean_row: Row,
}

/// Motion over a step from which the slopes under the wheels are estimated.
#[derive(Clone, Copy, Debug)]
pub struct ClimbInput<'a> {
    /// Displacement of body and free angles over the step [m, rad]; None before it is known: then slopes stay.
    pub motion: Option<&'a Row>,
    /// Rotation of every wheel over it [rad]; NaN where one has no encoder.
    pub turned: &'a [f64],
    /// Sine of the climb of every centre against the plane, before the step.
    pub slopes: &'a [f64; MAX_WHEELS],
    /// Standard deviation of the measured displacement of a centre across the plane [m]. Slopes are means over a
    /// distance of [`AVERAGING_LENGTH`] times this, in which the errors of readings at the ends of steps cancel.
    pub deviation: f64,
}

/// Contacts of the wheels, and the slopes under them.
#[derive(Clone, Copy, Debug)]
pub struct SiteContacts {
    /// The contacts.
    pub contacts: Contacts,
    /// Direction of the contact angle of every wheel.
    pub at: [Direction; MAX_WHEELS],
    /// Sine of the climb of every centre against the plane, after the step; 0 on a map.
    pub slopes: [f64; MAX_WHEELS],
}

/// Distance over which slopes are averaged, as a multiple of [`ClimbInput::deviation`]: the standard deviation of a
/// slope is the inverse of it.
pub const AVERAGING_LENGTH: f64 = 25.0;

impl<'a> Unmapped<'a> {
    /// At these free angles and steering angles [rad]. None where a differential does not reach, or the wheels stand
    /// in a line.
    pub fn new(chain: &'a Chain, joints: &[f64], steering: &[f64]) -> Option<Self> {
        let placed = in_body(chain, joints, steering)?;
        let normal = fit_plane(chain, &placed)?;
        let mut mean_row = [0.0; COLUMNS];
        let count = chain.wheels().len();
        for wheel in 0..count {
            let ([row], _) = point_rows(&placed, wheel, placed.wheel(wheel).centre, [normal]);
            for (sum, part) in mean_row.iter_mut().zip(row) {
                *sum += part / count as f64;
            }
        }
        Some(Self { placed, normal, mean_row })
    }

    /// Contacts of the wheels with the slopes after this motion.
    pub fn contacts(&self, chain: &Chain, climb: &ClimbInput<'_>) -> SiteContacts {
        let mut found = SiteContacts {
            contacts: Contacts::none(chain, [false; MAX_FREE]),
            at: [Direction::from(0.0); MAX_WHEELS],
            slopes: *climb.slopes,
        };
        for (wheel, mount) in chain.wheels().iter().enumerate() {
            let frame = self.placed.wheel(wheel);
            let mut plane = ContactPlane::new(frame, self.normal, mount.radius);
            let slope = &mut found.slopes[wheel];
            if let Some(motion) = climb.motion {
                let (displacement, turn) = carried(&self.placed, wheel, motion);
                let rolled = mount.radius * (climb.turned[wheel] + turn.dot(&plane.frame.axle));
                *slope = plane.slope(displacement, rolled, *slope, climb.deviation);
            }
            plane.climb(*slope);
            found.at[wheel] = plane.at;
            let mut contact = Contact::new(&self.placed, wheel, &plane, true);
            contact.rows[0] = self.mean_row;
            contact.swivel[0] = 0.0;
            found.contacts.wheels[wheel] = contact;
        }
        found
    }
}

impl Contacts {
    /// The contacts with one row of side slip for all unsteered wheels, the mean of theirs: unsteered wheels on several
    /// axles slide in every turn, and their mean does not. The wheel equation of a planar rover does the same.
    #[must_use]
    pub fn sharing_sides(mut self) -> Self {
        let is_unsteered = |contact: &Contact| contact.touching && contact.steering.is_none();
        let wheels = &self.wheels[..self.count];
        let count = wheels.iter().filter(|contact| is_unsteered(contact)).count() as f64;
        let mut mean = [0.0; COLUMNS];
        for contact in wheels.iter().filter(|contact| is_unsteered(contact)) {
            for (sum, part) in mean.iter_mut().zip(contact.rows[2]) {
                *sum += part / count;
            }
        }
        for contact in self.wheels[..self.count].iter_mut().filter(|one| is_unsteered(one)) {
            contact.rows[2] = mean;
        }
        self
    }
}

impl ContactPlane {
    /// Sine of the centre's climb against the plane: its displacement across over the distance `rolled` along the rim,
    /// in an exponential mean over [`AVERAGING_LENGTH`] times `deviation`, whose last value was `before`.
    fn slope(&self, displacement: Vector3<f64>, rolled: f64, before: f64, deviation: f64) -> f64 {
        let up = -self.centre_to_contact() / self.radius;
        let rolled = match rolled.is_nan() {
            true => displacement.dot(&self.tangent()),
            false => rolled,
        };
        if rolled == 0.0 {
            return before;
        }
        // A displacement that is not longer than its standard deviation counts for less than its length.
        let length = rolled * rolled / (rolled.abs() + deviation);
        let kept = match deviation > 0.0 {
            true => (-length / (AVERAGING_LENGTH * deviation)).exp(),
            false => 0.0,
        };
        (kept * before + (1.0 - kept) * displacement.dot(&up) / rolled).clamp(-STEEPEST, STEEPEST)
    }

    /// Rotates the contact angle and the normal about the axle by the angle with this sine.
    fn climb(&mut self, slope: f64) {
        let up = -self.centre_to_contact() / self.radius;
        let (Direction { sin, cos }, level) = (self.at, (1.0 - slope * slope).sqrt());
        self.at = Direction { sin: sin * level + cos * slope, cos: cos * level - sin * slope };
        // The normal keeps its part along the axle.
        let share = self.normal.dot(&up);
        self.normal -= up * share;
        self.normal -= self.centre_to_contact() * (share / self.radius);
    }
}

/// The normal, in the body, of the plane fitted to the touching points of the wheels that stand on it. None if the
/// wheels stand in a line.
fn fit_plane(chain: &Chain, placed: &Placed<'_>) -> Option<Vector3<f64>> {
    let mut points = [Vector3::zeros(); MAX_WHEELS];
    let count = chain.wheels().len();
    for (wheel, point) in points[..count].iter_mut().enumerate() {
        *point = placed.wheel(wheel).centre;
    }
    let mut slopes = plane_slopes(&points[..count])?;
    for _ in 0..ROUNDS {
        let normal = Vector3::new(-slopes[0], -slopes[1], 1.0).normalize();
        for (wheel, point) in points[..count].iter_mut().enumerate() {
            let frame = placed.wheel(wheel);
            let plane = ContactPlane::new(frame, normal, chain.wheels()[wheel].radius);
            *point = frame.centre + plane.centre_to_contact();
        }
        let next = plane_slopes(&points[..count])?;
        let change = (next[0] - slopes[0]).abs().max((next[1] - slopes[1]).abs());
        slopes = next;
        if change <= FOUND {
            break;
        }
    }
    Some(Vector3::new(-slopes[0], -slopes[1], 1.0).normalize())
}

/// Slopes along x and y of the plane nearest to points, in least squares of the heights. None if they lie in a line.
fn plane_slopes(points: &[Vector3<f64>]) -> Option<[f64; 2]> {
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
