//! Many steps in one call: a log, a plan, a simulation.

use super::Controller;
use six_wheel_kinematics::geometry::Twist;
use six_wheel_numerics::error::{Error, finite, number};
use six_wheel_numerics::threads::workers::{BETWEEN_CHECKS, IsInterrupted};

/// Output of a run, one row a step.
pub struct Steps<'a> {
    /// Steering angles [rad], joint after joint.
    pub steering: &'a mut [f64],
    /// Their rates [rad/s].
    pub steering_rates: &'a mut [f64],
    /// Wheel speeds [rad/s], wheel after wheel.
    pub speeds: &'a mut [f64],
    /// The motions they make: vx, vy, omega.
    pub twists: &'a mut [[f64; 3]],
    /// Reasons why they are not the desired motions: bits of [`super::reason`].
    pub reasons: &'a mut [u32],
}

impl Controller {
    /// Steps to all `times` [s]; the commands, given at `stamps` [s], come in their order, each before the first
    /// step that is not earlier than its stamp. The same as the calls one by one.
    ///
    /// Fails, without effect, if a stamp is not finite or later than the last step, or a time is not finite or not
    /// later than the one before it. Interrupted, the steps before that of the error are made.
    pub fn run(
        &mut self,
        stamps: &[f64],
        twists: &[[f64; 3]],
        times: &[f64],
        out: Steps<'_>,
        is_interrupted: IsInterrupted,
    ) -> Result<(), Error> {
        let mut last = self.clock;
        for (row, &time) in times.iter().enumerate() {
            finite("step_stamps", &[time]).map_err(|error| error.at_row(row))?;
            if let Some(last) = last.filter(|last| time <= *last) {
                let rule = format!("be later than the step before, at {}", number(last));
                return Err(Error::value("step_stamps", rule, number(time)).at_row(row));
            }
            last = Some(time);
        }
        for (row, &stamp) in stamps.iter().enumerate() {
            finite("stamps", &[stamp]).map_err(|error| error.at_row(row))?;
            let end = times.last().copied();
            if end.is_none_or(|end| stamp > end) {
                let rule = end.map_or_else(
                    || "be none without a step".into(),
                    |end| format!("not be later than the last step, at {}", number(end)),
                );
                return Err(Error::value("stamps", rule, number(stamp)).at_row(row));
            }
        }
        let (joints, wheels) = (self.steering.len(), self.speeds.len());
        let mut commands = stamps.iter().zip(twists).peekable();
        for (k, &time) in times.iter().enumerate() {
            if k % BETWEEN_CHECKS == BETWEEN_CHECKS - 1 && is_interrupted() {
                return Err(Error::interrupted().at_row(k));
            }
            while let Some((stamp, twist)) = commands.next_if(|(stamp, _)| **stamp <= time) {
                self.command(Twist::from(*twist), *stamp, None)?;
            }
            self.step(time, None)?;
            let (angles, speeds) = (k * joints..(k + 1) * joints, k * wheels..(k + 1) * wheels);
            out.steering[angles.clone()].copy_from_slice(&self.steering);
            out.steering_rates[angles].copy_from_slice(&self.steering_rates);
            out.speeds[speeds].copy_from_slice(&self.speeds);
            out.twists[k] = self.twist.into();
            out.reasons[k] = self.reasons;
        }
        Ok(())
    }
}
