//! Where shapes, dtypes and memory order meet: Python objects in, slices of `f64` out, and back.

mod array;
mod broadcast;
mod input;
pub mod memory;
mod out;
mod output;
mod pool;
mod scalars;
mod strided;

use std::cell::Cell;
use std::ffi::CString;
use std::sync::atomic::{AtomicUsize, Ordering};

use numpy::{PyArrayDyn, PyUntypedArray};
use pyo3::exceptions::{PyMemoryError, PyOverflowError, PyTypeError, PyValueError};
use pyo3::import_exception;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyBool, PyFloat, PyInt, PyTuple};
use six_wheel_kinematics::units::Question;
use six_wheel_numerics::error::{Error, ErrorKind};

pub use array::{read_array, singles};
pub use broadcast::{Broadcast, Named, given, joint, named, together};
pub use input::{Blocks, Rows, numbers};
pub use out::Out;
pub use output::{Asked, Output, Precision, scalar_or_array};
pub use scalars::Scalars;

import_exception!(six_wheel.errors, ArgumentTypeError);
import_exception!(six_wheel.errors, InfeasibleMotionError);
import_exception!(six_wheel.errors, UnderdeterminedError);

/// Rows from which a call lets other Python threads run meanwhile.
pub const DETACH_ROWS: usize = 32;

/// An array as Python sees it.
pub type Array<'py> = Bound<'py, PyArrayDyn<f64>>;

/// An array of either precision.
pub type AnyArray<'py> = Bound<'py, PyUntypedArray>;

