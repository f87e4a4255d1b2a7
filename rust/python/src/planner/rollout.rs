//! `Rover.rollout_cost`: what rollouts ask of the wheels.

use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyTuple, PyType};
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_planner::{Costs, rollout_cost};

use crate::convert::{Out, Precision, Rows, compute};
use crate::geometry::Course;
use crate::rover::Rover;
use crate::workers::workers;

/// Fields of the result, as `out=` names them.
const NAMES: [&str; 5] =
    ["out.poses", "out.max_wheel_speed", "out.max_steering_angle", "out.max_steering_rate", "out.max_side_slip"];

methods! { Rover:
    /// Rollouts for a sampling planner: poses, and the worst that each rollout asks of the wheels.
    ///
    /// One pass over the controls, which need not be possible for this rover: where a wheel cannot steer to where
    /// it should, it takes the nearest angle it can, and `max_side_slip` says by how much that misses. Every step's angles
    /// are those of `inverse` with the angles of the step before as `previous`.
    #[doc = section!(Parameters: controls)]
    /// previous : array_like, shape (steered wheels,), optional
    ///     Present steering angles [rad]; without them the first step costs no steering rate.
    /// out : RolloutCost or tuple of ndarray, optional
    ///     Five arrays of the shapes below to write to, such as the result of an earlier call.
    #[doc = parameters!(dtype, threads)]
    /// level : str, optional
    ///     One of `simd_levels()`, default the best: they agree to 5 ulp or 1e-14.
    #[doc = returns!("RolloutCost")]
    ///     A named tuple: ``poses`` (..., k, t + 1, 3) [m, m, rad], the first of every rollout its start, and the
    ///     largest of each rollout, shape (..., k): ``max_wheel_speed`` either way round [rad/s], ``max_steering_angle`` to
    ///     either side [rad], ``max_steering_rate`` from step to step, over the duration of the later one [rad/s], and
    ///     ``max_side_slip``, at which a wheel slides sideways [m/s].
    #[doc = raises!(ValueError)]
    ///     If a value is not finite, a duration is not positive or a shape does not fit; nothing is written.
    ///
    /// Source: G. Williams et al., Information-theoretic model predictive control, IEEE T-RO 34(6), 2018.
    fn rollout_cost[&self, py: Python<'py>](controls, dt, start=None, *, previous=None, out=None, dtype=None,
        threads: Option<i64> = None, level: Option<&str> = None)
    as "($self, controls, dt, start=(0.0, 0.0, 0.0), *, previous=None, out=None, dtype=None, threads=None, level=None)"
    -> PyResult<Bound<'py, PyAny>> {
        let course = Course::read_controls(controls, dt, start)?;
        let previous = Rows::read_beside("previous", previous, self.joints(), &[])?;
        let results = Out::read_all(out, NAMES, "be a RolloutCost or a tuple of its five arrays")?;
        let precision = Precision::read(py, dtype, out)?;
        let logs = course.logs().to_vec();
        let shapes = [course.poses_shape(), logs.clone(), logs.clone(), logs.clone(), logs];
        let mut results = results.results(py, shapes, precision, false)?;
        let [poses, wheel_speed, steering_angle, steering_rate, scrub] = results.flat();
        let targets = Costs { wheel_speed, steering_angle, steering_rate, scrub };
        let rows = course.twists.count();
        let workers = Workers { fresh: out.is_none(), ..workers(threads, level)? };
        let (controls, steps, starts) = (course.twists.table(), course.durations(), course.starts());
        let (count, target) = (course.count, poses.as_chunks_mut().0);
        let previous = previous.as_ref().map(Rows::flat);
        compute(py, rows, || {
            rollout_cost(&self.core, controls, count, steps, starts, previous, target, targets, workers)
        })
        .map_err(|error| course.raise(error))?;
        result(py, PyTuple::new(py, results.finish_arrays()?)?)
    }
}

/// The named tuple of five arrays.
fn result<'py>(py: Python<'py>, arrays: Bound<'py, PyTuple>) -> PyResult<Bound<'py, PyAny>> {
    static RESULT: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    RESULT.import(py, "six_wheel.kinematics.objects.rollout_cost", "RolloutCost")?.call1(arrays)
}
