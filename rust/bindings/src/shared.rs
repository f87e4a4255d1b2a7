//! State that any thread may work with, one at a time.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use pyo3::types::{PyCFunction, PyDict};

/// How many forks lie between this process and the one that loaded the module.
static FORKS: AtomicU64 = AtomicU64::new(0);

/// State behind a lock. Whoever comes second waits, and other Python threads run meanwhile.
pub struct Shared<T> {
    state: Mutex<T>,
    /// [`FORKS`] when it was last taken.
    taken: AtomicU64,
}

impl<T: Send> Shared<T> {
    /// State that nobody works with yet.
    pub fn new(state: T) -> Self {
        Self {
            state: Mutex::new(state),
            taken: AtomicU64::new(0),
        }
    }

    /// The state, if nobody works with it.
    #[inline(always)]
    pub fn try_lock(&self) -> Option<MutexGuard<'_, T>> {
        let guard = match self.state.try_lock() {
            Ok(guard) => guard,
            // A panic cannot have left it half changed: steps do not panic.
            Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
            Err(TryLockError::WouldBlock) => return None,
        };
        self.taken
            .store(FORKS.load(Ordering::Relaxed), Ordering::Relaxed);
        Some(guard)
    }

    /// The state, as soon as nobody else works with it. Fails where that would be never: the thread that does has
    /// been left behind in another process.
    pub fn lock(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, T>> {
        if let Some(guard) = self.try_lock() {
            return Ok(guard);
        }
        if self.taken.load(Ordering::Relaxed) != FORKS.load(Ordering::Relaxed) {
            return Err(PyRuntimeError::new_err(
                "another thread worked with this object when the process was forked: make a new one here",
            ));
        }
        let waited = self.state.lock_py_attached(py);
        let guard = waited.unwrap_or_else(PoisonError::into_inner);
        self.taken
            .store(FORKS.load(Ordering::Relaxed), Ordering::Relaxed);
        Ok(guard)
    }
}

/// Has a forked process forget what other threads were at.
pub fn watch_forks(py: Python<'_>) -> PyResult<()> {
    let os = py.import("os")?;
    if !os.hasattr("register_at_fork")? {
        return Ok(()); // no forks here
    }
    let forget = PyCFunction::new_closure(py, Some(c"forget_other_threads"), None, |_, _| {
        FORKS.fetch_add(1, Ordering::Relaxed);
        crate::convert::after_fork();
    })?;
    let keywords = PyDict::new(py);
    keywords.set_item("after_in_child", forget)?;
    os.call_method("register_at_fork", (), Some(&keywords))?;
    Ok(())
}
