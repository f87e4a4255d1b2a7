//! Warnings of dimensions and speeds that look like numbers in another unit.

use std::cell::Cell;
use std::ffi::CString;

use pyo3::prelude::*;
use six_wheel_kinematics::units::UnitSuspicion;

thread_local! {
    /// Calls of [`without_questions`] on this thread.
    static QUIET: Cell<u32> = const { Cell::new(0) };
}

/// Calls a function during which this thread raises no questions of units: for whoever asks them in another way.
#[pyfunction]
pub fn without_questions<'py>(call: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    QUIET.set(QUIET.get() + 1);
    let result = call.call0();
    QUIET.set(QUIET.get() - 1);
    result
}

/// Warns once, at the line that called this package, of all that cannot be meant, with the unit that is likely.
pub fn warn_units(py: Python<'_>, suspicions: impl IntoIterator<Item = UnitSuspicion>) -> PyResult<()> {
    if QUIET.get() > 0 {
        return Ok(());
    }
    let texts: Vec<String> =
        suspicions.into_iter().map(|odd| format!("{}; {}", odd.finding, odd.explanation)).collect();
    if texts.is_empty() {
        return Ok(());
    }
    let category = py.import("six_wheel.kinematics.errors")?.getattr("SuspiciousUnitsWarning")?;
    PyErr::warn(py, &category, &CString::new(texts.join(". "))?, callers_level(py)?)
}

/// The frame of Python that called this package, as `warnings.warn` counts: 1 is the innermost one.
fn callers_level(py: Python<'_>) -> PyResult<i32> {
    let mut level = 1;
    let Ok(mut frame) = py.import("sys")?.call_method0("_getframe") else { return Ok(level) };
    loop {
        let name = frame.getattr("f_globals")?.get_item("__name__");
        let name: String = name.and_then(|name| name.extract()).unwrap_or_default();
        let next = frame.getattr("f_back")?;
        if !(name == "six_wheel" || name.starts_with("six_wheel.")) || next.is_none() {
            return Ok(level);
        }
        (frame, level) = (next, level + 1);
    }
}
