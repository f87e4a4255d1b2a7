//! How a batch is worked through: with which instructions, and by how many threads.

use std::thread;

use super::level::Level;
use super::weave::BLOCK;
use crate::error::Error;

/// Rows under which no thread waits for another: starting one takes as long as some thousand rows.
const WORTH_A_THREAD: usize = 20_000;

/// Instructions and threads of a batch. Results depend on the instructions in their last digits, on the number
/// of threads not at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Workers {
    /// Which instructions.
    pub level: Level,
    /// How many threads at most.
    pub threads: usize,
    /// Whether a failure may leave the outputs half written, since nobody sees them then. Every row is
    /// otherwise checked before the first is written.
    pub fresh: bool,
}

impl Workers {
    /// One thread, row by row.
    pub const PLAIN: Self = Self {
        level: Level::Plain,
        threads: 1,
        fresh: false,
    };

    /// The same without instructions that the machine does not have.
    pub(crate) fn here(self) -> Self {
        if self.level.is_here() {
            return self;
        }
        Self {
            level: Level::Plain,
            ..self
        }
    }

    /// Rows that one thread takes at a time, out of so many.
    pub(crate) fn share(self, rows: usize) -> usize {
        if rows < WORTH_A_THREAD {
            return rows.max(1);
        }
        rows.div_ceil(self.threads.max(1)).next_multiple_of(BLOCK)
    }

    /// Logs that one thread takes at a time, out of so many of so many rows each.
    pub(crate) fn share_of_logs(self, logs: usize, count: usize) -> usize {
        if logs * count < WORTH_A_THREAD {
            return logs.max(1);
        }
        logs.div_ceil(self.threads.max(1))
            .max(1)
            .next_multiple_of(8)
    }
}

/// Does every job, the first one here and each of the others in a thread of its own. The failure of the
/// first job that fails.
pub(crate) fn each<J: Send>(
    jobs: impl Iterator<Item = J>,
    work: impl Fn(J) -> Result<(), Error> + Sync,
) -> Result<(), Error> {
    let mut jobs = jobs.into_iter();
    let Some(first) = jobs.next() else {
        return Ok(());
    };
    let Some(second) = jobs.next() else {
        return work(first);
    };
    let work = &work;
    thread::scope(|scope| {
        let others = [second].into_iter().chain(jobs);
        let started: Vec<_> = others.map(|job| scope.spawn(move || work(job))).collect();
        let mut result = work(first);
        for other in started {
            let theirs = match other.join() {
                Ok(theirs) => theirs,
                Err(panic) => std::panic::resume_unwind(panic),
            };
            result = result.and(theirs);
        }
        result
    })
}
