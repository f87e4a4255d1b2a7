//! Twists and poses.

mod course;

use pyo3::prelude::*;
use pyo3::types::PyFloat;
use six_wheel_kinematics::batch;
use six_wheel_kinematics::geometry as core;
use six_wheel_kinematics::geometry::Steps;
use six_wheel_kinematics::table::Table;
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_planner::Present;

use crate::batch::{any_workers, workers};
use crate::controller::limits::Limits;
use crate::convert::{
    AnyArray, Asked, Blocks, Output, Precision, Rows, Scalars, compute, memory, named, number, raise, refuse,
    shape_text, together,
};
use crate::given;
use crate::rover::Rover;
pub use course::Course;

/// Poses along a log of twists, each held over its step.
///
/// Exact for a twist that is constant over each step, whatever the length of the step. The sums carry
/// their rounding errors along, and the yaw keeps its full turns.
///
/// Parameters
/// ----------
/// twists : array_like, shape (..., n, 3)
///     Rows ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s]. Leading axes are separate logs.
/// dt : float or array_like, shape (n,)
///     Duration of the steps [s]; 0 where a recording has the same stamp twice: nothing moves.
/// start : array_like, shape (3,) or (..., 3), default (0, 0, 0)
///     First pose ``[x, y, yaw]`` [m, m, rad], of all logs or of each.
/// out : ndarray, shape (..., n + 1, 3), optional
///     Where to write the poses.
/// dtype : dtype, optional
///     float32 for a result of single precision, default float64; it is computed in double precision.
/// threads : int, optional
///     Threads at most, default `default_threads()`: logs are shared out among them. No result depends on it.
/// kernel : str, optional
///     One of `kernels()`, default the best.
///
/// Returns
/// -------
/// ndarray, shape (..., n + 1, 3)
///     Rows ``[x, y, yaw]`` [m, m, rad], the first of which is `start`.
///
/// Raises
/// ------
/// ValueError
///     If a value is not finite or a duration is negative.
///
/// Source: R. M. Murray, Z. Li, S. S. Sastry, A Mathematical Introduction to Robotic Manipulation, ch. 2.
#[pyfunction]
#[pyo3(
    signature = (twists, dt, start=None, *, out=None, dtype=None, threads=None, kernel=None),
    text_signature = "(twists, dt, start=(0.0, 0.0, 0.0), *, out=None, dtype=None, threads=None, kernel=None)"
)]
#[allow(clippy::too_many_arguments)] // they are keywords
pub fn integrate<'py>(
    py: Python<'py>,
    twists: &Bound<'py, PyAny>,
    dt: &Bound<'py, PyAny>,
    start: Option<&Bound<'py, PyAny>>,
    out: Option<&Bound<'py, PyAny>>,
    dtype: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = given::threads)] threads: Option<i64>,
    #[pyo3(from_py_with = given::kernel)] kernel: Option<&str>,
) -> PyResult<AnyArray<'py>> {
    let twists = Blocks::read("twists", twists, 3)?;
    let course = Course::read("twists", twists, dt, start)?;
    poses_along(py, &course, (out, dtype), (threads, kernel))
}

