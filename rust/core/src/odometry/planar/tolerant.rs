//! Whole logs as they are: rows that cannot be are left out and flagged, the rows after them are not lost.
//!
//! Running totals make good for a row left out by themselves, increments are owed to the next row. A clock or a
//! counter that goes on from another value for good is followed from the second such row on.

use super::{Health, Odometry, Readings, Refusal, Sample};
use crate::batch::one_row::step::log::Block;
use crate::error::{Error, ErrorKind};

/// Rows that are taken in one by one before registers of rows are tried again.
const SINGLY: usize = 8;

/// What is remembered of rows that were left out, until a row is taken in again.
///
/// - `flag` is [`Health::BACKWARDS`] or [`Health::JUMP`] if a row was left out for that since the last good one, and
///   then `stamp`, `wheels` and `steering` are the readings of the last such row; otherwise it is [`Health::GOOD`] and
///   they mean nothing.
/// - `owed` is not zero only where the readings are increments: the sum of those in rows left out because of their
///   stamps, which did happen and belong to the next step. In running totals the next row contains them.
/// - Both are cleared by every row taken in ([`Self::clear`]); `marked` says that there is anything to clear, so that a
///   good row after a good row pays one comparison.
#[derive(Clone, Debug)]
pub(crate) struct Suspect {
    pub(super) flag: Health,
    /// [s]
    pub(super) stamp: f64,
    /// As the encoders count.
    pub(super) wheels: Vec<f64>,
    /// As the encoders count.
    pub(super) steering: Vec<f64>,
    /// As the encoders count, one per wheel.
    owed: Vec<f64>,
    marked: bool,
}

impl Suspect {
    pub fn new(wheels: usize, joints: usize) -> Self {
        Self {
            flag: Health::GOOD,
            stamp: 0.0,
            wheels: vec![0.0; wheels],
            steering: vec![0.0; joints],
            owed: vec![0.0; wheels],
            marked: false,
        }
    }

    #[inline]
    pub fn clear(&mut self) {
        if self.marked {
            self.marked = false;
            self.flag = Health::GOOD;
            self.owed.fill(0.0);
        }
    }

    /// Increment of a wheel in the rows left out since the last good one, as its encoder counts.
    pub fn owed(&self, wheel: usize) -> f64 {
        self.owed[wheel]
    }

    /// Whether a row at odds with the good ones may go on from the one that was left out before it for the same reason.
    pub(super) fn precedes(&self, flag: Health, stamp: f64) -> bool {
        (flag == Health::BACKWARDS || flag == Health::JUMP) && self.flag == flag && stamp > self.stamp
    }

    /// Notes a row that is left out: what it read, and the increments that did happen.
    pub(super) fn leave_out(&mut self, flag: Health, sample: &Sample<'_>, readings: Readings) {
        if flag == Health::BACKWARDS || flag == Health::JUMP {
            self.marked = true;
            self.flag = flag;
            self.stamp = sample.stamp;
            self.wheels.copy_from_slice(sample.wheels);
            self.steering.copy_from_slice(sample.steering);
        }
        if readings == Readings::Increments && (flag == Health::BACKWARDS || flag == Health::DUPLICATE) {
            self.marked = true;
            for (owed, increment) in self.owed.iter_mut().zip(sample.wheels) {
                *owed += increment;
            }
        }
    }
}

/// Columns of a log: one row per sample.
#[derive(Clone, Copy, Debug)]
pub struct Recording<'a> {
    /// Readings of the steering joints, row after row.
    pub steering: &'a [f64],
    /// Readings of the wheels, row after row.
    pub wheels: &'a [f64],
    /// When [s].
    pub stamps: &'a [f64],
    /// Absolute yaw [rad]; NaN where there was none.
    pub yaws: Option<&'a [f64]>,
    /// Yaw rates [rad/s]; NaN where there was none.
    pub yaw_rates: Option<&'a [f64]>,
}

