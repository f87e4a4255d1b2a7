//! Execution of a batch: its instruction set and its number of threads.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread::{self, ThreadId};

use super::pool;
use crate::columns::BLOCK;
use crate::error::Error;
use crate::simd::level::Level;

/// Rows below which a batch stays in one thread: waking another takes as long as some hundred to some thousand rows.
const WORTH_A_THREAD: usize = 20_000;

/// Shares of a batch per thread: a thread that begins late or is held up takes fewer of them.
const SHARES: usize = 4;

/// Rows of a share at least, so that taking it from the queue takes no time beside computing them.
const LEAST: usize = 2048;

/// Rows of a share at most, so that an interruption is noticed in time.
const MOST: usize = 16_384;

/// Rows of a log, or steps, between two calls of [`IsInterrupted`]: some ten milliseconds at the most.
pub const BETWEEN_CHECKS: usize = 512;

/// Called by the thread of the caller between parts of a long call: true ends the call with [`Error::interrupted`].
pub type IsInterrupted = fn() -> bool;

/// [`IsInterrupted`] of calls that cannot be interrupted.
pub fn never() -> bool {
    false
}

/// Interruption of one call: the thread of the caller asks, and every thread ends by its answer.
#[derive(Debug)]
pub struct Interruption {
    is_interrupted: IsInterrupted,
    caller: ThreadId,
    ended: AtomicBool,
}

impl Interruption {
    fn new(is_interrupted: IsInterrupted) -> Self {
        Self { is_interrupted, caller: thread::current().id(), ended: AtomicBool::new(false) }
    }

    /// Fails once the call is interrupted. Jobs that take long call it between their parts.
    pub fn check(&self) -> Result<(), Error> {
        if thread::current().id() == self.caller && (self.is_interrupted)() {
            self.ended.store(true, Ordering::Relaxed);
        }
        if self.ended.load(Ordering::Relaxed) { Err(Error::interrupted()) } else { Ok(()) }
    }
}

/// Instructions and threads of a batch. Results depend on the instructions in their last digits, on the number
/// of threads not at all.
#[derive(Clone, Copy, Debug)]
pub struct Workers {
    /// Instruction set.
    pub level: Level,
    /// Largest number of threads.
    pub threads: usize,
    /// True if the outputs are allocated by the call, so that a failure may leave them half written. Otherwise every
    /// row is checked before the first is written.
    pub fresh: bool,
    /// Called between shares.
    pub is_interrupted: IsInterrupted,
}

impl Workers {
    /// One thread, row by row.
    pub const PLAIN: Self = Self { level: Level::Scalar, threads: 1, fresh: false, is_interrupted: never };

    /// These workers; at the scalar level if the machine does not have the instructions of their level.
    #[inline]
    pub fn here(self) -> Self {
        if self.level.is_here() {
            return self;
        }
        Self { level: Level::Scalar, ..self }
    }

    fn thread_count(self) -> usize {
        self.threads.clamp(1, MOST_HELPERS + 1)
    }

    /// Rows that one thread takes at a time, of all `rows`.
    pub fn share(self, rows: usize) -> usize {
        if rows < WORTH_A_THREAD {
            return rows.max(1);
        }
        let share = rows.div_ceil(self.thread_count() * SHARES).clamp(LEAST, MOST);
        share.next_multiple_of(BLOCK)
    }

    /// Logs that one thread takes at a time, out of so many of so many rows each.
    pub fn share_of_logs(self, logs: usize, count: usize) -> usize {
        if logs * count < WORTH_A_THREAD {
            return logs.max(1);
        }
        let share = logs.div_ceil(self.thread_count() * SHARES).min(MOST.div_ceil(count.max(1)));
        share.max(LEAST.div_ceil(count.max(1))).next_multiple_of(8)
    }

    /// Computes `count` rows: `row` gets the index `k`, and of every output of width `w` the `w` elements from `k w`
    /// on. Fails with the error of the first row that fails.
    pub fn rows<T: Send, const N: usize>(
        self,
        count: usize,
        outputs: [(&mut [T], usize); N],
        row: impl Fn(usize, [&mut [T]; N]) -> Result<(), Error> + Sync,
    ) -> Result<(), Error> {
        let share = self.share(count);
        let mut rest = outputs;
        let jobs = (0..count).step_by(share).map(|first| {
            let end = count.min(first + share);
            let parts = rest.each_mut().map(|(values, width)| {
                let (part, after) = std::mem::take(values).split_at_mut((end - first) * *width);
                *values = after;
                (part, *width)
            });
            (first..end, parts)
        });
        self.for_each(jobs, |(places, mut parts)| {
            for (k, place) in places.enumerate() {
                let outputs = parts.each_mut();
                row(place, outputs.map(|(part, width)| &mut part[k * *width..][..*width]))?;
            }
            Ok(())
        })
    }

    /// Does every job, with up to `threads` threads.
    pub fn for_each<J: Send>(
        self,
        jobs: impl Iterator<Item = J> + Send,
        work: impl Fn(J) -> Result<(), Error> + Sync,
    ) -> Result<(), Error> {
        self.for_each_long(jobs, |job, _| work(job))
    }

    /// [`Self::for_each`] of jobs that may take long and end with the interruption of the call.
    pub fn for_each_long<J: Send>(
        self,
        jobs: impl Iterator<Item = J> + Send,
        work: impl Fn(J, &Interruption) -> Result<(), Error> + Sync,
    ) -> Result<(), Error> {
        let jobs_at_most = jobs.size_hint().1.unwrap_or(usize::MAX);
        share_jobs(self.thread_count().min(jobs_at_most), jobs, work, self.is_interrupted)
    }
}

/// Threads of one batch beside the calling one, at most: more than speed up these kernels on any machine, and few
/// enough that their stacks need little memory.
const MOST_HELPERS: usize = 63;

/// Does every job by up to `threads` threads, this one among them; each takes the next job of the queue when it has
/// done its last one. Returns the failure of the first job that fails, or the interruption.
fn share_jobs<J: Send>(
    threads: usize,
    jobs: impl Iterator<Item = J> + Send,
    work: impl Fn(J, &Interruption) -> Result<(), Error> + Sync,
    is_interrupted: IsInterrupted,
) -> Result<(), Error> {
    let interruption = Interruption::new(is_interrupted);
    if threads <= 1 {
        for (number, job) in jobs.enumerate() {
            if number > 0 {
                interruption.check()?;
            }
            work(job, &interruption)?;
        }
        return Ok(());
    }
    let queue = Mutex::new(jobs.enumerate());
    let failed: Mutex<Option<(usize, Error)>> = Mutex::new(None);
    let work_through = || {
        loop {
            let next = queue.lock().unwrap_or_else(PoisonError::into_inner).next();
            let Some((number, job)) = next else { return };
            if number > 0 && interruption.check().is_err() {
                return;
            }
            if let Err(error) = work(job, &interruption) {
                let mut failed = failed.lock().unwrap_or_else(PoisonError::into_inner);
                if failed.as_ref().is_none_or(|(first, _)| number < *first) {
                    *failed = Some((number, error));
                }
            }
        }
    };
    pool::run(threads - 1, &work_through);
    if interruption.ended.into_inner() {
        return Err(Error::interrupted());
    }
    let failed = failed.into_inner().unwrap_or_else(PoisonError::into_inner);
    failed.map_or(Ok(()), |(_, error)| Err(error))
}
