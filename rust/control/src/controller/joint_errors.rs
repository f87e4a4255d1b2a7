//! Following errors of the steering joints: measured less commanded angles, and the halt by a stuck joint.

use super::Controller;
use six_wheel_kinematics::geometry::wrap_angle;

impl Controller {
    /// Measured less last commanded angles [rad], if the last step was given any; of a joint without ends within half a
    /// turn.
    pub fn joint_errors(&self) -> Option<&[f64]> {
        self.following.measured.then_some(&self.following.errors)
    }

    /// The joint that is stuck, or else the one with the largest error above the tolerance.
    pub fn worst_joint(&self) -> Option<usize> {
        let errors = || self.joint_errors().into_iter().flatten().map(|error| error.abs()).enumerate();
        let worst = || errors().filter(|(_, error)| *error > self.options.align_tolerance);
        self.following.stuck.or_else(|| Some(worst().max_by(|(_, a), (_, b)| a.total_cmp(b))?.0))
    }

    /// Records the errors of the measured angles [rad], and halts if an error has exceeded its bound for too long.
    pub(super) fn check_joints(&mut self, measured: Option<&[f64]>, dt: f64) {
        self.following.measured = measured.is_some();
        let Some(measured) = measured else {
            return;
        };
        let (bound, longest) = (self.options.following_error, self.options.following_time);
        let bound = bound.filter(|_| longest.is_some()).unwrap_or(f64::INFINITY);
        let rests = self.at_rest_with_joints();
        let mut found: Option<usize> = None;
        for (k, &angle) in measured.iter().enumerate() {
            let wheel = &self.given.wheels()[self.given.steered()[k]];
            let mut error = angle - self.steering[k];
            if wheel.steering().is_some_and(|range| range.lower.is_infinite() && range.upper.is_infinite()) {
                error = wrap_angle(error);
            }
            let following = &mut self.following;
            following.errors[k] = error;
            let before = following.beyond[k].map(|time| time + dt);
            following.beyond[k] = (error.abs() > bound).then(|| before.unwrap_or(0.0));
            let late = following.beyond[k].zip(longest).is_some_and(|(time, longest)| time >= longest);
            if late {
                let larger = |other: usize| following.errors[other].abs() >= error.abs();
                found = found.filter(|&other| larger(other)).or(Some(k));
            }
            if following.holds[k].map_or(late, |_| !rests) {
                // The measured angle in the whole turn of the command, clipped to the range.
                following.holds[k] = Some(wheel.steering().unwrap_or_default().clip(self.steering[k] + error));
            }
        }
        if let Some(joint) = found {
            self.following.stuck.get_or_insert(joint);
            self.halt();
        }
    }
}
