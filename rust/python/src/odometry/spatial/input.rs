//! Arguments of `Odometry3`: attitudes, poses and covariances in space.

use pyo3::prelude::*;
use six_wheel_ground_motion::spatial::{Attitude, Pose3, attitude};
use six_wheel_odometry::preintegrated::space::Motion3;

use crate::convert::{OrRaise, Rows, Scalars, refuse_shape};

/// Places of x, y and yaw among six numbers.
const PLAN: [usize; 3] = [0, 1, 5];

/// An attitude of one instant.
pub fn attitude_of(value: &Bound<'_, PyAny>) -> PyResult<Attitude> {
    let numbers = Scalars::read("attitude", value)?;
    match numbers.shape.as_slice() {
        [2..=4] => attitude(numbers.flat()).or_raise(&[]),
        shape => Err(refuse_shape("attitude", "have shape (2,), (3,) or (4,)", shape)),
    }
}

/// Attitudes of a log, and how many numbers each has.
pub fn attitudes<'py>(value: &Bound<'py, PyAny>, leading: &[usize]) -> PyResult<(Rows<'py>, usize)> {
    let shape = Scalars::read("attitude", value)?.shape;
    let width = match shape.as_slice() {
        [_, width @ 2..=4] => *width,
        _ => return Err(refuse_shape("attitude", "have shape (n, 2), (n, 3) or (n, 4)", &shape)),
    };
    let rows = Rows::read_over("attitude", value, width, leading)?;
    Ok((rows, width))
}

/// A pose: six numbers, a matrix, or three in plan.
pub fn pose(argument: &'static str, value: &Bound<'_, PyAny>) -> PyResult<Pose3> {
    let numbers = Scalars::read(argument, value)?;
    match (numbers.shape.as_slice(), numbers.flat()) {
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
    let mut matrix = [[0.0; 6]; 6];
    let Some(value) = value else { return Ok(matrix) };
    let numbers = Scalars::read("covariance", value)?;
    let flat = numbers.flat();
    let all = [0, 1, 2, 3, 4, 5];
    let (places, square) = match numbers.shape.as_slice() {
        [6] => (&all[..], false),
        [6, 6] => (&all[..], true),
        [3] => (&PLAN[..], false),
        [3, 3] => (&PLAN[..], true),
        shape => return Err(refuse_shape("covariance", "have shape (6,), (6, 6), (3,) or (3, 3)", shape)),
    };
    if places.len() == 3 {
        for k in [2, 3, 4] {
            matrix[k][k] = others;
        }
    }
    for (i, &row) in places.iter().enumerate() {
        for (k, &column) in places.iter().enumerate() {
            if square {
                matrix[row][column] = flat[i * places.len() + k];
            } else if i == k {
                matrix[row][row] = flat[i];
            }
        }
    }
    Ok(matrix)
}
