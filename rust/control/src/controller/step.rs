//! One step of a controller.

use super::Controller;
use super::options::AlignmentPolicy;
use super::route::Route;
use super::turn::EntryLimits;
use crate::motion::goal::Goal;
use crate::motion::reason;
use crate::motion::{LimitedBy, Motion};
use six_wheel_kinematics::geometry::Twist;
use six_wheel_numerics::error::Error;

impl Controller {
    /// Moves on to the time `now` [s], the steering angles being `measured` [rad].
    ///
    /// Fails, without effect, if the time is not later than that of the last step, or an angle is not finite or far
    /// outside the rover's own range; a small excess counts as play and is clipped. Measured angles may lie beyond a
    /// steering limit: the joints return inside at their rates. A step longer than [`super::Options::max_step`] counts
    /// as one of that length.
    pub fn step(&mut self, now: f64, measured: Option<&[f64]>) -> Result<(), Error> {
        self.check_time(now)?;
        if let Some(measured) = measured {
            self.given.check_measured("measured", measured)?;
        }
        let mut reasons = self.ignored;
        self.ignored &= !reason::OUT_OF_ORDER;
        if let (None, false, Some(measured)) = (self.clock, self.placed, measured) {
            self.start_at(measured);
        }
        let (dt, paused) = self.take_time(now);
        reasons |= paused;
        self.check_joints(measured, dt);
        self.adopt_limits(dt);
        if self.halted {
            self.reasons = reasons | self.brake(dt);
            return Ok(());
        }
        let goal = self.goal(now);
        if self.stale {
            reasons |= reason::STALE;
        }
        let share = self.alignment_share();
        if share < 1.0 {
            reasons |= reason::ALIGNING;
        }
        // Joints that already turn to the newest goal need no other route.
        let settled = self.route == Route::Align && goal.as_ref().is_some_and(|goal| goal.direction == self.target);
        if self.rerouted || (self.at_rest() && self.route.needs_rest() && !settled) {
            self.rerouted = false;
            self.route = self.find_route(goal.as_ref(), dt);
        }
        reasons |= goal.as_ref().map_or(0, |goal| goal.reasons);
        let mut why = self.advance(goal.as_ref(), share, dt);
        if self.at_rest() && self.route.needs_rest() && self.stops_at_once() {
            self.route = self.find_route(goal.as_ref(), dt);
            why = self.advance(goal.as_ref(), share, dt);
        }
        self.reasons = reasons | why;
        Ok(())
    }

    /// Length of the step to `now` [s], at most the longest allowed, and the reason if it took longer.
    fn take_time(&mut self, now: f64) -> (f64, u32) {
        let longest = self.options.max_step;
        let (dt, reasons) = match self.clock.map(|last| now - last) {
            None => (self.options.period.unwrap_or(0.0), 0),
            Some(since) if since > longest => {
                // A step that is less than one longest step late is no pause.
                if since > 2.0 * longest {
                    self.clear_rates();
                }
                (longest, reason::PAUSED)
            }
            Some(since) => (since, 0),
        };
        self.clock = Some(now);
        // A stamp later than the clock counts as now.
        self.newest = self.newest.map(|newest| newest.min(now));
        self.step_before = self.last_step;
        self.last_step = dt;
        (dt, reasons)
    }

    /// Sets all rates to 0 after a pause: speed and angles stay those of the last step.
    fn clear_rates(&mut self) {
        self.speed.rate = 0.0;
        self.turn.rate = 0.0;
        self.steering_rates.fill(0.0);
    }

    /// True if stopping and turning the wheels takes no time at all.
    fn stops_at_once(&self) -> bool {
        let steering = &self.speed_bounds.limits;
        let envelope = &self.envelope;
        [steering.steering_rate, steering.steering_acceleration, envelope.rates[0].value, envelope.change.value]
            .iter()
            .all(|limit| limit.is_infinite())
    }

    /// The goal of the last command, unless that is too old.
    fn goal(&mut self, now: f64) -> Option<Goal> {
        let command = self.command.as_mut()?;
        // A stamp later than the clock counts as now: it must not prolong the life of a command.
        command.stamp = command.stamp.min(now);
        let stale = now - command.stamp > self.options.timeout;
        self.rerouted |= stale != self.stale;
        self.stale = stale;
        (!stale).then_some(command.goal)
    }

