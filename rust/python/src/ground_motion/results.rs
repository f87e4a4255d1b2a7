//! The results of `Suspension.inverse` and `Suspension.forward`.

use numpy::Element;
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyIterator, PyTuple};
use six_wheel_terrain::suspension::{MAX_FREE, MAX_WHEELS};

use crate::convert::memory;

/// The attributes of a result: the `N` objects of a batch, or the numbers `R` of a single call. A control loop that looks
/// at none of the arrays does not pay for them.
pub enum Columns<const N: usize, R> {
    Batch([Py<PyAny>; N]),
    Single(R),
}

impl<const N: usize, R> Columns<N, R> {
    /// Column `k` of a batch, or the object that `single` makes of a single call.
    pub fn get(&self, py: Python<'_>, k: usize, single: impl FnOnce(&R) -> PyResult<Py<PyAny>>) -> PyResult<Py<PyAny>> {
        match self {
            Self::Batch(columns) => Ok(columns[k].clone_ref(py)),
            Self::Single(row) => single(row),
        }
    }
}

/// An array with one axis.
pub fn array<T: Element + Copy>(py: Python<'_>, values: &[T]) -> PyResult<Py<PyAny>> {
    let array = memory::array(py, values, &[values.len()])?;
    Ok(array.into_any().unbind())
}

/// Steering angles and wheel speeds for a wanted motion on the ground, and the motion that follows.
///
/// Unpacks into steering and wheel speeds.
#[pyclass(frozen, module = "six_wheel")]
pub struct GroundCommand(pub(super) Columns<5, CommandRow>);

/// The numbers of one row.
#[derive(Default)]
pub struct CommandRow {
    pub wheels: usize,
    pub joints: usize,
    pub steered: usize,
    pub steering: [f64; MAX_WHEELS],
    pub speeds: [f64; MAX_WHEELS],
    pub twist: [[f64; 6]; 1],
    pub joint_rates: [f64; MAX_FREE],
    pub scale: f64,
}

getters! { GroundCommand, self, py:
    /// Steering angles, shape (..., steered wheels) [rad].
    steering: PyResult<Py<PyAny>> = self.0.get(py, 0, |one| array(py, &one.steering[..one.steered]));
    /// Speed of every wheel against the link that carries it, shape (..., wheels) [rad/s].
    wheel_speeds: PyResult<Py<PyAny>> = self.0.get(py, 1, |one| array(py, &one.speeds[..one.wheels]));
    /// ``vx, vy, vz, wx, wy, wz`` of the body's origin in its own axes, shape (..., 6) [m/s, rad/s].
    twist: PyResult<Py<PyAny>> = self.0.get(py, 2, |one| array(py, one.twist.as_flattened()));
    /// Rates of the free angles, shape (..., joints) [rad/s].
    joint_rates: PyResult<Py<PyAny>> = self.0.get(py, 3, |one| array(py, &one.joint_rates[..one.joints]));
    /// Factor on the wanted motion, shape (...): 1 unless a wheel would have been too fast.
    scale: PyResult<Py<PyAny>> = self.0.get(py, 4, |one| Ok(PyFloat::new(py, one.scale).into_any().unbind()));
}

repr_of_attributes! { GroundCommand: steering wheel_speeds }

pickled_by_fields! { GroundCommand, this, py:
    (columns: [Py<PyAny>; 5] =
        [this.steering(py)?, this.wheel_speeds(py)?, this.twist(py)?, this.joint_rates(py)?, this.scale(py)?],)
    Self(Columns::Batch(columns))
}

#[pymethods]
impl GroundCommand {
    fn __len__(&self) -> usize {
        2
    }

    fn __getitem__(&self, py: Python<'_>, index: isize) -> PyResult<Py<PyAny>> {
        match index {
            0 | -2 => self.steering(py),
            1 | -1 => self.wheel_speeds(py),
            _ => Err(PyIndexError::new_err("a command holds steering and wheel_speeds")),
        }
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        PyTuple::new(py, [self.steering(py)?, self.wheel_speeds(py)?])?.try_iter()
    }
}

/// Motion of a rover on the ground: twist, joint rates and the residuals of the contacts.
#[pyclass(frozen, module = "six_wheel")]
pub struct GroundMotion(pub(super) Columns<3, MotionRow>);

/// The numbers of one row.
#[derive(Default)]
pub struct MotionRow {
    pub wheels: usize,
    pub joints: usize,
    pub twist: [[f64; 6]; 1],
    pub joint_rates: [f64; MAX_FREE],
    pub residual: [[f64; 3]; MAX_WHEELS],
}

impl MotionRow {
    fn residuals(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        let rows = self.residual[..self.wheels].as_flattened();
        Ok(memory::array(py, rows, &[self.wheels, 3])?.into_any().unbind())
    }
}

getters! { GroundMotion, self, py:
    /// ``vx, vy, vz, wx, wy, wz`` of the body's origin in its own axes, shape (..., 6) [m/s, rad/s].
    twist: PyResult<Py<PyAny>> = self.0.get(py, 0, |one| array(py, one.twist.as_flattened()));
    /// Rates of the free angles, shape (..., joints) [rad/s].
    joint_rates: PyResult<Py<PyAny>> = self.0.get(py, 1, |one| array(py, &one.joint_rates[..one.joints]));
    /// Velocity of every touching point along the normal of the ground, along the rim and to the left,
    /// shape (..., wheels, 3) [m/s]; NaN in the air.
    residuals: PyResult<Py<PyAny>> = self.0.get(py, 2, |one| one.residuals(py));
}

repr_of_attributes! { GroundMotion: twist joint_rates }

pickled_by_fields! { GroundMotion, this, py:
    (columns: [Py<PyAny>; 3] = [this.twist(py)?, this.joint_rates(py)?, this.residuals(py)?],)
    Self(Columns::Batch(columns))
}
