//! Time-optimal parametrization of a chord: its share as a function of time under constraints.
//!
//! The pace is the derivative of the share by time.
//!
//! Limits of first derivatives alone are met exactly: at every instant one constraint is active, its joint moves at its
//! limit, and the share follows from the joint in closed form. With a limit of the steering acceleration the squared
//! pace follows from a linear programme per cell, solved backwards for the largest values from which the end can be
//! reached, and forwards for the largest reachable ones (H. Pham, Q.-C. Pham, A New Approach to Time-Optimal Path
//! Parameterization Based on Reachability Analysis, IEEE Trans. Robotics 34(3), 2018). With a limit of the steering
//! jerk that result is smoothed by a moving average and stretched in time until the limit holds: feasible, not optimal.

use super::chord::{Chord, bisect};
use super::constraints::Constraint;
use super::{Axis, Derivatives, Piece};

/// Cells of a chord, at whose ends its constraints are evaluated.
const CELLS: usize = 256;

/// Points per piece at which the result is checked, and per piece among the tightest.
const CHECKS: usize = 6;
const FINE_CHECKS: usize = 96;

/// Share of the worst constraint ratio from which a piece is among the tightest.
const TIGHT: f64 = 1.0 - 1e-3;

/// Relative stretch of a checked result beyond the largest constraint ratio, for the points between the checks.
const MARGIN: f64 = 1e-7;

/// Halvings of a bisection for a change of the active constraint.
const HALVINGS: usize = 52;

/// Widths of the moving average that are tried, as shares of the time from rest to the largest acceleration at the jerk
/// limit.
const WIDTHS: [f64; 6] = [0.4, 0.7, 1.0, 1.4, 2.0, 2.8];

/// A part of the chord on which one constraint is active.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ActiveConstraint {
    /// Time at its start [s].
    start: f64,
    /// Shares of the chord at its ends.
    from: f64,
    to: f64,
    constraint: Constraint,
}

/// Share of the chord over time.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum TimeParametrization {
    /// Closed form, by active constraints; duration [s].
    Binding { bounds: Vec<ActiveConstraint>, duration: f64 },
    /// Pieces of constant second or third derivative.
    Sampled(Axis),
}

/// Limits of the acceleration [rad/s²] and jerk [rad/s³] of every joint's angle.
#[derive(Clone, Debug)]
pub(crate) struct Smoothness {
    pub accelerations: Vec<f64>,
    pub jerk: f64,
}

impl TimeParametrization {
    /// The fastest parametrization of a chord under its constraints; `None` if it never reaches the end.
    pub fn new(chord: &Chord, constraints: &[Constraint], smooth: &Smoothness) -> Option<Self> {
        let turning = chord.joints.iter().any(|joint| joint.angle_derivatives(0.5)[0] != 0.0);
        let rolling = constraints.iter().any(|constraint| matches!(constraint, Constraint::Rolling(..)));
        let firm = smooth.jerk == f64::INFINITY && smooth.accelerations.iter().all(|limit| *limit == f64::INFINITY);
        let timing = if !turning || (firm && !rolling) {
            binding(chord, constraints)
        } else {
            Self::Sampled(sampled(chord, constraints, smooth)?)
        };
        timing.duration().is_finite().then_some(timing)
    }

    /// Duration of the chord [s].
    pub fn duration(&self) -> f64 {
        match self {
            Self::Binding { duration, .. } => *duration,
            Self::Sampled(axis) => axis.duration,
        }
    }

    /// Share of the chord and its derivatives, up to the third where it is limited.
    pub fn at(&self, time: f64) -> Derivatives {
        match self {
            Self::Sampled(axis) => axis.at(time),
            Self::Binding { bounds, duration } => {
                if time >= *duration {
                    let last = bounds.last().map_or([0.0; 4], |bound| bound.at(f64::INFINITY));
                    return [1.0, last[1], last[2], 0.0];
                }
                let next = bounds.partition_point(|bound| bound.start <= time);
                let Some(bound) = bounds.get(next.saturating_sub(1)) else {
                    return [1.0, 0.0, 0.0, 0.0];
                };
                bound.at(time - bound.start)
            }
        }
    }
}

