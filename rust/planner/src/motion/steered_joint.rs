//! Steered wheels of a planner, and the ranges of their angles.

use std::f64::consts::{FRAC_PI_2, PI};

use six_wheel_kinematics::steering::SteeringRange;

/// A steered wheel: rows of the velocity of its pivot along the middle of its range and across it.
#[derive(Clone, Debug)]
pub(crate) struct SteeredJoint {
    pub along: Vec<f64>,
    pub across: Vec<f64>,
    /// Steering angle of the middle, and half the range, a quarter turn at most [rad].
    pub middle: f64,
    pub half: f64,
}

impl SteeredJoint {
    /// The angle in its range that is nearest to 0 [rad].
    pub fn straight(&self) -> f64 {
        0.0_f64.clamp(self.middle - self.half, self.middle + self.half)
    }
}

/// Middle and half of a steered wheel's range within the steering limit [rad], a quarter turn to either
/// side at most. None if it is empty.
pub(super) fn window(range: SteeringRange, limit: f64) -> Option<(f64, f64)> {
    let (lower, upper) = (range.lower.max(-limit), range.upper.min(limit));
    if lower > upper {
        return None;
    }
    let middle = if upper - lower > PI {
        0.0_f64.clamp(lower + FRAC_PI_2, upper - FRAC_PI_2)
    } else {
        f64::midpoint(lower, upper)
    };
    Some((middle, ((upper - lower) / 2.0).min(FRAC_PI_2)))
}
