//! Constant limits of speed and turn under which every limit of the rover holds, on a whole piece of an arc.
//!
//! The twist is `s d(a)`: a speed `s` [m/s] times a direction of unit length, `a` [rad] along the arc ([`super::arc`]).
//! Dashes are derivatives by time, `d'` by `a`. A limited velocity (of the body, its yaw, a wheel) is a row times the
//! twist, so with `f = |row d|` and `g = |row d'|` it changes by no more than
//!
//! ```text
//! velocity          s f
//! change            s' f  +  s a' g
//! change of change  s'' f  +  2 s' a' g  +  s a'' g  +  s a'² f
//! ```
//!
//! # What holds
//!
//! While `0 <= s <= speed`, `-rates[0] <= s' <= rates[1]`, `|s''| <= change`, `|a'| <= turn[0]` and `|a''| <= turn[1]`,
//! and `a` is on the piece from `start` to `end`, no limit of [`SpeedBounds::limits`] is exceeded: `f` and `g` are
//! bounded by their largest values on the piece, the terms with `a'` use at most half of every limit, and `rates` and
//! `change` are the rest.
//!
//! These are constants, so a step inside needs no check; and from any state inside, braking the turn by `turn[1]` and
//! the speed by `change` stays inside: the motion can always be stopped.

use super::Motion;
use super::arc::{Arc, Bound, Bounds};
use super::limits::Limits;
use super::reason;

/// Factor by which a value may exceed a limit by rounding.
const ROUNDING: f64 = 1.0 + 1e-12;

/// A limit and its reason.
#[derive(Clone, Copy, Debug)]
pub struct NamedLimit {
    /// The limit.
    pub value: f64,
    /// Its [`reason`].
    pub reason: u32,
}

impl NamedLimit {
    const NONE: Self = Self { value: f64::INFINITY, reason: 0 };

    /// The lower of two.
    fn or(self, value: f64, reason: u32) -> Self {
        if value < self.value { Self { value, reason } } else { self }
    }
}

/// Bounds of the motion that do not depend on the arc.
#[derive(Clone, Copy, Debug)]
pub struct SpeedBounds {
    /// The limits; those of the joints are tightened by the rolling of wheels with scrub under steering.
    pub limits: Limits,
    /// Upper bounds of the wheels' speed and acceleration by steering alone [rad/s, rad/s²].
    pub steering_share: [f64; 2],
    /// Rate at which a joint turns by less than half a turn in the longest step [rad/s].
    pub fastest_turn: f64,
}

/// Constants of a piece of an arc; the module's documentation states the invariant.
#[derive(Clone, Copy, Debug)]
pub struct Envelope {
    /// Angle of the arc at which the turn ends at rest [rad].
    pub end: f64,
    /// True if there is a turn.
    pub turning: bool,
    /// Highest speed on this piece with the turn at rest [m/s]; at least `speed`.
    pub fastest: NamedLimit,
    /// Highest speed at which the other limits of this envelope hold [m/s].
    pub speed: f64,
    /// Highest rate of the turn [rad/s] and change of it [rad/s²], at speeds up to `speed`. Both 0 without a turn.
    pub turn: [NamedLimit; 2],
    /// Highest change of the speed, slowing down and speeding up [m/s²].
    pub rates: [NamedLimit; 2],
    /// Highest change of that [m/s³].
    pub change: NamedLimit,
    /// Upper bound of the distance of the body's origin per distance along the motion [1].
    pub way: f64,
}

/// Product in which zero times infinity is zero.
fn times(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { 0.0 } else { a * b }
}

/// The limit divided by a rate: infinite for a rate of 0.
pub fn quotient(limit: f64, share: f64) -> f64 {
    if share > 0.0 { limit / share } else { f64::INFINITY }
}

