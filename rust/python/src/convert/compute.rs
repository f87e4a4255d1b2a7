//! Kernels that run while the interpreter's lock is released.

use std::sync::atomic::{AtomicUsize, Ordering};

use pyo3::prelude::*;
use six_wheel_numerics::error::Error;

use super::errors::{OrRaise, begin_kernel};
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

/// Runs a kernel, letting other Python threads run meanwhile if it takes long enough to matter.
pub fn compute<T: Send>(py: Python<'_>, rows: usize, kernel: impl FnOnce() -> T + Send) -> T {
    if rows >= DETACH_ROWS {
        let _at_work = ActiveKernelCount::begin();
        begin_kernel();
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
