//! Whole logs in the plane: rows whose readings need no check are integrated a register of samples at a time.

use std::ops::Range;

use super::{Odometry, ReferenceSample};
use crate::health::{Health, Refusal};
use crate::log::{BlockScratch, LogBlock, LogIntegrator, Rows};
use crate::samples::increments::may_start_over;
use crate::samples::recording::{Recording, Sample, TrackRows};
use crate::samples::whole_logs::{LogMemory, LogOdometry};
use crate::settings::{Settings, gyroscope};
use six_wheel_numerics::columns::BLOCK;
use six_wheel_numerics::error::Error;

/// The first of these rows in which a counter may have started over; their end where there is none.
fn first_start_over(readings: &[f64], wheels: usize, rows: Range<usize>) -> usize {
    let before = &readings[(rows.start - 1) * wheels..(rows.end - 1) * wheels];
    let after = &readings[rows.start * wheels..rows.end * wheels];
    let found = before.iter().zip(after).position(|(before, after)| may_start_over(*before, *after));
    found.map_or(rows.end, |place| rows.start + place / wheels)
}

/// Number of rows from which on registers of samples are faster than one sample at a time.
const FEW: usize = 4;

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

    #[inline]
    fn blocks(&self) -> Option<(BlockScratch, LogBlock)> {
        let constants = &self.work.constants;
        let can_have_blocks = constants.is_constant && constants.is_direct && !self.settings.inflate;
        let scratch = (can_have_blocks && self.settings.lag == 0.0).then(|| BlockScratch::new(constants)).flatten()?;
        Some((scratch, LogBlock::default()))
    }

    /// By registers of samples, until the first row whose readings have to be checked. The results are those of updates
    /// row by row.
    fn update_block(
        &mut self,
        recording: &Recording<'_>,
        first: usize,
        (scratch, block): &mut (BlockScratch, LogBlock),
        track: &mut TrackRows<'_>,
    ) -> usize {
        let (wheels, joints) = (self.rover.wheels().len(), self.rover.steered().len());
        let mut end = recording.until_yaw(first, BLOCK);
        let uncertainty = &self.state.uncertainty;
        let has_gyroscope =
            recording.yaw_rates.is_some() || uncertainty.bias.is_some() || uncertainty.has_gyroscope_error();
        if has_gyroscope {
            end = self.load_gyroscope_rows(recording, first..end, block);
        }
        end = first_start_over(recording.wheels, wheels, first..end);
        if end - first < FEW {
            return 0;
        }
        let rows = Rows {
            wheels: &recording.wheels[(first - 1) * wheels..end * wheels],
            steering: &recording.steering[(first - 1) * joints..end * joints],
            stamps: &recording.stamps[first - 1..end],
            settings: &self.settings,
            has_gyroscope,
        };
        let integrator = LogIntegrator {
            constants: &self.work.constants,
            rows,
            angles: &self.reference.angles,
            scratch,
            block,
            state: &mut self.state,
            noise: &mut self.work.noise,
        };
        let count = integrator.integrate();
        let Some(last) = count.checked_sub(1) else {
            return 0;
        };
        let done = first..first + count;
        block.write(scratch, done.clone(), wheels, track);
        block.last_residual(scratch, last, &mut self.residual);
        self.angles.copy_from_slice(scratch.angles(last));
        self.reference.stamp = recording.stamps[done.end - 2];
        self.write_flags(done.clone(), block, track);
        let sample = recording.row(wheels, joints, done.end - 1);
        self.commit_sample(&sample, Health::SLIP.when(block.slips.0[last] != 0.0), None);
        if sample.yaw.is_some() {
            // The yaw has corrected the pose after the block was written.
            self.write_row(done.end - 1, track);
        }
        count
    }
}

impl Odometry {
    /// Writes flags and weights of integrated rows.
    fn write_flags(&self, done: Range<usize>, block: &LogBlock, track: &mut TrackRows<'_>) {
        let (gap, wheels) = (self.settings.max_gap, self.rover.wheels().len());
        for (k, health) in track.health[done.clone()].iter_mut().enumerate() {
            let is_gap = gap.is_some_and(|gap| block.dt.0[k] > gap);
            let slips = block.slips.0[k] != 0.0;
            *health = (Health::SLIP.when(slips) | Health::GAP.when(is_gap)).0;
        }
        if let Some(weights) = &mut track.weights {
            for row in weights[done.start * wheels..done.end * wheels].chunks_exact_mut(wheels) {
                row.copy_from_slice(&self.work.fit.weights);
            }
        }
    }

    /// Loads the gyroscope's yaw increments of rows of a log, until the first one in which the rover stands, or that
    /// may have to be refused. Returns the end of these rows.
    fn load_gyroscope_rows(&self, recording: &Recording<'_>, rows: Range<usize>, block: &mut LogBlock) -> usize {
        let (wheels, joints) = (self.rover.wheels().len(), self.rover.steered().len());
        let mut bias = self.state.uncertainty.bias;
        for (k, row) in rows.clone().enumerate() {
            let [before, sample] = [row - 1, row].map(|row| recording.row(wheels, joints, row));
            let dt = sample.stamp - before.stamp;
            let rate = sample.yaw_rate;
            let has_to_be_checked = rate.is_some_and(|rate| {
                let turned = self.turned_between([before.wheels, sample.wheels]);
                rate.is_infinite() || self.stands(rate, bias, dt, turned)
            });
            if has_to_be_checked {
                return row;
            }
            block.is_read.0[k] = f64::from(u8::from(rate.is_some()));
            block.turn.0[k] = rate.map_or(0.0, |rate| gyroscope::turn(before.yaw_rate, rate, bias, dt));
            block.bias.0[k] = bias.map_or(0.0, |bias| bias.variance);
            if let Some(bias) = &mut bias {
                bias.variance += self.settings.bias_variance_increment(dt);
            }
        }
        rows.end
    }

    /// Writes pose and covariance to a row.
    pub(crate) fn write_row(&self, k: usize, track: &mut TrackRows<'_>) {
        track.poses[k] = self.pose().into();
        if let Some(covariances) = &mut track.covariances {
            covariances[k].copy_from_slice(self.covariance().as_flattened());
        }
    }
}
