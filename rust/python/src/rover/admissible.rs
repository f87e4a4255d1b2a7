//! `Rover.admissible`, `Rover.project` and `Rover.icr`.

use pyo3::prelude::*;
use six_wheel_kinematics::admissible::Keep;
use six_wheel_kinematics::batch;
use six_wheel_kinematics::geometry::Twist;
use six_wheel_numerics::threads::workers::Workers;

use super::Rover;
use crate::convert::{AnyArray, OrRaise, Output, Rows, compute_rows, joined, memory, name, one_twist, scalar_or_array};
use crate::workers::workers;

methods! { Rover:
    /// True if the rover can make the twist: no side slip, every wheel inside its steering range.
    #[doc = section!(Parameters: twist "(..., 3)", threads)]
    #[doc = returns!("bool or ndarray of bool, shape (...)")]
    ///     Side slip up to 1e-9 of the fastest wheel's speed counts as rounding.
    #[doc = raises!("If a value is not finite.")]
    fn admissible[&self, py: Python<'py>](twist, *more, threads: Option<i64> = None)
    as "($self, twist, *, threads=None)" -> PyResult<Py<PyAny>> {
        one_twist("Rover.admissible((vx, vy, omega))", 1, more)?;
        let workers = workers(threads, None)?;
        let twists = Rows::read("twist", twist, 3)?;
        let rows = twists.triples();
        let mut answers = memory::filled(false, rows.len())?;
        compute_rows(py, rows.len(), &twists.leading, || batch::admissible(&self.core, rows, &mut answers, workers))?;
        scalar_or_array(py, answers, &twists.leading)
    }

    /// The nearest twist the rover can make; one it can make already is returned unchanged.
    #[doc = section!(Parameters: twist "(..., 3)")]
    /// keep : {'curvature', 'speed', 'yaw_rate', 'nearest'}
    ///     Preserved quantity. ``'curvature'``: `vx` and `omega`, and with them the turning radius; if that turn
    ///     is too tight, the nearest possible twist, scaled so that neither grows (a spin the rover cannot
    ///     make becomes rest). ``'speed'``: `vx`. ``'yaw_rate'``: `omega`. ``'nearest'``: as much as possible,
    ///     by the root mean square change of the wheel pivots' velocities.
    #[doc = parameters!(out "(..., 3)", dtype, threads)]
    #[doc = returns!("ndarray, shape (..., 3)": "An admissible twist.")]
    #[doc = raises!(
        InfeasibleMotionError: "If no admissible twist keeps what was asked for.",
        ValueError: "If a value is not finite."
    )]
    fn project[&self, py: Python<'py>](twist, keep=None, *more, out=None, dtype=None, threads: Option<i64> = None)
    as "($self, twist, keep='curvature', *, out=None, dtype=None, threads=None)" -> PyResult<AnyArray<'py>> {
        one_twist("Rover.project((vx, vy, omega))", 2, more)?;
        let keep = keep.map_or(Ok(Keep::Curvature), |keep| name(keep).parse::<Keep>());
        let keep = keep.or_raise(&[])?;
        let twists = Rows::read("twist", twist, 3)?;
        let mut projected = Output::asked(py, (out, dtype), &twists.shape())?;
        let workers = Workers { fresh: projected.is_unseen(), ..workers(threads, None)? };
        let (rows, target) = (twists.triples(), projected.triples());
        compute_rows(py, rows.len(), &twists.leading, || batch::project(&self.core, rows, keep, target, workers))?;
        projected.finish_any()
    }

    /// Instantaneous centre of rotation of a twist: the point of the body that stands still.
    #[doc = section!(Parameters: twist "(..., 3)", out "(..., 2)", dtype, threads)]
    #[doc = returns!("ndarray, shape (..., 2)")]
    ///     ``[x, y]`` in body axes [m]. Straight ahead it is at infinity, ``[0, inf]`` forwards and
    ///     ``[0, -inf]`` backwards; at rest there is none, ``[nan, nan]``.
    #[doc = raises!("If a value is not finite.")]
    fn icr[&self, py: Python<'py>](twist, *more, out=None, dtype=None, threads: Option<i64> = None)
    as "($self, twist, *, out=None, dtype=None, threads=None)" -> PyResult<AnyArray<'py>> {
        one_twist("Rover.icr((vx, vy, omega))", 1, more)?;
        let workers = workers(threads, None)?;
        let twists = Rows::read("twist", twist, 3)?.finite()?;
        let mut centres = Output::asked(py, (out, dtype), &joined(&twists.leading, 2))?;
        let (rows, target) = (twists.triples(), centres.flat().as_chunks_mut().0);
        compute_rows(py, rows.len(), &twists.leading, || batch::fill(target, workers, |k| Twist::from(rows[k]).icr()))?;
        centres.finish_any()
    }
}
