//! Whole logs in space as they are, with the rules of those in the plane.

use super::Odometry3;
use super::sample::{Recording3, Sample3, attitude};
use six_wheel_numerics::error::{Error, ErrorKind};
use six_wheel_numerics::threads::workers::{BETWEEN_CHECKS, IsInterrupted};
use six_wheel_odometry::health::{Health, Refusal};

/// Output of a log, one row per sample.
#[derive(Debug)]
pub struct TrackRows3<'a> {
    /// x, y, z, roll, pitch, yaw.
    pub poses: &'a mut [[f64; 6]],
    /// Twists.
    pub twists: &'a mut [[f64; 6]],
    /// Covariances of the poses; None to do without.
    pub covariances: Option<&'a mut [[f64; 36]]>,
    /// Slip of the wheels along their rims and to their left [m/s], row after row; None to do without.
    pub slips: Option<&'a mut [[f64; 2]]>,
    /// Flags.
    pub health: &'a mut [u32],
}

impl Odometry3 {
    /// Takes in a sample if it can be; otherwise leaves it out and says why. The state goes on from the last good
    /// one either way.
    pub fn absorb(&mut self, sample: Sample3<'_>) -> Health {
        match self.take(sample) {
            Ok(health) => health,
            Err(refusal) => self.skip_row(sample, &refusal),
        }
    }

    fn skip_row(&mut self, sample: Sample3<'_>, refusal: &Refusal) -> Health {
        let flag = refusal.flag;
        if self.skipped.precedes(flag, sample.stamp)
            && let Some(health) = self.restart(sample, flag)
        {
            return health;
        }
        let readings = self.fixed.settings.common.readings;
        let plain = Self::plain(&sample);
        self.skipped.leave_out(flag, &plain, readings);
        flag
    }

    /// Starts over at the second row in succession that is consistent with the row left out before it only: its clock or its
    /// counters have a new zero.
    fn restart(&mut self, sample: Sample3<'_>, flag: Health) -> Option<Health> {
        let before = self.reference?;
        let mut moved = before;
        if flag == Health::BACKWARDS {
            // The clock was set back: the row left out and this one take a step each.
            moved.stamp = 2.0 * self.skipped.stamp - sample.stamp;
        } else {
            moved.stamp = self.skipped.stamp;
            moved.yaw_rate = None;
            moved.wheels[..sample.wheels.len()].copy_from_slice(&self.skipped.wheels);
            for (joint, reading) in self.skipped.steering.iter().enumerate() {
                moved.steering[joint] = *reading;
                let encoder = self.fixed.settings.common.steering_encoder(joint);
                moved.angles[joint] = encoder.first_angle(*reading);
            }
        }
        self.reference = Some(moved);
        match self.take(sample) {
            Ok(health) => {
                self.health = health | Health::RESTARTED;
                Some(self.health)
            }
            Err(_) => {
                self.reference = Some(before);
                None
            }
        }
    }

    /// Takes in every row of a log, from where the last one ended. With `strict` the first row that cannot be is an
    /// error; otherwise such rows are left out and flagged. On failure nothing has changed; interrupted, the rows before
    /// the one of the error are taken in.
    pub fn run(
        &mut self,
        recording: Recording3<'_>,
        strict: bool,
        track: TrackRows3<'_>,
        is_interrupted: IsInterrupted,
    ) -> Result<(), Error> {
        let before = strict.then(|| self.clone());
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
        recording: Recording3<'_>,
        strict: bool,
        track: TrackRows3<'_>,
        is_interrupted: IsInterrupted,
    ) -> Result<(), Error> {
        let wheels = self.fixed.chain.wheels().len();
        let TrackRows3 { poses, twists, mut covariances, mut slips, health } = track;
        for k in 0..recording.stamps.len() {
            if k % BETWEEN_CHECKS == BETWEEN_CHECKS - 1 && is_interrupted() {
                return Err(Error::interrupted().at_row(k));
            }
            let flags = match (self.row(&recording, k), strict) {
                (Ok(sample), true) => self.update(sample).map_err(|error| error.at_row(k))?,
                (Ok(sample), false) => self.absorb(sample),
                (Err(error), true) => return Err(error.at_row(k)),
                (Err(_), false) => Health::NOT_FINITE,
            };
            poses[k] = self.pose().numbers();
            twists[k] = self.twist();
            health[k] = flags.0;
            if let Some(covariances) = &mut covariances {
                covariances[k].copy_from_slice(self.covariance().as_flattened());
            }
            if let Some(slips) = &mut slips {
                let row = &mut slips[k * wheels..(k + 1) * wheels];
                match flags.is_left_out() {
                    true => row.fill([f64::NAN; 2]),
                    false => row.copy_from_slice(self.slip()),
                }
            }
        }
        Ok(())
    }

    /// A row of a log. On a map a row without an attitude goes by the map.
    fn row<'a>(&self, recording: &Recording3<'a>, k: usize) -> Result<Sample3<'a>, Error> {
        let chain = &self.fixed.chain;
        let part = |all: &'a [f64], width: usize| &all[k * width..(k + 1) * width];
        let attitude = match recording.attitudes {
            None => None,
            Some((all, width)) => {
                let numbers = part(all, width);
                let is_missing = self.fixed.ground.is_some() && numbers.iter().all(|one| one.is_nan());
                (!is_missing).then(|| attitude(numbers)).transpose()?
            }
        };
        let rate = recording.yaw_rates.map(|rates| rates[k]);
        Ok(Sample3 {
            steering: part(recording.steering, chain.steering().len()),
            wheels: part(recording.wheels, chain.wheels().len()),
            stamp: recording.stamps[k],
            joints: recording.joints.map(|joints| part(joints, chain.joints().len())),
            attitude,
            yaw_rate: rate.filter(|rate| !rate.is_nan()),
        })
    }
}