/// Poses of a sampling planner's rollouts: `integrate` for many short logs that start from one pose.
///
/// Parameters
/// ----------
/// controls : array_like, shape (..., k, t, 3)
///     Rows ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s]: k rollouts of t steps.
/// dt : float or array_like, shape (t,)
///     Duration of the steps [s].
/// start : array_like, shape (3,) or (..., k, 3), default (0, 0, 0)
///     First pose ``[x, y, yaw]`` [m, m, rad], of all rollouts or of each.
/// out : ndarray, shape (..., k, t + 1, 3), optional
///     Where to write the poses.
/// dtype : dtype, optional
///     float32 for a result of single precision, default float64; it is computed in double precision.
/// rover : Rover, optional
///     Whose motions they are: controls are then wishes, as those of `Mppi`, and what the rover cannot do at once becomes
///     what it does instead. The steps take one time, `dt`.
/// limits : Limits, optional
///     What these motions may not exceed.
/// twist : array_like, shape (3,), optional
///     How the rover moves at the start, in body axes [m/s, m/s, rad/s]; default at rest.
/// steering : array_like, shape (steered wheels,), optional
///     Where its steering joints are then [rad]; default straight ahead.
/// delay : float, default 0.0
///     How long it goes on as it does before a control has an effect [s].
/// threads : int, optional
///     Threads at most, default `default_threads()`: logs are shared out among them. No result depends on it.
/// kernel : str, optional
///     One of `kernels()`, default the best.
///
/// Returns
/// -------
/// ndarray, shape (..., k, t + 1, 3)
///     Rows ``[x, y, yaw]`` [m, m, rad], the first of every rollout its start.
///
/// Raises
/// ------
/// ValueError
///     If a value is not finite or a duration is negative.
#[pyfunction]
#[pyo3(
    signature = (controls, dt, start=None, *, out=None, dtype=None, rover=None, limits=None, twist=None, steering=None, delay=0.0, threads=None, kernel=None),
    text_signature = "(controls, dt, start=(0.0, 0.0, 0.0), *, out=None, dtype=None, rover=None, limits=None, twist=None, steering=None, delay=0.0, threads=None, kernel=None)"
)]
#[allow(clippy::too_many_arguments)] // they are keywords
pub fn rollout<'py>(
    py: Python<'py>,
    controls: &Bound<'py, PyAny>,
    dt: &Bound<'py, PyAny>,
    start: Option<&Bound<'py, PyAny>>,
    out: Option<&Bound<'py, PyAny>>,
    dtype: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = given::rover)] rover: Option<Bound<'py, Rover>>,
    #[pyo3(from_py_with = given::limits)] limits: Option<Limits>,
    twist: Option<&Bound<'py, PyAny>>,
    steering: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = given::delay)] delay: f64,
    #[pyo3(from_py_with = given::threads)] threads: Option<i64>,
    #[pyo3(from_py_with = given::kernel)] kernel: Option<&str>,
) -> PyResult<AnyArray<'py>> {
    let course = Course::read_controls(controls, dt, start)?;
    let Some(rover) = rover else {
        let given = [
            ("limits", limits.is_some()),
            ("twist", twist.is_some()),
            ("steering", steering.is_some()),
            ("delay", delay != 0.0),
        ];
        if let Some((name, _)) = given.iter().find(|(_, given)| *given) {
            return Err(refuse(name, "come with a rover", "none"));
        }
        return poses_along(py, &course, (out, dtype), (threads, kernel));
    };
    let dt = number("dt", dt)?;
    let twist = Rows::read_beside("twist", twist, 3, &[])?;
    let steering = Rows::read_beside("steering", steering, rover.get().joints(), &[])?;
    let mut buffer;
    let flat = match course.twists.table() {
        Table::Flat(values) => values,
        Table::Read(source) => {
            buffer = memory::filled(0.0, 3 * course.twists.count())?;
            source.read(0, &mut buffer);
            &buffer
        }
    };
    let mut poses = course.poses(py, "out", out, Precision::read(py, dtype, out)?)?;
    let workers = any_workers(threads, kernel)?;
    let present = Present {
        twist: twist.as_ref().map_or([0.0; 3], |rows| rows.triples()[0]),
        steering: steering.as_ref().map(Rows::flat),
        delay,
    };
    let limits = limits.map_or_else(Default::default, |limits| limits.0);
    let (core, starts, count) = (&rover.get().core, course.starts(), course.count);
    let (controls, target) = (flat.as_chunks().0, poses.triples());
    compute(py, controls.len(), || {
        six_wheel_planner::rollout(core, limits, controls, count, dt, starts, present, target, workers)
    })
    .map_err(|error| raise(error, &[]))?;
    poses.finish_any()
}

/// Integrates and writes.
fn poses_along<'py>(
    py: Python<'py>,
    course: &Course<'py>,
    (out, dtype): (Option<&Bound<'py, PyAny>>, Option<&Bound<'py, PyAny>>),
    (threads, kernel): (Option<i64>, Option<&str>),
) -> PyResult<AnyArray<'py>> {
    let precision = Precision::read(py, dtype, out)?;
    let mut poses = course.poses(py, "out", out, precision)?;
    let rows = course.twists.count();
    let workers = Workers { fresh: poses.is_unseen(), ..workers(rows, threads, kernel)? };
    let (twists, steps, starts) = (course.twists.table(), course.durations(), course.starts());
    let (count, target) = (course.count, poses.triples());
    compute(py, rows, || batch::integrate(twists, count, steps, starts, target, workers))
        .map_err(|error| course.raise(error))?;
    poses.finish_any()
}

