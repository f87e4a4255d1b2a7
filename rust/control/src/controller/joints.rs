//! Joint commands of a motion: steering angles and wheel speeds.

use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::{Inputs, MAX_WHEELS};

use super::Controller;

/// The array that solved angles are written to.
#[derive(Clone, Copy)]
pub(super) enum SolveTarget {
    Steering,
    Candidates,
}

impl Controller {
    /// Sets the angles of the joints, clipped to the rover's own ranges.
    pub(super) fn start_at(&mut self, angles: &[f64]) {
        self.steering.copy_from_slice(angles);
        self.given.clip_steering(&mut self.steering);
    }

    /// Clips the angles to the ranges of their joints.
    pub(super) fn set_angles_in_range(&mut self) {
        for (&joint, &i) in self.joints.iter().zip(self.rover.steered()) {
            let range = self.rover.wheels()[i].steering().unwrap_or_default();
            self.steering[joint] = range.clip(self.steering[joint]);
        }
    }

    /// Solves for the angles of a twist, nearest to the present ones; for [`SolveTarget::Steering`] for its wheel
    /// speeds too.
    pub(super) fn solve(&mut self, twist: Twist, into: SolveTarget) {
        let count = self.joints.len();
        let (mut previous, mut angles) = ([0.0; MAX_WHEELS], [0.0; MAX_WHEELS]);
        for (value, &joint) in previous.iter_mut().zip(&self.joints) {
            *value = self.steering[joint];
        }
        let inputs = Inputs { previous: Some(&previous[..count]), ..Inputs::default() };
        let angles = &mut angles[..count];
        // The speeds are those of the last step: they are set anew at the end of every step.
        let (joints, ratios) = match into {
            SolveTarget::Steering => (&mut self.steering, &mut self.ratios),
            SolveTarget::Candidates => (&mut self.candidates, &mut self.speeds),
        };
        self.rover.solve(twist, inputs, angles, ratios);
        joints.fill(0.0);
        for (angle, &joint) in angles.iter().zip(&self.joints) {
            joints[joint] = *angle;
        }
    }

    /// Sets the wheel speeds of the motion; wheels with scrub also roll by their steering rate.
    pub(super) fn set_speeds(&mut self) {
        for (speed, ratio) in self.speeds.iter_mut().zip(&self.ratios) {
            *speed = self.speed.value * ratio;
        }
        for (&joint, &i) in self.joints.iter().zip(self.rover.steered()) {
            let wheel = &self.rover.wheels()[i];
            if wheel.scrub != 0.0 {
                self.speeds[i] -= wheel.scrub * self.steering_rates[joint] / wheel.radius;
            }
        }
    }
}
