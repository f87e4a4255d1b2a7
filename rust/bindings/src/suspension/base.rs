//! `six_wheel.Suspension`: any chain of parts and wheels.

use pyo3::prelude::*;
use pyo3::types::PyTuple;
use six_wheel_core::Chain;

/// A suspension as data: parts that turn about axes of their parents, and wheels mounted on them.
///
/// `RockerBogie` is one of them. What settles on ground works on any.
#[pyclass(frozen, subclass, module = "six_wheel")]
pub struct Suspension {
    /// The parts, joints and wheels.
    pub chain: Chain,
}

impl Suspension {
    /// The face of a chain.
    pub fn of(chain: Chain) -> Self {
        Self { chain }
    }
}

#[pymethods]
impl Suspension {
    /// Names of the wheels, in the order of every array.
    #[getter]
    fn wheel_names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.chain.wheels().iter().map(|wheel| &*wheel.name))
    }

    /// Names of the free angles, in the order of `joints` of a settled pose.
    #[getter]
    fn free_joints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.chain.joints().iter().map(|joint| &*joint.name))
    }
}
