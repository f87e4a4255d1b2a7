//! Update by one sample: it is checked, a step is integrated, and it becomes the reference of the next step.

use super::{Odometry, StepReadings};
use crate::health::{Health, Refusal};
use crate::motion::Motion;
use crate::samples::increments::{
    Counts, StepTiming, add_increments, check_rim_speed, check_steering_rate, count_from_zero,
};
use crate::samples::recording::Sample;
use crate::samples::whole_logs::LogOdometry;
use crate::settings::Readings;
use crate::settings::gyroscope;
use crate::settings::gyroscope::{LIKELY, STANDING};
use crate::uncertainty::Bias;
use six_wheel_kinematics::geometry::Twist;
use six_wheel_numerics::error::{Error, HUGE, finite, number, numbers};

impl Odometry {
    /// Updates the state by a sample. On failure nothing has changed.
    #[inline]
    pub fn update(&mut self, sample: Sample<'_>) -> Result<Health, Error> {
        self.try_update(sample).map_err(|refusal| refusal.error)
    }

    /// Update by any sample, with all checks.
    pub(crate) fn update_any(&mut self, sample: Sample<'_>) -> Result<Health, Refusal> {
        self.check_numbers(&sample).map_err(|error| Refusal::new(Health::NOT_FINITE, error))?;
        if !self.reference.known {
            if let Some(held) = self.commanded.filter(|held| sample.stamp < *held) {
                let rule = format!("not be before the end of the last command, {}", number(held));
                let error = Error::value("stamp", rule, number(sample.stamp));
                return Err(Refusal::new(Health::BACKWARDS, error));
            }
            self.refer_to(&sample);
            self.health = Health::FIRST;
            if let Some(yaw) = sample.yaw {
                self.state.correct_yaw(yaw, self.settings.noise.yaw);
            }
            return Ok(Health::FIRST);
        }
        let dt = sample.stamp - self.reference.stamp;
        Refusal::unless_later(dt, sample.stamp, self.reference.stamp)?;
        let wrapped = self.difference(&sample, dt);
        let counted = Health::WRAPPED.when(wrapped) | Health::RESTARTED.when(self.count_from_zero(&sample, dt));
        self.check_jump(dt).map_err(|error| Refusal::new(Health::JUMP, error))?;
        let bias = self.state.uncertainty.bias;
        if let Some(rate) = sample.yaw_rate
            && self.stands(rate, bias, dt, self.turned.iter().copied())
        {
            self.rest(rate, dt);
            return Ok(self.commit_sample(&sample, counted, None));
        }
        let before = self.reference.yaw_rate;
        let gyro_turn = sample.yaw_rate.map(|rate| gyroscope::turn(before, rate, bias, dt));
        let motion = Motion {
            steering: [&self.reference.angles, &self.angles],
            turned: &self.turned,
            from_rates: self.settings.readings == Readings::Speeds,
            dt,
            gyro_turn,
            bias_variance: bias.map_or(0.0, |bias| bias.variance),
        };
        let Self { rover, settings, state, work, residual, .. } = self;
        let slips = work
            .advance(rover, settings, motion, HUGE, Some(state), residual)
            .map_err(|error| Refusal::new(Health::UNDETERMINED, error))?;
        Ok(self.commit_sample(&sample, counted | Health::SLIP.when(slips), gyro_turn))
    }

    /// Completes an update whose step has been integrated: the sample becomes the reference, its yaw corrects the pose,
    /// and it is added to the history.
    #[inline]
    pub(crate) fn commit_sample(&mut self, sample: &Sample<'_>, flags: Health, gyro_turn: Option<f64>) -> Health {
        let reference = &mut self.reference;
        let dt = sample.stamp - reference.stamp;
        let is_gap = self.settings.max_gap.is_some_and(|gap| dt > gap);
        self.health = flags | Health::GAP.when(is_gap);
        reference.stamp = sample.stamp;
        reference.yaw_rate = sample.yaw_rate;
        reference.wheels.copy_from_slice(sample.wheels);
        reference.steering.copy_from_slice(sample.steering);
        std::mem::swap(&mut reference.angles, &mut self.angles);
        if let Some(yaw) = sample.yaw {
            self.state.correct_yaw(yaw, self.settings.noise.yaw);
        }
        self.skipped.clear();
        self.commanded = None;
        let (angles, turned) = (&self.reference.angles, &self.turned);
        let make = || StepReadings { angles: angles.clone(), turned: turned.clone(), yaw: sample.yaw, gyro_turn };
        let write = |readings: &mut StepReadings| {
            readings.angles.copy_from_slice(angles);
            readings.turned.copy_from_slice(turned);
            (readings.yaw, readings.gyro_turn) = (sample.yaw, gyro_turn);
        };
        self.history.push([sample.stamp, dt], &self.state, make, write);
        self.health
    }

