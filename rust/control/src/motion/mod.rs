//! One number on its way to a goal, its rate and the change of its rate limited.
//!
//! Beside it the parts of such a motion: the arc of directions, limits and the part of the arc inside them, goals, and the
//! reasons for which a motion differs from its command.

pub mod arc;
pub mod envelope;
pub mod following;
pub mod goal;
pub mod limits;
pub mod reason;

/// Share of a motion's distance or time that counts as rounding.
const ROUNDING: f64 = 1e-12;

/// A value and its rate of change: of an angle [rad, rad/s] or a speed [m/s, m/s²].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// The value.
    pub value: f64,
    /// Its change per second.
    pub rate: f64,
}

/// The limit that is active in a step towards a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitedBy {
    /// None: the goal is reached.
    Nothing,
    /// The limit of its rate.
    Rate,
    /// The limit of the change of its rate.
    Change,
}

impl LimitedBy {
    /// The reason that belongs to the active limit, `rate` or `change`; 0 for none.
    pub fn reason(self, rate: u32, change: u32) -> u32 {
        match self {
            Self::Nothing => 0,
            Self::Rate => rate,
            Self::Change => change,
        }
    }
}

impl Motion {
    /// At rest.
    pub fn at(value: f64) -> Self {
        Self { value, rate: 0.0 }
    }

    /// Value at which it comes to rest when its rate falls by `change` per second.
    pub fn stop(self, change: f64) -> f64 {
        if self.rate == 0.0 || change.is_infinite() {
            self.value
        } else {
            self.value + self.rate * self.rate.abs() / (2.0 * change)
        }
    }

    /// The motion after `dt` seconds of the time-optimal motion to rest at the goal: the rate grows to a limit, stays,
    /// and falls to 0 at the goal. The limits hold at every instant, so they hold for steps of any length.
    ///
    /// `rates` are the limits of falling and growing values. A rate beyond its limit falls first.
    pub fn step_towards(self, goal: f64, rates: [f64; 2], change: f64, dt: f64) -> (Self, LimitedBy) {
        let there = (Self::at(goal), LimitedBy::Nothing);
        let (sign, way) = match self.plan(goal, rates, change) {
            PhaseList::Arrived => return there,
            PhaseList::Constant { gap, limit, .. } if limit * dt >= gap || limit.is_infinite() => return there,
            PhaseList::Constant { sign, limit, .. } => (sign, (limit * dt, limit, LimitedBy::Rate)),
            PhaseList::Phases { end, .. } if dt >= end * (1.0 - ROUNDING) => return there,
            PhaseList::Phases { sign, rate, peak, first, first_way, cruise, end, limit } => {
                if dt < first {
                    let slope = if rate > peak { -change } else { change };
                    (sign, (dt * (rate + slope * dt / 2.0), slope.mul_add(dt, rate), LimitedBy::Change))
                } else if dt < first + cruise {
                    let held = if peak < limit { LimitedBy::Change } else { LimitedBy::Rate };
                    (sign, (peak.mul_add(dt - first, first_way), peak, held))
                } else {
                    let left = end - dt;
                    let value = goal - sign * change * left * left / 2.0;
                    return (Self { value, rate: sign * change * left }, LimitedBy::Change);
                }
            }
        };
        let (way, rate, held) = way;
        (Self { value: sign.mul_add(way, self.value), rate: sign * rate }, held)
    }

    /// Duration of the motion of [`Self::step_towards`] [s].
    pub fn time_to(self, goal: f64, rates: [f64; 2], change: f64) -> f64 {
        match self.plan(goal, rates, change) {
            PhaseList::Arrived => 0.0,
            PhaseList::Constant { gap, limit, .. } => gap / limit,
            PhaseList::Phases { end, .. } => end,
        }
    }

    /// The time-optimal motion to rest at the goal.
    fn plan(self, goal: f64, rates: [f64; 2], change: f64) -> PhaseList {
        let stop = self.stop(change);
        // Braking now ends at the goal.
        let brakes = (goal - stop).abs() <= ROUNDING * ((stop - self.value).abs() + goal.abs());
        let way = if brakes && self.rate != 0.0 { self.rate } else { goal - stop };
        if way == 0.0 {
            return PhaseList::Arrived;
        }
        let sign = way.signum();
        let limit = rates[usize::from(way > 0.0)];
        let (gap, rate) = ((goal - self.value) * sign, self.rate * sign);
        // Half the square of the fastest rate; where it overflows, the limit of the change is never active.
        let fastest = change * gap + rate * rate / 2.0;
        if change.is_infinite() || !fastest.is_finite() {
            return PhaseList::Constant { sign, gap, limit };
        }
        // Braking distances of rates, and the fastest rate from which the motion still stops at the goal.
        let braking = |rate: f64| rate * rate / (2.0 * change);
        let peak = if brakes && rate > 0.0 { rate } else { limit.min(fastest.max(0.0).sqrt()) };
        let first = (peak - rate).abs() / change;
        let first_way = if rate > peak { braking(rate) - braking(peak) } else { braking(peak) - braking(rate) };
        let cruise_way = (gap - first_way - braking(peak)).max(0.0);
        let cruise = if cruise_way > 0.0 && peak > 0.0 { cruise_way / peak } else { 0.0 };
        PhaseList::Phases { sign, rate, limit, peak, first, first_way, cruise, end: first + cruise + peak / change }
    }
}

/// A motion to rest at a goal; distances and rates are positive in the direction `sign`.
enum PhaseList {
    /// The goal is reached.
    Arrived,
    /// The distance `gap` at one rate: the change of the rate is not limited.
    Constant { sign: f64, gap: f64, limit: f64 },
    /// From `rate` to `peak` in the time `first` over `first_way`, at `peak` for `cruise`, then to rest at the time `end`.
    Phases { sign: f64, rate: f64, limit: f64, peak: f64, first: f64, first_way: f64, cruise: f64, end: f64 },
}
