//! Copies of pre-integrated motion, and how it pickles.

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple, PyType};
use six_wheel_odometry::preintegrated::Samples;

use super::Preintegrated;
use crate::convert::OrRaise;
use crate::rover::Rover;

/// Stamps, readings of steering joints and of wheels, yaw rates, attitudes.
type RestoredSamples = (Vec<f64>, Vec<f64>, Vec<f64>, Vec<f64>, Vec<[f64; 4]>);

#[pymethods]
impl Preintegrated {
    /// The motion of these samples, as `__reduce__` lists them.
    #[classmethod]
    fn _restore(
        class: &Bound<'_, PyType>,
        rover: Py<Rover>,
        given: Bound<'_, PyDict>,
        samples: RestoredSamples,
        shares: [f64; 2],
    ) -> PyResult<Self> {
        let empty = class.call((rover,), Some(&given))?.cast_into::<Self>()?;
        let (stamps, steering, wheels, rates, attitudes) = samples;
        let samples = Samples { stamps, steering, wheels, rates, attitudes };
        let (py, empty) = (class.py(), empty.get());
        let core = empty.work.lock(py)?.core.with_samples(samples, shares).or_raise(&[])?;
        Ok(empty.with(core, py))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let (py, this) = (slf.py(), slf.get());
        let core = this.work.lock(py)?.core.clone();
        let (samples, shares) = core.samples();
        let Samples { stamps, steering, wheels, rates, attitudes } = samples.clone();
        let samples: RestoredSamples = (stamps, steering, wheels, rates, attitudes);
        let fields = (&this.rover, &this.given, samples, shares).into_pyobject(py)?;
        crate::classes::restored_by(slf.as_any(), &fields.iter().collect::<Vec<_>>())
    }

    fn __copy__(&self, py: Python<'_>) -> PyResult<Self> {
        let core = self.work.lock(py)?.core.clone();
        Ok(self.with(core, py))
    }

    fn __deepcopy__(&self, py: Python<'_>, _memo: &Bound<'_, PyAny>) -> PyResult<Self> {
        self.__copy__(py)
    }
}