/// The twists that, each held over its step, pass through the poses: the inverse of `integrate`.
///
/// Parameters
/// ----------
/// poses : array_like, shape (n + 1, 3)
///     Rows ``[x, y, yaw]`` [m, m, rad].
/// dt : float or array_like, shape (n,)
///     Duration of the steps [s].
/// out : ndarray, shape (n, 3), optional
///     Where to write the result.
/// dtype : dtype, optional
///     float32 for a result of single precision, default float64.
/// threads : int, optional
///     Threads at most, default `default_threads()`; under 20000 rows it is one. No result depends on it.
///
/// Returns
/// -------
/// ndarray, shape (n, 3)
///     Rows ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s]; each step turns the short way round.
///
/// Raises
/// ------
/// ValueError
///     If there is no pose, a value is not finite or a duration is not positive.
#[pyfunction]
#[pyo3(signature = (poses, dt, *, out=None, dtype=None, threads=None))]
pub fn differentiate<'py>(
    py: Python<'py>,
    poses: &Bound<'py, PyAny>,
    dt: &Bound<'py, PyAny>,
    out: Option<&Bound<'py, PyAny>>,
    dtype: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = given::threads)] threads: Option<i64>,
) -> PyResult<AnyArray<'py>> {
    let workers = any_workers(threads, None)?;
    let poses = Rows::read("poses", poses, 3)?;
    let &[count] = poses.leading.as_slice() else {
        let got = format!("leading axes {}", shape_text(&poses.leading));
        return Err(refuse("poses", "have shape (n + 1, 3)", &got));
    };
    let Some(steps) = count.checked_sub(1) else {
        return Err(refuse("poses", "hold at least one pose", "shape (0, 3)"));
    };
    let mut dt = Scalars::read("dt", dt)?;
    dt.fit("dt", steps)?;
    let mut twists = Output::asked(py, (out, dtype), &[steps, 3])?;
    let (rows, steps, target) = (poses.triples(), dt.steps(), twists.triples());
    compute(py, count, || batch::differentiate(rows, steps, target, workers))
        .map_err(|error| raise(error, &[count]))?;
    twists.finish_any()
}

/// Where holding a twist takes the body frame: the exponential map of SE(2).
///
/// Parameters
/// ----------
/// twist : array_like, shape (..., 3)
///     ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s].
/// dt : float or array_like, shape (...), default 1.0
///     For how long [s].
/// out : ndarray, shape (..., 3), optional
///     Where to write the result.
/// dtype : dtype, optional
///     float32 for a result of single precision, default float64.
/// threads : int, optional
///     Threads at most, default `default_threads()`; under 20000 rows it is one. No result depends on it.
///
/// Returns
/// -------
/// ndarray, shape (..., 3)
///     The end ``[x, y, yaw]`` seen from the start [m, m, rad].
#[pyfunction]
#[pyo3(
    signature = (twist, dt=None, *, out=None, dtype=None, threads=None),
    text_signature = "(twist, dt=1.0, *, out=None, dtype=None, threads=None)"
)]
pub fn exp<'py>(
    py: Python<'py>,
    twist: &Bound<'py, PyAny>,
    dt: Option<&Bound<'py, PyAny>>,
    out: Option<&Bound<'py, PyAny>>,
    dtype: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = given::threads)] threads: Option<i64>,
) -> PyResult<AnyArray<'py>> {
    over_time(py, ("twist", twist), dt, (out, dtype), threads, batch::Map::Exp)
}

/// The twist that reaches a pose along one arc, turning the short way: the logarithm of SE(2).
///
/// Parameters
/// ----------
/// pose : array_like, shape (..., 3)
///     The end ``[x, y, yaw]`` seen from the start [m, m, rad].
/// dt : float or array_like, shape (...), default 1.0
///     In how long [s].
/// out : ndarray, shape (..., 3), optional
///     Where to write the result.
/// dtype : dtype, optional
///     float32 for a result of single precision, default float64.
/// threads : int, optional
///     Threads at most, default `default_threads()`; under 20000 rows it is one. No result depends on it.
///
/// Returns
/// -------
/// ndarray, shape (..., 3)
///     ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s].
#[pyfunction]
#[pyo3(
    signature = (pose, dt=None, *, out=None, dtype=None, threads=None),
    text_signature = "(pose, dt=1.0, *, out=None, dtype=None, threads=None)"
)]
pub fn log<'py>(
    py: Python<'py>,
    pose: &Bound<'py, PyAny>,
    dt: Option<&Bound<'py, PyAny>>,
    out: Option<&Bound<'py, PyAny>>,
    dtype: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = given::threads)] threads: Option<i64>,
) -> PyResult<AnyArray<'py>> {
    over_time(py, ("pose", pose), dt, (out, dtype), threads, batch::Map::Log)
}

