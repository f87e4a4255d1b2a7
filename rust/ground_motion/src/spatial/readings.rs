//! Readings at both ends of one step, the turn between two tilts, and the motion by wheels, joints and tilt.

use nalgebra::{UnitQuaternion, Vector3};

use super::sample::Read;
use super::settings::Settings3;
use crate::{Contacts, Response};
use six_wheel_kinematics::geometry::Direction;
use six_wheel_terrain::suspension::{Chain, MAX_WHEELS};

/// The readings at both ends of a step.
pub(crate) struct StepReadings<'a> {
    pub chain: &'a Chain,
    pub settings: &'a Settings3,
    pub radii: &'a [f64; MAX_WHEELS],
    /// Standard deviation of the distance that a wheel's centre moves across the ground [m].
    pub centre_deviation: f64,
    /// Climb of every wheel against the plane of all, as a sine.
    pub slopes: &'a [f64; MAX_WHEELS],
    pub before: &'a Read,
    pub after: &'a Read,
    /// Rotation of every wheel [rad].
    pub turned: &'a [f64; MAX_WHEELS],
    /// Length of the step [s].
    pub dt: f64,
}

/// Tilt at both ends of a step.
#[derive(Clone, Copy)]
pub(crate) struct TiltPair {
    /// `Ry(pitch) Rx(roll)` at the start and at the end.
    pub ends: [UnitQuaternion<f64>; 2],
    /// Change of the yaw by the attitudes [rad].
    pub yaw: Option<f64>,
    /// The vertical in the body in the middle of the step.
    pub up: Vector3<f64>,
}

impl TiltPair {
    pub fn of(step: &StepReadings<'_>) -> Option<Self> {
        let (first, last) = (step.before.attitude?, step.after.attitude?);
        let ends = [first.tilt(), last.tilt()];
        let up = ends.map(|tilt| tilt.inverse() * Vector3::z());
        let yaw = first.yaw.zip(last.yaw);
        Some(Self {
            ends,
            yaw: yaw.map(|(first, last)| six_wheel_kinematics::geometry::wrap_angle(last - first)),
            up: (up[0] + up[1]) * 0.5,
        })
    }

    /// Rotation vector of the body over the step [rad], for this change of the yaw [rad].
    pub fn turn(&self, yaw: f64) -> Vector3<f64> {
        let [first, last] = &self.ends;
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw);
        (first.inverse() * turn * last).scaled_axis()
    }

    /// Derivatives of the turn by roll and pitch at the start and at the end, at a constant change of the yaw.
    pub fn by_ends(&self, turn: &Vector3<f64>, step: &StepReadings<'_>) -> [[Vector3<f64>; 2]; 2] {
        let rolls = [step.before, step.after].map(|read| read.attitude.map_or(0.0, |one| one.roll));
        let axes = rolls.map(|roll| {
            let (sin, cos) = roll.sin_cos();
            [Vector3::x(), Vector3::new(0.0, cos, -sin)]
        });
        [axes[0].map(|axis| turn.cross(&axis) * 0.5 - axis), axes[1].map(|axis| axis + turn.cross(&axis) * 0.5)]
    }
}

/// Motion by wheels, joints and tilt over a step, before a gyroscope corrects it.
pub(crate) struct WheelMotion {
    /// Displacement over the step, in axes of the body [m, rad].
    pub twist: [f64; 6],
    /// Rotation vector between the measured tilts [rad]; None where tilt was not measured.
    pub turn: Option<Vector3<f64>>,
    /// Change of the yaw, where tilt was measured [rad].
    pub yaw: f64,
    pub contacts: Contacts,
    /// Direction of the contact angle of every wheel.
    pub at: [Direction; MAX_WHEELS],
    /// Sine of the climb of every wheel against the plane of all.
    pub slopes: [f64; MAX_WHEELS],
    /// Distance that every contact slid along its rim and to its left [m].
    pub slid: [[f64; 2]; MAX_WHEELS],
    pub response: Response,
}
