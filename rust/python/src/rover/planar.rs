//! `RockerBogie.planar`.

use pyo3::prelude::*;

use super::Rover;
use crate::convert::numbers;
use crate::suspension::{RockerBogie, rocker_and_bogies};

#[pymethods]
impl RockerBogie {
    /// The rover seen from above: its wheels where the suspension puts their centres.
    ///
    /// Parameters
    /// ----------
    /// joints : array_like, shape (3,)
    ///     Angles of the left rocker (the right one has the opposite one), the left and the right bogie [rad]; default 0.
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
    #[pyo3(signature = (joints=None), text_signature = "($self, joints=(0.0, 0.0, 0.0))")]
    fn planar(&self, py: Python<'_>, joints: Option<&Bound<'_, PyAny>>) -> PyResult<Rover> {
        let (rho, beta) = rocker_and_bogies(joints.map_or(Ok([0.0; 3]), |joints| numbers("joints", joints))?);
        Rover::named(py, self.0.planar(rho, beta))
    }
}
