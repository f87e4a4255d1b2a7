//! Twists and poses.

mod integration;

use pyo3::prelude::*;
use pyo3::types::PyFloat;
use six_wheel_kinematics::batch;
use six_wheel_kinematics::geometry::{self as core, Steps};

use crate::convert::{AnyArray, OrRaise, Output, OutputOptions, Rows, compute_rows, refuse, shape_text, together};
use crate::workers::workers;
pub use integration::{Course, integrate, rollout};

functions! {
    /// The twists that, each held over its step, pass through the poses: the inverse of `integrate`.
    #[doc = section!(Parameters)]
    /// poses : array_like, shape (n + 1, 3)
    ///     Rows ``[x, y, yaw]`` [m, m, rad].
    /// dt : float or array_like, shape (n,)
    ///     Duration of the steps [s].
    #[doc = parameters!(out "(n, 3)", dtype, threads)]
    #[doc = returns!("ndarray, shape (n, 3)")]
    ///     Rows ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s]; each step turns the short way round.
    #[doc = raises!("If there is no pose, a value is not finite or a duration is not positive.")]
    pub fn differentiate[py: Python<'py>](poses, dt, *, out=None, dtype=None, threads: Option<i64> = None, **)
    as "(poses, dt, *, out=None, dtype=None, threads=None)"
    -> PyResult<AnyArray<'py>> {
        let workers = workers(threads, None)?;
        let poses = Rows::read("poses", poses, 3)?;
        let &[count] = poses.leading.as_slice() else {
            return Err(refuse("poses", "have shape (n + 1, 3)", format!("leading axes {}", shape_text(&poses.leading))));
        };
        let Some(steps) = count.checked_sub(1) else {
            return Err(refuse("poses", "hold at least one pose", "shape (0, 3)"));
        };
        let mut dt = Rows::read_numbers("dt", dt)?;
        dt.fit(steps)?;
        let mut twists = Output::asked(py, (out, dtype), &[steps, 3])?;
        let (rows, steps, target) = (poses.triples(), dt.steps(), twists.triples());
        compute_rows(py, count, &[count], || batch::differentiate(rows, steps, target, workers))?;
        twists.finish_any()
    }

    /// Pose of the body frame after holding a twist for `dt`: the exponential map of SE(2).
    #[doc = section!(Parameters: twist "(..., 3)")]
    /// dt : float or array_like, shape (...), default 1.0
    ///     Duration [s].
    #[doc = parameters!(out "(..., 3)", dtype, threads)]
    #[doc = returns!("ndarray, shape (..., 3)": "The end ``[x, y, yaw]`` seen from the start [m, m, rad].")]
    #[doc = raises!("If a number is not finite, `dt` negative, or a shape does not fit.")]
    pub fn exp[py: Python<'py>](twist, dt=None, *, out=None, dtype=None, threads: Option<i64> = None, **)
    as "(twist, dt=1.0, *, out=None, dtype=None, threads=None)" -> PyResult<AnyArray<'py>> {
        over_time(py, ("twist", twist), dt, (out, dtype), threads, batch::Map::Exp)
    }

    /// The twist that reaches a pose along one arc, turning the short way: the logarithm of SE(2).
    #[doc = section!(Parameters)]
    /// pose : array_like, shape (..., 3)
    ///     The end ``[x, y, yaw]`` seen from the start [m, m, rad].
    /// dt : float or array_like, shape (...), default 1.0
    ///     In how long [s].
    #[doc = parameters!(out "(..., 3)", dtype, threads)]
    #[doc = returns!("ndarray, shape (..., 3)": "``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s].")]
    #[doc = raises!("If a number is not finite, `dt` not positive, or a shape does not fit.")]
    pub fn log[py: Python<'py>](pose, dt=None, *, out=None, dtype=None, threads: Option<i64> = None, **)
    as "(pose, dt=1.0, *, out=None, dtype=None, threads=None)" -> PyResult<AnyArray<'py>> {
        over_time(py, ("pose", pose), dt, (out, dtype), threads, batch::Map::Log)
    }
}

