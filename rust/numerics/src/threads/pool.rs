//! A pool of threads that stay parked between batches, since starting one takes as long as some thousand rows.
//!
//! There is one pool in a process, with as many threads as the largest request so far, and at most one per core beside
//! the caller. It works for one caller at a time; a call that comes meanwhile does its work in the thread of its
//! caller. A fork does not copy threads: the child finds the pool of another process, and makes its own without reading
//! the other one's state.
//!
//! Not rayon: a scope waits for helpers that have not begun, which on a machine with other work is milliseconds for a batch
//! of a fifth of one, and it allocates at every call.

use std::any::Any;
use std::hint::spin_loop;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::process;
use std::ptr;
use std::sync::atomic::{AtomicPtr, AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Time for which a thread spins for another task before it parks: a batch is checked and then solved, and waking up
/// between the two takes longer than this.
const PATIENCE: Duration = Duration::from_micros(30);

/// The function that every thread calls once for a batch; it returns when no work is left.
type Task = &'static (dyn Fn() + Sync);

/// The task, and the threads that run it.
#[derive(Default)]
struct State {
    /// True while the pool works for a caller.
    busy: bool,
    task: Option<Task>,
    /// Threads that may still begin the task.
    places: usize,
    /// Threads that run the task.
    running: usize,
    /// Threads of the pool, and those of them that are parked.
    threads: usize,
    parked: usize,
    /// Payload of a panic in one of them.
    panic: Option<Box<dyn Any + Send>>,
}

struct ThreadPool {
    process: u32,
    state: Mutex<State>,
    /// Tasks so far, read by spinning threads without the lock.
    tasks: AtomicUsize,
    begun: Condvar,
    /// A thread has started, or the last one has finished its task.
    changed: Condvar,
}

/// Largest number of threads of the pool: with more than one per core nothing is done sooner, and their stacks stay
/// allocated.
fn most_threads() -> usize {
    static MOST: OnceLock<usize> = OnceLock::new();
    *MOST.get_or_init(|| thread::available_parallelism().map_or(1, |cores| cores.get() - 1))
}

impl ThreadPool {
    /// The pool of this process.
    fn here() -> &'static Self {
        static POOL: AtomicPtr<ThreadPool> = AtomicPtr::new(ptr::null_mut());
        let process = process::id();
        let found = POOL.load(Ordering::Acquire);
        // SAFETY: the pointer that is stored there came from a box that is never freed.
        if let Some(pool) = unsafe { found.as_ref() }
            && pool.process == process
        {
            return pool;
        }
        let new = Box::into_raw(Box::new(Self {
            process,
            state: Mutex::default(),
            tasks: AtomicUsize::new(0),
            begun: Condvar::new(),
            changed: Condvar::new(),
        }));
        // The pool that is stored first serves all; one without threads is not worth freeing.
        let stored = POOL.compare_exchange(found, new, Ordering::AcqRel, Ordering::Acquire);
        // SAFETY: as above, whichever of the two it is.
        unsafe { &*stored.map_or_else(|other| other, |_| new) }
    }

    /// No thread panics while it holds the lock: the state is whole in any case.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The loop of a thread of the pool: runs tasks, spins for [`PATIENCE`], parks.
    fn serve(&self) {
        let mut state = self.lock();
        state.threads += 1;
        self.changed.notify_one();
        loop {
            if let Some(task) = state.task
                && state.places > 0
            {
                state.places -= 1;
                state.running += 1;
                drop(state);
                let done = catch_unwind(AssertUnwindSafe(task));
                state = self.lock();
                state.panic = done.err().or(state.panic.take());
                state.running -= 1;
                if state.running == 0 {
                    self.changed.notify_one();
                }
                continue;
            }
            let seen = self.tasks.load(Ordering::Relaxed);
            drop(state);
            let idle_since = Instant::now();
            while self.tasks.load(Ordering::Relaxed) == seen && idle_since.elapsed() < PATIENCE {
                spin_loop();
            }
            state = self.lock();
            if self.tasks.load(Ordering::Relaxed) == seen {
                state.parked += 1;
                state = wait(&self.begun, state);
                state.parked -= 1;
            }
        }
    }

    /// Starts threads until there are `count`, or no more can start. On return each of them runs [`Self::serve`] and
    /// allocates nothing from then on.
    fn grow<'a>(&'static self, mut state: MutexGuard<'a, State>, count: usize) -> MutexGuard<'a, State> {
        while state.threads < count {
            let before = state.threads;
            drop(state);
            let started = thread::Builder::new().name("six_wheel".to_owned()).spawn(|| self.serve());
            state = self.lock();
            if started.is_err() {
                break;
            }
            while state.threads == before {
                state = wait(&self.changed, state);
            }
        }
        state
    }
}

fn wait<'a, T>(signal: &Condvar, guard: MutexGuard<'a, T>) -> MutexGuard<'a, T> {
    signal.wait(guard).unwrap_or_else(PoisonError::into_inner)
}

/// Runs a task in this thread and in up to `helpers` others at the same time; all have returned from it on return. A
/// task returns when no work is left, so the result does not depend on the number of threads that run it, or when they
/// begin.
pub(crate) fn run(helpers: usize, task: &(dyn Fn() + Sync)) {
    let helpers = helpers.min(most_threads());
    if helpers == 0 {
        return task();
    }
    let pool = ThreadPool::here();
    let mut state = pool.lock();
    if state.busy {
        drop(state);
        return task();
    }
    state.busy = true;
    state = pool.grow(state, helpers);
    // SAFETY: the task is removed below before every return, after the last thread has returned from it.
    state.task = Some(unsafe { std::mem::transmute::<&(dyn Fn() + Sync), Task>(task) });
    state.places = helpers;
    pool.tasks.fetch_add(1, Ordering::Relaxed);
    let parked = state.parked;
    drop(state);
    for _ in 0..helpers.min(parked) {
        pool.begun.notify_one();
    }
    let done = catch_unwind(AssertUnwindSafe(task));
    let mut state = pool.lock();
    (state.task, state.places) = (None, 0);
    while state.running > 0 {
        state = wait(&pool.changed, state);
    }
    state.busy = false;
    let panic = done.err().or(state.panic.take());
    drop(state);
    if let Some(panic) = panic {
        resume_unwind(panic);
    }
}
