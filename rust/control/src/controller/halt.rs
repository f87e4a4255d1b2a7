//! A halt, and limits that change during a motion.

use super::find_route::ANGLE_TOLERANCE;
use super::route::Route;
use super::{Controller, PATIENCE, speed_bounds};
use crate::motion::Motion;
use crate::motion::envelope::{Envelope, SpeedBounds, fastest};
use crate::motion::limits::Limits;
use crate::motion::reason;
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::MAX_WHEELS;
use six_wheel_numerics::error::Error;

impl Controller {
    /// Brings the rover to rest by `halt_deceleration` from the next step on, and keeps it there. Commands are not taken
    /// any more until [`Self::release`].
    pub fn halt(&mut self) {
        self.halted = true;
        self.command = None;
        self.stale = false;
        self.route = Route::Stay;
        self.rerouted = true;
    }

    /// True after a halt, until the release.
    pub fn halted(&self) -> bool {
        self.halted
    }

    /// Ends a halt, also one by a stuck joint. Returns false, without effect, while something still moves. Nothing
    /// moves afterwards before a new command.
    pub fn release(&mut self) -> bool {
        if self.halted && !self.stopped() {
            return false;
        }
        if self.halted {
            self.following.clear();
            self.off_goal_time = PATIENCE;
        }
        self.halted = false;
        true
    }

    /// One step of a halt. Returns its reasons.
    ///
    /// The speed falls so that the fastest wheel slows down over the ground by `halt_deceleration`, the direction stays,
    /// and joints that turn brake within their limits: in this step without a limit of their acceleration.
    pub(super) fn brake(&mut self, dt: f64) -> u32 {
        let stuck = self.following.stuck;
        let reasons = reason::HALTED | stuck.map_or(0, |_| reason::JOINT_STUCK);
        if self.at_rest_with_joints() && stuck.is_some() {
            self.aligned = false;
        }
        if self.aligned {
            // The change of the turn in the envelope has shares of the body's acceleration and jerk, which do not count.
            if self.joints.is_empty() || self.filled.steering_acceleration.is_infinite() {
                self.turn.rate = 0.0;
            }
            let before = self.ground_speeds();
            self.turn_on(None, dt);
            let sign = self.speed.value.signum();
            let slowest = self.slowest(before, self.filled.halt_deceleration * dt);
            self.speed = if slowest > 0.0 { Motion::at(sign * slowest) } else { Motion::default() };
            self.twist = if slowest > 0.0 { Twist::from(self.direction() * self.speed.value) } else { Twist::ZERO };
        } else {
            self.align(None, dt);
        }
        self.set_speeds();
        reasons
    }

    /// Speed of every wheel over the ground [m/s].
    fn ground_speeds(&self) -> [f64; MAX_WHEELS] {
        let mut ground_speeds = [0.0; MAX_WHEELS];
        for (rim, (wheel, ratio)) in ground_speeds.iter_mut().zip(self.rover.wheels().iter().zip(&self.ratios)) {
            *rim = (wheel.radius * ratio * self.speed.value).abs();
        }
        ground_speeds
    }

    /// The least speed at which no wheel has slowed down over the ground by more than `allowed`, from `before` [m/s].
    fn slowest(&self, before: [f64; MAX_WHEELS], allowed: f64) -> f64 {
        let speed = self.speed.value.abs();
        let pairs = self.ground_speeds().into_iter().zip(before);
        let needed = pairs.filter(|&(now, before)| now > 0.0 && before > allowed);
        needed.map(|(now, before)| speed * (before - allowed) / now).fold(0.0, f64::max).min(speed)
    }

    /// True if neither the body nor the direction moves.
    pub(super) fn at_rest_with_joints(&self) -> bool {
        self.at_rest() && (!self.aligned || self.turn.rate == 0.0)
    }

    /// Replaces the limits, from the next step on. A motion beyond them slows down into them without a stop; command,
    /// clock and halt stay.
    ///
    /// Fails, without effect, if the rover cannot meet them.
    pub fn set_limits(&mut self, limits: Limits) -> Result<(), Error> {
        let (model, _) = self.options.model(&self.given, &limits)?;
        let filled = limits.on(&self.given);
        self.pending = Some(speed_bounds(&model, filled, &self.options));
        self.limits = limits;
        self.filled = filled;
        self.narrowed = Some(model);
        if let Some(command) = self.command
            && let Some(goal) = self.goal_of(command.twist, command.mode)
        {
            self.command = Some(super::Command { goal, ..command });
        }
        self.rerouted = true;
        Ok(())
    }

    /// Adopts new limits as soon as the present turn fits them, and the new steering limit once all joints are inside.
    pub(super) fn adopt_limits(&mut self, dt: f64) {
        if let Some(speed_bounds) = self.pending
            && self.is_ready_for(speed_bounds, dt)
        {
            self.pending = None;
            self.rerouted = true;
        }
        let Some(model) = &self.narrowed else {
            return;
        };
        let mut wheels = self.joints.iter().zip(model.steered());
        let inside = wheels.all(|(&joint, &i)| {
            let range = model.wheels()[i].steering().unwrap_or_default();
            (range.clip(self.steering[joint]) - self.steering[joint]).abs() <= ANGLE_TOLERANCE
        });
        if (inside || self.at_rest_with_joints())
            && let Some(model) = self.narrowed.take()
        {
            self.rover = model;
            if !inside {
                self.aligned = false;
                self.route = Route::Stay;
            }
            self.rerouted = true;
        }
    }

    /// Adopts the bounds of new limits and returns true, if the present turn can end within them.
    fn is_ready_for(&mut self, speed_bounds: SpeedBounds, dt: f64) -> bool {
        let old = std::mem::replace(&mut self.speed_bounds, speed_bounds);
        if !self.aligned {
            return true;
        }
        if let (Route::Turn { end, .. }, true) = (self.route, self.turn.rate != 0.0)
            && let Some((_, envelope)) = self.search(end, 0.0, dt, 1.0).best
        {
            self.enter(envelope);
            return true;
        }
        if self.turn.rate != 0.0 && self.envelope.turn[1].value.is_finite() {
            self.speed_bounds = old;
            self.rerouted = true;
            return false;
        }
        let here = self.turn.value;
        self.turn.rate = 0.0;
        let envelope = Envelope::of_direction(&self.speed_bounds, &self.arc, here);
        self.enter(envelope.for_motion(self.speed, &self.envelope));
        true
    }

    /// The highest speed in the present direction within these bounds [m/s].
    pub(super) fn fastest_by(&self, speed_bounds: &SpeedBounds) -> f64 {
        fastest(&speed_bounds.limits, &self.arc.bounds(self.turn.value, self.turn.value)).value
    }
}
