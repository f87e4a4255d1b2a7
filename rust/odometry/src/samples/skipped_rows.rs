//! Record of the rows of a log that were left out.

use crate::health::Health;
use crate::samples::recording::Sample;
use crate::settings::Readings;

/// Record of rows that were left out since the last update.
///
/// - `flag` is [`Health::BACKWARDS`] or [`Health::JUMP`] if a row was left out for that since the last update, and
///   then `stamp`, `wheels` and `steering` are the readings of the last such row; otherwise it is [`Health::GOOD`] and
///   they are undefined.
/// - `pending` is not zero only if the readings are increments: the sum of those in rows left out because of their
///   stamps, which belong to the next step. In running totals the next row contains them.
/// - Every update clears both ([`Self::clear`]); `marked` is true if they are to be cleared, so that an update after an
///   update takes one comparison.
#[derive(Clone, Debug)]
pub struct SkippedRows {
    /// The reason for which the last row was left out.
    pub flag: Health,
    /// Stamp of the last row left out [s].
    pub stamp: f64,
    /// Readings of the wheels, in units of their encoders.
    pub wheels: Vec<f64>,
    /// Readings of the steering joints, in units of their encoders.
    pub steering: Vec<f64>,
    /// Pending increment of every wheel, in units of its encoder.
    pending: Vec<f64>,
    marked: bool,
}

impl SkippedRows {
    /// No row was left out yet.
    pub fn new(wheels: usize, joints: usize) -> Self {
        Self {
            flag: Health::GOOD,
            stamp: 0.0,
            wheels: vec![0.0; wheels],
            steering: vec![0.0; joints],
            pending: vec![0.0; wheels],
            marked: false,
        }
    }

    /// Clears the record after an update.
    #[inline]
    pub fn clear(&mut self) {
        if self.marked {
            self.marked = false;
            self.flag = Health::GOOD;
            self.pending.fill(0.0);
        }
    }

    /// Increment of a wheel in the rows left out since the last update, as its encoder counts.
    #[inline]
    pub fn pending_increment(&self, wheel: usize) -> f64 {
        self.pending[wheel]
    }

    /// True if a refused row may be consistent with the row that was left out before it for the same reason.
    #[inline]
    pub fn precedes(&self, flag: Health, stamp: f64) -> bool {
        (flag == Health::BACKWARDS || flag == Health::JUMP) && self.flag == flag && stamp > self.stamp
    }

    /// Records a row that is left out: its readings, and its increments.
    pub fn leave_out(&mut self, flag: Health, sample: &Sample<'_>, readings: Readings) {
        if flag == Health::BACKWARDS || flag == Health::JUMP {
            self.marked = true;
            self.flag = flag;
            self.stamp = sample.stamp;
            self.wheels.copy_from_slice(sample.wheels);
            self.steering.copy_from_slice(sample.steering);
        }
        if readings == Readings::Increments && (flag == Health::BACKWARDS || flag == Health::DUPLICATE) {
            self.marked = true;
            for (pending, increment) in self.pending.iter_mut().zip(sample.wheels) {
                *pending += increment;
            }
        }
    }
}
