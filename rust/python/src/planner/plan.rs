//! `six_wheel.MppiPlan`.

use numpy::PyArray1;
use pyo3::prelude::*;
use six_wheel_planner::{CycleOutput, ImmobileReason, State};

use crate::convert::{Array, Output};

result_class! {
    /// Result of one planning cycle.
    pub struct MppiPlan {
        /// The motion to command now, ``[vx, vy, omega]`` in body axes, shape (3,) [m/s, m/s, rad/s].
        twist: Py<PyAny>,
        /// Angles of the steering joints after this step, shape (steered wheels,) [rad].
        steering: Py<PyAny>,
        /// Speeds of the wheels, shape (wheels,) [rad/s].
        wheel_speeds: Py<PyAny>,
        /// The motions the plan leads to, within the limits, shape (horizon, 3) [m/s, m/s, rad/s].
        twists: Py<PyAny>,
        /// The poses they lead to, the first one where the rover is, shape (horizon + 1, 3) [m, m, rad].
        poses: Py<PyAny>,
        /// Wished motion of every step: the weighted mean of the samples, shape (horizon, 3) [m/s, m/s, rad/s].
        controls: Py<PyAny>,
        /// Lowest cost of a rollout.
        cost: f64,
        /// Effective number of rollouts: one over the sum of their squared weights.
        effective_samples: f64,
        /// Reason for which the rover stays, or should stay: it cannot move, every way is blocked, or it is at its goal;
        /// empty if it may move.
        reason: String,
    }
}

impl MppiPlan {
    pub(super) fn of(
        py: Python<'_>,
        outcome: &CycleOutput,
        blocked: bool,
        state: &State,
        [steering, wheel_speeds]: [Py<PyAny>; 2],
    ) -> PyResult<Self> {
        Ok(Self {
            twist: PyArray1::from_slice(py, &outcome.twist).into_any().unbind(),
            steering,
            wheel_speeds,
            twists: triples(py, &outcome.twists)?.into_any().unbind(),
            poses: triples(py, &outcome.poses)?.into_any().unbind(),
            controls: triples(py, &state.controls)?.into_any().unbind(),
            cost: outcome.cost,
            effective_samples: outcome.effective,
            reason: match outcome.stuck {
                Some(ImmobileReason::Rover) => "no motion lets all wheels of this rover roll",
                Some(ImmobileReason::SteeringLimit) => "a steered wheel has no angle within steering_limit",
                None if blocked => "every rollout and the plan come to a lethal place of the costmap",
                None if outcome.arrived => "the rover is at its goal",
                None => "",
            }
            .into(),
        })
    }
}

#[pymethods]
impl MppiPlan {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let twist: [f64; 3] = self.twist.bind(py).extract()?;
        let [vx, vy, omega] = twist;
        let why = if self.reason.is_empty() { String::new() } else { format!(", reason={:?}", self.reason) };
        let (cost, effective) = (self.cost, self.effective_samples);
        Ok(format!(
            "MppiPlan(twist=({vx:.4}, {vy:.4}, {omega:.4}), cost={cost:.4}, effective_samples={effective:.1}{why})"
        ))
    }
}

/// Rows of numbers.
pub fn triples<'py>(py: Python<'py>, rows: &[[f64; 3]]) -> PyResult<Array<'py>> {
    let mut output = Output::fresh(py, &[rows.len(), 3])?;
    output.triples().copy_from_slice(rows);
    output.finish()
}