/// The highest speed in a direction.
pub fn fastest(limits: &Limits, bounds: &Bounds) -> NamedLimit {
    let lateral = times(bounds.linear.along, bounds.yaw.along);
    let wheels = bounds.wheels.along.max(bounds.castors);
    NamedLimit::NONE
        .or(quotient(limits.speed, bounds.linear.along), reason::SPEED)
        .or(quotient(limits.yaw_rate, bounds.yaw.along), reason::YAW_RATE)
        .or(quotient(limits.lateral_acceleration, lateral).sqrt(), reason::LATERAL_ACCELERATION)
        .or(quotient(limits.wheel_speed, wheels), reason::WHEEL_SPEED)
}

/// A velocity with limited acceleration and jerk.
struct Row {
    bound: Bound,
    /// Limits of its change, slowing down and speeding up.
    change: [f64; 2],
    jerk: f64,
    reasons: [u32; 2],
    jerk_reason: u32,
}

impl Envelope {
    /// The envelope of one direction that is kept.
    pub fn of_direction(speed_bounds: &SpeedBounds, arc: &Arc, angle: f64) -> Self {
        Self::new(speed_bounds, arc, [angle; 2], 0.0, 0.0)
    }

    /// The envelope of the turn from `start` to `end` [rad], for speeds up to `speed` [m/s] or the highest possible
    /// one. The rate of the turn is `useful` [rad/s] at most.
    pub fn new(speed_bounds: &SpeedBounds, arc: &Arc, [start, end]: [f64; 2], speed: f64, useful: f64) -> Self {
        let mut limits = speed_bounds.limits;
        let turning = end != start;
        let bounds = arc.bounds(start, end);
        if turning {
            limits.wheel_speed -= speed_bounds.steering_share[0];
            limits.wheel_acceleration -= speed_bounds.steering_share[1];
        }
        let fastest = fastest(&limits, &bounds);
        let speed = speed.min(fastest.value);
        let rows = rows(&limits, &bounds);
        let mut envelope = Self {
            end,
            turning,
            fastest,
            speed,
            turn: [NamedLimit { value: 0.0, reason: 0 }; 2],
            rates: [NamedLimit::NONE; 2],
            change: NamedLimit::NONE,
            way: bounds.linear.along,
        };
        if turning {
            envelope.turn = turn(speed_bounds, &limits, &bounds, &rows, [speed, useful]);
        } else {
            envelope.speed = fastest.value;
        }
        let [rate, change] = envelope.turn.map(|limit| limit.value);
        for row in &rows {
            let turned = times(speed * row.bound.across, rate);
            for (k, limit) in envelope.rates.iter_mut().enumerate() {
                if row.change[k] < f64::INFINITY {
                    let left = (row.change[k] - turned).max(0.0);
                    *limit = limit.or(quotient(left, row.bound.along), row.reasons[k]);
                }
                if row.jerk < f64::INFINITY {
                    let share = quotient(row.jerk / 12.0, times(row.bound.across, rate));
                    *limit = limit.or(share, row.jerk_reason);
                }
            }
        }
        let steepest = envelope.rates[0].value.max(envelope.rates[1].value);
        for row in rows.iter().filter(|row| row.jerk < f64::INFINITY) {
            let Bound { along, across } = row.bound;
            let turned = times(speed * across, change)
                + times(speed * along, rate * rate)
                + 2.0 * times(steepest, times(rate, across));
            envelope.change = envelope.change.or(quotient(row.jerk - turned, along), row.jerk_reason);
        }
        envelope
    }

    /// Peak rate of a turn from rest at `angle` to rest at the end [rad/s], if it takes at least `dt` [s].
    pub fn guaranteed_rate(&self, angle: f64, dt: f64) -> f64 {
        let [rate, change] = self.turn.map(|limit| limit.value);
        let left = (self.end - angle).abs();
        rate.min(times(change, left).sqrt()).min(left / dt)
    }

    /// The envelope with a `change` large enough for a motion from inside `old` to stop braking at rest, or to stop
    /// speeding up below the highest speed.
    #[must_use]
    pub fn for_motion(mut self, speed: Motion, old: &Self) -> Self {
        let way = if speed.value * speed.rate < 0.0 { speed.value.abs() } else { old.speed - speed.value.abs() };
        let needed = quotient(speed.rate * speed.rate / 2.0, way.max(0.0)).min(old.change.value);
        if speed.rate != 0.0 {
            self.change.value = self.change.value.max(needed);
        }
        self
    }

