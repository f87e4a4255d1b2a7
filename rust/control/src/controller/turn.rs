//! The turn of the direction of motion along its arc: the choice of its envelope, and one step inside that.

use super::Controller;
use super::joints::SolveTarget;
use super::route::Route;
use crate::motion::Motion;
use crate::motion::envelope::Envelope;
use crate::motion::goal::Goal;
use six_wheel_kinematics::geometry::Twist;

/// Most pieces of the rest of the arc that are tried, each half as long as the one before.
const PIECES: usize = 32;

/// Least time for a turn while the body speeds up [s]: the quicker the turn, the less acceleration is left along the
/// motion.
const SHORT_TURN: f64 = 0.1;

/// Share of the desired speed above which [`SHORT_TURN`] no longer slows down the turn: it would lag behind a moving
/// goal for good.
const NEARLY: f64 = 0.9;

/// Limits of the speed in addition to the envelope, which bring the motion into another envelope.
#[derive(Clone, Copy)]
pub(super) struct EntryLimits {
    /// Highest speed [m/s].
    pub speed: f64,
    /// Highest change of the speed, slowing down and speeding up [m/s²].
    pub rates: [f64; 2],
    /// Bits of [`crate::motion::reason`].
    pub reasons: u32,
}

impl EntryLimits {
    pub const NONE: Self = Self { speed: f64::INFINITY, rates: [f64::INFINITY; 2], reasons: 0 };
}

/// Envelopes of pieces of the rest of the arc.
pub(super) struct EnvelopeSearch {
    /// Of the envelopes that the motion is inside of, the one with the highest guaranteed rate, and that rate [rad/s].
    pub best: Option<(f64, Envelope)>,
    /// The envelope of the whole rest of the arc.
    pub whole: Option<Envelope>,
    /// Speed for which they were computed [m/s].
    pub needed: f64,
}

impl Controller {
    /// Enters the envelope with the highest guaranteed rate of turn if the motion is inside of it; otherwise returns
    /// the limits of the speed that bring the motion inside.
    pub(super) fn choose_envelope(&mut self, end: f64, target: f64, dt: f64) -> EntryLimits {
        let here = self.turn.value;
        let left = self.envelope.end - here;
        let present = if self.envelope.turning && left * (end - here) > 0.0 {
            self.envelope.guaranteed_rate(here, dt)
        } else {
            -1.0
        };
        let used = present < 0.0 || (here - self.entry_angle).abs() >= left.abs();
        let enough = self.envelope.speed >= target.abs();
        if self.plane_changed || (enough && !used) {
            self.plane_changed = false;
            return EntryLimits { speed: self.turn_speed, ..EntryLimits::NONE };
        }
        if enough && present >= 0.0 && left.abs() >= (end - here).abs() {
            return EntryLimits::NONE;
        }
        let EnvelopeSearch { best, whole, needed } = self.search(end, target, dt, 1.0);
        if let Some((guaranteed_rate, envelope)) = best
            && (guaranteed_rate > present || used || !enough)
        {
            self.enter(envelope);
        }
        let Some(whole) = whole else {
            return EntryLimits::NONE;
        };
        let highest = whole.fastest.value;
        self.turn_speed = highest;
        let reasons = if highest < needed { whole.fastest.reason } else { 0 };
        if best.is_some() {
            return EntryLimits { speed: highest, rates: [f64::INFINITY; 2], reasons };
        }
        // A speed above new limits comes down first.
        let rates = if self.speed.value.abs() > self.envelope.speed {
            EntryLimits::NONE.rates
        } else {
            whole.rates.map(|rate| rate.value)
        };
        EntryLimits { speed: highest, rates, reasons: reasons | whole.turn[0].reason | whole.turn[1].reason }
    }

    /// Enters an envelope that begins at the present angle of the arc.
    pub(super) fn enter(&mut self, envelope: Envelope) {
        self.envelope = envelope;
        self.entry_angle = self.turn.value;
        self.is_direction_envelope = false;
    }

