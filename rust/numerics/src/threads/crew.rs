//! Threads that stay: they wait, parked, for the next batch, since starting one takes as long as some thousand rows.
//!
//! There is one crew in a process, as large as the most hands anybody asked for, and no larger than the machine. It works
//! for one caller at a time; who comes meanwhile does without. A fork leaves threads behind: its child finds a crew of
//! another process, and starts one of its own without looking at what that one holds.

use std::any::Any;
use std::hint::spin_loop;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::process;
use std::ptr;
use std::sync::atomic::{AtomicPtr, AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, OnceLock, PoisonError, TryLockError};
use std::thread;
use std::time::{Duration, Instant};

/// Time for which a thread looks for more before it parks: a batch is checked and then solved, and waking up in between
/// takes longer than this.
const PATIENCE: Duration = Duration::from_micros(30);

/// Task of all hands at once, each until there is nothing left to do.
type Task = &'static (dyn Fn() + Sync);

/// Task of the crew, and the helpers who are at it.
struct Board {
    task: Option<Task>,
    /// Helpers who may still join in.
    places: usize,
    /// Helpers who are at it.
    inside: usize,
    /// Threads there are, and those of them that are parked.
    helpers: usize,
    parked: usize,
    /// Payload of a helper's panic.
    panic: Option<Box<dyn Any + Send>>,
}

struct Crew {
    process: u32,
    /// Held by the caller the crew works for.
    turn: Mutex<()>,
    board: Mutex<Board>,
    /// Tasks so far, for those who look without the board.
    tasks: AtomicUsize,
    called: Condvar,
    /// A helper has come, or gone from its task.
    left: Condvar,
}

/// Nobody panics while holding one: what it guards is whole in any case.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn wait<'a, T>(signal: &Condvar, guard: MutexGuard<'a, T>) -> MutexGuard<'a, T> {
    signal.wait(guard).unwrap_or_else(PoisonError::into_inner)
}

/// Helpers beyond the machine's cores do nothing sooner, and as they stay, their stacks would keep what memory there is.
fn most() -> usize {
    static MOST: OnceLock<usize> = OnceLock::new();
    *MOST.get_or_init(|| thread::available_parallelism().map_or(1, |cores| cores.get() - 1))
}

/// The crew of this process.
fn crew() -> &'static Crew {
    static CREW: AtomicPtr<Crew> = AtomicPtr::new(ptr::null_mut());
    let process = process::id();
    let found = CREW.load(Ordering::Acquire);
    // SAFETY: what is stored there came from a box that is never freed.
    if let Some(crew) = unsafe { found.as_ref() }
        && crew.process == process
    {
        return crew;
    }
    let new = Box::into_raw(Box::new(Crew {
        process,
        turn: Mutex::new(()),
        board: Mutex::new(Board { task: None, places: 0, inside: 0, helpers: 0, parked: 0, panic: None }),
        tasks: AtomicUsize::new(0),
        called: Condvar::new(),
        left: Condvar::new(),
    }));
    // Whoever comes second takes the other one's; a crew without threads is not worth freeing.
    let stored = CREW.compare_exchange(found, new, Ordering::AcqRel, Ordering::Acquire);
    // SAFETY: as above, whichever of the two it is.
    unsafe { &*stored.map_or_else(|other| other, |_| new) }
}

impl Crew {
    /// The life of a helper.
    fn serve(&self) {
        let mut board = lock(&self.board);
        board.helpers += 1;
        self.left.notify_one();
        loop {
            match board.task {
                Some(task) if board.places > 0 => {
                    board.places -= 1;
                    board.inside += 1;
                    drop(board);
                    let done = catch_unwind(AssertUnwindSafe(task));
                    board = lock(&self.board);
                    board.panic = done.err().or(board.panic.take());
                    board.inside -= 1;
                    if board.inside == 0 {
                        self.left.notify_one();
                    }
                }
                _ => {
                    let seen = self.tasks.load(Ordering::Relaxed);
                    drop(board);
                    let begun = Instant::now();
                    while self.tasks.load(Ordering::Relaxed) == seen && begun.elapsed() < PATIENCE {
                        spin_loop();
                    }
                    board = lock(&self.board);
                    if self.tasks.load(Ordering::Relaxed) == seen {
                        board.parked += 1;
                        board = wait(&self.called, board);
                        board.parked -= 1;
                    }
                }
            }
        }
    }