/// Applies a map of three numbers and a duration to every row.
fn over_time<'py>(
    py: Python<'py>,
    (argument, value): (&'static str, &Bound<'py, PyAny>),
    dt: Option<&Bound<'py, PyAny>>,
    asked: Asked<'_, 'py>,
    threads: Option<i64>,
    map: batch::Map,
) -> PyResult<AnyArray<'py>> {
    let workers = any_workers(threads, None)?;
    let mut rows = Rows::read(argument, value, 3)?;
    let one = PyFloat::new(py, 1.0).into_any();
    let mut dt = Scalars::read("dt", dt.unwrap_or(&one))?;
    together([named(argument, &mut rows), named("dt", &mut dt)])?;
    match map {
        batch::Map::Log => dt.steps().check_positive(rows.count()),
        _ => dt.steps().check(rows.count()),
    }
    .map_err(|error| raise(error, &rows.leading))?;
    rows.check_finite(argument)?;
    let mut result = Output::asked(py, asked, &rows.shape())?;
    let (triples, steps, target) = (rows.triples(), dt.steps(), result.triples());
    compute(py, triples.len(), || batch::map(map, triples, &[], steps, target, workers))
        .map_err(|error| raise(error, &rows.leading))?;
    result.finish_any()
}

/// One pose after another: `second` is seen from the end of `first`; yaws add up.
///
/// Parameters
/// ----------
/// first, second : array_like, shape (..., 3)
///     ``[x, y, yaw]`` [m, m, rad].
/// out : ndarray, shape (..., 3), optional
///     Where to write the result.
/// dtype : dtype, optional
///     float32 for a result of single precision, default float64.
/// threads : int, optional
///     Threads at most, default `default_threads()`; under 20000 rows it is one. No result depends on it.
///
/// Returns
/// -------
/// ndarray, shape (..., 3)
///     The end of `second` seen from the start of `first`.
#[pyfunction]
#[pyo3(signature = (first, second, *, out=None, dtype=None, threads=None))]
pub fn compose<'py>(
    py: Python<'py>,
    first: &Bound<'py, PyAny>,
    second: &Bound<'py, PyAny>,
    out: Option<&Bound<'py, PyAny>>,
    dtype: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = given::threads)] threads: Option<i64>,
) -> PyResult<AnyArray<'py>> {
    let workers = any_workers(threads, None)?;
    let mut first = Rows::read("first", first, 3)?;
    first.check_finite("first")?;
    let mut second = Rows::read("second", second, 3)?;
    second.check_finite("second")?;
    together([named("first", &mut first), named("second", &mut second)])?;
    let mut result = Output::asked(py, (out, dtype), &first.shape())?;
    let (from, then, target) = (first.triples(), second.triples(), result.triples());
    compute(py, from.len(), || batch::map(batch::Map::Compose, from, then, Steps::Constant(1.0), target, workers))
        .map_err(|error| raise(error, &first.leading))?;
    result.finish_any()
}

/// Angles brought into [-pi, pi] by whole turns; unchanged if they are there already.
///
/// Parameters
/// ----------
/// angle : float or array_like, shape (...)
///     Angles [rad].
/// out : ndarray, shape (...), optional
///     Where to write the result.
/// dtype : dtype, optional
///     float32 for a result of single precision, default float64.
/// threads : int, optional
///     Threads at most, default `default_threads()`; under 20000 rows it is one. No result depends on it.
///
/// Returns
/// -------
/// float or ndarray, shape (...)
///     The same angles, wrapped [rad].
#[pyfunction]
#[pyo3(signature = (angle, *, out=None, dtype=None, threads=None))]
pub fn wrap_angle<'py>(
    py: Python<'py>,
    angle: &Bound<'py, PyAny>,
    out: Option<&Bound<'py, PyAny>>,
    dtype: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = given::threads)] threads: Option<i64>,
) -> PyResult<Bound<'py, PyAny>> {
    let workers = any_workers(threads, None)?;
    let angles = Scalars::read("angle", angle)?;
    angles.check_finite("angle")?;
    if angles.shape.is_empty() && out.is_none() && dtype.is_none() {
        let wrapped = core::wrap_angle(angles.flat()[0]);
        return Ok(wrapped.into_pyobject(py)?.into_any());
    }
    let mut result = Output::asked(py, (out, dtype), &angles.shape)?;
    let (rows, targets) = (angles.flat(), result.flat().as_chunks_mut().0);
    compute(py, rows.len(), || batch::fill(targets, workers, |k| [core::wrap_angle(rows[k])]))
        .map_err(|error| raise(error, &angles.shape))?;
    result.finish_number(out)
}
