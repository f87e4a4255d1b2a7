//! Results of a batch or of a single call, behind the same attributes.

use numpy::Element;
use pyo3::prelude::*;

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
