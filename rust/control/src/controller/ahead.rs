//! The envelope of the turn ahead, and the turn inside it.

use super::Controller;
use super::joints::Into;
use super::way::Route;
use crate::motion::Motion;
use crate::motion::envelope::Envelope;
use crate::motion::goal::Goal;
use six_wheel_kinematics::geometry::Twist;

/// Pieces of the arc ahead that are tried, each half as long.
const PIECES: usize = 32;

/// Time that a turn may take while the body speeds up [s]: the quicker the turn, the less of the acceleration is left.
const SHORT_TURN: f64 = 0.1;

/// Share of the speed asked for from which on the turn goes first again: a goal that moves would be followed late for good.
const NEARLY: f64 = 0.9;

/// Bounds of the speed beside the envelope, while the motion gets ready for another one.
#[derive(Clone, Copy)]
pub(super) struct Bridle {
    pub speed: f64,
    pub rates: [f64; 2],
    pub reasons: u32,
}

impl Bridle {
    pub const NONE: Self = Self { speed: f64::INFINITY, rates: [f64::INFINITY; 2], reasons: 0 };
}

/// Envelopes of the pieces of arc ahead.
pub(super) struct Ahead {
    /// The one that promises the quickest turn of those that the motion fits into, and its promise [rad/s].
    pub best: Option<(f64, Envelope)>,
    /// That of all the way.
    pub whole: Option<Envelope>,
    /// The speed asked of them [m/s].
    pub needed: f64,
}

impl Controller {
    /// Takes the envelope of the piece of arc ahead that promises the quickest turn, if the motion fits into it;
    /// otherwise the bounds that make it fit.
    pub(super) fn look_ahead(&mut self, end: f64, target: f64, dt: f64) -> Bridle {
        let here = self.turn.value;
        let left = self.envelope.end - here;
        let present =
            if self.envelope.turning && left * (end - here) > 0.0 { self.envelope.promise(here, dt) } else { -1.0 };
        let used = present < 0.0 || (here - self.entered).abs() >= left.abs();
        let enough = self.envelope.speed >= target.abs();
        if self.swung || (enough && !used) {
            self.swung = false;
            return Bridle { speed: self.ahead, ..Bridle::NONE };
        }
        if enough && present >= 0.0 && left.abs() >= (end - here).abs() {
            return Bridle::NONE;
        }
        let Ahead { best, whole, needed } = self.search(end, target, dt, 1.0);
        if let Some((promise, envelope)) = best
            && (promise > present || used || !enough)
        {
            self.enter(envelope);
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
        // A speed that new limits do not allow comes down before anything is made ready for a turn.
        let rates = if self.speed.value.abs() > self.envelope.speed {
            Bridle::NONE.rates
        } else {
            whole.rates.map(|rate| rate.value)
        };
        Bridle { speed: cap, rates, reasons: reasons | whole.turn[0].reason | whole.turn[1].reason }
    }

    /// Takes an envelope that begins where the turn is.
    pub(super) fn enter(&mut self, envelope: Envelope) {
        self.envelope = envelope;
        self.entered = self.turn.value;
        self.settled = false;
    }

    /// The envelopes from here to `end` for a speed of `target` [m/s], with this share of the change of the turn.
    pub(super) fn search(&self, end: f64, target: f64, dt: f64, share: f64) -> Ahead {
        let here = self.turn.value;
        let sign = if self.speed.value < 0.0 { -1.0 } else { 1.0 };
        let peak = if self.speed.rate * sign > 0.0 {
            self.speed.stop(self.envelope.change.value) * sign
        } else {
            self.speed.value * sign
        };
        let needed = peak.max(target.abs());
        // A short turn leaves the rest of the acceleration for speeding up.
        let speeds_up = self.speed.value.abs() < NEARLY * target.abs();
        let time = if speeds_up { dt.max(SHORT_TURN) } else { dt };
        let useful = ((end - here).abs() / time).max(self.turn.rate.abs());
        let mut ahead = Ahead { best: None, whole: None, needed };
        let mut last = 0.0;
        let mut length = end - here;
        for k in 0..PIECES {
            let piece_end = if k == 0 { end } else { here + length };
            if piece_end == here {
                break;
            }
            let mut envelope = Envelope::new(&self.speed_bounds, &self.arc, [here, piece_end], needed, useful);
            envelope.turn[1].value *= share;
            ahead.whole.get_or_insert(envelope);
            let fits = envelope.holds_turn(self.turn) && envelope.holds_speed(self.speed);
            let promise = envelope.promise(here, dt);
            if fits && ahead.best.is_none_or(|(most, _)| promise > most) {
                ahead.best = Some((promise, envelope));
            }
            if promise < last || (fits && (envelope.turn[0].value.is_infinite() || promise >= useful)) {
                break;
            }
            last = promise;
            length /= 2.0;
        }
        ahead
    }

    /// Turns the direction as far as the envelope goes, or brings the turn to rest.
    pub(super) fn turn_on(&mut self, goal: Option<&Goal>, dt: f64) -> u32 {
        if self.joints.is_empty() && self.at_rest() {
            self.turn.rate = 0.0; // nothing turns
        }
        let resting = self.turn.rate == 0.0;
        if resting {
            self.steering_rates.fill(0.0);
        }
        let wanted = match self.route {
            Route::Turn { end, sign, exact } => Some((end, sign, exact)),
            _ => None,
        };
        if wanted.is_none() && resting {
            if !self.settled {
                self.rest_turn();
            }
            return 0;
        }
        let [rate, change] = self.envelope.turn.map(|cap| cap.value);
        let ahead = wanted.filter(|(end, ..)| {
            let way = self.envelope.end - self.turn.value;
            self.envelope.turning && way * (end - self.turn.value) > 0.0
        });
        let target = if let Some((end, ..)) = ahead {
            let [near, far] = [self.envelope.end, end].map(|end| (end - self.turn.value).abs());
            if near < far { self.envelope.end } else { end }
        } else if resting {
            self.turn.value
        } else {
            self.turn.stop(change)
        };
        let before = self.turn;
        let held;
        (self.turn, held) = self.turn.approach(target, [rate; 2], change, dt);
        let mut reasons = held.reason(self.envelope.turn[0].reason, self.envelope.turn[1].reason);
        if let (Some((end, sign, exact)), Some(goal)) = (wanted, goal) {
            self.rerouted |= !exact;
            if exact && self.turn == Motion::at(end) {
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
            self.turn_joints();
        }
        reasons
    }

    /// Gives the joints the angles and rates of the turn.
    fn turn_joints(&mut self) {
        self.solve(Twist::from(self.direction()), Into::Steering);
        let rates = self.arc.steering_rates(&self.rover, self.turn.value);
        self.steering_rates.fill(0.0);
        for (rate, &joint) in rates.zip(&self.joints) {
            self.steering_rates[joint] = rate * self.turn.rate;
        }
    }

    /// Takes the envelope of the direction there is, as soon as the speed fits into it.
    pub(super) fn rest_turn(&mut self) {
        let here = self.turn.value;
        let envelope = Envelope::of_direction(&self.speed_bounds, &self.arc, here);
        if envelope.holds_speed(self.speed) {
            self.envelope = envelope;
            self.settled = true;
        }
    }
}
