//! Keywords that a call does not have, values for which it has no place, and arguments that are missing.

use std::ffi::CStr;

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple, PyType};

/// A call, as it is written in messages.
pub struct Call {
    /// `Class.method`; `Class.new` for a constructor.
    pub name: &'static str,
    /// The parameters as Python shows them.
    pub signature: &'static str,
}

/// An argument without a default, which may be missing.
pub struct Given<'py>(pub Option<Bound<'py, PyAny>>);

impl<'py> FromPyObject<'_, 'py> for Given<'py> {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        Ok(Self(Some(value.to_owned())))
    }
}

impl Call {
    fn name(&self) -> &str {
        self.name.trim_end_matches(".new")
    }

    /// Fails if there are unknown keywords: the message has the nearest name, and all there are. Then if there are more
    /// values without keywords than places, then if any of the `required` arguments is missing.
    pub fn check(
        &self,
        unknown: Option<&Bound<'_, PyDict>>,
        excess: &[&Bound<'_, PyTuple>],
        required: &[(&str, &Given<'_>)],
    ) -> PyResult<()> {
        let refused = |function: &str, value: Bound<'_, PyAny>| {
            let module = value.py().import("six_wheel.kinematics.keywords")?;
            let message: String = module.call_method1(function, (self.name(), value, self.signature))?.extract()?;
            Err(PyTypeError::new_err(message))
        };
        if let Some((name, _)) = unknown.and_then(|unknown| unknown.iter().next()) {
            return refused("unknown_keyword", name);
        }
        if let Some(excess) = excess.first().filter(|excess| !excess.is_empty()) {
            return refused("too_many_values", (*excess).clone().into_any());
        }
        let missing: Vec<&str> = required.iter().filter(|each| each.1.0.is_none()).map(|each| each.0).collect();
        if missing.is_empty() { Ok(()) } else { Err(self.needs(&missing)) }
    }

    /// An argument without a default; fails where it is missing.
    pub fn required<'a, 'py>(&self, name: &str, given: &'a Given<'py>) -> PyResult<&'a Bound<'py, PyAny>> {
        given.0.as_ref().ok_or_else(|| self.needs(&[name]))
    }

    fn needs(&self, missing: &[&str]) -> PyErr {
        let (call, plural) = (self.name(), if missing.len() > 1 { "s" } else { "" });
        PyTypeError::new_err(format!("{call}() needs the argument{plural} {}", missing.join(", ")))
    }
}

/// The nearest name and all others in place of pyo3's error for a keyword, one of `names`, that a method does not have.
pub fn explain(class: &Bound<'_, PyType>, method: &CStr, names: &Bound<'_, PyAny>) {
    let py = class.py();
    let Some(error) = PyErr::take(py) else { return };
    let message = || -> PyResult<Option<String>> {
        if !error.is_instance_of::<PyTypeError>(py) {
            return Ok(None);
        }
        let method = class.getattr(method.to_string_lossy().as_ref())?;
        py.import("six_wheel.kinematics.keywords")?.call_method1("unknown_of", (method, names))?.extract()
    };
    match message() {
        Ok(Some(message)) => PyTypeError::new_err(message).restore(py),
        _ => error.restore(py),
    }
}
