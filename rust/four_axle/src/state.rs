//! States, steps and motions of a robot with four axles on pivots.

use crate::brakes::Brakes;
use six_wheel_kinematics::geometry::{Pose, Twist};

/// One number per axle: front left, front right, rear left, rear right.
pub type Axles = [f64; 4];

/// Wheel speeds [rad/s]; `None` where the drive follows: the wheel turns freely by the motion of the robot.
pub type Drives = [Option<f64>; 4];

/// State of a robot; by default straight ahead at the origin, both pairs locked.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Headings of the wheels in the body [rad].
    pub angles: Axles,
    /// The pivots that are locked and those that are free.
    pub brakes: Brakes,
    /// `world_from_body`.
    pub pose: Pose,
}

/// One step of a sequence: brakes and constant wheel speeds for a time.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Name of the step, in two words.
    pub action: String,
    /// Duration [s]; 0 for a brake alone.
    pub duration: f64,
    /// Brakes, set at its start.
    pub brakes: Brakes,
    /// Constant wheel speeds [rad/s].
    pub speeds: Drives,
    /// State at its end.
    pub end: State,
}

/// Mobility of the robot with all axles at given angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mobility {
    /// Rank of the four side-slip rows; 3 means locked.
    pub rank: usize,
    /// Singular values of those rows, in the units of the rows, descending.
    pub singular_values: [f64; 3],
    /// Right singular vectors as twists, the free ones last: each moves the pivots at 1 m/s (root mean square).
    pub(crate) motions: [Twist; 3],
    /// Side slip of the least slipping motion per distance driven, both root mean square over the wheels.
    pub slip: f64,
    /// Tolerance less slip.
    pub margin: f64,
}

impl Mobility {
    /// Number of independent motions without slip: 3 - rank.
    pub fn degree(&self) -> usize {
        3 - self.rank
    }

    /// The free motions.
    pub fn free(&self) -> &[Twist] {
        &self.motions[self.rank..]
    }

    /// The motion that slips least, free or not.
    pub fn least(&self) -> Twist {
        self.motions[2]
    }
}

/// Velocities of body and pivots at given wheel speeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Twist of the body.
    pub twist: Twist,
    /// Rates of the axles in the body [rad/s]; 0 where locked.
    pub pivot_rates: Axles,
    /// Speeds of all wheels, the following ones included [rad/s].
    pub speeds: Axles,
    /// Speed at which each contact slides [m/s].
    pub residual: Axles,
    /// Number of unknowns of body and free pivots, all of which the wheels determine.
    pub rank: usize,
}
