//! What `Suspension.inverse` and `Suspension.forward` return.

use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyIterator, PyTuple};
use six_wheel_terrain::suspension::{MAX_FREE, MAX_WHEELS};

use super::array;
use crate::convert::memory;

/// What the wheels have to do on the ground, and what the rover then does. Unpacks into steering and speeds.
#[pyclass(frozen, module = "six_wheel")]
pub struct GroundCommand(pub(super) Told);

#[allow(clippy::large_enum_variant)] // in the object itself: a box would be one more allocation of every call
pub(super) enum Told {
    /// The arrays of a batch.
    Rows { steering: Py<PyAny>, speeds: Py<PyAny>, twist: Py<PyAny>, joint_rates: Py<PyAny>, scale: Py<PyAny> },
    /// One call's numbers: a control loop need not pay for arrays that it does not look at.
    One(CommandRow),
}

/// The numbers of one row.
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

impl GroundCommand {
    /// That of one call.
    pub fn one(one: CommandRow) -> Self {
        Self(Told::One(one))
    }
}

#[pymethods]
impl GroundCommand {
    /// Steering angles, shape (..., steered wheels) [rad].
    #[getter]
    fn steering(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        match &self.0 {
            Told::Rows { steering, .. } => Ok(steering.clone_ref(py)),
            Told::One(one) => array(py, &one.steering[..one.steered]),
        }
    }

    /// Speed of every wheel against the link that carries it, shape (..., wheels) [rad/s].
    #[getter]
    fn speeds(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        match &self.0 {
            Told::Rows { speeds, .. } => Ok(speeds.clone_ref(py)),
            Told::One(one) => array(py, &one.speeds[..one.wheels]),
        }
    }

    /// ``vx, vy, vz, wx, wy, wz`` of the body's origin in its own axes, shape (..., 6) [m/s, rad/s].
    #[getter]
    fn twist(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        match &self.0 {
            Told::Rows { twist, .. } => Ok(twist.clone_ref(py)),
            Told::One(one) => array(py, one.twist.as_flattened()),
        }
    }

    /// Rates of the free angles, shape (..., joints) [rad/s].
    #[getter]
    fn joint_rates(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        match &self.0 {
            Told::Rows { joint_rates, .. } => Ok(joint_rates.clone_ref(py)),
            Told::One(one) => array(py, &one.joint_rates[..one.joints]),
        }
    }

    /// What is left of the wanted motion, shape (...): 1 unless a wheel would have been too fast.
    #[getter]
    fn scale(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        match &self.0 {
            Told::Rows { scale, .. } => Ok(scale.clone_ref(py)),
            Told::One(one) => Ok(PyFloat::new(py, one.scale).into_any().unbind()),
        }
    }

    fn __len__(&self) -> usize {
        2
    }

    fn __getitem__(&self, py: Python<'_>, index: isize) -> PyResult<Py<PyAny>> {
        match index {
            0 | -2 => self.steering(py),
            1 | -1 => self.speeds(py),
            _ => Err(PyIndexError::new_err("a command holds steering and speeds")),
        }
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        PyTuple::new(py, [self.steering(py)?, self.speeds(py)?])?.try_iter()
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!(
            "GroundCommand(steering={}, speeds={})",
            self.steering(py)?.bind(py).repr()?,
            self.speeds(py)?.bind(py).repr()?
        ))
    }
}

/// How a rover moves on the ground.
#[pyclass(frozen, module = "six_wheel")]
pub struct GroundMotion(pub(super) Moved);

#[allow(clippy::large_enum_variant)] // see `Told`
pub(super) enum Moved {
    /// The arrays of a batch.
    Rows { twist: Py<PyAny>, joint_rates: Py<PyAny>, residual: Py<PyAny> },
    /// One call's numbers.
    One(MotionRow),
}

/// The numbers of one row.
pub struct MotionRow {
    pub wheels: usize,
    pub joints: usize,
    pub twist: [[f64; 6]; 1],
    pub joint_rates: [f64; MAX_FREE],
    pub residual: [[f64; 3]; MAX_WHEELS],
}

impl GroundMotion {
    /// That of one call.
    pub fn one(one: MotionRow) -> Self {
        Self(Moved::One(one))
    }
}

#[pymethods]
impl GroundMotion {
    /// ``vx, vy, vz, wx, wy, wz`` of the body's origin in its own axes, shape (..., 6) [m/s, rad/s].
    #[getter]
    fn twist(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        match &self.0 {
            Moved::Rows { twist, .. } => Ok(twist.clone_ref(py)),
            Moved::One(one) => array(py, one.twist.as_flattened()),
        }
    }

    /// Rates of the free angles, shape (..., joints) [rad/s].
    #[getter]
    fn joint_rates(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        match &self.0 {
            Moved::Rows { joint_rates, .. } => Ok(joint_rates.clone_ref(py)),
            Moved::One(one) => array(py, &one.joint_rates[..one.joints]),
        }
    }

    /// What every touching point does along the normal of the ground, along the rim and to the left,
    /// shape (..., wheels, 3) [m/s]; NaN in the air.
    #[getter]
    fn residual(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        match &self.0 {
            Moved::Rows { residual, .. } => Ok(residual.clone_ref(py)),
            Moved::One(one) => {
                let rows = one.residual[..one.wheels].as_flattened();
                let array = memory::array(py, rows, &[one.wheels, 3])?;
                Ok(array.into_any().unbind())
            }
        }
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!(
            "GroundMotion(twist={}, joint_rates={})",
            self.twist(py)?.bind(py).repr()?,
            self.joint_rates(py)?.bind(py).repr()?
        ))
    }
}
