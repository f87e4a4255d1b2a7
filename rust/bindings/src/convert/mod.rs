//! Where shapes, dtypes and memory order meet: Python objects in, slices of `f64` out, and back.

mod input;
mod output;
mod strided;

use std::sync::atomic::{AtomicUsize, Ordering};

use numpy::PyArrayDyn;
use pyo3::exceptions::PyValueError;
use pyo3::import_exception;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyBool;
use six_wheel_core::{Error, ErrorKind};

pub use input::{Rows, Scalars};
pub use output::{Output, disjoint, nested, scalar_or_array};

import_exception!(six_wheel.errors, ArgumentTypeError);
import_exception!(six_wheel.errors, InfeasibleMotionError);
import_exception!(six_wheel.errors, UnderdeterminedError);

/// Rows from which a call lets other Python threads run meanwhile.
pub const DETACH_ROWS: usize = 32;

/// An array as Python sees it.
pub type Array<'py> = Bound<'py, PyArrayDyn<f64>>;

/// The exception of a core error, its row written as the index into the leading axes.
pub fn raise(error: Error, leading: &[usize]) -> PyErr {
    let message = error.message(
        &error
            .row
            .map_or_else(String::new, |row| index(row, leading)),
    );
    match error.kind {
        ErrorKind::Value => PyValueError::new_err(message),
        ErrorKind::Infeasible => InfeasibleMotionError::new_err(message),
        ErrorKind::Underdetermined => UnderdeterminedError::new_err(message),
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

/// A number of a constructor.
pub fn number(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<f64> {
    let refused = || {
        let text = value
            .repr()
            .map_or_else(|_| "an object".into(), |repr| repr.to_string());
        // An array's takes lines.
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        ArgumentTypeError::new_err(format!("{argument} must be a number, got {text}"))
    };
    if value.is_instance_of::<PyBool>() {
        return Err(refused());
    }
    value.extract::<f64>().map_err(|_| refused())
}

fn numpy(py: Python<'_>) -> PyResult<&Bound<'_, PyModule>> {
    static NUMPY: PyOnceLock<Py<PyModule>> = PyOnceLock::new();
    let module = NUMPY.get_or_try_init(py, || py.import("numpy").map(Bound::unbind))?;
    Ok(module.bind(py))
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
