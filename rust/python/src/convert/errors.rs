//! Exceptions with the argument, the rule and the value, and those of signals that end a kernel.

use std::cell::{Cell, RefCell};
use std::time::{Duration, Instant};

use pyo3::exceptions::{PyKeyboardInterrupt, PyMemoryError, PyOverflowError, PyTypeError, PyValueError};
use pyo3::import_exception;
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyInt, PyTuple};
use six_wheel_numerics::error::{Error, ErrorKind, LARGEST, bounded};
use six_wheel_numerics::names::one_of;
use six_wheel_numerics::sizes::are_below;

import_exception!(six_wheel.kinematics.errors, ArgumentTypeError);
import_exception!(six_wheel.kinematics.errors, InfeasibleMotionError);
import_exception!(six_wheel.kinematics.errors, UnderdeterminedError);

/// The exception of a core error, its row written as the index into the leading axes.
pub fn raise(error: Error, leading: &[usize]) -> PyErr {
    let message = error.message(&error.row.map_or_else(String::new, |row| index(row, leading)));
    match error.kind {
        ErrorKind::Value => PyValueError::new_err(message),
        ErrorKind::Infeasible => InfeasibleMotionError::new_err(message),
        ErrorKind::Underdetermined => UnderdeterminedError::new_err(message),
        ErrorKind::Memory => PyMemoryError::new_err(message),
        ErrorKind::Interrupted => interruption(error.row),
    }
}

/// Results of the core as results of Python, their errors as exceptions with the row as an index into leading axes.
pub trait OrRaise<T> {
    /// The value, or the exception of [`raise`].
    fn or_raise(self, leading: &[usize]) -> PyResult<T>;
}

impl<T> OrRaise<T> for Result<T, Error> {
    #[inline]
    fn or_raise(self, leading: &[usize]) -> PyResult<T> {
        self.map_err(|error| raise(error, leading))
    }
}

/// Time between two questions to the interpreter, each of which may wait for its lock.
const BETWEEN_QUESTIONS: Duration = Duration::from_millis(50);

thread_local! {
    /// When this thread asked last, or began its kernel.
    static ASKED: Cell<Option<Instant>> = const { Cell::new(None) };
    /// The exception of the signal that ended a kernel of this thread.
    static ENDED_BY: RefCell<Option<PyErr>> = const { RefCell::new(None) };
}

/// Begins the time until the first question of a kernel.
pub(super) fn begin_kernel() {
    ASKED.set(Some(Instant::now()));
}

/// Asks the interpreter whether a signal's handler has raised an exception, which ends the kernel at work.
pub fn is_interrupted() -> bool {
    let now = Instant::now();
    let is_due = ASKED.get().is_none_or(|asked| now.duration_since(asked) >= BETWEEN_QUESTIONS);
    if !is_due {
        return false;
    }
    let raised = Python::attach(|py| py.check_signals().err());
    begin_kernel();
    let ends = raised.is_some();
    ENDED_BY.with(|ended_by| *ended_by.borrow_mut() = raised);
    ends
}

/// The exception that ended a kernel, with the row that would have been the next, if objects are at it.
fn interruption(row: Option<usize>) -> PyErr {
    let error = ENDED_BY.with(|ended_by| ended_by.borrow_mut().take());
    let error = error.unwrap_or_else(|| PyKeyboardInterrupt::new_err(()));
    if let Some(row) = row {
        // Without memory for a note the exception stays as it is.
        let _ = Python::attach(|py| error.value(py).call_method1("add_note", (format!("before row {row}"),)).map(drop));
    }
    error
}

/// `[1, 3]`: a flat row number as an index.
fn index(row: usize, leading: &[usize]) -> String {
    if leading.is_empty() {
        return String::new();
    }
    let mut rest = row;
    let mut places: Vec<String> = Vec::new();
    for length in leading.iter().rev() {
        places.push((rest % length.max(&1)).to_string());
        rest /= length.max(&1);
    }
    places.reverse();
    format!("[{}]", places.join(", "))
}

