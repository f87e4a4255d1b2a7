//! One step.

use super::envelope::Envelope;
use super::goal::Goal;
use super::motion::{Held, Motion};
use super::options::Align;
use super::reason;
use super::way::Route;
use super::{Controller, Into};
use six_wheel_kinematics::geometry::Twist;
use six_wheel_numerics::error::Error;

/// Pieces of the arc ahead that are tried, each half as long.
const PIECES: usize = 32;

/// What the speed is bounded by beside the envelope, while the motion gets ready for another one.
#[derive(Clone, Copy)]
struct Bridle {
    speed: f64,
    rates: [f64; 2],
    reasons: u32,
}

impl Bridle {
    const NONE: Self = Self { speed: f64::INFINITY, rates: [f64::INFINITY; 2], reasons: 0 };
}

impl Controller {
    /// Moves on to the time `now` [s], the steering angles being `measured` [rad].
    ///
    /// Fails, without effect, if the time is not later than that of the last step, or an angle is not finite. Measured
    /// angles may lie beyond a limit: the joints come back inside at their rates. A step longer than the longest allowed counts as that.
    pub fn step(&mut self, now: f64, measured: Option<&[f64]>) -> Result<(), Error> {
        self.check_time(now)?;
        if let Some(measured) = measured {
            self.check_numbers("measured", measured)?;
        }
        let mut reasons = self.ignored;
        self.ignored &= !reason::OUT_OF_ORDER;
        let since = self.clock.map(|last| now - last);
        if let (None, None, None, Some(measured)) = (since, &self.start, self.moving, measured) {
            self.steering.copy_from_slice(measured);
        }
        let dt = match since {
            None => self.options.period.unwrap_or(0.0),
            Some(since) if since > self.options.max_step => {
                reasons |= reason::PAUSED;
                // A step that was merely late is not taken for a pause.
                if since > 2.0 * self.options.max_step {
                    self.hold();
                }
                self.options.max_step
            }
            Some(since) => since,
        };
        self.clock = Some(now);
        self.last_step = dt;
        let goal = self.goal(now);
        if self.stale {
            reasons |= reason::STALE;
        }
        let share = self.share(measured);
        if share < 1.0 {
            reasons |= reason::ALIGNING;
        }
        if self.rerouted || (self.at_rest() && self.route.needs_rest()) {
            self.route = self.find_route(goal.as_ref());
            self.rerouted = false;
        }
        reasons |= goal.as_ref().map_or(0, |goal| goal.reasons);
        let mut why = self.advance(goal.as_ref(), share, dt);
        if self.at_rest() && self.route.needs_rest() && self.stops_at_once() {
            self.route = self.find_route(goal.as_ref());
            why = self.advance(goal.as_ref(), share, dt);
        }
        self.reasons = reasons | why;
        Ok(())
    }

    /// Nothing went on meanwhile: speed and angles are those of the last step, and change from rest.
    fn hold(&mut self) {
        self.speed.rate = 0.0;
        self.turn.rate = 0.0;
        self.steering_rates.fill(0.0);
    }

    /// Whether stopping and turning the wheels takes no time at all.
    fn stops_at_once(&self) -> bool {
        let steering = &self.room.limits;
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
    fn share(&self, measured: Option<&[f64]>) -> f64 {
        let (Some(measured), Some(align)) = (measured, self.options.align) else {
            return 1.0;
        };
        let errors = measured.iter().zip(&self.steering);
        let error = errors.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
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
            Route::Turn { end, sign } => {
                let target = sign * wanted;
                bridle = self.look_ahead(end, target, dt);
                target
            }
            Route::Wait => {
                let [rate, change] = self.envelope.turn;
                reasons |= rate.reason | change.reason;
                let stop = self.speed.stop(self.envelope.change.value);
                stop.clamp(-wanted, wanted)
            }
            Route::Blocked(why) => {
                reasons |= why;
                0.0
            }
            Route::Stay | Route::Align => 0.0,
        };
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
        reasons
    }

    /// Each joint on its own way, the body at rest. Whether the drive may begin.
    fn align(&mut self, goal: Option<&Goal>, dt: f64) -> (bool, u32) {
        let limits = &self.room.limits;
        let (rates, change) = ([limits.steering_rate; 2], limits.steering_acceleration);
        let at_once = limits.steering_rate.is_infinite() && change.is_infinite();
        let onwards = self.route == Route::Align;
        let (mut there, mut moved, mut reasons) = (true, false, 0);
        for (k, angle) in self.steering.iter_mut().enumerate() {
            let motion = Motion { value: *angle, rate: self.steering_rates[k] };
            let target = match self.joints.iter().position(|&joint| joint == k) {
                _ if onwards => self.targets[k],
                Some(place) => {
                    let wheel = &self.rover.wheels()[self.rover.steered()[place]];
                    let range = wheel.steering().unwrap_or_default();
                    range.clip(motion.stop(change))
                }
                // Held straight by the mode.
                None => 0.0,
            };
            let (motion, held) = motion.approach(target, rates, change, dt);
            moved |= motion.value != *angle;
            there &= held == Held::No;
            reasons |= match held {
                Held::No => 0,
                Held::Rate => reason::STEERING_RATE,
                Held::Change => reason::STEERING_ACCELERATION,
            };
            *angle = motion.value;
            self.steering_rates[k] = motion.rate;
        }
        self.twist = Twist::ZERO;
        let Some(goal) = goal.filter(|_| onwards) else {
            return (false, reasons);
        };
        if there {
            self.settle(goal.direction);
            self.rest_turn();
            self.route = Route::Along { sign: 1.0 };
        }
        let go = there && (at_once || !moved);
        (go, if go { 0 } else { reasons | reason::ALIGNING })
    }

