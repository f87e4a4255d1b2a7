//! `six_wheel.Odometry3State`.

use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyString;
use six_wheel_ground_motion::spatial::{Odometry3, Pose3, size_of_slip};
use six_wheel_kinematics::estimate::worst_wheel;
use six_wheel_terrain::suspension::MAX_WHEELS;

use super::super::state::{Short, matrix};
use crate::suspension::Suspension;

type Vector<'py> = Bound<'py, PyArray1<f64>>;
type Matrix<'py> = Bound<'py, PyArray2<f64>>;

/// Pose and twist of a rover on ground after a sample, with their covariances.
#[pyclass(frozen, module = "six_wheel")]
pub struct Odometry3State {
    stamp: Option<f64>,
    pose: Pose3,
    twist: [f64; 6],
    covariance: [[f64; 6]; 6],
    twist_covariance: [[f64; 6]; 6],
    slip: [[f64; 2]; MAX_WHEELS],
    wheels: usize,
    health: u32,
    suspension: Py<Suspension>,
}

impl Odometry3State {
    pub fn of(odometry: &Odometry3, suspension: Py<Suspension>) -> Self {
        let slips = odometry.slip();
        let mut slip = [[0.0; 2]; MAX_WHEELS];
        slip[..slips.len()].copy_from_slice(slips);
        Self {
            stamp: odometry.stamp(),
            pose: odometry.pose(),
            twist: odometry.twist(),
            covariance: odometry.covariance(),
            twist_covariance: odometry.twist_covariance(),
            slip,
            wheels: slips.len(),
            health: odometry.health().0,
            suspension,
        }
    }

    fn sliding_speeds(&self) -> Vec<f64> {
        self.slip[..self.wheels].iter().map(|slip| size_of_slip(*slip)).collect()
    }
}

getters! { Odometry3State, self, py:
    /// When the sample was taken [s]; None before the first one.
    stamp: Option<f64> = self.stamp;
    /// ``[x, y, z, roll, pitch, yaw]`` in the world, ``Rz(yaw) Ry(pitch) Rx(roll)``, the yaw with its full turns, shape
    /// (6,) [m, rad].
    pose: Vector<'py> = PyArray1::from_slice(py, &self.pose.numbers());
    /// Of the body's origin, shape (3,) [m].
    position: Vector<'py> = PyArray1::from_slice(py, &self.pose.numbers()[..3]);
    /// ``[roll, pitch, yaw]``, shape (3,) [rad].
    attitude: Vector<'py> = PyArray1::from_slice(py, &self.pose.numbers()[3..]);
    /// ``world_from_body``, shape (4, 4).
    transform: PyResult<Matrix<'py>> = matrix(py, self.pose.motion().matrix().as_flattened(), 4);
    /// Mean ``vx, vy, vz, wx, wy, wz`` over the last step in axes of the body, shape (6,) [m/s, rad/s].
    twist: Vector<'py> = PyArray1::from_slice(py, &self.twist);
    /// Covariance of x, y, z [m] and about the axes of the world [rad], as in ROS messages, shape (6, 6).
    covariance: PyResult<Matrix<'py>> = matrix(py, self.covariance.as_flattened(), 6);
    /// Covariance of the twist, shape (6, 6); infinite variances where nothing is known of the twist: before the first
    /// step, and after a pose was set.
    twist_covariance: PyResult<Matrix<'py>> = matrix(py, self.twist_covariance.as_flattened(), 6);
    /// Speed at which each wheel's contact slid over the last step, shape (wheels,) [m/s]; NaN in the air.
    residuals: Vector<'py> = PyArray1::from_vec(py, self.sliding_speeds());
    /// The same along the rim, forwards, and to the left, shape (wheels, 2) [m/s].
    slips: PyResult<Matrix<'py>> = matrix(py, self.slip[..self.wheels].as_flattened(), 2);
    /// Flags of the sample, an `OdometryHealth`.
    health: PyResult<Bound<'py, PyAny>> = py.import("six_wheel.kinematics.odometry")?.getattr("OdometryHealth")?.call1((self.health,));
    /// ``world_from_body`` as a quaternion x, y, z, w, shape (4,).
    orientation: Vector<'py> = {
        let turn = self.pose.motion().rotation;
        PyArray1::from_slice(py, &[turn.i, turn.j, turn.k, turn.w])
    };
    /// Name of the wheel that disagrees most; None if none does.
    worst_wheel: Option<Bound<'py, PyString>> = {
        let worst = worst_wheel(&self.sliding_speeds())?;
        Some(PyString::new(py, &self.suspension.get().chain.wheels()[worst].name))
    };
}

pickled_by_fields! { Odometry3State, this, py:
    (
        stamp: Option<f64> = this.stamp,
        poses: [[f64; 6]; 2] = [this.pose.numbers(), this.twist],
        covariances: [[[f64; 6]; 6]; 2] = [this.covariance, this.twist_covariance],
        slips: Vec<[f64; 2]> = this.slip[..this.wheels].to_vec(),
        health: u32 = this.health,
        suspension: Py<Suspension> = &this.suspension,
    )
    {
        let mut slip = [[0.0; 2]; MAX_WHEELS];
        let wheels = slips.len().min(MAX_WHEELS);
        slip[..wheels].copy_from_slice(&slips[..wheels]);
        let ([pose, twist], [covariance, twist_covariance]) = (poses, covariances);
        Self { stamp, pose: pose.into(), twist, covariance, twist_covariance, slip, wheels, health, suspension }
    }
}

#[pymethods]
impl Odometry3State {
    fn __repr__(&self) -> String {
        let deviation = |k: usize| Short(self.covariance[k][k].sqrt());
        let names = ["x", "y", "z", "roll", "pitch", "yaw"];
        let numbers = self.pose.numbers();
        let places: Vec<String> = (0..3)
            .map(|k| format!("{}={:.4} ± {} m", names[k], numbers[k], deviation(k)))
            .chain((3..6).map(|k| format!("{}={:.4} rad", names[k], numbers[k])))
            .collect();
        crate::classes::cut(format!("Odometry3State({})", places.join(", ")))
    }
}
