//! A pose from outside: it corrects the state of its instant, and the samples after it are taken in again.

use nalgebra::{Matrix3, Matrix6, Vector3};

use super::Odometry3;
use super::history::Correction;
use super::sample::Read;
use super::spread::whole;
use super::state::{Fixed, Pose3, State, check_covariance};
use six_wheel_kinematics::geometry::wrap_angle;
use six_wheel_numerics::error::{Error, number};
use six_wheel_odometry::preintegrated::space::Motion3;
use six_wheel_odometry::state::check_pose;

impl Fixed {
    /// Moves a pose towards one from outside. What was measured of the tilt, and what follows from the map, stays.
    fn meet(&self, state: &mut State, read: &Read, pose: &Motion3, covariance: &Matrix6<f64>) {
        let keeps = match read.attitude {
            Some(_) => state.upright(),
            None => Matrix6::identity(),
        };
        let here = state.pose().motion();
        let mut seen = Matrix6::identity();
        let mut about = (pose.rotation * here.rotation.inverse()).scaled_axis();
        if covariance[(3, 3)].is_infinite() && covariance[(4, 4)].is_infinite() {
            // Nothing of its tilt: it tells the yaw, whatever the tilt is.
            let (_, _, yaw) = pose.rotation.euler_angles();
            about = Vector3::z() * wrap_angle(yaw - state.walk.heading.value());
            seen.set_row(5, &state.yaw_row());
        }
        let mut apart = whole(&(pose.translation - here.translation), &about);
        for k in 0..6 {
            if covariance[(k, k)].is_infinite() {
                apart[k] = 0.0;
            }
        }
        let gain = state.errors.correct(covariance, &seen, &keeps);
        state.shift(&(gain * apart));
        if let Some(ground) = &self.ground {
            // Where it does not settle it keeps what it had.
            let _ = self.stand(state, read, ground);
        }
    }
}

impl Odometry3 {
    /// A pose from outside at some instant of the last `lag` seconds, with its covariance in axes of the world, infinite
    /// variances where it says nothing. Between two samples the rover is taken to be on the screw of the step; after
    /// the last one it is taken to have gone on as before.
    pub fn correct(&mut self, pose: Pose3, stamp: f64, covariance: [[f64; 6]; 6]) -> Result<(), Error> {
        let covariance = check_covariance(covariance, true)?;
        check_pose(&pose.numbers())?;
        let Some(reference) = self.reference.filter(|_| stamp.is_finite()) else {
            let rule = "be finite and follow a first sample";
            return Err(Error::value("stamp", rule, number(stamp)));
        };
        let last = reference.stamp;
        let history = &self.history;
        let oldest = match history.entries.front() {
            None => last - self.last_dt,
            Some(entry) => entry.read.stamp - entry.dt,
        };
        let latest = last + history.lag.max(self.last_dt);
        if stamp < oldest || stamp > latest {
            let rule = format!("be between {} and {}, as lag and history allow", number(oldest), number(latest));
            return Err(Error::value("stamp", rule, number(stamp)));
        }
        // The first entry at or after it, or the last one.
        let entries = &history.entries;
        let after = entries.partition_point(|entry| entry.read.stamp < stamp);
        let at = after.min(entries.len().saturating_sub(1));
        let entry = entries.get(at);
        let (twist, then) = entry.map_or((self.state.twist, last), |entry| (entry.state.twist, entry.read.stamp));
        let number = entry.map(|_| history.first + at as u64);
        let seen = pose.motion();
        let moved = seen.compose(&Motion3::exp(&(nalgebra::Vector6::from(twist) * (then - stamp))));
        let mut swing = Matrix6::identity();
        let lever = (moved.translation - seen.translation).cross_matrix();
        swing.fixed_view_mut::<3, 3>(0, 3).copy_from(&-Matrix3::from(lever));
        let covariance = match covariance.iter().all(|value| value.is_finite()) {
            true => swing * covariance * swing.transpose(),
            false => covariance,
        };
        let Some(entry) = number else {
            self.fixed.meet(&mut self.state, &reference, &moved, &covariance);
            return Ok(());
        };
        let correction = Correction { entry, pose: moved, covariance };
        self.replay(correction);
        self.history.remember(correction);
        Ok(())
    }

    /// Goes back to an entry, corrects it, and takes in again what came after it. On a map a corrected rover may come
    /// to where it does not stand; it then goes on by the step it had made.
    fn replay(&mut self, correction: Correction) {
        let (first, next) = (correction.entry, self.history.next());
        let place = self.history.place(first);
        let mut state = self.history.entries[place].state;
        let read = self.history.entries[place].read;
        self.fixed.meet(&mut state, &read, &correction.pose, &correction.covariance);
        self.history.entries[place].state = state;
        for number in first + 1..next {
            let (before, place) = (self.history.place(number - 1), self.history.place(number));
            let (start, entry) = (self.history.entries[before].read, self.history.entries[place]);
            let kept = state;
            let reads = [&start, &entry.read];
            if let Ok(taken) = self.fixed.advance(reads, &entry.turned, entry.dt, &mut state) {
                self.noise = taken.noise;
            } else {
                state = kept;
                self.fixed.hold(&mut state, &entry.state, &entry.read, entry.dt);
            }
            let known = &self.history.corrections;
            for known in known.iter().filter(|known| known.entry == number) {
                self.fixed.meet(&mut state, &entry.read, &known.pose, &known.covariance);
            }
            self.history.entries[place].state = state;
        }
        self.state = state;
    }
}

impl Fixed {
    /// Goes along a step as it was made before, where it cannot be made anew.
    fn hold(&self, state: &mut State, before: &State, read: &Read, dt: f64) {
        let tangent = nalgebra::Vector6::from(before.twist) * dt;
        let start = state.rotation();
        let none = super::spread::StepNoise::none();
        state.errors.propagate(&start, &tangent, &none);
        let moved = Motion3::exp(&tangent);
        let shift = start * moved.translation;
        state.shift(&whole(&shift, &(start * moved.rotation.scaled_axis())));
        (state.roll, state.pitch) = (before.roll, before.pitch);
        state.twist = before.twist;
        self.measure_tilt(state, read);
    }
}
