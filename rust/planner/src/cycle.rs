//! Input and output of a cycle, and the state kept from one to the next.

use super::costmap::Costmap;
use crate::motion::limits::ImmobileReason;

/// State of a planner that is kept from one cycle to the next.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Control of every step, in body axes [m/s, m/s, rad/s].
    pub controls: Vec<[f64; 3]>,
    /// Cycles so far.
    pub cycle: u32,
    /// Commanded angles of the steering joints [rad].
    pub steering: Vec<f64>,
    /// Distance of the rover along its path [m].
    pub progress: f64,
}

/// Input of a cycle.
#[derive(Clone, Copy, Debug, Default)]
pub struct CycleInput<'a> {
    /// Pose x, y, yaw [m, m, rad].
    pub pose: [f64; 3],
    /// Twist in body axes [m/s, m/s, rad/s].
    pub twist: [f64; 3],
    /// Measured steering angles [rad].
    pub steering: Option<&'a [f64]>,
    /// Costs of positions.
    pub costmap: Option<&'a Costmap>,
    /// Corners of the path [m].
    pub path: Option<&'a [[f64; 2]]>,
    /// Position of the goal [m]; the end of the path if not given.
    pub goal: Option<[f64; 2]>,
    /// Yaw to have at the goal [rad].
    pub goal_yaw: Option<f64>,
    /// True if the rollouts' poses are kept, for an extra cost.
    pub record: bool,
}

/// Output of a cycle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CycleOutput {
    /// The motion to command now [m/s, m/s, rad/s].
    pub twist: [f64; 3],
    /// Commands for this step: steering angles [rad] and wheel speeds [rad/s].
    pub steering: Vec<f64>,
    /// See `steering`.
    pub speeds: Vec<f64>,
    /// Twists [m/s, m/s, rad/s] and poses [m, m, rad] of the rollout of the mean: one row a step, poses with the start
    /// first.
    pub twists: Vec<[f64; 3]>,
    /// See `twists`.
    pub poses: Vec<[f64; 3]>,
    /// Lowest cost of a rollout.
    pub cost: f64,
    /// Effective number of rollouts: one over the sum of the squared weights.
    pub effective: f64,
    /// Reason why the rover cannot move; None if it can.
    pub stuck: Option<ImmobileReason>,
    /// True if the rover is at its goal: within one standard deviation of the displacement by the noise of one step.
    pub arrived: bool,
}
