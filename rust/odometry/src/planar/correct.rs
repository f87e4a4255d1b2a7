//! A pose from outside: it corrects the state at its instant, and the samples after that are integrated again.

use nalgebra::Vector3;

use super::{Odometry, PoseMeasurement, StepReadings};
use crate::history::{HistoryEntry, Instant};
use crate::motion::Motion;
use crate::propagation::covariance::{Covariance3, lane};
use crate::settings::Readings;
use crate::state::{State, check_covariance, check_pose};
use six_wheel_kinematics::geometry::{Pose, Twist, wrap_angle};
use six_wheel_numerics::error::Error;

impl State {
    /// Corrects the pose by one from outside, with the gain of their covariances.
    fn correct_with_pose(&mut self, PoseMeasurement { pose, covariance }: &PoseMeasurement) {
        let gain = self.uncertainty.correct(covariance);
        let here = self.pose();
        let mut difference = Vector3::new(pose.x - here.x, pose.y - here.y, wrap_angle(pose.yaw - here.yaw));
        for (part, variance) in difference.iter_mut().zip(covariance.diagonal().iter()) {
            if variance.is_infinite() {
                *part = 0.0;
            }
        }
        self.shift(&(gain * difference));
    }
}

impl PoseMeasurement {
    /// The pose after `dt` [s] at a constant twist. A covariance with infinite variances is unchanged.
    fn propagate(self, twist: Twist, dt: f64) -> Self {
        let Self { pose: start, mut covariance } = self;
        let pose = start.compose(twist.exp(dt));
        if covariance.iter().all(|value| value.is_finite()) {
            let yaw_lever = lane([start.y - pose.y, pose.x - start.x]);
            covariance = Covariance3::of(&covariance).lane().propagate(yaw_lever).total().matrix();
        }
        Self { pose, covariance }
    }
}

impl Odometry {
    /// Pose at an instant at most `lag` seconds before or after the last sample: between two samples on the arc of the
    /// step, after the last one at its twist.
    pub fn pose_at(&self, stamp: f64) -> Result<Pose, Error> {
        let Instant { state, stamp: then, .. } = self.history.locate(stamp, self.stamp(), &self.state)?;
        Ok(state.pose().compose(state.twist.exp(stamp - then)))
    }

    /// Corrects the state by a pose from outside at an instant of the last `lag` seconds, with its covariance in world
    /// axes; variances of unknown components are infinite. Between two samples the rover is on the arc of the step,
    /// after the last one it continues at its twist.
    #[inline]
    pub fn correct(&mut self, pose: Pose, stamp: f64, covariance: [[f64; 3]; 3]) -> Result<(), Error> {
        let covariance = check_covariance(covariance)?;
        check_pose(&<[f64; 3]>::from(pose))?;
        let Instant { number, state, stamp: then } = self.history.locate(stamp, self.stamp(), &self.state)?;
        let measured = PoseMeasurement { pose, covariance }.propagate(state.twist, then - stamp);
        let Some(number) = number else {
            self.state.correct_with_pose(&measured);
            return Ok(());
        };
        let (rover, settings, work) = (&self.rover, &self.settings, &mut self.work);
        let integrate = |state: &mut State, before: &StepReadings, entry: &HistoryEntry<StepReadings, State>| {
            let readings = &entry.readings;
            let motion = Motion {
                steering: [&before.angles, &readings.angles],
                turned: &readings.turned,
                from_rates: settings.readings == Readings::Speeds,
                dt: entry.dt,
                gyro_turn: readings.gyro_turn,
                bias_variance: state.uncertainty.bias.map_or(0.0, |bias| bias.variance),
            };
            // The step succeeded before and does not depend on the pose. It cannot fail with an infinite bound,
            // although the corrected bias of a gyroscope changes its noise.
            let _ = work.advance(rover, settings, motion, f64::INFINITY, Some(state), &mut []);
            if let Some(yaw) = readings.yaw {
                state.correct_yaw(yaw, settings.noise.yaw);
            }
        };
        let correct = |state: &mut State, _: &StepReadings, pose: &PoseMeasurement| state.correct_with_pose(pose);
        self.history.correct(number, measured, &mut self.state, integrate, correct);
        Ok(())
    }
}
