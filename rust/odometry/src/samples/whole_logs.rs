//! Whole logs with faulty rows, in the plane and in space: rows that cannot be used are left out and flagged, the rows
//! after them are used.
//!
//! Running totals contain the motion over a row left out, increments are added to the next row. After a change of the
//! zero of the clock or of a counter, rows are used from the second one on.

use crate::health::{Health, Refusal};
use crate::samples::recording::Sample;
use crate::samples::skipped_rows::SkippedRows;
use crate::settings::Settings;
use six_wheel_numerics::error::{Error, ErrorKind};
use six_wheel_numerics::threads::workers::{BETWEEN_CHECKS, IsInterrupted};

/// Updates row by row before blocks of rows are tried again.
const SINGLY: usize = 8;

/// Part of the state of a dead reckoning that [`LogOdometry`] reads and sets.
pub struct LogMemory<'a, R> {
    /// The sample at which the next step starts.
    pub reference: &'a mut R,
    /// The rows left out.
    pub skipped: &'a mut SkippedRows,
    /// Flags of the last sample.
    pub health: &'a mut Health,
}

/// Dead reckoning of whole logs.
pub trait LogOdometry: Clone {
    /// Readings at one instant.
    type Sample<'a>: Copy;
    /// Columns of a log.
    type Recording<'a>;
    /// Output of a log, one row per sample.
    type Track<'a>;
    /// The sample at which the next step starts.
    type Reference: Clone;
    /// Memory of updates by blocks of rows.
    type Blocks;

    /// The settings.
    fn log_settings(&self) -> &Settings;

    /// The memory of the last rows.
    fn log_memory(&mut self) -> LogMemory<'_, Self::Reference>;

