//! Kernels that run while the interpreter's lock is released.

use std::cell::{Cell, RefCell};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use six_wheel_numerics::error::Error;

use super::errors::OrRaise;
use super::memory;

/// Rows from which a call lets other Python threads run meanwhile.
const DETACH_ROWS: usize = 32;

/// After a fork only the thread that forked is left: whatever others were at is not going on.
pub fn forget_other_threads() {
    BATCHES.store(0, Ordering::Relaxed);
    memory::forget();
}

/// Kernels at work while other Python threads run.
static BATCHES: AtomicUsize = AtomicUsize::new(0);

/// True if a kernel may be reading or writing arrays meanwhile. It changes only with the interpreter's lock held.
pub fn batches_at_work() -> bool {
    BATCHES.load(Ordering::Relaxed) > 0
}

/// Counts a kernel for as long as it is at work, even if it panics.
struct ActiveKernelCount;

impl ActiveKernelCount {
    fn begin() -> Self {
        BATCHES.fetch_add(1, Ordering::Relaxed);
        Self
    }
}

impl Drop for ActiveKernelCount {
    fn drop(&mut self) {
        BATCHES.fetch_sub(1, Ordering::Relaxed);
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

/// Asks the interpreter whether a signal's handler has raised an exception, which ends the kernel at work.
pub fn is_interrupted() -> bool {
    let now = Instant::now();
    let is_due = ASKED.get().is_none_or(|asked| now.duration_since(asked) >= BETWEEN_QUESTIONS);
    if !is_due {
        return false;
    }
    let raised = Python::attach(|py| py.check_signals().err());
    ASKED.set(Some(Instant::now()));
    let ends = raised.is_some();
    ENDED_BY.with(|ended_by| *ended_by.borrow_mut() = raised);
    ends
}

/// The exception that ended a kernel, with the row that would have been the next, if objects are at it.
pub(super) fn interruption(row: Option<usize>) -> PyErr {
    let error = ENDED_BY.with(|ended_by| ended_by.borrow_mut().take());
    let error = error.unwrap_or_else(|| PyKeyboardInterrupt::new_err(()));
    if let Some(row) = row {
        // Without room for a note the exception says what it said.
        let _ = Python::attach(|py| error.value(py).call_method1("add_note", (format!("before row {row}"),)).map(drop));
    }
    error
}

/// Runs a kernel, letting other Python threads run meanwhile if it takes long enough to matter.
pub fn compute<T: Send>(py: Python<'_>, rows: usize, kernel: impl FnOnce() -> T + Send) -> T {
    if rows >= DETACH_ROWS {
        let _at_work = ActiveKernelCount::begin();
        ASKED.set(Some(Instant::now()));
        py.detach(kernel)
    } else {
        kernel()
    }
}

/// As [`compute`], with the kernel's error raised: its row is an index into these leading axes.
pub fn compute_rows<T: Send>(
    py: Python<'_>,
    rows: usize,
    leading: &[usize],
    kernel: impl FnOnce() -> Result<T, Error> + Send,
) -> PyResult<T> {
    compute(py, rows, kernel).or_raise(leading)
}