    /// True if a turn is inside: not faster than `turn[0]`, and braked by `turn[1]` at rest before `end`.
    pub fn holds_turn(&self, turn: Motion) -> bool {
        let [rate, change] = self.turn.map(|limit| limit.value);
        if turn.rate == 0.0 || change.is_infinite() {
            return true; // at rest, or with a rate that may jump
        }
        let sign = turn.rate.signum();
        let left = (self.end - turn.value) * sign;
        let braking = turn.stop(change) - turn.value;
        turn.rate.abs() <= rate * ROUNDING && braking.abs() <= left * ROUNDING
    }

    /// True if a speed is inside: its change is, and reducing that by `change` leads neither above `speed` nor past
    /// rest.
    pub fn holds_speed(&self, speed: Motion) -> bool {
        let sign = if speed.value < 0.0 { -1.0 } else { 1.0 };
        let forward = Motion { value: speed.value * sign, rate: speed.rate * sign };
        let stop = forward.stop(self.change.value);
        let rate = self.rates[usize::from(forward.rate > 0.0)].value;
        (forward.rate.abs() <= rate * ROUNDING || self.change.value.is_infinite())
            && forward.value.max(stop) <= self.speed * ROUNDING
            && stop >= (ROUNDING - 1.0) * -forward.value
    }
}

fn rows(limits: &Limits, bounds: &Bounds) -> [Row; 3] {
    [
        Row {
            bound: bounds.linear,
            change: [limits.deceleration, limits.acceleration],
            jerk: limits.jerk,
            reasons: [reason::DECELERATION, reason::ACCELERATION],
            jerk_reason: reason::JERK,
        },
        Row {
            bound: bounds.yaw,
            change: [limits.angular_deceleration, limits.angular_acceleration],
            jerk: limits.angular_jerk,
            reasons: [reason::ANGULAR_DECELERATION, reason::ANGULAR_ACCELERATION],
            jerk_reason: reason::ANGULAR_JERK,
        },
        Row {
            bound: bounds.wheels,
            change: [limits.wheel_acceleration; 2],
            jerk: f64::INFINITY,
            reasons: [reason::WHEEL_ACCELERATION; 2],
            jerk_reason: 0,
        },
    ]
}

/// Limits of the turn's rate [rad/s] and of its change [rad/s²]: those of the joints, and half of every other limit.
fn turn(
    speed_bounds: &SpeedBounds,
    limits: &Limits,
    bounds: &Bounds,
    rows: &[Row; 3],
    [speed, useful]: [f64; 2],
) -> [NamedLimit; 2] {
    let [first, second] = bounds.steering;
    let joints = [limits.steering_rate, limits.steering_acceleration];
    let mut rate = NamedLimit::NONE
        .or(quotient(joints[0], first), reason::STEERING_RATE)
        .or(quotient(joints[1] / 2.0, second).sqrt(), reason::STEERING_ACCELERATION);
    for row in rows {
        let across = times(speed, row.bound.across);
        let least = row.change[0].min(row.change[1]);
        rate = rate.or(quotient(least / 2.0, across), row.reasons[1]);
        let along = times(speed, row.bound.along);
        rate = rate.or(quotient(row.jerk / 6.0, along).sqrt(), row.jerk_reason);
    }
    if rate.value < f64::INFINITY {
        // Below this rate the sense of rotation of a wheel does not depend on the length of steps.
        rate = rate.or(quotient(speed_bounds.fastest_turn, first), rate.reason);
        rate.value = rate.value.min(useful);
    }
    let left = joints[1] - times(second, rate.value * rate.value);
    let mut change = NamedLimit::NONE;
    if joints[1] < f64::INFINITY {
        change = change.or(quotient(left, first), reason::STEERING_ACCELERATION);
    }
    for row in rows {
        let across = times(speed, row.bound.across);
        change = change.or(quotient(row.jerk / 6.0, across), row.jerk_reason);
    }
    [rate, change]
}
