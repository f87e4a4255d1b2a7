//! `RockerBogie.planar`.

use pyo3::prelude::*;

use super::Rover;
use crate::convert::{Rows, refuse_shape};
use crate::suspension::{RockerBogie, rocker_and_bogies};

methods! { RockerBogie:
    /// The rover seen from above: its wheels where the suspension puts their centres.
    #[doc = section!(Parameters)]
    /// joints : array_like, shape (3,)
    ///     Angles of the left rocker (the right one has the opposite one), the left and the right bogie [rad]; default 0.
    #[doc = returns!("Rover")]
    ///     With the origin of R; wheels front_left, front_right, middle_left, middle_right, rear_left, rear_right.
    #[doc = raises!("If an angle is not finite or a shape does not fit.")]
    fn planar[&self, py: Python<'py>](joints=None) as "($self, joints=(0.0, 0.0, 0.0))" -> PyResult<Rover> {
        let joints = Rows::read_optional("joints", joints, 3)?;
        if let Some(rows) = joints.as_ref().filter(|rows| !rows.is_single()) {
            return Err(refuse_shape("joints", "be one row of shape (3,)", &rows.shape()));
        }
        let (rho, beta) = rocker_and_bogies(joints.map_or([0.0; 3], |rows| rows.triples()[0]));
        Rover::named(py, self.0.planar(rho, beta))
    }
}
