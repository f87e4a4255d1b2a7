//! Exceptions with the argument, the rule and the value, and those of signals that end a kernel.

use std::cell::{Cell, RefCell};
use std::time::{Duration, Instant};

use pyo3::exceptions::{PyKeyboardInterrupt, PyMemoryError, PyOverflowError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyInt, PyTuple};
use pyo3::{PyTypeInfo, import_exception, intern};
use six_wheel_numerics::error::{Error, ErrorKind};
use six_wheel_numerics::names::one_of;

import_exception!(six_wheel.kinematics.errors, ArgumentTypeError);
import_exception!(six_wheel.kinematics.errors, InfeasibleMotionError);
import_exception!(six_wheel.kinematics.errors, UnderdeterminedError);

/// The exception of a core error, its row written as the index into the leading axes.
pub fn raise(error: Error, leading: &[usize]) -> PyErr {
    let exception = match error.kind {
        ErrorKind::Value => exception::<PyValueError>,
        ErrorKind::Infeasible => exception::<InfeasibleMotionError>,
        ErrorKind::Underdetermined => exception::<UnderdeterminedError>,
        ErrorKind::Memory => exception::<PyMemoryError>,
        ErrorKind::Interrupted => return interruption(error.row),
    };
    let row = error.row.map_or_else(Vec::new, |row| index(row, leading));
    exception(&error.argument, &row, &error.rule, &error.value)
}

/// The exception with the text "`path[row]` must `rule`, got `value`", and the parts of the text as attributes:
/// `argument`, the first name of the path; `place`, what stands between it and the rule; `row`; and `problem`, the rest.
fn exception<E: PyTypeInfo>(path: &str, row: &[usize], rule: &str, value: &str) -> PyErr {
    let end = path.find(|letter: char| !letter.is_alphanumeric() && letter != '_').unwrap_or(path.len());
    let (argument, inside) = path.split_at(end);
    let place = if row.is_empty() { inside.into() } else { format!("{inside}{row:?}") };
    let problem = format!("must {rule}, got {value}");
    // The object at once: pyo3 would let go of the interpreter while it makes one later, with arrays still in use.
    let made = Python::attach(|py| {
        let error = E::type_object(py).call1((format!("{argument}{place} {problem}"),))?;
        error.setattr(intern!(py, "argument"), argument)?;
        error.setattr(intern!(py, "place"), place)?;
        error.setattr(intern!(py, "row"), PyTuple::new(py, row)?)?;
        error.setattr(intern!(py, "problem"), problem)?;
        PyResult::Ok(PyErr::from_value(error))
    });
    made.unwrap_or_else(|failure| failure)
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

/// A flat row number as an index into the leading axes.
fn index(row: usize, leading: &[usize]) -> Vec<usize> {
    let mut rest = row;
    let mut places: Vec<usize> = Vec::new();
    for length in leading.iter().rev() {
        places.push(rest % length.max(&1));
        rest /= length.max(&1);
    }
    places.reverse();
    places
}

/// "`argument` must `rule`, got `value`" for what only Python knows of.
pub fn refuse(argument: &str, rule: impl ToString, value: impl ToString) -> PyErr {
    exception::<PyValueError>(argument, &[], &rule.to_string(), &value.to_string())
}

/// The same for a value of another type.
pub fn refuse_type(argument: &str, rule: impl ToString, value: impl ToString) -> PyErr {
    exception::<ArgumentTypeError>(argument, &[], &rule.to_string(), &value.to_string())
}

/// The value of a name among a few, each with its own; `got` writes another name in the error.
pub fn choice<T: Copy>(argument: &str, name: &str, got: fn(&str) -> String, all: &[(&str, T)]) -> PyResult<T> {
    let found = all.iter().find(|(known, _)| *known == name);
    found.map(|(_, value)| *value).ok_or_else(|| {
        let names: Vec<&str> = all.iter().map(|(known, _)| *known).collect();
        refuse(argument, one_of(&names), got(name))
    })
}

/// The same for a value whose shape breaks the rule.
pub fn refuse_shape(argument: &str, rule: impl ToString, shape: &[usize]) -> PyErr {
    refuse(argument, rule, format!("shape {}", shape_text(shape)))
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