/// The exception of a core error, its row written as the index into the leading axes.
pub fn raise(error: Error, leading: &[usize]) -> PyErr {
    let message = error.message(&error.row.map_or_else(String::new, |row| index(row, leading)));
    match error.kind {
        ErrorKind::Value => PyValueError::new_err(message),
        ErrorKind::Infeasible => InfeasibleMotionError::new_err(message),
        ErrorKind::Underdetermined => UnderdeterminedError::new_err(message),
        ErrorKind::Memory => PyMemoryError::new_err(message),
    }
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

/// "`argument` must `rule`, got `value`" for what only Python knows of.
pub fn refuse(argument: &str, rule: &str, value: &str) -> PyErr {
    PyValueError::new_err(format!("{argument} must {rule}, got {value}"))
}

/// A shape as Python writes it.
pub fn shape_text(shape: &[usize]) -> String {
    let lengths: Vec<String> = shape.iter().map(usize::to_string).collect();
    let comma = if shape.len() == 1 { "," } else { "" };
    format!("({}{comma})", lengths.join(", "))
}

/// Whether an error is the interpreter's own word that a value is of another kind. What an argument's own code
/// raises is not, and comes through.
pub fn is_of_another_kind(py: Python<'_>, error: &PyErr) -> bool {
    error.traceback(py).is_none()
        && (error.is_instance_of::<PyTypeError>(py)
            || error.is_instance_of::<PyValueError>(py)
            || error.is_instance_of::<PyOverflowError>(py))
}

/// What a value looks like, on one line: an array's representation takes several.
pub fn short_repr(value: &Bound<'_, PyAny>) -> String {
    let text = value.repr().map_or_else(|_| "an object".into(), |repr| repr.to_string());
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// One of some names; what is none looks like itself, and is refused with the names.
pub fn name(value: &Bound<'_, PyAny>) -> String {
    value.extract().unwrap_or_else(|_| short_repr(value))
}

/// Fails where numbers came one by one that belong into one row: more of them than the method has parameters, of
/// which `given` are.
pub fn one_twist(call: &str, given: usize, more: &Bound<'_, PyTuple>) -> PyResult<()> {
    match more.is_empty() {
        true => Ok(()),
        false => Err(one_row(call, "twist", given + more.len())),
    }
}

/// The same where the first of them may be all there is to see: the others fill parameters of their own.
pub fn one_twist_first(call: &str, first: &Bound<'_, PyAny>, given: usize, more: &Bound<'_, PyTuple>) -> PyResult<()> {
    let number = first.is_instance_of::<PyFloat>() || first.is_instance_of::<PyInt>();
    match number && given > 1 {
        true => Err(one_row(call, "twist", given + more.len())),
        false => one_twist(call, given, more),
    }
}

/// Who hands over several numbers for one row of them is told how it is called.
pub fn one_row(call: &str, what: &str, count: usize) -> PyErr {
    let (class, call) = call.split_once('.').unwrap_or(("", call));
    let method = call.split('(').next().unwrap_or(call);
    PyTypeError::new_err(format!("{class}.{method}() takes one {what}, as in {call}, got {count} arguments"))
}

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

/// Warns of what cannot be meant, with the unit that is likely.
pub fn ask(py: Python<'_>, questions: impl IntoIterator<Item = Question>) -> PyResult<()> {
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

/// A number of a constructor.
pub fn number(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<f64> {
    let py = value.py();
    let refused = || ArgumentTypeError::new_err(format!("{argument} must be a number, got {}", short_repr(value)));
    if value.is_instance_of::<PyBool>() {
        return Err(refused());
    }
    array::refuse_masks(argument, value, array::DEEP)?;
    value.extract::<f64>().map_err(|error| match is_of_another_kind(py, &error) {
        true => refused(),
        false => error,
    })
}

/// The items of an iterable, `most` at most: more are none that could be meant.
pub fn items<'py>(argument: &str, value: &Bound<'py, PyAny>, most: usize) -> PyResult<Vec<Bound<'py, PyAny>>> {
    let mut items = Vec::new();
    for item in value.try_iter()? {
        if items.len() == most {
            return Err(refuse(argument, &format!("hold {most} at most"), "more"));
        }
        items.try_reserve(1).map_err(|_| memory::none_for(&[items.len()]))?;
        items.push(item?);
    }
    Ok(items)
}

static READY: PyOnceLock<()> = PyOnceLock::new();

/// Loads NumPy for the `numpy` crate, which would panic at what an import may raise: a Ctrl-C, a NumPy that is broken.
///
/// Whatever touches an array comes by here first: arguments on their way in, fresh arrays, and rovers and suspensions,
/// without which there is no object that has arrays to show.
pub fn ready(py: Python<'_>) -> PyResult<()> {
    READY.get_or_try_init(py, || numpy::get_array_module(py).map(drop)).copied()
}

/// Whether that has been done.
pub fn is_ready(py: Python<'_>) -> bool {
    READY.get(py).is_some()
}

fn numpy(py: Python<'_>) -> PyResult<&Bound<'_, PyModule>> {
    static NUMPY: PyOnceLock<Py<PyModule>> = PyOnceLock::new();
    let module = NUMPY.get_or_try_init(py, || py.import("numpy").map(Bound::unbind))?;
    Ok(module.bind(py))
}

/// After a fork only the thread that forked is left: whatever others were at is not going on.
pub fn after_fork() {
    BATCHES.store(0, Ordering::Relaxed);
    memory::forget();
}

/// Kernels at work while other Python threads run.
static BATCHES: AtomicUsize = AtomicUsize::new(0);

/// Whether a kernel may be reading or writing arrays meanwhile. It changes only with the interpreter's lock held.
pub fn batches_at_work() -> bool {
    BATCHES.load(Ordering::Relaxed) > 0
}

/// Counts a kernel for as long as it is at work, even if it panics.
struct AtWork;

impl AtWork {
    fn begin() -> Self {
        BATCHES.fetch_add(1, Ordering::Relaxed);
        Self
    }
}

impl Drop for AtWork {
    fn drop(&mut self) {
        BATCHES.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Runs a kernel, letting other Python threads run meanwhile if it takes long enough to matter.
pub fn compute<T: Send>(py: Python<'_>, rows: usize, kernel: impl FnOnce() -> T + Send) -> T {
    if rows >= DETACH_ROWS {
        let _at_work = AtWork::begin();
        py.detach(kernel)
    } else {
        kernel()
    }
}

/// Leading axes with a last one.
pub fn joined(leading: &[usize], last: usize) -> Vec<usize> {
    leading.iter().copied().chain([last]).collect()
}
