//! Contacts of a settled rover: their directions, and their velocities by the rates.

use nalgebra::Vector3;

use crate::rates::contact_rows::COLUMNS;
use crate::rates::point_rows::{Row, in_body, point_rows};
use six_wheel_kinematics::geometry::Direction;
use six_wheel_terrain::suspension::{Chain, MAX_FREE, MAX_WHEELS, Placed, WheelFrame};

/// One wheel on the ground.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// Derivatives by the rates of the velocity of the touching point along the normal, along the rim and to the left
    /// [m/s], of a wheel that does not turn against its link.
    pub rows: [Row; 3],
    /// Derivatives of these velocities by the rate of the wheel's own steering joint [m/rad].
    pub swivel: [f64; 3],
    /// Index of its steering joint; None for an unsteered wheel.
    pub steering: Option<usize>,
    /// True if the wheel touches the ground.
    pub touching: bool,
}

/// Plane on which a wheel stands, and the contact angle at which the wheel touches it.
pub(crate) struct ContactPlane {
    pub frame: WheelFrame,
    pub normal: Vector3<f64>,
    pub radius: f64,
    /// Direction of the contact angle.
    pub at: Direction,
}

impl ContactPlane {
    /// The contact of the lower side of a wheel on a plane.
    pub fn new(frame: WheelFrame, normal: Vector3<f64>, radius: f64) -> Self {
        let (ahead, up) = (frame.forward.dot(&normal), frame.up.dot(&normal));
        let length = ahead.hypot(up);
        // The normal along the axle leaves the contact angle open: 0.
        let at = match length {
            0.0 => Direction::from(0.0),
            _ => Direction { sin: -ahead / length, cos: up / length },
        };
        Self { frame, normal, radius, at }
    }

    /// The direction in which the wheel rolls.
    pub fn tangent(&self) -> Vector3<f64> {
        self.frame.tangent(self.at)
    }

    /// Vector from the wheel's centre to the touching point, in the body [m].
    pub fn centre_to_contact(&self) -> Vector3<f64> {
        self.frame.spoke(self.at) * self.radius
    }
}

/// The contacts of all wheels: the velocities of their touching points as linear functions of the rates.
#[derive(Clone, Copy, Debug)]
pub struct Contacts {
    /// Wheel by wheel; the first `count` are filled.
    pub wheels: [Contact; MAX_WHEELS],
    /// Number of wheels.
    pub count: usize,
    /// Number of free angles.
    pub joints: usize,
    /// True for the free angles at a stop: their rates are 0.
    pub stopped: [bool; MAX_FREE],
}

impl Contacts {
    /// Nothing touches yet.
    pub(crate) fn none(chain: &Chain, stopped: [bool; MAX_FREE]) -> Self {
        let blank = Contact { rows: [[0.0; COLUMNS]; 3], swivel: [0.0; 3], steering: None, touching: false };
        Self { wheels: [blank; MAX_WHEELS], count: chain.wheels().len(), joints: chain.joints().len(), stopped }
    }

    pub(crate) fn touching(&self) -> impl Iterator<Item = (usize, &Contact)> {
        let wheels = self.wheels[..self.count].iter().enumerate();
        wheels.filter(|(_, contact)| contact.touching)
    }
}

impl Contact {
    pub(crate) fn new(placed: &Placed<'_>, wheel: usize, plane: &ContactPlane, touching: bool) -> Self {
        let (normal, tangent) = (plane.normal, plane.tangent());
        let directions = [normal, tangent, normal.cross(&tangent)];
        let point = plane.frame.centre + plane.centre_to_contact();
        let (rows, swivel) = point_rows(placed, wheel, point, directions);
        let steering = placed.steering_axes(wheel).next().map(|(joint, _, _)| joint);
        Self { rows, swivel, steering, touching }
    }
}

/// Velocity of a wheel's centre [m/s] and angular velocity of the link that carries it [rad/s], at given rates.
pub(crate) fn carried(placed: &Placed<'_>, wheel: usize, rates: &Row) -> (Vector3<f64>, Vector3<f64>) {
    let centre = placed.wheel(wheel).centre;
    let [vx, vy, vz, wx, wy, wz, joint_rates @ ..] = *rates;
    let mut turn = Vector3::new(wx, wy, wz);
    let mut velocity = Vector3::new(vx, vy, vz) + turn.cross(&centre);
    for (joint, axis, origin) in placed.free_axes(wheel) {
        let swing = axis * joint_rates[joint];
        velocity += swing.cross(&(centre - origin));
        turn += swing;
    }
    (velocity, turn)
}

/// Distance of the mean of the unsteered wheels' centres behind the body's origin, all angles 0 [m]. On level ground a
/// rover scrubs least when its centre of rotation is at this distance behind the origin.
pub fn rest_offset(chain: &Chain) -> f64 {
    let Some(placed) = in_body(chain, &[], &[]) else {
        return 0.0;
    };
    let fixed = |wheel: &usize| placed.steering_axes(*wheel).next().is_none();
    let unsteered: Vec<f64> =
        (0..chain.wheels().len()).filter(fixed).map(|wheel| placed.wheel(wheel).centre.x).collect();
    if unsteered.is_empty() {
        return 0.0;
    }
    0.0 - unsteered.iter().sum::<f64>() / unsteered.len() as f64 // not minus zero
}
