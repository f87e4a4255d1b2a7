//! Odometry of whole logs in space.

use super::Odometry3;
use super::sample::{Read, Recording3, Sample3, attitude};
use six_wheel_numerics::error::Error;
use six_wheel_odometry::health::{Health, Refusal};
use six_wheel_odometry::recording::Sample;
use six_wheel_odometry::settings::Settings;
use six_wheel_odometry::whole_logs::{LogMemory, LogOdometry};

/// Output of a log, one row per sample.
#[derive(Debug)]
pub struct TrackRows3<'a> {
    /// x, y, z [m], roll, pitch, yaw [rad].
    pub poses: &'a mut [[f64; 6]],
    /// Twists in axes of the body [m/s, rad/s].
    pub twists: &'a mut [[f64; 6]],
    /// Covariances of the poses; None if they are not needed.
    pub covariances: Option<&'a mut [[f64; 36]]>,
    /// Slip of the wheels along their rims and to their left [m/s], row after row; None if it is not needed.
    pub slips: Option<&'a mut [[f64; 2]]>,
    /// Flags of [`Health`].
    pub health: &'a mut [u32],
}

impl LogOdometry for Odometry3 {
    type Sample<'a> = Sample3<'a>;
    type Recording<'a> = Recording3<'a>;
    type Track<'a> = TrackRows3<'a>;
    type Reference = Option<Read>;
    type Blocks = ();

    fn log_settings(&self) -> &Settings {
        &self.fixed.settings.common
    }

    fn log_memory(&mut self) -> LogMemory<'_, Option<Read>> {
        LogMemory { reference: &mut self.reference, skipped: &mut self.skipped, health: &mut self.health }
    }

    fn row_count(recording: &Recording3<'_>) -> usize {
        recording.stamps.len()
    }

    /// A row of a log. On a map an attitude of NaN is none, and the tilt follows from the map.
    fn row<'a>(&self, recording: &'a Recording3<'_>, k: usize) -> Result<Sample3<'a>, Error> {
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

    fn readings<'a>(sample: &'a Sample3<'_>) -> Sample<'a> {
        let Sample3 { steering, wheels, stamp, yaw_rate, .. } = *sample;
        Sample { steering, wheels, stamp, yaw: None, yaw_rate }
    }

    fn try_update(&mut self, sample: Sample3<'_>) -> Result<Health, Refusal> {
        self.update_or_refuse(sample)
    }

    fn set_reference_stamp(&mut self, stamp: f64) {
        if let Some(reference) = &mut self.reference {
            reference.stamp = stamp;
        }
    }

    fn refer_to_skipped(&mut self) {
        let Some(reference) = &mut self.reference else { return };
        let (skipped, settings) = (&self.skipped, &self.fixed.settings.common);
        reference.stamp = skipped.stamp;
        reference.yaw_rate = None;
        reference.wheels[..skipped.wheels.len()].copy_from_slice(&skipped.wheels);
        reference.steering[..skipped.steering.len()].copy_from_slice(&skipped.steering);
        settings.first_angles(&skipped.steering, &mut reference.angles);
    }

    fn needs_copy(&self, strict: bool) -> Result<bool, Error> {
        self.history.needs_copy(strict)
    }

    fn write(&self, k: usize, flags: Health, track: &mut TrackRows3<'_>) {
        track.poses[k] = self.pose().numbers();
        track.twists[k] = self.twist();
        track.health[k] = flags.0;
        if let Some(covariances) = &mut track.covariances {
            covariances[k].copy_from_slice(self.covariance().as_flattened());
        }
        if let Some(slips) = &mut track.slips {
            let wheels = self.slip().len();
            let row = &mut slips[k * wheels..(k + 1) * wheels];
            match flags.is_left_out() {
                true => row.fill([f64::NAN; 2]),
                false => row.copy_from_slice(self.slip()),
            }
        }
    }
}
