//! Arguments of `Odometry3`: attitudes, poses and covariances in space.

use pyo3::prelude::*;
use six_wheel_ground_motion::spatial::{Attitude, Pose3, attitude};
use six_wheel_odometry::preintegrated::space::Motion3;

use super::super::input::covariance_of;
use crate::convert::{OrRaise, Rows, refuse_shape};

/// An attitude of one instant.
pub fn attitude_of(value: &Bound<'_, PyAny>) -> PyResult<Attitude> {
    let numbers = Rows::read_numbers("attitude", value)?;
    match numbers.leading.as_slice() {
        [2..=4] => attitude(numbers.flat()).or_raise(&[]),
        shape => Err(refuse_shape("attitude", "have shape (2,), (3,) or (4,)", shape)),
    }
}

/// Attitudes of a log, and how many numbers each has.
pub fn attitudes<'py>(value: &Bound<'py, PyAny>, leading: &[usize]) -> PyResult<(Rows<'py>, usize)> {
    let shape = Rows::read_numbers("attitude", value)?.leading;
    let width = match shape.as_slice() {
        [_, width @ 2..=4] => *width,
        _ => return Err(refuse_shape("attitude", "have shape (n, 2), (n, 3) or (n, 4)", &shape)),
    };
    Ok((Rows::read("attitude", value, width)?.over(leading)?, width))
}

/// A pose: six numbers, a matrix, or three in plan.
pub fn pose(argument: &'static str, value: &Bound<'_, PyAny>) -> PyResult<Pose3> {
    let numbers = Rows::read_numbers(argument, value)?;
    match (numbers.leading.as_slice(), numbers.flat()) {
        ([6], &[x, y, z, roll, pitch, yaw]) => Ok(Pose3::from([x, y, z, roll, pitch, yaw])),
        ([3], &[x, y, yaw]) => Ok(Pose3::from([x, y, 0.0, 0.0, 0.0, yaw])),
        ([4, 4], flat) => {
            let mut matrix = [[0.0; 4]; 4];
            matrix.as_flattened_mut().copy_from_slice(flat);
            let motion = Motion3::from_matrix(argument, &matrix);
            Ok(Pose3::of(&motion.or_raise(&[])?))
        }
        (shape, _) => Err(refuse_shape(argument, "have shape (6,), (4, 4) or (3,)", shape)),
    }
}

/// A covariance, zero if it is left out: of six numbers, or of three in plan with this variance for the others.
pub fn covariance(value: Option<&Bound<'_, PyAny>>, others: f64) -> PyResult<[[f64; 6]; 6]> {
    let rule = "have shape (6,), (6, 6), (3,) or (3, 3)";
    covariance_of(value, &[&[0, 1, 2, 3, 4, 5], &[0, 1, 5]], others, rule)
}
