//! Keywords that a call does not have.

use std::ffi::CStr;

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyType};

/// Fails if there are unknown keywords: the message has the nearest name, and all those in the signature `shown`.
pub fn check(call: &str, shown: &str, unknown: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
    let Some((name, _)) = unknown.and_then(|unknown| unknown.iter().next()) else { return Ok(()) };
    let module = name.py().import("six_wheel.kinematics.keywords")?;
    let call = call.trim_end_matches(".new");
    let message: String = module.call_method1("unknown_keyword", (call, &name, shown))?.extract()?;
    Err(PyTypeError::new_err(message))
}

/// An argument without a default, which may be missing.
pub struct Given<'py>(pub Option<Bound<'py, PyAny>>);

impl<'py> FromPyObject<'_, 'py> for Given<'py> {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        Ok(Self(Some(value.to_owned())))
    }
}

/// An argument without a default; fails where it is missing.
pub fn required<'a, 'py>(call: &str, name: &str, given: &'a Given<'py>) -> PyResult<&'a Bound<'py, PyAny>> {
    let message = || format!("{}() needs the argument {name}", call.trim_end_matches(".new"));
    given.0.as_ref().ok_or_else(|| PyTypeError::new_err(message()))
}

/// The error of pyo3 for an unknown keyword of a method, if it is the one that is set, with the nearest name and all others.
pub fn explain(class: &Bound<'_, PyType>, method: &CStr) {
    let py = class.py();
    let Some(error) = PyErr::take(py) else { return };
    let explained = || -> PyResult<Option<String>> {
        if !error.is_instance_of::<PyTypeError>(py) {
            return Ok(None);
        }
        let text = error.value(py).to_string();
        let method = class.getattr(method.to_string_lossy().as_ref())?;
        py.import("six_wheel.kinematics.keywords")?.call_method1("explained", (text, method))?.extract()
    };
    match explained() {
        Ok(Some(message)) => PyTypeError::new_err(message).restore(py),
        _ => error.restore(py),
    }
}
