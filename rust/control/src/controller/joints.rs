//! Joint commands of a motion: steering angles and wheel speeds, and checks of angles that are handed over.

use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::{Inputs, MAX_WHEELS};
use six_wheel_kinematics::wheels::Wheel;
use six_wheel_numerics::error::{Error, finite, numbers};

use super::Controller;

/// Play and noise of a measured steering angle beyond its range [rad]; an angle farther off is an error of wiring or units.
const MEASURED_SLACK: f64 = 0.05;

/// The angles to write.
#[derive(Clone, Copy)]
pub(super) enum Into {
    Steering,
    Candidates,
}

impl Controller {
    /// Fails unless there is an angle for every joint, near its range at least.
    pub(super) fn check_angles(&self, argument: &'static str, angles: &[f64]) -> Result<(), Error> {
        self.check_numbers(argument, angles)?;
        let mut joints = self.joints.iter().zip(self.rover.steered());
        joints.try_for_each(|(&joint, &i)| check_angle(argument, &self.rover.wheels()[i], angles, joint))
    }

    /// Fails unless there is an angle for every joint, near the rover's own range at least.
    pub(super) fn check_measured(&self, measured: &[f64]) -> Result<(), Error> {
        self.check_numbers("measured", measured)?;
        let mut joints = self.given.steered().iter().enumerate();
        joints.try_for_each(|(joint, &i)| check_angle("measured", &self.given.wheels()[i], measured, joint))
    }

    /// The joints start at the measured angles, or at the end of the rover's own range that is nearer.
    pub(super) fn start_at(&mut self, measured: &[f64]) {
        for ((angle, &measured), &i) in self.steering.iter_mut().zip(measured).zip(self.given.steered()) {
            *angle = self.given.wheels()[i].steering().unwrap_or_default().clip(measured);
        }
    }

    /// Fails unless there is a finite angle for every joint.
    fn check_numbers(&self, argument: &'static str, angles: &[f64]) -> Result<(), Error> {
        if angles.len() != self.steering.len() {
            let rule = format!("have {} angles, one per steered wheel", self.steering.len());
            return Err(Error::value(argument, rule, angles.len().to_string()));
        }
        finite(argument, angles)
    }

    /// Brings the angles into the ranges of their joints.
    pub(super) fn set_angles_in_range(&mut self) {
        for (&joint, &i) in self.joints.iter().zip(self.rover.steered()) {
            let range = self.rover.wheels()[i].steering().unwrap_or_default();
            self.steering[joint] = range.clip(self.steering[joint]);
        }
    }

    /// Angles of a twist, from the present angles; where they become those of the joints, its wheel speeds too.
    pub(super) fn solve(&mut self, twist: Twist, into: Into) {
        let count = self.joints.len();
        let (mut previous, mut angles) = ([0.0; MAX_WHEELS], [0.0; MAX_WHEELS]);
        for (value, &joint) in previous.iter_mut().zip(&self.joints) {
            *value = self.steering[joint];
        }
        let inputs = Inputs { previous: Some(&previous[..count]), ..Inputs::default() };
        let angles = &mut angles[..count];
        // The speeds are those of the last step: they are set anew at the end of every step.
        let (joints, ratios) = match into {
            Into::Steering => (&mut self.steering, &mut self.ratios),
            Into::Candidates => (&mut self.candidates, &mut self.speeds),
        };
        self.rover.solve(twist, inputs, angles, ratios);
        joints.fill(0.0);
        for (angle, &joint) in angles.iter().zip(&self.joints) {
            joints[joint] = *angle;
        }
    }

    /// Wheel speeds of the motion, with what turning the wheels about their pivots asks of those with scrub.
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

/// Fails unless the angle of this joint is near the range of its wheel at least.
fn check_angle(argument: &'static str, wheel: &Wheel, angles: &[f64], joint: usize) -> Result<(), Error> {
    let range = wheel.steering().unwrap_or_default();
    if (angles[joint] - range.clip(angles[joint])).abs() <= MEASURED_SLACK {
        return Ok(());
    }
    let rule = format!("be inside the steering range, {range}, of wheel {:?} (to {MEASURED_SLACK} rad)", wheel.name);
    Err(Error::value(argument, rule, numbers(angles)))
}