impl ActiveConstraint {
    fn time(&self) -> f64 {
        (self.constraint.time(self.to) - self.constraint.time(self.from)).abs()
    }

    fn at(&self, time: f64) -> Derivatives {
        let (from, to) = (self.constraint.time(self.from), self.constraint.time(self.to));
        let onward = if to >= from { time } else { -time };
        let near = f64::midpoint(self.from, self.to);
        let found = self.constraint.place(from + onward, near);
        let s = if time >= self.time() { self.to } else { found.clamp(self.from, self.to) };
        let pace = self.constraint.slowness(s);
        [s, 1.0 / pace, -self.constraint.slope(s) / (pace * pace * pace), 0.0]
    }
}

/// Index of the constraint with the longest time per share at a point of the chord.
fn strictest(constraints: &[Constraint], s: f64) -> usize {
    let mut best = (0, f64::NEG_INFINITY);
    for (i, constraint) in constraints.iter().enumerate() {
        let pace = constraint.slowness(s);
        if pace > best.1 {
            best = (i, pace);
        }
    }
    best.0
}

fn binding(chord: &Chord, constraints: &[Constraint]) -> TimeParametrization {
    let mut places = chord.nodes(CELLS);
    // At the point of least pivot speed the derivative of that speed changes sign, and the wheel turns fastest.
    let slowest = chord.joints.iter().map(|joint| joint.slowest());
    places.extend(slowest.filter(|s| *s > 0.0 && *s < 1.0));
    places.sort_by(f64::total_cmp);
    places.dedup();
    let mut bounds: Vec<ActiveConstraint> = Vec::new();
    let mut clock = 0.0;
    for cell in places.windows(2) {
        let (mut from, to) = (cell[0], cell[1]);
        // Just inside the cell: its ends may be points of least pivot speed.
        let inside = |share: f64| cell[0] + (cell[1] - cell[0]) * share;
        let last = strictest(constraints, inside(1.0 - 1e-6));
        let mut current = strictest(constraints, inside(1e-6));
        while from < to {
            let mut until = to;
            if current != last {
                [_, until] = bisect([from, to], HALVINGS, |s| strictest(constraints, s) == current);
            }
            let bound = ActiveConstraint { start: clock, from, to: until, constraint: constraints[current] };
            let time = bound.time();
            if time > 0.0 {
                clock += time;
                bounds.push(bound);
            }
            from = until;
            let next = strictest(constraints, from + (to - from) * 1e-6);
            current = if next == current { last } else { next };
        }
    }
    TimeParametrization::Binding { bounds, duration: clock }
}

/// First and second derivative of every joint's angle by the share of the chord, at one point.
type AngleDerivatives = Vec<[f64; 2]>;

