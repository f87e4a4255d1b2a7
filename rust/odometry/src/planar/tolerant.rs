//! Whole logs as they are: rows that cannot be are left out and flagged, the rows after them are not lost.
//!
//! Running totals make good for a row left out by themselves, increments are pending to the next row. A clock or a
//! counter that goes on from another value for good is followed from the second such row on.

use super::Odometry;
use crate::health::{Health, Refusal};
use crate::log::LogBlock;
use crate::samples::recording::{Recording, Sample, TrackRows};
use six_wheel_numerics::error::{Error, ErrorKind};
use six_wheel_numerics::threads::workers::{BETWEEN_CHECKS, IsInterrupted};

/// Rows that are taken in one by one before registers of rows are tried again.
const SINGLY: usize = 8;

impl Odometry {
    /// Takes in a sample that is acceptable; otherwise leaves it out and returns the flag of the reason. The state goes on
    /// from the last good one either way. Fails, with nothing changed, only where there is no memory for the history.
    pub fn absorb(&mut self, sample: Sample<'_>) -> Result<Health, Error> {
        match self.try_update(sample) {
            Ok(health) => Ok(health),
            Err(refusal) if refusal.error.kind == ErrorKind::Memory => Err(refusal.error),
            Err(refusal) => Ok(self.skip_or_restart(sample, &refusal)),
        }
    }

    fn skip_or_restart(&mut self, sample: Sample<'_>, refusal: &Refusal) -> Health {
        let flag = refusal.flag;
        if self.skipped.precedes(flag, sample.stamp)
            && let Some(health) = self.restart(sample, flag)
        {
            return health;
        }
        let readings = self.settings.readings;
        self.skipped.leave_out(flag, &sample, readings);
        flag
    }

    /// Starts over at the second row in succession that is consistent with the row left out before it only: its clock or its
    /// counters have a new zero.
    fn restart(&mut self, sample: Sample<'_>, flag: Health) -> Option<Health> {
        let before = self.reference.clone();
        if flag == Health::BACKWARDS {
            // The clock was set back: the row left out and this one take a step each.
            self.reference.stamp = 2.0 * self.skipped.stamp - sample.stamp;
            self.commanded = None;
        } else {
            let skipped = self.skipped.clone();
            self.refer_to(&Sample {
                steering: &skipped.steering,
                wheels: &skipped.wheels,
                stamp: skipped.stamp,
                yaw: None,
                yaw_rate: None,
            });
        }
        match self.try_update(sample) {
            Ok(health) => {
                self.health = health | Health::RESTARTED;
                Some(self.health)
            }
            Err(_) => {
                self.reference = before;
                None
            }
        }
    }

    /// Takes in every row of a log, from where the last one ended. With `strict` the first row that cannot be is an
    /// error; otherwise such rows are left out and flagged. On failure nothing has changed; interrupted, the rows before
    /// the one of the error are taken in.
    pub fn run(
        &mut self,
        recording: Recording<'_>,
        strict: bool,
        track: TrackRows<'_>,
        is_interrupted: IsInterrupted,
    ) -> Result<(), Error> {
        let may_fail = strict || self.history.may_grow();
        let before = may_fail.then(|| self.history.check_copy()).transpose()?;
        let before = before.map(|()| self.clone());
        let taken = self.take_all(recording, strict, track, is_interrupted);
        if let (Err(error), Some(before)) = (&taken, before)
            && error.kind != ErrorKind::Interrupted
        {
            *self = before;
        }
        taken
    }

    fn take_all(
        &mut self,
        recording: Recording<'_>,
        strict: bool,
        mut track: TrackRows<'_>,
        is_interrupted: IsInterrupted,
    ) -> Result<(), Error> {
        let rows = recording.stamps.len();
        let mut room = (rows > SINGLY).then(|| self.block_scratch()).flatten();
        let mut block = LogBlock::new();
        let (mut k, mut singly, mut next_check) = (0, 1, BETWEEN_CHECKS);
        while k < rows {
            if k >= next_check {
                if is_interrupted() {
                    return Err(Error::interrupted().at_row(k));
                }
                next_check = k + BETWEEN_CHECKS;
            }
            if singly == 0
                && let Some(room) = &mut room
            {
                let taken = self.update_rows(&recording, k, room, &mut block, &mut track);
                k += taken;
                singly = if taken == 0 { SINGLY } else { 0 };
                continue;
            }
            let flags = self.take_one(&recording, strict, k, &mut track)?;
            // The row before has to be the one from which the next one counts.
            singly = if flags.is_left_out() { 1 } else { singly.saturating_sub(1) };
            k += 1;
        }
        Ok(())
    }

    fn take_one(
        &mut self,
        recording: &Recording<'_>,
        strict: bool,
        k: usize,
        track: &mut TrackRows<'_>,
    ) -> Result<Health, Error> {
        let (wheels, joints) = (self.rover.wheels().len(), self.rover.steered().len());
        let sample = recording.row(wheels, joints, k);
        let taken = if strict { self.update(sample) } else { self.absorb(sample) };
        let flags = taken.map_err(|error| match error.kind {
            ErrorKind::Memory => error,
            _ => error.at_row(k),
        })?;
        self.write_row(k, track);
        track.twists[k] = self.twist().into();
        track.health[k] = flags.0;
        let of_wheels = [(&mut track.residuals, &self.residual), (&mut track.weights, &self.work.fit.weights)];
        for (rows, values) in of_wheels {
            if let Some(rows) = rows {
                let row = &mut rows[k * wheels..(k + 1) * wheels];
                if flags.is_left_out() {
                    row.fill(f64::NAN);
                } else {
                    row.copy_from_slice(values);
                }
            }
        }
        Ok(flags)
    }

    /// Writes pose and covariance to a row.
    pub(crate) fn write_row(&self, k: usize, track: &mut TrackRows<'_>) {
        track.poses[k] = self.pose().into();
        if let Some(covariances) = &mut track.covariances {
            covariances[k].copy_from_slice(self.covariance().as_flattened());
        }
    }
}
