//! Brakes, plans and simulation of `six_wheel.FourAxle`.

use pyo3::prelude::*;
use pyo3::types::PyTuple;
use six_wheel_four_axle::{Axles, Brakes, FourAxle as Core, Pair, State};
use six_wheel_numerics::error::Error;

use super::FourAxle;
use super::values::{array, pace, raised, read_state, read_step, value, vector, write_plan, write_state, write_step};
use crate::convert::{compute, is_interrupted, items};

/// Steps of a sequence that are looked at.
const MOST_STEPS: usize = 1 << 20;

impl FourAxle {
    fn with_brakes<'py>(
        &self,
        py: Python<'py>,
        state: &Bound<'py, PyAny>,
        pair: &str,
        change: impl FnOnce(&Core, &Axles, Brakes, Pair) -> Result<Brakes, Error>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let state = read_state(state)?;
        let pair = pair.parse().map_err(raised)?;
        let brakes = change(&self.core, &state.angles, state.brakes, pair).map_err(raised)?;
        write_state(py, &State { brakes, ..state })
    }
}

methods! { FourAxle:
    /// The step that drives on with both pairs locked.
    #[doc = section!(Parameters)]
    /// state : FourAxleState
    ///     Pose and angles at the beginning.
    /// speed : float
    ///     Root mean square speed of the pivots [m/s]: straight ahead the speed of the body. Negative
    ///     backwards.
    #[doc = parameters!(duration)]
    #[doc = returns!("FourAxleStep")]
    #[doc = raises!(
        InfeasibleMotionError: "If the robot cannot move with these angles locked.",
        ValueError: "If the speed is not finite or the duration not positive."
    )]
    fn drive[&self, py: Python<'py>](state, speed: f64, duration: f64) -> PyResult<Bound<'py, PyAny>> {
        let step = self.core.drive(read_state(state)?, speed, duration);
        write_step(py, &step.map_err(raised)?)
    }

    /// Steps that re-aim the axles for a curve, without a stop if the axles allow it.
    ///
    /// Free the rear, let its wheels turn it, lock it, then the same in front; or the other way round, or by
    /// way of straight ahead; a pair that stays is left out. Under way the free pair has constant wheel
    /// speeds and the drives of the locked pair follow. That needs the axles of the locked pair in line:
    /// rigid axles always are, those on two pivots at angle 0. Where it cannot be, the robot stops: one pair turns
    /// while the other and its wheels hold the body.
    #[doc = section!(Parameters)]
    /// state : FourAxleState
    ///     Pose and angles at the beginning, both pairs locked.
    /// curvature : float
    ///     To turn with [1/m], positive to the left; 0 is straight ahead.
    /// steer : {'both', 'front', 'rear'}
    ///     Axles that turn: the centre of rotation lies abreast of the origin, of the rear pivots, of the
    ///     front pivots.
    /// speed : float, default 0.0
    ///     Root mean square speed of the pivots to begin with [m/s]; 0 to re-aim standing.
    /// pivot_rate : float, default 0.5
    ///     Rate of the faster axle where the pair turns slowest [rad/s].
    /// brake_time : float, default 0.0
    ///     For how long to drive on with both pairs locked after locking one under way [s].
    #[doc = returns!("TurnSequence")]
    ///     ``.steps`` with their expected ends, ``.stops``, and ``.reason``, which says why it stops or takes
    ///     a detour.
    #[doc = raises!(
        InfeasibleMotionError: "If an axle would leave its range.",
        ValueError: "If a value is not finite or a brake is free."
    )]
    fn turn_sequence[&self, py: Python<'py>](state, curvature: f64, *, steer: &str = "both", speed: Option<f64> = None,
        pivot_rate: Option<f64> = None, brake_time: Option<f64> = None)
    as "($self, state, curvature, *, steer='both', speed=0.0, pivot_rate=0.5, brake_time=0.0)"
    -> PyResult<Bound<'py, PyAny>> {
        let steer = steer.parse().map_err(raised)?;
        let pace = pace(speed, pivot_rate, brake_time);
        let plan = self.core.turn_sequence(read_state(state)?, curvature, steer, pace);
        write_plan(py, &plan.map_err(raised)?)
    }

    /// Steps that re-aim the axles at a point, without a stop if the axles allow it: (0, 0) to spin in place.
    #[doc = section!(Parameters)]
    /// state : FourAxleState
    ///     Pose and angles at the beginning, both pairs locked.
    /// icr : array_like, shape (2,)
    ///     The point, as in `concurrent_angles` [m].
    /// speed, pivot_rate, brake_time : float
    ///     Speed [m/s], rate of the faster axle [rad/s] and time with both pairs locked [s], as in `turn_sequence`.
    #[doc = returns!("TurnSequence")]
    #[doc = raises!(InfeasibleMotionError, ValueError)]
    ///     As `turn_sequence` and `concurrent_angles`.
    fn aim_sequence[&self, py: Python<'py>](state, icr: [f64; 2], *, speed: Option<f64> = None,
        pivot_rate: Option<f64> = None, brake_time: Option<f64> = None)
    as "($self, state, icr, *, speed=0.0, pivot_rate=0.5, brake_time=0.0)" -> PyResult<Bound<'py, PyAny>> {
        let pace = pace(speed, pivot_rate, brake_time);
        let plan = self.core.aim_sequence(read_state(state)?, icr, pace);
        write_plan(py, &plan.map_err(raised)?)
    }

    /// Drives a sequence: what body and free pivots do at the wheel speeds of its steps.
    ///
    /// Every change of a brake is checked at the angles where it happens. Motion with both pairs locked is
    /// exact; with a free pair it is integrated until half the step changes nothing beyond 1e-12 rad and m.
    #[doc = section!(Parameters)]
    /// sequence : iterable of FourAxleStep
    ///     Steps to do; the ends of planned steps are not looked at.
    /// dt : float
    ///     Largest time between samples [s].
    /// state : FourAxleState, optional
    ///     Pose and angles at the beginning; by default straight ahead at the origin, both pairs locked.
    #[doc = returns!("FourAxleSimulation")]
    ///     ``.stamps``, ``.poses``, ``.steering``, ``.twists``, ``.wheel_speeds``, ``.residuals``,
    ///     ``.ends``, ``.final``.
    #[doc = raises!(
        InfeasibleMotionError: "If a brake may not change at the angles it would change at; the step is named.",
        UnderdeterminedError: "If the wheels of a step do not determine the motion.",
        ValueError: "If a value is not finite, `dt` not positive, or an axle leaves its range."
    )]
    fn simulate[&self, py: Python<'py>](sequence, dt: f64, *, state=None) -> PyResult<Bound<'py, PyAny>> {
        let start = state.map_or(Ok(State::default()), read_state)?;
        let given = items("sequence", sequence, MOST_STEPS)?;
        let steps = given.iter().map(read_step).collect::<PyResult<Vec<_>>>()?;
        let (track, end) = compute(py, usize::MAX, || self.core.simulate(start, &steps, dt, is_interrupted)).map_err(raised)?;
        let ends: Vec<i64> = track.ends.into_iter().map(|row| row as i64).collect();
        let keywords = dict!(
            py,
            rover = &self.rover,
            steps = PyTuple::new(py, given)?,
            stamps = vector(py, track.times),
            poses = array(py, &track.poses)?,
            steering = array(py, &track.angles)?,
            twists = array(py, &track.twists)?,
            wheel_speeds = array(py, &track.speeds)?,
            residuals = array(py, &track.residual)?,
            ends = vector(py, ends),
            final = write_state(py, &end)?
        );
        value(py, "FourAxleSimulation")?.call((), Some(&keywords))
    }

    /// The state with a pair locked.
    #[doc = section!(Parameters)]
    /// state : FourAxleState
    ///     The present state; it is left as it is.
    /// pair : {'front', 'rear'}
    ///     Brake to set.
    #[doc = returns!("FourAxleState")]
    #[doc = raises!(InfeasibleMotionError)]
    ///     If both pairs locked at these angles could not move; the message has the singular value and the
    ///     angles at which the pair could be locked.
    fn lock[&self, py: Python<'py>](state, pair: &str) -> PyResult<Bound<'py, PyAny>> {
        self.with_brakes(py, state, pair, Core::lock)
    }

    /// The state with a pair free.
    ///
    /// Both pairs may be free only where locking both would be refused: there the axles themselves hold the
    /// body.
    #[doc = section!(Parameters)]
    /// state : FourAxleState
    ///     The present state; it is left as it is.
    /// pair : {'front', 'rear'}
    ///     Brake to release.
    #[doc = returns!("FourAxleState")]
    #[doc = raises!(InfeasibleMotionError)]
    ///     If the other pair is free and the axle lines share a point: nothing would hold the body.
    fn release[&self, py: Python<'py>](state, pair: &str) -> PyResult<Bound<'py, PyAny>> {
        self.with_brakes(py, state, pair, Core::release)
    }
}
