//! One step.

use super::Controller;
use super::ahead::Bridle;
use super::options::Align;
use super::way::Route;
use crate::motion::goal::Goal;
use crate::motion::reason;
use crate::motion::{Held, Motion};
use six_wheel_kinematics::geometry::Twist;
use six_wheel_numerics::error::Error;

impl Controller {
    /// Moves on to the time `now` [s], the steering angles being `measured` [rad].
    ///
    /// Fails, without effect, if the time is not later than that of the last step, or an angle is not finite or far outside
    /// the rover's own range: a little is play, and the joints start at the end of the range. Measured angles may lie beyond a
    /// limit: the joints come back inside at their rates. A step longer than the longest allowed counts as that.
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
        self.watch_joints(measured, dt);
        self.adopt_limits(dt);
        if self.halted {
            self.reasons = reasons | self.brake(dt);
            return Ok(());
        }
        let goal = self.goal(now);
        if self.stale {
            reasons |= reason::STALE;
        }
        let share = self.share();
        if share < 1.0 {
            reasons |= reason::ALIGNING;
        }
        // Joints under way to the newest goal need no other way.
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

    /// Length that the step to `now` counts for [s], and the reason if that is less than it took.
    fn take_time(&mut self, now: f64) -> (f64, u32) {
        let longest = self.options.max_step;
        let (dt, reasons) = match self.clock.map(|last| now - last) {
            None => (self.options.period.unwrap_or(0.0), 0),
            Some(since) if since > longest => {
                // A step that was merely late is not taken for a pause.
                if since > 2.0 * longest {
                    self.hold();
                }
                (longest, reason::PAUSED)
            }
            Some(since) => (since, 0),
        };
        self.clock = Some(now);
        // A stamp ahead of the clock counts as now.
        self.newest = self.newest.map(|newest| newest.min(now));
        self.step_before = self.last_step;
        self.last_step = dt;
        (dt, reasons)
    }

    /// Nothing went on meanwhile: speed and angles are those of the last step, and change from rest.
    fn hold(&mut self) {
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
        // A stamp ahead of the clock counts as now: it must not keep a command alive.
        command.stamp = command.stamp.min(now);
        let stale = now - command.stamp > self.options.timeout;
        self.rerouted |= stale != self.stale;
        self.stale = stale;
        (!stale).then_some(command.goal)
    }

    /// Share of the drive that the measured angles allow.
    fn share(&self) -> f64 {
        let Some(align) = self.options.align else {
            return 1.0;
        };
        let error = self.joint_errors().into_iter().flatten().fold(0.0, |most: f64, error| most.max(error.abs()));
        match align {
            _ if error <= self.options.align_tolerance => 1.0,
            Align::Hold => 0.0,
            Align::Cosine => error.cos().max(0.0),
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
        let wanted = goal.map_or(0.0, |goal| goal.speed * share);
        let mut bridle = Bridle::NONE;
        let target = match self.route {
            Route::Along { sign } => sign * wanted,
            Route::Near { sign } => {
                reasons |= reason::ALIGNING;
                sign * wanted
            }
            Route::Turn { end, sign, .. } => {
                let target = sign * wanted;
                bridle = self.look_ahead(end, target, dt);
                target
            }
            Route::Wait => {
                let [rate, change] = self.envelope.turn;
                reasons |= rate.reason | change.reason | reason::ALIGNING;
                // The share of the goal along the direction there is.
                let along = |goal: &Goal| self.direction().dot(&(self.metric() * goal.direction));
                if self.at_rest() { 0.0 } else { wanted * goal.map_or(0.0, along) }
            }
            Route::Blocked(why) => {
                reasons |= why;
                0.0
            }
            Route::Stay | Route::Align => 0.0,
        };
        if let Some(speed_bounds) = &self.pending {
            bridle.speed = bridle.speed.min(self.fastest_by(speed_bounds));
        }
        reasons |= bridle.reasons;
        let turning = self.turn_on(goal, dt);
        reasons |= self.change_speed(target, bridle, dt);
        // Without joints a direction that still turns at rest is nothing.
        if !(self.joints.is_empty() && self.at_rest() && self.route == Route::Stay) {
            reasons |= turning;
        }
        self.set_speeds();
        let exact = matches!(self.route, Route::Along { .. }) && self.speed == Motion::at(target);
        self.twist = match goal.filter(|_| exact && share == 1.0) {
            Some(goal) => {
                reasons = 0; // met, whatever it took
                goal.twist
            }
            None if self.speed.value == 0.0 => Twist::ZERO,
            None => Twist::from(self.direction() * self.speed.value),
        };
        // Met to the last digit on a turn to a direction next to it.
        if share == 1.0 && goal.is_some_and(|goal| goal.twist == self.twist) { 0 } else { reasons }
    }

    /// Speeds up or slows down, never through rest in one go.
    fn change_speed(&mut self, target: f64, bridle: Bridle, dt: f64) -> u32 {
        let Motion { value, rate } = self.speed;
        if self.speed == Motion::at(target) {
            return 0;
        }
        let sign = if value < 0.0 || (value == 0.0 && target < 0.0) { -1.0 } else { 1.0 };
        let highest = self.envelope.speed.min(bridle.speed).max(0.0); // never below rest, where a stop would have no end
        let mut reasons = 0;
        let mut goal = target * sign;
        if goal > highest {
            goal = highest;
            reasons |= self.envelope.fastest.reason;
        }
        let rates = [0, 1].map(|k| self.envelope.rates[k].value.min(bridle.rates[k]));
        let change = self.envelope.change.value;
        let forward = Motion { value: value * sign, rate: rate * sign };
        let (moved, held) = forward.approach(goal.max(0.0), rates, change, dt);
        let slower = usize::from(moved.rate > 0.0);
        reasons |= held.reason(self.envelope.rates[slower].reason, self.envelope.change.reason);
        if held == Held::No && goal < 0.0 && rates[0].is_infinite() && change.is_infinite() {
            self.speed = Motion::default();
            return reasons | self.change_speed(target, bridle, dt);
        }
        if held == Held::No && goal < 0.0 {
            // At rest, and on in the other sense with the next step.
            reasons |= self.envelope.rates[0].reason | self.envelope.change.reason;
        }
        self.speed = Motion { value: moved.value * sign + 0.0, rate: moved.rate * sign + 0.0 };
        reasons
    }
}
