//! `six_wheel.Fit`: a twist with everything the wheels say about it.

use pyo3::prelude::*;

/// Twist fitted to the readings of all wheels, with what speaks for and against it.
#[pyclass(frozen, module = "six_wheel")]
pub struct Fit {
    /// ``[vx, vy, omega]`` in body axes, shape (..., 3) [m/s, m/s, rad/s].
    #[pyo3(get)]
    pub twist: Py<PyAny>,
    /// Speed at which each wheel contradicts the twist, shape (..., wheels) [m/s].
    #[pyo3(get)]
    pub residual: Py<PyAny>,
    /// Independent directions of the twist that the readings determine: 3 if all.
    #[pyo3(get)]
    pub rank: Py<PyAny>,
    /// Smallest singular value of the stacked, weighted rows of the wheel equation.
    #[pyo3(get)]
    pub sigma_min: Py<PyAny>,
    /// Say of each wheel, shape (..., wheels), 0 to 1.
    #[pyo3(get)]
    pub weights: Py<PyAny>,
    /// Name of the wheel with the largest residual; nested lists of names for a batch.
    #[pyo3(get)]
    pub worst_wheel: Py<PyAny>,
}

#[pymethods]
impl Fit {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let text = |value: &Py<PyAny>| value.bind(py).repr().map(|repr| repr.to_string());
        Ok(format!(
            "Fit(twist={}, residual={}, rank={}, sigma_min={}, weights={}, worst_wheel={})",
            text(&self.twist)?,
            text(&self.residual)?,
            text(&self.rank)?,
            text(&self.sigma_min)?,
            text(&self.weights)?,
            text(&self.worst_wheel)?,
        ))
    }
}