    /// Share of the desired speed that the errors of the measured steering angles allow.
    fn alignment_share(&self) -> f64 {
        let Some(align) = self.options.align else {
            return 1.0;
        };
        let error = self.joint_errors().into_iter().flatten().fold(0.0, |most: f64, error| most.max(error.abs()));
        match align {
            _ if error <= self.options.align_tolerance => 1.0,
            AlignmentPolicy::Hold => 0.0,
            AlignmentPolicy::Cosine => error.cos().max(0.0),
        }
    }

    fn advance(&mut self, goal: Option<&Goal>, share: f64, dt: f64) -> u32 {
        let mut reasons = 0;
        if !self.aligned {
            let (there, why) = self.align(goal, dt);
            reasons |= why;
            if !there {
                self.set_speeds();
                return reasons;
            }
        }
        let desired = goal.map_or(0.0, |goal| goal.speed * share);
        let mut entry = EntryLimits::NONE;
        let target = match self.route {
            Route::Along { sign } => sign * desired,
            Route::Near { sign } => {
                reasons |= reason::ALIGNING;
                sign * desired
            }
            Route::Turn { end, sign, .. } => {
                let target = sign * desired;
                entry = self.choose_envelope(end, target, dt);
                target
            }
            Route::Wait => {
                let [rate, change] = self.envelope.turn;
                reasons |= rate.reason | change.reason | reason::ALIGNING;
                // Component of the goal along the present direction.
                let along = |goal: &Goal| self.direction().dot(&(self.metric() * goal.direction));
                if self.at_rest() { 0.0 } else { desired * goal.map_or(0.0, along) }
            }
            Route::Blocked(why) => {
                reasons |= why;
                0.0
            }
            Route::Stay | Route::Align => 0.0,
        };
        if let Some(speed_bounds) = &self.pending {
            entry.speed = entry.speed.min(self.fastest_by(speed_bounds));
        }
        reasons |= entry.reasons;
        let turning = self.turn_on(goal, dt);
        reasons |= self.change_speed(target, entry, dt);
        // Without joints, a direction that turns while the body rests is no motion.
        if !(self.joints.is_empty() && self.at_rest() && self.route == Route::Stay) {
            reasons |= turning;
        }
        self.set_speeds();
        let exact = matches!(self.route, Route::Along { .. }) && self.speed == Motion::at(target);
        self.twist = match goal.filter(|_| exact && share == 1.0) {
            Some(goal) => {
                reasons = 0; // the goal is met
                goal.twist
            }
            None if self.speed.value == 0.0 => Twist::ZERO,
            None => Twist::from(self.direction() * self.speed.value),
        };
        // Also met if the twist is equal to all digits before the end of the turn.
        if share == 1.0 && goal.is_some_and(|goal| goal.twist == self.twist) { 0 } else { reasons }
    }

    /// One step of the speed towards `target` [m/s]; a change of sign takes two steps unless stopping takes no time.
    fn change_speed(&mut self, target: f64, entry: EntryLimits, dt: f64) -> u32 {
        let Motion { value, rate } = self.speed;
        if self.speed == Motion::at(target) {
            return 0;
        }
        let sign = if value < 0.0 || (value == 0.0 && target < 0.0) { -1.0 } else { 1.0 };
        let highest = self.envelope.speed.min(entry.speed).max(0.0); // a negative bound would be approached backwards
        let mut reasons = 0;
        let mut goal = target * sign;
        if goal > highest {
            goal = highest;
            reasons |= self.envelope.fastest.reason;
        }
        let rates = [0, 1].map(|k| self.envelope.rates[k].value.min(entry.rates[k]));
        let change = self.envelope.change.value;
        let forward = Motion { value: value * sign, rate: rate * sign };
        let (moved, held) = forward.step_towards(goal.max(0.0), rates, change, dt);
        let slower = usize::from(moved.rate > 0.0);
        reasons |= held.reason(self.envelope.rates[slower].reason, self.envelope.change.reason);
        if held == LimitedBy::Nothing && goal < 0.0 && rates[0].is_infinite() && change.is_infinite() {
            self.speed = Motion::default();
            return reasons | self.change_speed(target, entry, dt);
        }
        if held == LimitedBy::Nothing && goal < 0.0 {
            // At rest; the next step goes on in the other sense.
            reasons |= self.envelope.rates[0].reason | self.envelope.change.reason;
        }
        self.speed = Motion { value: moved.value * sign + 0.0, rate: moved.rate * sign + 0.0 };
        reasons
    }
}
