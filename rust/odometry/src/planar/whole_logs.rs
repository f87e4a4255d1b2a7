//! Whole logs in the plane.

use super::{Odometry, ReferenceSample};
use crate::health::{Health, Refusal};
use crate::log::{BlockScratch, LogBlock};
use crate::samples::recording::{Recording, Sample, TrackRows};
use crate::samples::whole_logs::{LogMemory, LogOdometry};
use crate::settings::Settings;
use six_wheel_numerics::error::Error;

impl LogOdometry for Odometry {
    type Sample<'a> = Sample<'a>;
    type Recording<'a> = Recording<'a>;
    type Track<'a> = TrackRows<'a>;
    type Reference = ReferenceSample;
    type Blocks = (BlockScratch, LogBlock);

    fn log_settings(&self) -> &Settings {
        &self.settings
    }

    fn log_memory(&mut self) -> LogMemory<'_, ReferenceSample> {
        LogMemory { reference: &mut self.reference, skipped: &mut self.skipped, health: &mut self.health }
    }

    fn row_count(recording: &Recording<'_>) -> usize {
        recording.stamps.len()
    }

    #[inline(always)]
    fn row<'a>(&self, recording: &'a Recording<'_>, k: usize) -> Result<Sample<'a>, Error> {
        Ok(recording.row(self.rover.wheels().len(), self.rover.steered().len(), k))
    }

    fn readings<'a>(sample: &'a Sample<'_>) -> Sample<'a> {
        *sample
    }

    #[inline]
    fn try_update(&mut self, sample: Sample<'_>) -> Result<Health, Refusal> {
        self.history.make_room(sample.stamp).map_err(|error| Refusal::new(Health::GOOD, error))?;
        match self.direct_step(&sample) {
            Some((slips, gyro_turn)) => Ok(self.commit_sample(&sample, Health::SLIP.when(slips), gyro_turn)),
            None => self.update_any(sample),
        }
    }

    fn set_reference_stamp(&mut self, stamp: f64) {
        self.reference.stamp = stamp;
        self.commanded = None;
    }

    fn refer_to_skipped(&mut self) {
        let skipped = self.skipped.clone();
        self.refer_to(&Sample {
            steering: &skipped.steering,
            wheels: &skipped.wheels,
            stamp: skipped.stamp,
            yaw: None,
            yaw_rate: None,
        });
    }

    fn needs_copy(&self, strict: bool) -> Result<bool, Error> {
        self.history.needs_copy(strict)
    }

    #[inline]
    fn write(&self, k: usize, flags: Health, track: &mut TrackRows<'_>) {
        self.write_row(k, track);
        track.twists[k] = self.twist().into();
        track.health[k] = flags.0;
        let wheels = self.residual.len();
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
    }

    #[inline(always)]
    fn blocks(&self) -> Option<(BlockScratch, LogBlock)> {
        Some((self.block_scratch()?, LogBlock::default()))
    }

    fn update_block(
        &mut self,
        recording: &Recording<'_>,
        first: usize,
        (scratch, block): &mut (BlockScratch, LogBlock),
        track: &mut TrackRows<'_>,
    ) -> usize {
        self.update_rows(recording, first, scratch, block, track)
    }
}

impl Odometry {
    /// Writes pose and covariance to a row.
    pub(crate) fn write_row(&self, k: usize, track: &mut TrackRows<'_>) {
        track.poses[k] = self.pose().into();
        if let Some(covariances) = &mut track.covariances {
            covariances[k].copy_from_slice(self.covariance().as_flattened());
        }
    }
}
