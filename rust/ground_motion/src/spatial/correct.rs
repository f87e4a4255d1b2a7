//! Correction by a measured pose: the state of its instant is corrected, and the later samples are integrated again.

use nalgebra::{Matrix6, Vector3, Vector6};

use super::Odometry3;
use super::sample::Read;
use super::spread::by_start;
use super::state::{Fixed, Pose3, PoseMeasurement3, State, StepReadings3, check_covariance};
use six_wheel_kinematics::geometry::wrap_angle;
use six_wheel_numerics::error::Error;
use six_wheel_odometry::history::{HistoryEntry, Instant};
use six_wheel_odometry::preintegrated::space::{Motion3, stack};
use six_wheel_odometry::state::check_pose;

impl Fixed {
    /// Corrects a pose by a measured one. Measured tilt stays; height and tilt on a map are settled again.
    fn correct_with_pose(&self, state: &mut State, read: &Read, seen: &PoseMeasurement3) {
        let PoseMeasurement3 { pose, covariance } = seen;
        let keeps = match read.attitude {
            Some(_) => state.tilt_free_projection(),
            None => Matrix6::identity(),
        };
        let here = state.pose().motion();
        let mut by_error = Matrix6::identity();
        let mut about = (pose.rotation * here.rotation.inverse()).scaled_axis();
        if covariance[(3, 3)].is_infinite() && covariance[(4, 4)].is_infinite() {
            // A measurement without tilt: its yaw angle is compared with the state's.
            let (_, _, yaw) = pose.rotation.euler_angles();
            about = Vector3::z() * wrap_angle(yaw - state.pose_sums.heading.value());
            by_error.set_row(5, &state.yaw_row());
        }
        let mut difference = stack(&(pose.translation - here.translation), &about);
        for k in 0..6 {
            if covariance[(k, k)].is_infinite() {
                difference[k] = 0.0;
            }
        }
        let gain = state.errors.correct(covariance, &by_error, &keeps);
        state.shift(&(gain * difference));
        if let Some(ground) = &self.ground {
            // If the rover does not settle there, height, tilt and joints stay.
            let _ = self.stand(state, read, ground);
        }
    }
}

impl PoseMeasurement3 {
    /// The measurement after `dt` [s] at this twist [m/s, rad/s]. A covariance with infinite variances stays.
    fn propagate(self, twist: [f64; 6], dt: f64) -> Self {
        let Self { pose: start, mut covariance } = self;
        let pose = start.compose(&Motion3::exp(&(Vector6::from(twist) * dt)));
        if covariance.iter().all(|value| value.is_finite()) {
            let by_start = by_start(&(pose.translation - start.translation));
            covariance = by_start * covariance * by_start.transpose();
        }
        Self { pose, covariance }
    }
}

impl Odometry3 {
    /// Corrects by a measured pose at an instant of the last `lag` seconds, with its covariance in axes of the world,
    /// infinite variances for what was not measured. Between two samples the pose is interpolated on the screw of the
    /// step; after the last sample it is extrapolated at the last twist. Where a corrected rover does not settle on the
    /// map, its steps are those from before the correction.
    pub fn correct(&mut self, pose: Pose3, stamp: f64, covariance: [[f64; 6]; 6]) -> Result<(), Error> {
        let covariance = check_covariance(covariance, true)?;
        check_pose(&pose.numbers())?;
        let Instant { number, state, stamp: then } = self.history.locate(stamp, self.stamp(), &self.state)?;
        let seen = PoseMeasurement3 { pose: pose.motion(), covariance }.propagate(state.twist, then - stamp);
        let (fixed, noise) = (&self.fixed, &mut self.noise);
        let Some(number) = number else {
            if let Some(read) = &self.reference {
                fixed.correct_with_pose(&mut self.state, read, &seen);
            }
            return Ok(());
        };
        let integrate = |state: &mut State, before: &StepReadings3, entry: &HistoryEntry<StepReadings3, State>| {
            let (kept, after) = (*state, &entry.readings);
            if let Ok(taken) = fixed.advance([&before.read, &after.read], &after.turned, entry.dt, state) {
                *noise = taken.noise;
            } else {
                *state = kept;
                fixed.repeat_step(state, &entry.state, &after.read, entry.dt);
            }
        };
        let correct = |state: &mut State, after: &StepReadings3, seen: &PoseMeasurement3| {
            fixed.correct_with_pose(state, &after.read, seen);
        };
        self.history.correct(number, seen, &mut self.state, integrate, correct);
        Ok(())
    }
}

impl Fixed {
    /// Repeats the displacement of a step that fails from the corrected state.
    fn repeat_step(&self, state: &mut State, before: &State, read: &Read, dt: f64) {
        let tangent = Vector6::from(before.twist) * dt;
        let start = state.rotation();
        let none = super::spread::StepNoise::none();
        state.errors.propagate(&start, &tangent, &none);
        let moved = Motion3::exp(&tangent);
        let shift = start * moved.translation;
        state.shift(&stack(&shift, &(start * moved.rotation.scaled_axis())));
        (state.roll, state.pitch) = (before.roll, before.pitch);
        state.twist = before.twist;
        self.measure_tilt(state, read);
    }
}
