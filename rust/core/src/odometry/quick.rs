//! The usual sample, by registers of wheels, and logs of them, by registers of samples; every other one is for the plain core.

use super::arithmetic::{Apart, Arithmetic};
use super::tolerant::{Recording, TrackRows};
use super::{Health, Odometry, Sample, Settings};
use crate::batch::one_row::step::log::{Block, Follow, Room, Rows};
use crate::batch::one_row::step::{Given, LARGEST_STEP, SURELY, Targets};

/// What the settings say of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Terms<T> {
    /// Duration [s].
    pub dt: T,
    /// Variance of what a wheel rolled, but for slip [m²].
    pub reading_variance: T,
    /// Half the deviation of a steering angle [rad], and its variance.
    pub half_deviation: T,
    pub steering_variance: T,
    /// How far a wheel slides that is reported [m]; None: by the variances.
    pub slip_bound: Option<T>,
    /// Way of a wheel and turn of a joint beyond which the plain core is asked [m, rad]; at most [`LARGEST_STEP`].
    pub most: [T; 2],
    /// Variance along and across a wheel's heading per metre of its pivot [m].
    pub slip_variances: [f64; 2],
    /// Time constant of the filter of the twist [s].
    pub smoothing: f64,
}

impl Settings {
    /// Of a step that takes so long.
    #[inline(always)]
    pub(crate) fn terms<F: Arithmetic>(&self, by: F, dt: F::Number) -> Terms<F::Number> {
        let noise = &self.noise;
        let read = by.number(noise.speed) * dt;
        let steering = by.number(noise.steering);
        let (reading_variance, deviation) = match noise.period {
            None => (read * read, steering),
            Some(period) => {
                let sharing = by.over(by.number(period), dt);
                (sharing * (read * read), by.sqrt(sharing) * steering)
            }
        };
        let most = |limit: Option<f64>, largest: f64| match limit {
            None => by.number(largest),
            Some(limit) => by.least(by.number(SURELY * limit) * dt, by.number(largest)),
        };
        let [way, turn] = LARGEST_STEP;
        Terms {
            dt,
            reading_variance,
            half_deviation: deviation * by.number(0.5),
            steering_variance: deviation * deviation,
            slip_bound: self
                .flagged_slip()
                .map(|threshold| by.number(threshold) * dt),
            most: [
                most(self.max_speed, way),
                most(self.max_steering_rate, turn),
            ],
            slip_variances: [noise.slip * noise.slip, noise.side_slip * noise.side_slip],
            smoothing: self.smoothing,
        }
    }
}

impl Odometry {
    /// A usual sample by registers. Whether a wheel slips; nothing, and nothing has changed, where the sample is
    /// none or may have to be refused.
    #[inline]
    pub(super) fn step(&mut self, sample: &Sample<'_>) -> Option<bool> {
        let (plan, reference) = (self.plan.as_mut()?, &self.reference);
        let dt = sample.stamp - reference.stamp;
        let is_usual = reference.known
            && dt >= f64::MIN_POSITIVE // whose reciprocal is finite
            && dt.is_finite()
            && sample.yaw_rate.is_none()
            && sample.yaw.is_none_or(f64::is_finite);
        if !is_usual {
            return None;
        }
        let given = Given {
            wheels: [&reference.wheels, sample.wheels],
            steering: [&reference.steering, sample.steering],
            angles: &reference.angles,
            terms: self.settings.terms(Apart, dt),
        };
        let mut targets = Targets {
            angles: &mut self.angles,
            residual: &mut self.residual,
            state: &mut self.state,
            noise: &mut self.work.noise,
        };
        let slips = plan.step(&given, &mut targets)?;
        if self.settings.lag > 0.0 {
            self.difference(sample, dt); // which a late pose asks for
        }
        Some(slips)
    }

    /// Memory to take in a log by registers of samples; nothing where that cannot be.
    pub(super) fn room(&self) -> Option<Room> {
        let plan = self.plan.as_ref().filter(|_| self.settings.lag == 0.0)?;
        Room::new(plan)
    }

    /// Takes in rows of a log from `first` on, the row before which has just been taken in, as many as are usual: the
    /// same numbers as row by row. How many.
    pub(super) fn stride(
        &mut self,
        recording: &Recording<'_>,
        first: usize,
        room: &mut Room,
        block: &mut Block,
        track: &mut TrackRows<'_>,
    ) -> usize {
        let (wheels, joints) = (self.rover.wheels().len(), self.rover.steered().len());
        let end = recording.bare_until(first, room.rows());
        let Some(plan) = self
            .plan
            .as_ref()
            .filter(|_| !self.state.uncertainty.leans_on_gyroscope())
        else {
            return 0;
        };
        let rows = Rows {
            wheels: &recording.wheels[(first - 1) * wheels..end * wheels],
            steering: &recording.steering[(first - 1) * joints..end * joints],
            stamps: &recording.stamps[first - 1..end],
            settings: &self.settings,
        };
        let follow = Follow {
            plan,
            rows,
            angles: &self.reference.angles,
            room,
            block,
            state: &mut self.state,
            noise: &mut self.work.noise,
        };
        let count = follow.go();
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
        self.conclude(&sample, Health::SLIP.when(block.slips.0[last] != 0.0), None);
        count
    }
}