    /// The envelopes from here to `end` for a speed of `target` [m/s], with this share of the change of the turn.
    pub(super) fn search(&self, end: f64, target: f64, dt: f64, share: f64) -> EnvelopeSearch {
        let here = self.turn.value;
        let sign = if self.speed.value < 0.0 { -1.0 } else { 1.0 };
        let peak = if self.speed.rate * sign > 0.0 {
            self.speed.stop(self.envelope.change.value) * sign
        } else {
            self.speed.value * sign
        };
        let needed = peak.max(target.abs());
        // A rate no higher than needed for the turn leaves acceleration for speeding up.
        let speeds_up = self.speed.value.abs() < NEARLY * target.abs();
        let time = if speeds_up { dt.max(SHORT_TURN) } else { dt };
        let useful = ((end - here).abs() / time).max(self.turn.rate.abs());
        let mut found = EnvelopeSearch { best: None, whole: None, needed };
        let mut last = 0.0;
        let mut length = end - here;
        for k in 0..PIECES {
            let piece_end = if k == 0 { end } else { here + length };
            if piece_end == here {
                break;
            }
            let mut envelope = Envelope::new(&self.speed_bounds, &self.arc, [here, piece_end], needed, useful);
            envelope.turn[1].value *= share;
            found.whole.get_or_insert(envelope);
            let fits = envelope.holds_turn(self.turn) && envelope.holds_speed(self.speed);
            let guaranteed_rate = envelope.guaranteed_rate(here, dt);
            if fits && found.best.is_none_or(|(most, _)| guaranteed_rate > most) {
                found.best = Some((guaranteed_rate, envelope));
            }
            if guaranteed_rate < last || (fits && (envelope.turn[0].value.is_infinite() || guaranteed_rate >= useful)) {
                break;
            }
            last = guaranteed_rate;
            length /= 2.0;
        }
        found
    }

    /// One step of the turn, towards the goal or the end of the envelope, or to rest. Returns its reasons.
    pub(super) fn turn_on(&mut self, goal: Option<&Goal>, dt: f64) -> u32 {
        if self.joints.is_empty() && self.at_rest() {
            self.turn.rate = 0.0; // without joints and speed the direction may jump
        }
        let resting = self.turn.rate == 0.0;
        if resting {
            self.steering_rates.fill(0.0);
        }
        let desired = match self.route {
            Route::Turn { end, sign, exact } => Some((end, sign, exact)),
            _ => None,
        };
        if desired.is_none() && resting {
            if !self.is_direction_envelope {
                self.rest_turn();
            }
            return 0;
        }
        let [rate, change] = self.envelope.turn.map(|highest| highest.value);
        let towards = desired.filter(|(end, ..)| {
            let left = self.envelope.end - self.turn.value;
            self.envelope.turning && left * (end - self.turn.value) > 0.0
        });
        let target = if let Some((end, ..)) = towards {
            let [near, far] = [self.envelope.end, end].map(|end| (end - self.turn.value).abs());
            if near < far { self.envelope.end } else { end }
        } else if resting {
            self.turn.value
        } else {
            self.turn.stop(change)
        };
        let before = self.turn;
        let held;
        (self.turn, held) = self.turn.step_towards(target, [rate; 2], change, dt);
        let mut reasons = held.reason(self.envelope.turn[0].reason, self.envelope.turn[1].reason);
        if let (Some((end, sign, exact)), Some(goal)) = (desired, goal) {
            self.rerouted |= !exact;
            if exact && self.turn == Motion::at(end) {
                // The envelope of the turn stays in force until the end of the step.
                self.set_direction(goal.direction * sign);
                self.route = Route::Along { sign };
                self.steering_rates.fill(0.0);
                return reasons;
            }
            // Not there yet: a limit of the envelope is the reason.
            reasons |= self.envelope.turn[0].reason | self.envelope.turn[1].reason;
        } else if self.turn.rate == 0.0 {
            self.rerouted |= self.route == Route::Wait;
        }
        if self.turn != before {
            self.turn_joints();
        }
        reasons
    }

    /// Sets the angles and rates of the joints by the turn.
    fn turn_joints(&mut self) {
        self.solve(Twist::from(self.direction()), SolveTarget::Steering);
        let rates = self.arc.steering_rates(&self.rover, self.turn.value);
        self.steering_rates.fill(0.0);
        for (rate, &joint) in rates.zip(&self.joints) {
            self.steering_rates[joint] = rate * self.turn.rate;
        }
    }

    /// Enters the envelope of the present direction, kept, as soon as the speed is inside of it.
    pub(super) fn rest_turn(&mut self) {
        let here = self.turn.value;
        let envelope = Envelope::of_direction(&self.speed_bounds, &self.arc, here);
        if envelope.holds_speed(self.speed) {
            self.envelope = envelope;
            self.is_direction_envelope = true;
        }
    }
}