/// Fails unless the numbers of every row are finite and smaller than [`LARGEST`]; a row that has no answer may also be NaN throughout.
pub(super) fn check_finite(
    argument: &'static str,
    values: &[f64],
    width: usize,
    leading: &[usize],
    has_no_answer: impl Fn(usize) -> bool,
) -> PyResult<()> {
    if are_below(values, LARGEST) {
        return Ok(());
    }
    for (row, values) in values.chunks_exact(width.max(1)).enumerate() {
        if values.iter().all(|value| value.is_nan()) && has_no_answer(row) {
            continue;
        }
        bounded(argument, values).map_err(|error| raise(error.at_row(row), leading))?;
    }
    Ok(())
}

/// "`argument` must `rule`, got `value`" for what only Python knows of.
pub fn refuse(argument: &str, rule: &str, value: &str) -> PyErr {
    PyValueError::new_err(format!("{argument} must {rule}, got {value}"))
}

/// The value of a name among a few, each with its own; `got` writes another name in the error.
pub fn choice<T: Copy>(argument: &str, name: &str, got: fn(&str) -> String, all: &[(&str, T)]) -> PyResult<T> {
    let found = all.iter().find(|(known, _)| *known == name);
    found.map(|(_, value)| *value).ok_or_else(|| {
        let names: Vec<&str> = all.iter().map(|(known, _)| *known).collect();
        refuse(argument, &one_of(&names), &got(name))
    })
}

/// The same for a value whose shape breaks the rule.
pub fn refuse_shape(argument: &str, rule: &str, shape: &[usize]) -> PyErr {
    refuse(argument, rule, &format!("shape {}", shape_text(shape)))
}

/// A shape as Python writes it.
pub fn shape_text(shape: &[usize]) -> String {
    let lengths: Vec<String> = shape.iter().map(usize::to_string).collect();
    let comma = if shape.len() == 1 { "," } else { "" };
    format!("({}{comma})", lengths.join(", "))
}

/// True if an error is the interpreter's own complaint that a value is of another kind. Errors that an argument's own
/// code raises are not, and pass through.
pub fn is_of_another_kind(py: Python<'_>, error: &PyErr) -> bool {
    error.traceback(py).is_none()
        && (error.is_instance_of::<PyTypeError>(py)
            || error.is_instance_of::<PyValueError>(py)
            || error.is_instance_of::<PyOverflowError>(py))
}

/// The representation of a value on one line; that of an array takes several.
pub fn short_repr(value: &Bound<'_, PyAny>) -> String {
    let text = value.repr().map_or_else(|_| "an object".into(), |repr| repr.to_string());
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Fails where numbers came one by one that belong into one row: more of them than the method has parameters, of
/// which `given` are.
pub fn one_twist(call: &str, given: usize, more: &Bound<'_, PyTuple>) -> PyResult<()> {
    if more.is_empty() { Ok(()) } else { Err(one_row(call, "twist", given + more.len())) }
}

/// The same where the first of them may be all there is to see: the others fill parameters of their own.
pub fn one_twist_first(call: &str, first: &Bound<'_, PyAny>, given: usize, more: &Bound<'_, PyTuple>) -> PyResult<()> {
    let number = first.is_instance_of::<PyFloat>() || first.is_instance_of::<PyInt>();
    if number && given > 1 { Err(one_row(call, "twist", given + more.len())) } else { one_twist(call, given, more) }
}

/// The error for several numbers instead of one row of them, with the call that is right.
pub fn one_row(call: &str, what: &str, count: usize) -> PyErr {
    let (class, call) = call.split_once('.').unwrap_or(("", call));
    let method = call.split('(').next().unwrap_or(call);
    PyTypeError::new_err(format!("{class}.{method}() takes one {what}, as in {call}, got {count} arguments"))
}
