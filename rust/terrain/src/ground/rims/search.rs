//! The least gap of rims along a stretch of them, in lanes: see [`crate::ground::rims::lanes`].

use super::circles::{FAR, Jet, Point, Rims, both, cells, floor};
use crate::terrain::Terrain;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;

/// Minima nearer to each other than this are for the plain walk to tell apart [m].
pub(crate) const TIE: f64 = 2e-7;

/// Arcs shorter than this are points [rad].
const POINT: f64 = 1e-14;

/// Steps below this leave less than 1e-11 [rad]: they are of third order.
const CLOSE: f64 = 1e-4;

/// Steps of a walk at most: more cells lie under no wheel that this is worth it for.
const STEPS: usize = 96;

/// A part of the lower halves, and how sure the answer has to be.
#[derive(Clone, Copy)]
pub(crate) struct Stretch<S: Vector> {
    /// Sine and cosine of the contact angle where it begins.
    pub start: [Lanes<S>; 2],
    /// The same where it ends.
    pub end: [Lanes<S>; 2],
    /// Height above the least gap up to which other minima are kept [m].
    pub margin: Lanes<S>,
}

impl<S: Vector> Stretch<S> {
    /// The lower halves.
    #[inline(always)]
    pub fn lower(simd: S) -> Self {
        let (zero, unit) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        Self { start: [-unit, zero], end: [unit, zero], margin: Lanes::splat(simd, TIE) }
    }
}

/// The least gap of every rim along a stretch.
#[derive(Clone, Copy)]
pub(crate) struct Found<S: Vector> {
    /// The gap [m]; [`FAR`] where there is no minimum in the stretch.
    pub gap: Lanes<S>,
    /// Sine and cosine of its contact angle.
    pub at: [Lanes<S>; 2],
    /// Derivatives of the ground's height by columns and rows [m].
    pub slope: [Lanes<S>; 2],
    /// No other minimum is lower than this, as far as it is up to the margin above the gap [m].
    pub others: Lanes<S>,
}

/// A candidate: an arc with one minimum inside.
#[derive(Clone, Copy)]
struct Slot<S: Vector> {
    bound: Lanes<S>,
    sin: Lanes<S>,
    cos: Lanes<S>,
    length: Lanes<S>,
    share: Lanes<S>,
    column: Lanes<S>,
    row: Lanes<S>,
}

impl<S: Vector> Slot<S> {
    #[inline(always)]
    fn pick(mask: Mask<S>, yes: &Self, no: &Self) -> Self {
        Self {
            bound: mask.select(yes.bound, no.bound),
            sin: mask.select(yes.sin, no.sin),
            cos: mask.select(yes.cos, no.cos),
            length: mask.select(yes.length, no.length),
            share: mask.select(yes.share, no.share),
            column: mask.select(yes.column, no.column),
            row: mask.select(yes.row, no.row),
        }
    }
}

/// A line of the grid that a rim crosses next: sine and cosine there, and whether it only turns back before it.
#[inline(always)]
fn crossing<S: Vector>(
    simd: S,
    line: Lanes<S>,
    sign: Lanes<S>,
    [inverse, p, q]: [Lanes<S>; 3],
) -> (Lanes<S>, Lanes<S>, Mask<S>) {
    let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let w = line * inverse;
    let turns = one.at_most(w * sign);
    let w = turns.select(sign, w);
    let v = sign * (one - w * w).max(zero).sqrt();
    let (sin, cos) = (w * p + v * q, v * p - w * q);
    (zero.below(cos).select(sin, Lanes::splat(simd, 2.0)), cos, turns)
}