    /// Takes the envelope of the piece of arc ahead that promises the quickest turn, if the motion fits into it;
    /// otherwise the bounds that make it fit.
    fn look_ahead(&mut self, end: f64, target: f64, dt: f64) -> Bridle {
        let here = self.turn.value;
        let left = self.envelope.end - here;
        let present =
            if self.envelope.turning && left * (end - here) > 0.0 { self.envelope.promise(here, dt) } else { -1.0 };
        let used = present < 0.0 || (here - self.entered).abs() >= left.abs();
        let enough = self.envelope.speed >= target.abs();
        if enough && !used {
            return Bridle { speed: self.ahead, ..Bridle::NONE };
        }
        if enough && present >= 0.0 && left.abs() >= (end - here).abs() {
            return Bridle::NONE;
        }
        let sign = if self.speed.value < 0.0 { -1.0 } else { 1.0 };
        let peak = if self.speed.rate * sign > 0.0 {
            self.speed.stop(self.envelope.change.value) * sign
        } else {
            self.speed.value * sign
        };
        let needed = peak.max(target.abs());
        let mut best: Option<(f64, Envelope)> = None;
        let mut whole: Option<Envelope> = None;
        let mut last = 0.0;
        let mut length = end - here;
        for k in 0..PIECES {
            let piece_end = if k == 0 { end } else { here + length };
            if piece_end == here {
                break;
            }
            let envelope = Envelope::new(&self.room, &self.arc, here, piece_end, needed);
            whole.get_or_insert(envelope);
            let fits = envelope.holds_turn(self.turn) && envelope.holds_speed(self.speed);
            let promise = envelope.promise(here, dt);
            if fits && best.is_none_or(|(most, _)| promise > most) {
                best = Some((promise, envelope));
            }
            if promise < last || (fits && envelope.turn[0].value.is_infinite()) {
                break;
            }
            last = promise;
            length /= 2.0;
        }
        if let Some((promise, envelope)) = best
            && (promise > present || used)
        {
            self.envelope = envelope;
            self.entered = here;
            self.settled = false;
        }
        let Some(whole) = whole else {
            return Bridle::NONE;
        };
        let cap = whole.fastest.value;
        self.ahead = cap;
        let reasons = if cap < needed { whole.fastest.reason } else { 0 };
        if best.is_some() {
            return Bridle { speed: cap, rates: [f64::INFINITY; 2], reasons };
        }
        Bridle {
            speed: cap,
            rates: whole.rates.map(|rate| rate.value),
            reasons: reasons | whole.turn[0].reason | whole.turn[1].reason,
        }
    }

    /// Turns the direction as far as the envelope goes, or brings the turn to rest.
    fn turn_on(&mut self, goal: Option<&Goal>, dt: f64) -> u32 {
        if self.joints.is_empty() && self.at_rest() {
            self.turn.rate = 0.0; // nothing turns
        }
        let resting = self.turn.rate == 0.0;
        if resting {
            self.steering_rates.fill(0.0);
        }
        let wanted = match self.route {
            Route::Turn { end, sign } => Some((end, sign)),
            _ => None,
        };
        if wanted.is_none() && resting {
            if !self.settled {
                self.rest_turn();
            }
            return 0;
        }
        let (limits, change) = self.envelope.turn_limits();
        let ahead = wanted.filter(|(end, _)| {
            let way = self.envelope.end - self.turn.value;
            self.envelope.turning && way * (end - self.turn.value) > 0.0
        });
        let target = if let Some((end, _)) = ahead {
            let [near, far] = [self.envelope.end, end].map(|end| (end - self.turn.value).abs());
            if near < far { self.envelope.end } else { end }
        } else if resting {
            self.turn.value
        } else {
            self.turn.stop(change)
        };
        let before = self.turn;
        let held;
        (self.turn, held) = self.turn.approach(target, limits, change, dt);
        let mut reasons = match held {
            Held::No => 0,
            Held::Rate => self.envelope.turn[0].reason,
            Held::Change => self.envelope.turn[1].reason,
        };
        if let (Some((end, sign)), Some(goal)) = (wanted, goal) {
            if self.turn == Motion::at(end) {
                // Until the step is over the envelope of the turn holds.
                self.settle(goal.direction * sign);
                self.route = Route::Along { sign };
                self.steering_rates.fill(0.0);
                return reasons;
            }
            // On the way: something holds it, if only the end of this envelope.
            reasons |= self.envelope.turn[0].reason | self.envelope.turn[1].reason;
        } else if self.turn.rate == 0.0 {
            self.rerouted |= self.route == Route::Wait;
        }
        if self.turn != before {
            self.solve(Twist::from(self.direction()), Into::Steering);
            let rates = self.arc.steering_rates(&self.rover, self.turn.value);
            self.steering_rates.fill(0.0);
            for (rate, &joint) in rates.zip(&self.joints) {
                self.steering_rates[joint] = rate * self.turn.rate;
            }
        }
        reasons
    }

    /// Takes the envelope of the direction there is, as soon as the speed fits into it.
    fn rest_turn(&mut self) {
        let here = self.turn.value;
        let envelope = Envelope::new(&self.room, &self.arc, here, here, 0.0);
        if envelope.holds_speed(self.speed) {
            self.envelope = envelope;
            self.settled = true;
        }
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
        reasons |= match held {
            Held::No => 0,
            Held::Rate => self.envelope.rates[slower].reason,
            Held::Change => self.envelope.change.reason,
        };
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

impl Route {
    /// Whether there is something to do once the body stands.
    fn needs_rest(self) -> bool {
        matches!(self, Self::Turn { .. } | Self::Wait | Self::Blocked(_))
    }
}
