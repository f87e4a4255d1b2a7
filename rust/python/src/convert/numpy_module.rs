//! NumPy, loaded once.

use numpy::{PyArrayDyn, PyUntypedArray};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

/// An array as Python sees it.
pub type Array<'py> = Bound<'py, PyArrayDyn<f64>>;

/// An array of either precision.
pub type AnyArray<'py> = Bound<'py, PyUntypedArray>;

static READY: PyOnceLock<()> = PyOnceLock::new();

/// Loads NumPy for the `numpy` crate, which would panic at what an import may raise: a Ctrl-C, a NumPy that is broken.
///
/// Whatever touches an array comes by here first: arguments on their way in, fresh arrays, and rovers and suspensions,
/// without which there is no object that has arrays to show.
pub fn ready(py: Python<'_>) -> PyResult<()> {
    READY.get_or_try_init(py, || numpy::get_array_module(py).map(drop)).copied()
}

/// True once NumPy is loaded.
pub fn is_ready(py: Python<'_>) -> bool {
    READY.get(py).is_some()
}

pub(super) fn numpy(py: Python<'_>) -> PyResult<&Bound<'_, PyModule>> {
    static NUMPY: PyOnceLock<Py<PyModule>> = PyOnceLock::new();
    let module = NUMPY.get_or_try_init(py, || py.import("numpy").map(Bound::unbind))?;
    Ok(module.bind(py))
}