    /// Number of rows.
    fn row_count(recording: &Self::Recording<'_>) -> usize;

    /// A row of a log.
    fn row<'a>(&self, recording: &'a Self::Recording<'_>, k: usize) -> Result<Self::Sample<'a>, Error>;

    /// The readings of wheels and steering joints.
    fn readings<'a>(sample: &'a Self::Sample<'_>) -> Sample<'a>;

    /// Updates the state by a sample. On failure nothing has changed.
    fn try_update(&mut self, sample: Self::Sample<'_>) -> Result<Health, Refusal>;

    /// Sets the stamp of the reference [s].
    fn set_reference_stamp(&mut self, stamp: f64);

    /// Makes the last row left out the reference.
    fn refer_to_skipped(&mut self);

    /// True if a log may fail, so that a copy of the state has to be restored. Fails if there is no memory for the
    /// copy.
    fn needs_copy(&self, strict: bool) -> Result<bool, Error>;

    /// Writes the last sample, with its flags, to a row.
    fn write(&self, k: usize, flags: Health, track: &mut Self::Track<'_>);

    /// Memory of updates by blocks of rows; None if rows have to be integrated one by one.
    fn blocks(&self) -> Option<Self::Blocks> {
        None
    }

    /// Updates the state by a block of rows from `first` on, and writes them; the last update was by the row before
    /// `first`. Returns their number.
    fn update_block(
        &mut self,
        _recording: &Self::Recording<'_>,
        _first: usize,
        _blocks: &mut Self::Blocks,
        _track: &mut Self::Track<'_>,
    ) -> usize {
        0
    }

    /// Updates the state by a sample, or leaves it out and returns the flag of the reason. Fails, with nothing changed,
    /// only if there is no memory for the history.
    #[inline]
    fn update_or_skip(&mut self, sample: Self::Sample<'_>) -> Result<Health, Error> {
        match self.try_update(sample) {
            Ok(health) => Ok(health),
            Err(refusal) if refusal.error.kind == ErrorKind::Memory => Err(refusal.error),
            Err(refusal) => Ok(self.skip_or_restart(sample, refusal.flag)),
        }
    }

    /// Leaves out a sample that was refused for the reason of this flag, unless it confirms a new zero of the clock or
    /// a counter.
    fn skip_or_restart(&mut self, sample: Self::Sample<'_>, flag: Health) -> Health {
        let readings = Self::readings(&sample);
        if self.log_memory().skipped.precedes(flag, readings.stamp)
            && let Some(health) = self.restart(sample, flag)
        {
            return health;
        }
        let kind = self.log_settings().readings;
        self.log_memory().skipped.leave_out(flag, &readings, kind);
        flag
    }

    /// Updates the state by a refused row that is consistent with the row left out before it: the clock or the counters
    /// have a new zero. None if it is not.
    fn restart(&mut self, sample: Self::Sample<'_>, flag: Health) -> Option<Health> {
        let LogMemory { reference, skipped, .. } = self.log_memory();
        let (before, skipped) = (reference.clone(), skipped.stamp);
        if flag == Health::BACKWARDS {
            // The clock was set back: the row left out is one step after the reference, and this row another.
            self.set_reference_stamp(2.0 * skipped - Self::readings(&sample).stamp);
        } else {
            self.refer_to_skipped();
        }
        let taken = self.try_update(sample);
        let LogMemory { reference, health, .. } = self.log_memory();
        match taken {
            Ok(flags) => {
                *health = flags | Health::RESTARTED;
                Some(*health)
            }
            Err(_) => {
                *reference = before;
                None
            }
        }
    }

    /// Updates the state by every row of a log. With `strict` the first row that cannot be used is an error; otherwise
    /// such rows are left out and flagged. On failure nothing has changed; after an interruption the rows before that
    /// of the error are integrated.
    fn run(
        &mut self,
        recording: Self::Recording<'_>,
        strict: bool,
        track: Self::Track<'_>,
        is_interrupted: IsInterrupted,
    ) -> Result<(), Error> {
        let before = self.needs_copy(strict)?.then(|| self.clone());
        let taken = self.update_all(&recording, strict, track, is_interrupted);
        if let (Err(error), Some(before)) = (&taken, before)
            && error.kind != ErrorKind::Interrupted
        {
            *self = before;
        }
        taken
    }

    /// Updates by the rows, in blocks where possible.
    fn update_all(
        &mut self,
        recording: &Self::Recording<'_>,
        strict: bool,
        mut track: Self::Track<'_>,
        is_interrupted: IsInterrupted,
    ) -> Result<(), Error> {
        let rows = Self::row_count(recording);
        let mut blocks = if rows > SINGLY { self.blocks() } else { None };
        let (mut k, mut singly, mut next_check) = (0, 1, BETWEEN_CHECKS);
        while k < rows {
            if k >= next_check {
                if is_interrupted() {
                    return Err(Error::interrupted().at_row(k));
                }
                next_check = k + BETWEEN_CHECKS;
            }
            if singly == 0
                && let Some(blocks) = &mut blocks
            {
                let count = self.update_block(recording, k, blocks, &mut track);
                k += count;
                singly = if count == 0 { SINGLY } else { 0 };
                continue;
            }
            let flags = self.update_row(recording, strict, k)?;
            self.write(k, flags, &mut track);
            // A block starts at the reference, which is the row before unless that was left out.
            singly = if flags.is_left_out() { 1 } else { singly.saturating_sub(1) };
            k += 1;
        }
        Ok(())
    }

    /// Update by one row.
    #[inline]
    fn update_row(&mut self, recording: &Self::Recording<'_>, strict: bool, k: usize) -> Result<Health, Error> {
        let taken = match self.row(recording, k) {
            Ok(sample) if strict => self.try_update(sample).map_err(|refusal| refusal.error),
            Ok(sample) => self.update_or_skip(sample),
            Err(error) if strict => Err(error),
            Err(_) => Ok(Health::NOT_FINITE),
        };
        taken.map_err(|error| match error.kind {
            ErrorKind::Memory => error,
            _ => error.at_row(k),
        })
    }
}