/// Walks along a stretch of every rim.
#[inline(always)]
pub(crate) fn search<S: Vector>(simd: S, ground: &Terrain, rims: &Rims<S>, stretch: &Stretch<S>) -> Found<S> {
    let (zero, unit, far) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0), Lanes::splat(simd, FAR));
    let mut size = [zero; 3];
    for (k, size) in size.iter_mut().enumerate() {
        let (h, u) = (rims.forward[k], rims.up[k]);
        *size = (h * h + u * u).sqrt();
    }
    let lines = both!(k, {
        // Along a line of the grid there is none to cross.
        let across = Lanes::splat(simd, 1e-12).below(size[k]);
        let inverse = across.select(unit.quotient(across.select(size[k], unit)), zero);
        [inverse, rims.forward[k] * inverse, rims.up[k] * inverse]
    });
    let mut start = rims.point(stretch.start[0], stretch.start[1]);
    let mut cell_at = both!(k, floor(simd, rims.centre[k] + start.spoke[k]));
    // Where it turns just there, the way it then takes.
    let mut sign = both!(k, {
        let rests = start.tangent[k].abs().at_most(zero);
        let way = rests.select(-start.spoke[k], start.tangent[k]);
        way.below(zero).select(-unit, unit)
    });

    let mut active = zero.below(unit);
    let (mut best, mut best_sin, mut best_cos) = (far, zero, unit);
    let mut best_slope = [zero; 2];
    // What may be lower than the best and is not known exactly; what is known and not the best.
    let (mut doubt, mut second) = (far, far);
    // Over ground that is not known, where doubt is no number.
    let mut blind = unit.below(zero);
    let mut before: (Mask<S>, Lanes<S>, [Lanes<S>; 2]) = (unit.below(zero), zero, [zero; 2]);
    let nothing = Slot { bound: far, sin: zero, cos: unit, length: zero, share: zero, column: zero, row: zero };
    let mut slots = [nothing; 2];
    for _ in 0..STEPS {
        let cell = cells(simd, ground, cell_at[0], cell_at[1]);
        let [x, y] = both!(k, {
            let ahead = zero.below(sign[k]).select(unit, zero);
            let line = (cell_at[k] + ahead) - rims.centre[k];
            crossing(simd, line, sign[k], lines[k])
        });
        let by_x = x.0.below(y.0);
        let (mut sin, mut cos) = (by_x.select(x.0, y.0), by_x.select(x.1, y.1));
        // Rounding may put a crossing before the last one.
        let back = sin.below(start.sin);
        (sin, cos) = (back.select(start.sin, sin), back.select(start.cos, cos));
        // Half a radian on.
        let (half_sin, half_cos) =
            (Lanes::splat(simd, 0.479_425_538_604_203), Lanes::splat(simd, 0.877_582_561_890_372_8));
        let (on_sin, on_cos) =
            (start.sin * half_cos + start.cos * half_sin, start.cos * half_cos - start.sin * half_sin);
        let splits = on_sin.below(sin) & zero.below(on_cos);
        (sin, cos) = (splits.select(on_sin, sin), splits.select(on_cos, cos));
        let last = stretch.end[0].at_most(sin);
        (sin, cos) = (last.select(stretch.end[0], sin), last.select(stretch.end[1], cos));
        let end = rims.point(sin, cos);

        let from = both!(k, rims.centre[k] - cell_at[k]);
        let (left, right) = (rims.jet(&cell, from, &start), rims.jet(&cell, from, &end));
        // Unknown or off the map: NaN.
        let known = cell.twist.at_most(far);
        // The arc ends in its cell unless rounding has led the walk astray.
        let strays = both!(k, {
            let place = from[k] + end.spoke[k];
            Lanes::splat(simd, 0.5 + 1e-9).below((place - Lanes::splat(simd, 0.5)).abs())
        });
        blind = blind | (active & (!known | strays[0] | strays[1]));
        let turn = sin * start.cos - cos * start.sin;
        let real = active & Lanes::splat(simd, POINT).below(turn);
        let length = turn * turn.mul_add(turn * Lanes::splat(simd, 0.19), unit);
        let eighth = length * length * Lanes::splat(simd, 0.125);
        let (along, across) = (cell.twist.mul_add(from[1], cell.along), cell.twist.mul_add(from[0], cell.across));
        let fourth = size[2]
            + along.abs() * size[0]
            + across.abs() * size[1]
            + Lanes::splat(simd, 8.0) * cell.twist.abs() * size[0] * size[1];
        let slack = fourth * eighth;
        let least = left.curvature.min(right.curvature) - slack;
        let most = left.curvature.max(right.curvature) + slack;
        let bound = left.gap.min(right.gap) - most.max(zero) * eighth;
        let convex = zero.at_most(least);
        // Where the gap rises or falls all along there is nothing inside.
        let bent = length * least;
        let steady = zero.below(left.rise + bent) | (right.rise - bent).below(zero);
        let low = real & zero.below(most) & bound.at_most(best + stretch.margin) & (convex | !steady);
        // Parabolas from its ends say how low another one may be.
        let bent = bent * Lanes::splat(simd, 0.5);
        let other =
            (left.rise + bent).mul_add(length, left.gap).max((bent - right.rise).mul_add(length, right.gap)).max(bound);
        doubt = (low & !convex).select(doubt.min(other), doubt);
        let dips = left.rise.below(zero) & zero.below(right.rise);
        // Parabolas through both ends, bent as little as the gap is anywhere on the arc, are below it.
        let (bend, turn) = (least.max(Lanes::splat(simd, 1e-12)), dips.select(left.rise - right.rise, -unit));
        let inverse = unit.quotient(bend * turn);
        let depth = turn * inverse * Lanes::splat(simd, -0.5);
        let bound = (left.rise * left.rise)
            .mul_add(depth, left.gap)
            .max((right.rise * right.rise).mul_add(depth, right.gap))
            .max(bound);
        let slot = Slot {
            bound,
            sin: start.sin,
            cos: start.cos,
            length,
            share: left.rise * bend * inverse,
            column: cell_at[0],
            row: cell_at[1],
        };
        let inner = low & convex & dips & bound.at_most(best + stretch.margin);
        // The two lowest are kept, of the others only how low they may be.
        let first_slot = inner & bound.below(slots[0].bound);
        let second_slot = inner & !first_slot & bound.below(slots[1].bound);
        let dropped = first_slot.select(slots[1].bound, second_slot.select(slots[1].bound, inner.select(bound, far)));
        doubt = doubt.min(dropped);
        slots[1] = Slot::pick(first_slot, &slots[0], &Slot::pick(second_slot, &slot, &slots[1]));
        slots[0] = Slot::pick(first_slot, &slot, &slots[0]);

        // The crease between the last arc and this one.
        let (was, rise, slope) = before;
        let crease = real & was & rise.at_most(zero) & zero.at_most(left.rise);
        let turned = left.rise - rise;
        let some = zero.below(turned);
        let share = some.select(left.rise.quotient(some.select(turned, unit)), Lanes::splat(simd, 0.5));
        let better = crease & left.gap.below(best);
        second = better.select(best, crease.select(second.min(left.gap), second));
        best = better.select(left.gap, best);
        best_sin = better.select(start.sin, best_sin);
        best_cos = better.select(start.cos, best_cos);
        best_slope = both!(k, {
            let mix = share * slope[k] + (unit - share) * left.slope[k];
            better.select(mix, best_slope[k])
        });
        // The ends of the walk, where the upper half goes on.
        let begins = real & !was;
        doubt = begins.select(doubt.min(left.gap), doubt);
        doubt = (active & last).select(doubt.min(right.gap), doubt);
        before = (was | real, real.select(right.rise, rise), both!(k, real.select(right.slope[k], slope[k])));

        active = active & !last;
        if !active.any() {
            break;
        }
        let moves = !splits;
        let (here_x, here_y) = (moves & by_x, moves & !by_x);
        cell_at[0] = (here_x & !x.2).select(cell_at[0] + sign[0], cell_at[0]);
        sign[0] = (here_x & x.2).select(-sign[0], sign[0]);
        cell_at[1] = (here_y & !y.2).select(cell_at[1] + sign[1], cell_at[1]);
        sign[1] = (here_y & y.2).select(-sign[1], sign[1]);
        start = end;
    }
    doubt = (active | blind).select(-far, doubt);
    for slot in &slots {
        // Where there is no candidate there is no arc either, however far the best is.
        let wanted = slot.bound.below(far) & slot.bound.at_most(best + stretch.margin);
        if !wanted.any() {
            continue;
        }
        let (at, jet, sure) = bottom(simd, ground, rims, slot);
        doubt = (wanted & !sure).select(-far, doubt);
        let better = wanted & jet.gap.below(best);
        second = better.select(best, wanted.select(second.min(jet.gap), second));
        best = better.select(jet.gap, best);
        best_sin = better.select(at.sin, best_sin);
        best_cos = better.select(at.cos, best_cos);
        best_slope = both!(k, better.select(jet.slope[k], best_slope[k]));
    }
    Found { gap: best, at: [best_sin, best_cos], slope: best_slope, others: doubt.min(second) }
}