/// Applies a map of three numbers and a duration to every row.
fn over_time<'py>(
    py: Python<'py>,
    (argument, value): (&'static str, &Bound<'py, PyAny>),
    dt: Option<&Bound<'py, PyAny>>,
    asked: OutputOptions<'_, 'py>,
    threads: Option<i64>,
    map: batch::Map,
) -> PyResult<AnyArray<'py>> {
    let workers = workers(threads, None)?;
    let mut rows = Rows::read(argument, value, 3)?;
    let one = PyFloat::new(py, 1.0).into_any();
    let mut dt = Rows::read_numbers("dt", dt.unwrap_or(&one))?;
    together([&mut rows, &mut dt])?;
    match map {
        batch::Map::Log => dt.steps().check_positive(rows.count()),
        _ => dt.steps().check(rows.count()),
    }
    .or_raise(&rows.leading)?;
    let rows = rows.finite()?;
    let mut result = Output::asked(py, asked, &rows.shape())?;
    let (triples, steps, target) = (rows.triples(), dt.steps(), result.triples());
    compute_rows(py, triples.len(), &rows.leading, || batch::map(map, triples, &[], steps, target, workers))?;
    result.finish_any()
}

functions! {
    /// One pose after another: `second` is seen from the end of `first`; yaws add up.
    #[doc = section!(Parameters)]
    /// first, second : array_like, shape (..., 3)
    ///     ``[x, y, yaw]`` [m, m, rad].
    #[doc = parameters!(out "(..., 3)", dtype, threads)]
    #[doc = returns!("ndarray, shape (..., 3)": "The end of `second` seen from the start of `first`.")]
    #[doc = raises!("If a number is not finite or a shape does not fit.")]
    pub fn compose[py: Python<'py>](first, second, *, out=None, dtype=None, threads: Option<i64> = None, **)
    as "(first, second, *, out=None, dtype=None, threads=None)"
    -> PyResult<AnyArray<'py>> {
        let workers = workers(threads, None)?;
        let mut first = Rows::read("first", first, 3)?.finite()?;
        let mut second = Rows::read("second", second, 3)?.finite()?;
        together([&mut first, &mut second])?;
        let mut result = Output::asked(py, (out, dtype), &first.shape())?;
        let (from, then, target) = (first.triples(), second.triples(), result.triples());
        compute_rows(py, from.len(), &first.leading, || {
            batch::map(batch::Map::Compose, from, then, Steps::Constant(1.0), target, workers)
        })?;
        result.finish_any()
    }

    /// Angles brought into [-pi, pi] by whole turns; unchanged if they are there already.
    #[doc = section!(Parameters)]
    /// angle : float or array_like, shape (...)
    ///     Angles [rad].
    #[doc = parameters!(out "(...)", dtype, threads)]
    #[doc = returns!("float or ndarray, shape (...)": "The same angles, wrapped [rad].")]
    #[doc = raises!("If an angle is not finite.")]
    pub fn wrap_angle[py: Python<'py>](angle, *, out=None, dtype=None, threads: Option<i64> = None, **)
    as "(angle, *, out=None, dtype=None, threads=None)"
    -> PyResult<Bound<'py, PyAny>> {
        let workers = workers(threads, None)?;
        let angles = Rows::read_numbers("angle", angle)?.finite()?;
        if angles.leading.is_empty() && out.is_none() && dtype.is_none() {
            let wrapped = core::wrap_angle(angles.flat()[0]);
            return Ok(wrapped.into_pyobject(py)?.into_any());
        }
        let mut result = Output::asked(py, (out, dtype), &angles.leading)?;
        let (rows, targets) = (angles.flat(), result.flat().as_chunks_mut().0);
        compute_rows(py, rows.len(), &angles.leading, || batch::fill(targets, workers, |k| [core::wrap_angle(rows[k])]))?;
        result.finish_number(out)
    }
}
