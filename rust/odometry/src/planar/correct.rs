//! A pose from outside: it corrects the state of its instant, and the samples after it are taken in again.

use nalgebra::Matrix3;

use super::Odometry;
use super::advance::{follow, meet_yaw};
use super::history::Correction;
use crate::motion::Motion;
use crate::settings::Readings;
use crate::state::{State, check_covariance, check_pose};
use six_wheel_kinematics::geometry::{Pose, wrap_angle};
use six_wheel_numerics::error::{Error, number};

impl State {
    /// Moves the pose towards one from outside.
    fn correct_with_pose(&mut self, pose: Pose, covariance: &Matrix3<f64>) {
        let gain = self.uncertainty.correct(covariance);
        let here = self.pose();
        let mut apart = nalgebra::Vector3::new(pose.x - here.x, pose.y - here.y, wrap_angle(pose.yaw - here.yaw));
        for (part, variance) in apart.iter_mut().zip(covariance.diagonal().iter()) {
            if variance.is_infinite() {
                *part = 0.0;
            }
        }
        self.shift(&(gain * apart));
    }
}

impl Odometry {
    /// A pose from outside at some instant of the last `lag` seconds, with its covariance in world axes, infinite
    /// variances where it says nothing. Between two samples the rover is taken to be on the arc of the step; after
    /// the last one it is taken to have gone on as before.
    #[inline]
    pub fn correct(&mut self, pose: Pose, stamp: f64, covariance: [[f64; 3]; 3]) -> Result<(), Error> {
        let covariance = check_covariance(covariance)?;
        check_pose(&<[f64; 3]>::from(pose))?;
        let Some(last) = self.stamp().filter(|_| stamp.is_finite()) else {
            let rule = "be finite and follow a first sample";
            return Err(Error::value("stamp", rule, number(stamp)));
        };
        let history = &self.history;
        let oldest = match history.entries.is_empty() || history.first == history.next {
            true => last - history.last_dt,
            false => {
                let entry = &history.entries[history.place(history.first)];
                entry.stamp - entry.dt
            }
        };
        if stamp < oldest || stamp - last > history.lag.max(history.last_dt) {
            let rule = format!(
                "be between {} and {}, as lag and history allow",
                number(oldest),
                number(last + history.lag.max(history.last_dt))
            );
            return Err(Error::value("stamp", rule, number(stamp)));
        }
        // The first entry at or after it.
        let mut at = history.next.saturating_sub(1).max(history.first);
        while at > history.first && history.entries[history.place(at - 1)].stamp >= stamp {
            at -= 1;
        }
        let kept = !history.entries.is_empty() && history.first < history.next;
        let (twist, then) = if kept {
            let entry = &history.entries[history.place(at)];
            (entry.state.twist, entry.stamp)
        } else {
            (self.state.twist, last)
        };
        let moved = pose.compose(twist.exp(then - stamp));
        let swing = Matrix3::new(
            1.0,
            0.0,
            pose.y - moved.y, //
            0.0,
            1.0,
            moved.x - pose.x, //
            0.0,
            0.0,
            1.0,
        );
        let pose = moved;
        let covariance = if covariance.iter().all(|value| value.is_finite()) {
            swing * covariance * swing.transpose()
        } else {
            covariance
        };
        if !kept {
            self.state.correct_with_pose(pose, &covariance);
            return Ok(());
        }
        let correction = Correction { entry: at, pose, covariance };
        self.replay(correction);
        self.history.remember(correction);
        Ok(())
    }

    /// Goes back to an entry, corrects it, and takes in again what came after it.
    fn replay(&mut self, correction: Correction) {
        let rules = self.settings.rules();
        let (first, next) = (correction.entry, self.history.next);
        let place = self.history.place(first);
        self.state.copy_from(&self.history.entries[place].state);
        self.state.correct_with_pose(correction.pose, &correction.covariance);
        self.history.entries[place].state.copy_from(&self.state);
        for number in first + 1..next {
            let (before, place) = (self.history.place(number - 1), self.history.place(number));
            let entry = &self.history.entries[place];
            let motion = Motion {
                steering: [&self.history.entries[before].angles, &entry.angles],
                turned: &entry.turned,
                from_rates: self.settings.readings == Readings::Speeds,
                dt: entry.dt,
                gyro_turn: entry.gyro_turn,
                bias_variance: self.state.uncertainty.bias.map_or(0.0, |bias| bias.variance),
            };
            // It was found the first time and does not depend on the pose: what was taken in is taken in again,
            // however large its noise is said to be by another way of summing it.
            let found = self.work.displacement(&self.rover, motion, &rules);
            let lasting = self.work.find_lasting(&self.rover, motion, rules.method);
            if let (Ok(found), Ok(())) = (found, lasting) {
                follow(found, motion, &self.work, &mut self.state, self.settings.habits());
            }
            if let Some(yaw) = entry.yaw {
                meet_yaw(&mut self.state, yaw, rules.noise.yaw);
            }
            for known in self.history.corrections.iter().filter(|known| known.entry == number) {
                self.state.correct_with_pose(known.pose, &known.covariance);
            }
            self.history.entries[place].state.copy_from(&self.state);
        }
    }
}
