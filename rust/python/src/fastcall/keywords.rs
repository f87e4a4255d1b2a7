//! Keywords that a constructor does not have.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Fails if there are unknown keywords: the message has the nearest name, and all those in the signature `shown`.
pub fn check(call: &str, shown: &str, unknown: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
    let Some((name, _)) = unknown.and_then(|unknown| unknown.iter().next()) else { return Ok(()) };
    let module = name.py().import("six_wheel.kinematics.keywords")?;
    let call = call.trim_end_matches(".new");
    let message: String = module.call_method1("unknown_keyword", (call, &name, shown))?.extract()?;
    Err(PyTypeError::new_err(message))
}