/// `1 - x / a (1 - x / b (..))`: sine over angle, and cosine, of a squared angle.
#[inline(always)]
fn series<S: Vector, const N: usize>(simd: S, square: Lanes<S>, divisors: [f64; N]) -> Lanes<S> {
    let unit = Lanes::splat(simd, 1.0);
    let mut sum = unit;
    for k in 0..N {
        let factor = Lanes::splat(simd, -1.0 / divisors[N - 1 - k]);
        sum = (square * factor).mul_add(sum, unit);
    }
    sum
}

/// The minimum inside a convex arc, by Chebyshev's method (Newton's, of third order) inside its bracket, and whether it
/// was found.
#[inline(always)]
fn bottom<S: Vector>(simd: S, ground: &Terrain, rims: &Rims<S>, slot: &Slot<S>) -> (Point<S>, Jet<S>, Mask<S>) {
    let (zero, unit, half) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0), Lanes::splat(simd, 0.5));
    let cell = cells(simd, ground, slot.column, slot.row);
    let from = [rims.centre[0] - slot.column, rims.centre[1] - slot.row];
    let (mut low, mut high) = (zero, slot.length);
    let mut angle = slot.length * slot.share;
    let (mut at, mut step) = ([slot.sin, slot.cos], zero);
    let (mut near, mut sure) = (unit.below(zero), unit.below(zero));
    for _ in 0..12 {
        let square = angle * angle;
        let sin = angle * series(simd, square, [6.0, 20.0, 42.0]);
        let cos = series(simd, square, [2.0, 12.0, 30.0, 56.0]);
        at = turned(simd, [slot.sin, slot.cos], [sin, cos]);
        let jet = rims.jet(&cell, from, &rims.point(at[0], at[1]));
        let falls = jet.rise.at_most(zero);
        low = falls.select(angle, low);
        high = falls.select(high, angle);
        let inverse = unit.quotient(jet.curvature);
        step = jet.rise * inverse;
        step = step * (step * inverse).mul_add(jet.third * half, unit);
        near = step.abs().below(Lanes::splat(simd, CLOSE));
        sure = near | (high - low).below(Lanes::splat(simd, 1e-14));
        if !(!sure).any() {
            break;
        }
        let next = angle - step;
        let inside = low.at_most(next) & next.at_most(high);
        let next = inside.select(next, (low + high) * half);
        angle = sure.select(angle, next);
    }
    let step = near.select(-step, zero);
    let square = step * step;
    let sin = step * series(simd, square, [6.0]);
    let at = turned(simd, at, [sin, series(simd, square, [2.0])]);
    let at = rims.point(at[0], at[1]);
    (at, rims.jet(&cell, from, &at), sure)
}

/// Sine and cosine of an angle and one that is turned on by, put back on the circle: they are off by 1e-8 at most.
#[inline(always)]
fn turned<S: Vector>(simd: S, [s, c]: [Lanes<S>; 2], [sin, cos]: [Lanes<S>; 2]) -> [Lanes<S>; 2] {
    let [s, c] = [s * cos + c * sin, c * cos - s * sin];
    let scale = Lanes::splat(simd, 1.5) - (s * s + c * c) * Lanes::splat(simd, 0.5);
    [s * scale, c * scale]
}