fn sampled(chord: &Chord, constraints: &[Constraint], smooth: &Smoothness) -> Option<Axis> {
    let places = chord.nodes(CELLS);
    let derivatives = |s: f64| -> AngleDerivatives {
        let all = chord.joints.iter().map(|joint| joint.angle_derivatives(s));
        all.map(|[slope, bend, _]| [slope, bend]).collect()
    };
    let ceilings: Vec<f64> = places
        .iter()
        .map(|&s| constraints.iter().fold(0.0, |pace: f64, constraint| pace.max(constraint.slowness(s))).powi(-2))
        .collect();
    let derivatives: Vec<AngleDerivatives> = places.iter().map(|&s| derivatives(s)).collect();
    let cell = |k: usize, highest: f64| TimeSegment {
        length: places[k + 1] - places[k],
        first: &derivatives[k],
        last: &derivatives[k + 1],
        limits: &smooth.accelerations,
        highest,
    };
    // Largest squared pace at every point from which the end can be reached within the limits.
    let count = places.len();
    let mut highest = vec![0.0; count];
    for k in (0..count - 1).rev() {
        highest[k] = cell(k, highest[k + 1]).fastest(ceilings[k]);
    }
    let mut pieces = Vec::with_capacity(count);
    let (mut square, mut clock) = (0.0, 0.0);
    for k in 0..count - 1 {
        let cell = cell(k, highest[k + 1]);
        let (_, most) = cell.room(square);
        let next = (square + 2.0 * cell.length * most).clamp(0.0, highest[k + 1]);
        let acceleration = (next - square) / (2.0 * cell.length);
        let pace = square.sqrt();
        pieces.push(Piece { start: clock, state: [places[k], pace, acceleration, 0.0] });
        clock += 2.0 * cell.length / (pace + next.sqrt());
        square = next;
    }
    let last = pieces.last()?.state;
    let axis = Axis { pieces, duration: clock, end: [1.0, 0.0, last[2], 0.0] };
    if !clock.is_finite() {
        return None;
    }
    let stretched = |axis: Axis| {
        let excess = excess(chord, constraints, smooth, &axis);
        stretch(axis, if excess > 1.0 { excess * (1.0 + MARGIN) } else { 1.0 })
    };
    if smooth.jerk == f64::INFINITY {
        return Some(stretched(axis));
    }
    let strongest = smooth.accelerations.iter().fold(f64::INFINITY, |a: f64, b| a.min(*b));
    let build_up = (strongest / smooth.jerk).min(clock);
    let smoothed = WIDTHS.iter().map(|share| stretched(average(&axis, share * build_up)));
    smoothed.min_by(|a, b| a.duration.total_cmp(&b.duration))
}

/// A cell of the chord, passed with a constant second derivative of the share by time.
struct TimeSegment<'a> {
    /// Length, a share of the chord.
    length: f64,
    /// Derivatives of the angles at both ends.
    first: &'a AngleDerivatives,
    last: &'a AngleDerivatives,
    /// Limits of the joints' accelerations [rad/s²].
    limits: &'a [f64],
    /// Largest squared pace at its end.
    highest: f64,
}

impl TimeSegment<'_> {
    /// Least and greatest second derivative from a squared pace; empty if the first is the greater.
    fn room(&self, square: f64) -> (f64, f64) {
        let mut room = (-square / (2.0 * self.length), (self.highest - square) / (2.0 * self.length));
        let mut narrow = |factor: f64, offset: f64, limit: f64| {
            if factor == 0.0 {
                if offset.abs() > limit {
                    room = (1.0, 0.0);
                }
                return;
            }
            let (a, b) = ((-limit - offset) / factor, (limit - offset) / factor);
            room = (room.0.max(a.min(b)), room.1.min(a.max(b)));
        };
        for ((first, last), &limit) in self.first.iter().zip(self.last).zip(self.limits) {
            if limit.is_finite() {
                narrow(first[0], first[1] * square, limit);
                // At the end of the cell the squared pace is `square + 2 length second`.
                narrow(last[0] + last[1] * 2.0 * self.length, last[1] * square, limit);
            }
        }
        room
    }

    /// Largest squared pace at the start for which [`Self::room`] is not empty.
    fn fastest(&self, ceiling: f64) -> f64 {
        let possible = |square: f64| {
            let (least, most) = self.room(square);
            least <= most
        };
        let mut high = ceiling;
        if high == f64::INFINITY {
            high = 1.0;
            while possible(high) && high < 1e300 {
                high *= 4.0;
            }
        }
        if possible(high) {
            return high;
        }
        bisect([0.0, high], 60, possible)[0]
    }
}

