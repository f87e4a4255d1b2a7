//! `RockerBogie.planar`.

use pyo3::prelude::*;

use super::Rover;
use crate::suspension::{Joints, RockerBogie};

#[pymethods]
impl RockerBogie {
    /// The rover seen from above: its wheels where the suspension puts their centres.
    ///
    /// Parameters
    /// ----------
    /// rho : float
    ///     Angle of the left rocker [rad]; the right one has ``-rho``.
    /// beta : array_like, shape (2,)
    ///     Angles of the left and the right bogie against their rockers [rad].
    ///
    /// Returns
    /// -------
    /// Rover
    ///     With the origin of R; wheels front_left, front_right, middle_left, middle_right, rear_left, rear_right.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an angle is not finite or a shape does not fit.
    fn planar(&self, py: Python<'_>, rho: &Bound<'_, PyAny>, beta: &Bound<'_, PyAny>) -> PyResult<Rover> {
        let (rho, beta) = Joints::read_one(rho, beta)?;
        Rover::named(py, self.0.planar(rho, beta))
    }
}
