//! State that any thread may work with, one at a time.

use std::cell::UnsafeCell;
use std::ops::{Deref, DerefMut};
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use pyo3::types::{PyCFunction, PyDict};

/// The number of forks between this process and the one that loaded the module.
static FORKS: AtomicU64 = AtomicU64::new(0);

thread_local! {
    /// Its address tells this thread from others that live.
    static HERE: u8 = const { 0 };
}

/// State for one at a time. Whoever comes second waits, and other Python threads run meanwhile.
///
/// The owner is noted in plain numbers, which only change with the interpreter's lock held: a control loop's step is
/// spared the two atomic exchanges of a mutex, each of which waits for all that was written before. A mutex has whoever may let
/// go of the interpreter's lock meanwhile, so that others can wait.
pub struct Shared<T> {
    state: UnsafeCell<T>,
    at_work: AtomicBool,
    gate: Mutex<()>,
    /// [`FORKS`] when the gate was last taken.
    taken: AtomicU64,
    /// Address of [`HERE`] in the thread that took it.
    taken_by: AtomicUsize,
}

// SAFETY: `state` is reached through a `Turn` only, and there is one at a time: `at_work` is asked and set with the
// interpreter's lock held, which also hands on what was written.
unsafe impl<T: Send> Sync for Shared<T> {}

/// Somebody's turn to work with the state. Ends with the interpreter's lock held: no other thread can be sent it.
pub struct Turn<'a, T> {
    shared: &'a Shared<T>,
    _gate: Option<MutexGuard<'a, ()>>,
}

impl<T> Deref for Turn<'_, T> {
    type Target = T;

    #[inline(always)]
    fn deref(&self) -> &T {
        // SAFETY: there is one turn at a time.
        unsafe { &*self.shared.state.get() }
    }
}

impl<T> DerefMut for Turn<'_, T> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut T {
        // SAFETY: as above.
        unsafe { &mut *self.shared.state.get() }
    }
}

impl<T> Drop for Turn<'_, T> {
    #[inline(always)]
    fn drop(&mut self) {
        self.shared.at_work.store(false, Ordering::Relaxed);
    }
}

impl<T: Send> Shared<T> {
    /// State that nobody works with yet.
    pub fn new(state: T) -> Self {
        Self {
            state: UnsafeCell::new(state),
            at_work: AtomicBool::new(false),
            gate: Mutex::new(()),
            taken: AtomicU64::new(0),
            taken_by: AtomicUsize::new(0),
        }
    }

    /// The state, if nobody works with it: for who keeps the interpreter's lock until the turn is over.
    #[inline(always)]
    pub fn try_lock<'a>(&'a self, _: Python<'a>) -> Option<Turn<'a, T>> {
        (!self.at_work.load(Ordering::Relaxed)).then(|| self.turn(None))
    }

    #[inline(always)]
    fn turn<'a>(&'a self, gate: Option<MutexGuard<'a, ()>>) -> Turn<'a, T> {
        self.at_work.store(true, Ordering::Relaxed);
        Turn { shared: self, _gate: gate }
    }

    /// The state, as soon as nobody else works with it. Fails where that would be never: the thread that does has
    /// been left behind in another process, or is this one, in the handler of a signal.
    pub fn lock<'a>(&'a self, py: Python<'a>) -> PyResult<Turn<'a, T>> {
        let forks = FORKS.load(Ordering::Relaxed);
        let here = HERE.with(|here| std::ptr::from_ref(here).addr());
        let gate = match self.gate.try_lock() {
            Ok(gate) => gate,
            // A panic cannot have left the state half changed: steps do not panic.
            Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
            Err(TryLockError::WouldBlock) => {
                if self.taken.load(Ordering::Relaxed) != forks {
                    return Err(PyRuntimeError::new_err(
                        "another thread worked with this object when the process was forked: make a new one here",
                    ));
                }
                if self.taken_by.load(Ordering::Relaxed) == here {
                    return Err(PyRuntimeError::new_err(
                        "a call of this object is at work in this thread: the handler of a signal or the code of an argument \
                         cannot use it",
                    ));
                }
                let waited = self.gate.lock_py_attached(py);
                waited.unwrap_or_else(PoisonError::into_inner)
            }
        };
        // A single call that the interpreter has interrupted.
        while self.at_work.load(Ordering::Relaxed) {
            py.detach(std::thread::yield_now);
        }
        self.taken.store(forks, Ordering::Relaxed);
        self.taken_by.store(here, Ordering::Relaxed);
        Ok(self.turn(Some(gate)))
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
        crate::convert::forget_other_threads();
    })?;
    let keywords = PyDict::new(py);
    keywords.set_item("after_in_child", forget)?;
    os.call_method("register_at_fork", (), Some(&keywords))?;
    Ok(())
}