/// Factor by which the time has to be stretched for every constraint to hold at the checked places, which are denser in
/// the tightest pieces.
fn excess(chord: &Chord, constraints: &[Constraint], smooth: &Smoothness, axis: &Axis) -> f64 {
    let starts = axis.pieces.iter().map(|piece| piece.start);
    let ends = || starts.clone().skip(1).chain([axis.duration]);
    let worst_of = |piece: &Piece, end: f64, checks: usize| {
        let step = (end - piece.start) / checks as f64;
        let states = (0..=checks).map(|check| super::constant_jerk_state(piece.state, step * check as f64));
        states.fold(0.0, |worst: f64, state| worst.max(constraint_ratio(chord, constraints, smooth, state)))
    };
    let coarse = axis.pieces.iter().zip(ends()).map(|(piece, end)| worst_of(piece, end, CHECKS));
    let coarse: Vec<f64> = coarse.collect();
    let worst = coarse.iter().fold(0.0, |a: f64, b| a.max(*b));
    let tight = axis.pieces.iter().zip(ends()).zip(&coarse).filter(|(_, own)| **own >= worst * TIGHT);
    tight.fold(worst, |worst, ((piece, end), _)| worst.max(worst_of(piece, end, FINE_CHECKS)))
}

/// Factor by which the time has to be stretched for every constraint to hold at one place, given with its derivatives.
fn constraint_ratio(
    chord: &Chord,
    constraints: &[Constraint],
    smooth: &Smoothness,
    [s, pace, second, third]: Derivatives,
) -> f64 {
    let s = s.clamp(0.0, 1.0);
    let mut worst = constraints.iter().fold(0.0, |most: f64, constraint| most.max(constraint.slowness(s))) * pace;
    for (joint, &limit) in chord.joints.iter().zip(&smooth.accelerations) {
        let [slope, bend, twist] = joint.angle_derivatives(s);
        let acceleration = bend * pace * pace + slope * second;
        worst = worst.max((acceleration.abs() / limit).sqrt());
        let jerk = twist * pace * pace * pace + 3.0 * bend * pace * second + slope * third;
        worst = worst.max((jerk.abs() / smooth.jerk).cbrt());
    }
    worst
}

/// The same motion in more time, by this factor.
fn stretch(mut axis: Axis, factor: f64) -> Axis {
    let slow = |state: Derivatives| {
        let mut scale = 1.0;
        state.map(|part| {
            let scaled = part / scale;
            scale *= factor;
            scaled
        })
    };
    for piece in &mut axis.pieces {
        piece.start *= factor;
        piece.state = slow(piece.state);
    }
    axis.duration *= factor;
    axis.end = slow(axis.end);
    axis
}

/// Moving average over a time [s]: pieces of constant acceleration become pieces of constant jerk.
fn average(axis: &Axis, width: f64) -> Axis {
    let begun = |time: f64| if time < 0.0 { [0.0; 4] } else { axis.at(time) };
    let starts = || axis.pieces.iter().map(|piece| piece.start);
    let mut times: Vec<f64> = starts().chain([axis.duration]).collect();
    times.extend(starts().map(|time| time + width));
    times.sort_by(f64::total_cmp);
    times.dedup();
    let duration = axis.duration + width;
    let mut pieces: Vec<Piece> = Vec::with_capacity(times.len());
    let mut value = 0.0;
    for (k, &time) in times.iter().enumerate() {
        let end = times.get(k + 1).copied().unwrap_or(duration);
        // The accelerations at both ends of the window are constant until the next of these times.
        let middle = f64::midpoint(time, end);
        let [now, before] = [begun(time), begun(time - width)];
        let [ahead, behind] = [begun(middle), begun(middle - width)];
        let jerk = (ahead[2] - behind[2]) / width;
        // The average's acceleration at the start, extrapolated from the middle: there that of the axis may jump.
        let acceleration = (ahead[1] - behind[1]) / width - jerk * (middle - time);
        let state = [value, (now[0] - before[0]) / width, acceleration, jerk];
        pieces.push(Piece { start: time, state });
        value = super::constant_jerk_state(state, end - time)[0];
    }
    Axis { pieces, duration, end: [1.0, 0.0, 0.0, 0.0] }
}
