//! The usual sample, by registers of wheels, and logs of them, by registers of samples; every other one is for the plain core.

use std::ops::Range;

use super::Odometry;
use crate::arithmetic::Unfused;
use crate::health::Health;
use crate::recording::{Recording, Sample, TrackRows};
use crate::registers::log::{BlockScratch, LogBlock, LogIntegrator, Rows};
use crate::registers::{StepInput, StepOutput};
use crate::settings::gyroscope;
use crate::uncertainty::GyroscopeIncrement;

/// Rows of a log that are worth a register.
const FEW: usize = 4;

impl Odometry {
    /// Takes in a usual sample by registers. Returns true if a wheel slips, and the turn by the gyroscope [rad].
    /// Returns None, with nothing changed, where the sample is unusual, the rover stands, or the sample may have to be
    /// refused.
    #[inline]
    pub(crate) fn step(&mut self, sample: &Sample<'_>) -> Option<(bool, Option<f64>)> {
        let reference = &self.reference;
        self.plan.as_ref()?;
        let dt = sample.stamp - reference.stamp;
        let is_usual = reference.known
            && dt >= f64::MIN_POSITIVE // whose reciprocal is finite
            && dt.is_finite()
            && sample.yaw_rate.is_none_or(f64::is_finite)
            && sample.yaw.is_none_or(f64::is_finite);
        if !is_usual {
            return None;
        }
        let wheels = [&reference.wheels, sample.wheels];
        let bias = self.state.uncertainty.bias;
        let mut turned = None;
        if let Some(rate) = sample.yaw_rate {
            if self.stands(rate, bias, dt, self.turned_between(wheels)) {
                return None;
            }
            turned = Some(GyroscopeIncrement {
                says: 1.0,
                turn: gyroscope::turn(reference.yaw_rate, rate, bias, dt),
                deviation: self.settings.turn_deviation(Unfused, dt),
                bias_variance: bias.map_or(0.0, |bias| bias.variance),
            });
        }
        let plan = self.plan.as_mut()?;
        let given = StepInput {
            wheels,
            steering: [&reference.steering, sample.steering],
            angles: &reference.angles,
            terms: self.settings.terms(Unfused, dt),
            wandered: self.settings.wandered(dt),
            turned,
        };
        let mut targets = StepOutput {
            angles: &mut self.angles,
            residual: &mut self.residual,
            state: &mut self.state,
            noise: &mut self.work.noise,
        };
        let slips = plan.step(&given, &mut targets)?;
        if self.settings.lag > 0.0 {
            self.difference(sample, dt); // which a late pose asks for
        }
        Some((slips, turned.map(|turned| turned.turn)))
    }

    /// Rotation of every wheel between two readings that are running totals [rad].
    #[inline]
    fn turned_between<'a>(&'a self, [before, after]: [&'a [f64]; 2]) -> impl Iterator<Item = f64> {
        let counts = before.iter().zip(after).enumerate();
        counts.map(|(i, (before, after))| (after - before) * self.settings.wheel_encoder(i).angle_per_count())
    }

    /// Memory to take in a log by registers of samples; nothing where that cannot be.
    #[inline]
    pub(crate) fn block_scratch(&self) -> Option<BlockScratch> {
        let plan = self.plan.as_ref().filter(|_| self.settings.lag == 0.0)?;
        BlockScratch::new(plan)
    }

    /// Takes in rows of a log from `first` on, the row before which has just been taken in, as many as are usual: the
    /// same numbers as row by row. Returns their number.
    pub(crate) fn update_rows(
        &mut self,
        recording: &Recording<'_>,
        first: usize,
        room: &mut BlockScratch,
        block: &mut LogBlock,
        track: &mut TrackRows<'_>,
    ) -> usize {
        let (wheels, joints) = (self.rover.wheels().len(), self.rover.steered().len());
        let mut end = recording.until_yaw(first, room.rows());
        let uncertainty = &self.state.uncertainty;
        let leans = recording.yaw_rates.is_some() || uncertainty.bias.is_some() || uncertainty.leans_on_gyroscope();
        if leans {
            end = self.load_gyroscope_rows(recording, first..end, block);
        }
        let Some(plan) = self.plan.as_ref().filter(|_| end - first >= FEW) else {
            return 0;
        };
        let rows = Rows {
            wheels: &recording.wheels[(first - 1) * wheels..end * wheels],
            steering: &recording.steering[(first - 1) * joints..end * joints],
            stamps: &recording.stamps[first - 1..end],
            settings: &self.settings,
            leans,
        };
        let integrator = LogIntegrator {
            plan,
            rows,
            angles: &self.reference.angles,
            room,
            block,
            state: &mut self.state,
            noise: &mut self.work.noise,
        };
        let count = integrator.go();
        let Some(last) = count.checked_sub(1) else {
            return 0;
        };
        let done = first..first + count;
        block.write(room, done.clone(), wheels, track);
        block.last_residual(room, last, &mut self.residual);
        self.angles.copy_from_slice(room.angles(last));
        self.reference.stamp = recording.stamps[done.end - 2];
        let gap = self.settings.max_gap;
        for (k, health) in track.health[done.clone()].iter_mut().enumerate() {
            let is_gap = gap.is_some_and(|gap| block.dt.0[k] > gap);
            let slips = block.slips.0[k] != 0.0;
            *health = (Health::SLIP.when(slips) | Health::GAP.when(is_gap)).0;
        }
        if let Some(weights) = &mut track.weights {
            for row in weights[done.start * wheels..done.end * wheels].chunks_exact_mut(wheels) {
                row.copy_from_slice(&self.work.weights);
            }
        }
        let sample = recording.row(wheels, joints, done.end - 1);
        self.commit_sample(&sample, Health::SLIP.when(block.slips.0[last] != 0.0), None);
        if sample.yaw.is_some() {
            // It has corrected the pose since.
            self.write_row(done.end - 1, track);
        }
        count
    }

    /// Loads the gyroscope's turns of rows of a log, until the first one in which the rover stands, or that may have to
    /// be refused. Returns the end of these rows.
    fn load_gyroscope_rows(&self, recording: &Recording<'_>, rows: Range<usize>, block: &mut LogBlock) -> usize {
        let (wheels, joints) = (self.rover.wheels().len(), self.rover.steered().len());
        let mut bias = self.state.uncertainty.bias;
        for (k, row) in rows.clone().enumerate() {
            let [before, sample] = [row - 1, row].map(|row| recording.row(wheels, joints, row));
            let dt = sample.stamp - before.stamp;
            let rate = sample.yaw_rate;
            let is_unusual = rate.is_some_and(|rate| {
                let turned = self.turned_between([before.wheels, sample.wheels]);
                rate.is_infinite() || self.stands(rate, bias, dt, turned)
            });
            if is_unusual {
                return row;
            }
            block.says.0[k] = f64::from(u8::from(rate.is_some()));
            block.turn.0[k] = rate.map_or(0.0, |rate| gyroscope::turn(before.yaw_rate, rate, bias, dt));
            block.bias.0[k] = bias.map_or(0.0, |bias| bias.variance);
            if let Some(bias) = &mut bias {
                bias.variance += self.settings.wandered(dt);
            }
        }
        rows.end
    }
}
