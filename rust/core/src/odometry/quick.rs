//! The usual sample, by registers of wheels; every other one is for the plain core.

use super::{Odometry, Sample};
use crate::batch::one_row::step::{Given, SURELY, Targets};

impl Odometry {
    /// A usual sample by registers. Whether a wheel slips; nothing, and nothing has changed, where the sample is
    /// none or may have to be refused.
    #[inline]
    pub(super) fn step(&mut self, sample: &Sample<'_>) -> Option<bool> {
        let (plan, reference, noise) = (self.plan.as_mut()?, &self.reference, &self.settings.noise);
        let dt = sample.stamp - reference.stamp;
        let is_usual = reference.known
            && dt > 0.0
            && dt.is_finite()
            && sample.yaw_rate.is_none()
            && sample.yaw.is_none_or(f64::is_finite);
        if !is_usual {
            return None;
        }
        let sharing = noise.sharing(dt);
        let most = |limit: Option<f64>| limit.map_or(f64::INFINITY, |limit| SURELY * limit * dt);
        let given = Given {
            wheels: [&reference.wheels, sample.wheels],
            steering: [&reference.steering, sample.steering],
            angles: &reference.angles,
            dt,
            reading_variance: sharing * (noise.speed * dt).powi(2),
            steering_deviation: noise.period.map_or(1.0, |_| sharing.sqrt()) * noise.steering,
            slip_variances: [noise.slip * noise.slip, noise.side_slip * noise.side_slip],
            slip_bound: self.settings.flagged_slip().map(|threshold| threshold * dt),
            smoothing: self.settings.smoothing,
            most: [
                most(self.settings.max_speed),
                most(self.settings.max_steering_rate),
            ],
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
}
