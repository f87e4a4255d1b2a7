//! Update by a sample of running totals whose readings need no check: the usual one while driving.

use super::Odometry;
use crate::samples::increments::may_start_over;
use crate::samples::recording::Sample;
use crate::settings::gyroscope;
use crate::step::{StepInput, StepOutput, WheelInput};
use six_wheel_numerics::error::HUGE;

impl Odometry {
    /// Integrates a step to a sample. Returns true if a wheel slips, and the yaw increment by the gyroscope [rad].
    /// Returns None, with nothing changed, if the step is one of [`Self::update_any`]: the rover stands, the equations
    /// are no constants of the rover, a counter may have started over, or the sample may have to be refused.
    #[inline]
    pub(crate) fn direct_step(&mut self, sample: &Sample<'_>) -> Option<(bool, Option<f64>)> {
        let (reference, constants) = (&self.reference, &self.work.constants);
        let dt = sample.stamp - reference.stamp;
        let is_direct = constants.is_constant
            && constants.is_direct
            && reference.known
            && dt > 0.0
            && dt.is_finite()
            && sample.yaw_rate.is_none_or(f64::is_finite)
            && sample.yaw.is_none_or(f64::is_finite);
        if !is_direct {
            return None;
        }
        let wheels = [reference.wheels.as_slice(), sample.wheels];
        if wheels[0].iter().zip(wheels[1]).any(|(before, after)| may_start_over(*before, *after)) {
            return None;
        }
        let bias = self.state.uncertainty.bias;
        if let Some(rate) = sample.yaw_rate
            && self.stands(rate, bias, dt, self.turned_between(wheels))
        {
            return None;
        }
        let gyro_turn = sample.yaw_rate.map(|rate| gyroscope::turn(reference.yaw_rate, rate, bias, dt));
        let input = StepInput {
            settings: &self.settings,
            wheels: WheelInput::Totals {
                wheels,
                steering: [&reference.steering, sample.steering],
                angles: &reference.angles,
            },
            dt,
            from_rates: false,
            gyro_turn,
            bias_variance: bias.map_or(0.0, |bias| bias.variance),
            bound: HUGE,
        };
        let output =
            StepOutput { angles: &mut self.angles, residual: &mut self.residual, state: Some(&mut self.state) };
        let slips = self.work.step(&input, output)?;
        if self.settings.lag > 0.0 {
            self.difference(sample, dt); // for the history of late poses
        }
        Some((slips, gyro_turn))
    }

    /// Rotation of every wheel between two readings that are running totals [rad].
    #[inline]
    pub(crate) fn turned_between<'a>(&'a self, [before, after]: [&'a [f64]; 2]) -> impl Iterator<Item = f64> {
        let counts = before.iter().zip(after).enumerate();
        counts.map(|(i, (before, after))| (after - before) * self.settings.wheel_encoder(i).angle_per_count())
    }
}
