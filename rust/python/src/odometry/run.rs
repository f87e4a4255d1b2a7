//! `Odometry.run`.

use numpy::PyArray1;
use pyo3::prelude::*;
use six_wheel_kinematics::estimate::Method;
use six_wheel_odometry::{LogOdometry, Recording, TrackRows};

use super::Odometry;
use super::input::{Columns, build_track};
use super::values::Noise;
use crate::convert::{Array, Output, Rows, compute_rows, is_interrupted, memory};

methods! { Odometry:
    /// Takes in a whole log, from where the last sample ended; the same numbers as `update`, row by row.
    #[doc = section!(Parameters: log)]
    /// yaw, yaw_rate : array_like, shape (n,), optional
    ///     As in `update`; NaN in rows without.
    /// errors : {'flag', 'raise'}
    ///     Leave out rows that cannot be, flagged in `health`, or raise on the first one.
    /// covariances, residuals : bool
    ///     True to compute these; those that are not computed are None.
    #[doc = returns!("Track")]
    ///     `poses`, `twists`, `covariances`, `residuals`, `weights` (of the robust method) and `health`, one row per
    ///     sample.
    #[doc = raises!(ValueError)]
    ///     If a shape does not fit; with ``errors="raise"`` as `update`, the row named.
    fn run[&self, py: Python<'py>](steering, wheel_angles, stamps, *, yaw=None, yaw_rate=None, errors: &str = "flag",
        covariances: bool = true, residuals: bool = true) -> PyResult<Bound<'py, PyAny>> {
        let count = self.wheels();
        let widths = [count, self.joints()];
        let log = Columns::read(wheel_angles, steering, stamps, errors, widths)?;
        let yaws = log.optional("yaw", yaw)?;
        let rates = log.optional("yaw_rate", yaw_rate)?;
        let recording = Recording {
            steering: log.angles(),
            wheels: log.wheels.flat(),
            stamps: log.stamps.flat(),
            yaws: yaws.as_ref().map(Rows::flat),
            yaw_rates: rates.as_ref().map(Rows::flat),
        };
        let rows = log.wheels.count();
        let output = |shape: &[usize]| Output::fresh(py, shape);
        let wanted = |flag: bool, shape: &[usize]| flag.then(|| output(shape)).transpose();
        let is_robust = self.work.lock(py)?.core.settings().method == Method::Robust;
        let (mut poses, mut twists) = (output(&[rows, 3])?, output(&[rows, 3])?);
        let mut covariances = wanted(covariances, &[rows, 3, 3])?;
        let mut residuals = wanted(residuals, &[rows, count])?;
        let mut weights = wanted(is_robust, &[rows, count])?;
        let mut flags = memory::filled(0, rows)?;
        let track = TrackRows {
            poses: poses.triples(),
            twists: twists.triples(),
            covariances: covariances.as_mut().map(|out| out.flat().as_chunks_mut().0),
            residuals: residuals.as_mut().map(Output::flat),
            weights: weights.as_mut().map(Output::flat),
            health: &mut flags,
        };
        let mut work = self.work.lock(py)?;
        let core = &mut work.core;
        compute_rows(py, rows, &log.wheels.leading, || core.run(recording, log.is_strict, track, is_interrupted))?;
        let noise = Noise::from(work.core.settings().noise);
        drop(work);
        let finish = |out: Option<Output<'py>>| -> PyResult<Option<Array<'py>>> { out.map(Output::finish).transpose() };
        let stamps = memory::array(py, log.stamps.flat(), &[rows])?;
        let (poses, twists, covariances) = (poses.finish()?, twists.finish()?, finish(covariances)?);
        let (residuals, weights, health) = (finish(residuals)?, finish(weights)?, PyArray1::from_vec(py, flags));
        let rover = &self.rover;
        let keywords = dict!(py, rover, stamps, poses, twists, covariances, residuals, weights, health, noise);
        build_track(&keywords, "Track")
    }
}
