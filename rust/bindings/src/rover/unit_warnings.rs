//! Warnings of dimensions and speeds that look like numbers in another unit.

use std::cell::Cell;
use std::ffi::CString;

use pyo3::prelude::*;
use six_wheel_core::units::Question;

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

/// Warns of numbers of an unlikely size, with the unit that is likely.
pub fn warn_units(py: Python<'_>, questions: impl IntoIterator<Item = Question>) -> PyResult<()> {
    if QUIET.get() > 0 {
        return Ok(());
    }
    for question in questions {
        let text = CString::new(format!("{}; {}", question.says, question.likely))?;
        let category = py.import("six_wheel.errors")?.getattr("SuspiciousUnitsWarning")?;
        PyErr::warn(py, &category, &text, 1)?;
    }
    Ok(())
}