    fn check_numbers(&self, sample: &Sample<'_>) -> Result<(), Error> {
        finite("steering", sample.steering)?;
        for (wheel, reading) in self.rover.wheels().iter().zip(sample.wheels) {
            if !(reading.is_finite() || reading.is_nan() && !wheel.driven) {
                return Err(Error::value("wheel_angles", "be finite", numbers(sample.wheels)));
            }
        }
        let others = [("stamp", Some(sample.stamp)), ("yaw", sample.yaw), ("yaw_rate", sample.yaw_rate)];
        others.into_iter().try_for_each(|(argument, value)| finite(argument, value.as_slice()))
    }

    /// Makes the sample the reference of the next step.
    pub(crate) fn refer_to(&mut self, sample: &Sample<'_>) {
        self.settings.first_angles(sample.steering, &mut self.reference.angles);
        self.reference.known = true;
        self.reference.stamp = sample.stamp;
        self.reference.wheels.copy_from_slice(sample.wheels);
        self.reference.steering.copy_from_slice(sample.steering);
        self.reference.yaw_rate = sample.yaw_rate;
    }

    /// Computes the rotations of wheels since the reference and the angles of joints [rad]. Returns true if a counter
    /// started over.
    pub(crate) fn difference(&mut self, sample: &Sample<'_>, dt: f64) -> bool {
        let Self { settings, skipped, reference, turned, angles, .. } = self;
        angles.copy_from_slice(&reference.angles);
        let before = Counts { wheels: &reference.wheels, steering: &reference.steering };
        let after = Counts { wheels: sample.wheels, steering: sample.steering };
        add_increments(settings, skipped, [before, after], dt, turned, angles)
    }

    /// Replaces the rotations of wheels whose counters restarted at zero since the reference. Returns true if there is
    /// one.
    fn count_from_zero(&mut self, sample: &Sample<'_>, dt: f64) -> bool {
        let wheels = self.rover.wheels();
        let reach = wheels.iter().map(|wheel| wheel.x.hypot(wheel.y)).fold(0.0, f64::max);
        let Twist { vx, vy, omega } = self.state.twist;
        let timing =
            StepTiming { dt, last_dt: self.history.last_duration(), speed: vx.hypot(vy) + omega.abs() * reach };
        let readings = [self.reference.wheels.as_slice(), sample.wheels];
        let radii = wheels.iter().map(|wheel| wheel.radius);
        count_from_zero(&self.settings, readings, radii, timing, &mut self.turned)
    }

    /// Fails if a wheel or a joint moved faster than the settings allow.
    fn check_jump(&self, dt: f64) -> Result<(), Error> {
        let Self { rover, settings, skipped, reference, turned, angles, .. } = self;
        let wheels = rover.wheels().iter().zip(turned);
        check_rim_speed(settings, skipped, dt, wheels.map(|(wheel, turned)| (&*wheel.name, wheel.radius, *turned)))?;
        let names = rover.steered().iter().map(|&wheel| &*rover.wheels()[wheel].name);
        let joints = names.zip(reference.angles.iter().zip(angles));
        check_steering_rate(settings, dt, joints.map(|(name, (before, after))| (name, *before, *after)))
    }

    /// True if the rover stands: no wheel rolls faster than [`STANDING`], and the reading of the gyroscope is within
    /// [`LIKELY`] deviations of its bias.
    #[inline]
    pub(crate) fn stands(&self, rate: f64, bias: Option<Bias>, dt: f64, turned: impl Iterator<Item = f64>) -> bool {
        let (Some(known), Some(bias)) = (self.settings.gyroscope, bias) else {
            return false;
        };
        let still = self
            .rover
            .wheels()
            .iter()
            .zip(turned)
            .all(|(wheel, turned)| turned.is_nan() || (wheel.radius * turned).abs() <= STANDING * dt);
        let variance = bias.variance + known.noise * known.noise;
        still && (rate - bias.value).abs() <= LIKELY * variance.sqrt()
    }

    /// A step at rest: the pose is constant, and the reading of the gyroscope corrects its bias.
    fn rest(&mut self, rate: f64, dt: f64) {
        let noise = self.settings.gyroscope.map_or(0.0, |known| known.noise);
        if let Some(bias) = &mut self.state.uncertainty.bias {
            bias.variance += self.settings.bias_variance_increment(dt);
        }
        let shift = self.state.uncertainty.correct_bias(rate, noise * noise);
        self.state.shift(&shift);
        self.state.hold_twist(Twist::ZERO, dt, self.settings.smoothing);
        self.residual.fill(0.0);
        self.work.fit.weights.fill(1.0);
        self.work.noise.clear();
    }
}
