//! What a cycle is told, what it found, and what is remembered from one to the next.

use super::costmap::Costmap;
use crate::motion::facts::Stuck;

/// All that a planner remembers from one cycle to the next.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// What is wished at every step, in body axes [m/s, m/s, rad/s].
    pub controls: Vec<[f64; 3]>,
    /// Cycles so far.
    pub cycle: u32,
    /// Where the steering joints are meant to be [rad].
    pub steering: Vec<f64>,
    /// How far along its path the rover is [m].
    pub progress: f64,
}

/// What a cycle is told.
#[derive(Clone, Copy, Debug, Default)]
pub struct Situation<'a> {
    /// x, y, yaw [m, m, rad].
    pub pose: [f64; 3],
    /// In body axes [m/s, m/s, rad/s].
    pub twist: [f64; 3],
    /// Measured steering angles [rad].
    pub steering: Option<&'a [f64]>,
    /// What it costs to be somewhere.
    pub costmap: Option<&'a Costmap>,
    /// Corners of the path [m].
    pub path: Option<&'a [[f64; 2]]>,
    /// Where to go [m]; the end of the path if not given.
    pub goal: Option<[f64; 2]>,
    /// Whether the ways are kept, for an extra cost.
    pub record: bool,
}

/// What a cycle found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// The motion to command now [m/s, m/s, rad/s].
    pub twist: [f64; 3],
    /// Where its joints have to be after this step [rad], and how fast its wheels roll [rad/s].
    pub steering: Vec<f64>,
    /// See `steering`.
    pub speeds: Vec<f64>,
    /// Motions and poses that the mean leads to: one row a step, poses with the start first.
    pub twists: Vec<[f64; 3]>,
    /// See `twists`.
    pub poses: Vec<[f64; 3]>,
    /// Lowest cost of a rollout.
    pub cost: f64,
    /// How many rollouts count: one over the sum of the squared weights.
    pub effective: f64,
    /// Why the rover stays, if it has to.
    pub stuck: Option<Stuck>,
}