impl<'a> Recording<'a> {
    pub(super) fn row(&self, wheels: usize, joints: usize, k: usize) -> Sample<'a> {
        let at = |values: Option<&'a [f64]>| values.map(|values| values[k]).filter(|value| !value.is_nan());
        Sample {
            steering: &self.steering[k * joints..(k + 1) * joints],
            wheels: &self.wheels[k * wheels..(k + 1) * wheels],
            stamp: self.stamps[k],
            yaw: at(self.yaws),
            yaw_rate: at(self.yaw_rates),
        }
    }

    /// Where the rows from `first` on end of which none but the last one tells a yaw, `most` of them at most.
    pub(super) fn until_yaw(&self, first: usize, most: usize) -> usize {
        let end = self.stamps.len().min(first + most);
        let told = self.yaws.and_then(|yaws| {
            let found = yaws[first..end].iter().position(|yaw| !yaw.is_nan());
            found.map(|k| first + k)
        });
        told.map_or(end, |row| {
            let is_usual = self.yaws.is_some_and(|yaws| yaws[row].is_finite());
            row + usize::from(is_usual)
        })
    }
}

/// Where the results of a log go, one row per sample.
#[derive(Debug)]
pub struct TrackRows<'a> {
    /// Poses.
    pub poses: &'a mut [[f64; 3]],
    /// Twists.
    pub twists: &'a mut [[f64; 3]],
    /// Covariances of the poses; None to do without.
    pub covariances: Option<&'a mut [[f64; 9]]>,
    /// Residuals of the wheels [m/s], row after row; None to do without.
    pub residuals: Option<&'a mut [f64]>,
    /// Say of the wheels, row after row; None to do without.
    pub weights: Option<&'a mut [f64]>,
    /// Flags.
    pub health: &'a mut [u32],
}

impl Odometry {
    /// Takes in a sample if it can be; otherwise leaves it out and says why. The state goes on from the last good
    /// one either way. Fails, with nothing changed, only where there is no memory for what is kept.
    pub fn absorb(&mut self, sample: Sample<'_>) -> Result<Health, Error> {
        match self.take(sample) {
            Ok(health) => Ok(health),
            Err(refusal) if refusal.error.kind == ErrorKind::Memory => Err(refusal.error),
            Err(refusal) => Ok(self.doubt(sample, &refusal)),
        }
    }

    fn doubt(&mut self, sample: Sample<'_>, refusal: &Refusal) -> Health {
        let flag = refusal.flag;
        if self.suspect.precedes(flag, sample.stamp)
            && let Some(health) = self.restart(sample, flag)
        {
            return health;
        }
        let readings = self.settings.readings;
        self.suspect.leave_out(flag, &sample, readings);
        flag
    }

    /// The second row in succession that only fits the one left out before it: what it counts from moved for good.
    fn restart(&mut self, sample: Sample<'_>, flag: Health) -> Option<Health> {
        let before = self.reference.clone();
        if flag == Health::BACKWARDS {
            // The clock was set back: the row left out and this one take a step each.
            self.reference.stamp = 2.0 * self.suspect.stamp - sample.stamp;
            self.history.commanded = None;
        } else {
            let suspect = self.suspect.clone();
            self.refer_to(&Sample {
                steering: &suspect.steering,
                wheels: &suspect.wheels,
                stamp: suspect.stamp,
                yaw: None,
                yaw_rate: None,
            });
        }
        match self.take(sample) {
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
    /// error; otherwise such rows are left out and flagged. On failure nothing has changed.
    pub fn run(&mut self, recording: Recording<'_>, strict: bool, track: TrackRows<'_>) -> Result<(), Error> {
        let may_fail = strict || self.history.may_grow();
        let before = may_fail.then(|| self.history.check_copy()).transpose()?;
        let before = before.map(|()| self.clone());
        let taken = self.take_all(recording, strict, track);
        if let (Err(_), Some(before)) = (&taken, before) {
            *self = before;
        }
        taken
    }

    fn take_all(&mut self, recording: Recording<'_>, strict: bool, mut track: TrackRows<'_>) -> Result<(), Error> {
        let rows = recording.stamps.len();
        let mut room = (rows > SINGLY).then(|| self.room()).flatten();
        let mut block = Block::new();
        let (mut k, mut singly) = (0, 1);
        while k < rows {
            if singly == 0
                && let Some(room) = &mut room
            {
                let taken = self.stride(&recording, k, room, &mut block, &mut track);
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
        self.tell(k, track);
        track.twists[k] = self.twist().into();
        track.health[k] = flags.0;
        let of_wheels = [(&mut track.residuals, &self.residual), (&mut track.weights, &self.work.weights)];
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

    /// Where the rover is, into a row.
    pub(super) fn tell(&self, k: usize, track: &mut TrackRows<'_>) {
        track.poses[k] = self.pose().into();
        if let Some(covariances) = &mut track.covariances {
            covariances[k].copy_from_slice(self.covariance().as_flattened());
        }
    }
}