    /// As many helpers as there are to be; fewer where threads cannot start. Each has arrived, and has taken all the memory
    /// it ever will.
    fn hire(&'static self, wanted: usize) {
        let mut board = lock(&self.board);
        while board.helpers < wanted {
            let there = board.helpers;
            drop(board);
            let name = thread::Builder::new().name("six_wheel".to_owned());
            if name.spawn(|| self.serve()).is_err() {
                return;
            }
            board = lock(&self.board);
            while board.helpers == there {
                board = wait(&self.left, board);
            }
        }
    }
}

/// Ends a task, and waits for those who are at it.
struct Over(&'static Crew);

impl Over {
    fn wait(&self) -> Option<Box<dyn Any + Send>> {
        let mut board = lock(&self.0.board);
        (board.task, board.places) = (None, 0);
        while board.inside > 0 {
            board = wait(&self.0.left, board);
        }
        board.panic.take()
    }
}

impl Drop for Over {
    fn drop(&mut self) {
        self.wait();
    }
}

/// Does a task here and, at the same time, in so many other threads at most; all are done with it on return. A task ends
/// when there is nothing left to do, so it does not matter how many join in, or when.
pub(crate) fn together(helpers: usize, task: &(dyn Fn() + Sync)) {
    let helpers = helpers.min(most());
    if helpers == 0 {
        return task();
    }
    let crew = crew();
    let _turn = match crew.turn.try_lock() {
        Ok(turn) => turn,
        Err(TryLockError::Poisoned(turn)) => turn.into_inner(),
        Err(TryLockError::WouldBlock) => return task(),
    };
    crew.hire(helpers);
    // SAFETY: the task is on the board until `over` takes it off, which it does on every way out of here, and then
    // waits for all who had taken it.
    let lasting = unsafe { std::mem::transmute::<&(dyn Fn() + Sync), Task>(task) };
    let over = Over(crew);
    let parked = {
        let mut board = lock(&crew.board);
        (board.task, board.places) = (Some(lasting), helpers);
        crew.tasks.fetch_add(1, Ordering::Relaxed);
        board.parked
    };
    for _ in 0..helpers.min(parked) {
        crew.called.notify_one();
    }
    task();
    if let Some(panic) = over.wait() {
        resume_unwind(panic);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counts to 1000 by whoever is there.
    fn count(helpers: usize) -> usize {
        let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
        together(helpers, &|| {
            while next.fetch_add(1, Ordering::Relaxed) < 1000 {
                done.fetch_add(1, Ordering::Relaxed);
            }
        });
        done.into_inner()
    }

    #[test]
    fn all_is_done_on_return_however_many_there_are() {
        for helpers in [0, 1, 3, 7, 2] {
            for _ in 0..200 {
                assert_eq!(count(helpers), 1000);
            }
        }
    }

    #[test]
    fn several_callers_and_callers_within_a_task_all_get_their_work_done() {
        thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| (0..100).for_each(|_| assert_eq!(count(3), 1000)));
            }
        });
        let inner = AtomicUsize::new(0);
        together(2, &|| {
            inner.fetch_add(count(2), Ordering::Relaxed);
        });
        assert_eq!(inner.into_inner() % 1000, 0);
    }

    #[test]
    fn a_panic_reaches_the_caller_and_the_crew_goes_on() {
        for _ in 0..20 {
            let caller = thread::current().id();
            let (begun, there) = (AtomicUsize::new(0), AtomicUsize::new(0));
            let panicked = catch_unwind(AssertUnwindSafe(|| {
                together(1, &|| {
                    begun.fetch_add(1, Ordering::Relaxed);
                    if thread::current().id() != caller {
                        there.fetch_add(1, Ordering::Relaxed);
                        resume_unwind(Box::new("a helper's"));
                    }
                });
            }));
            assert_eq!(panicked.is_err(), there.into_inner() > 0);
            assert_eq!(count(2), 1000);
        }
    }
}
