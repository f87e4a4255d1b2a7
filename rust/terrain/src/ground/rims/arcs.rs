//! Arcs of rims over one cell each: their ends, and bounds of the gap along them.

use super::candidate::Candidate;
use super::circles::{Cells, GapDerivatives, Point, RimLanes};
use super::interval::{AngleInterval, GapMinimum};
use crate::interval::both;
use crate::terrain::Terrain;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;

/// Sine and cosine of half a radian, the longest arc.
const LONGEST_ARC: [f64; 2] = [0.479_425_538_604_203, 0.877_582_561_890_372_8];

/// Constants of a search along the rims.
pub(super) struct Search<'a, S: Vector> {
    pub simd: S,
    pub ground: &'a Terrain,
    pub rims: &'a RimLanes<S>,
    pub interval: &'a AngleInterval<S>,
    /// Half the widths of the circles, along columns, rows and heights.
    pub size: [Lanes<S>; 3],
    /// For columns and rows: one over that, and `forward` and `up` as shares of it.
    pub lines: [[Lanes<S>; 3]; 2],
}

/// State of a search along the rims, from arc to arc.
pub(super) struct Walk<S: Vector> {
    pub found: GapMinimum<S>,
    /// Upper bound of the least gap [m].
    pub ceiling: Lanes<S>,
    pub candidates: [Candidate<S>; 2],
    /// True in the lanes that have not reached the end of the interval.
    pub active: Mask<S>,
    pub start: Point<S>,
    /// Lowest column and row of the cell ahead.
    pub cell: [Lanes<S>; 2],
    /// 1 where the rim goes towards larger columns and rows, -1 elsewhere.
    pub sign: [Lanes<S>; 2],
    /// Sine and cosine of the largest end of the next arc; a sine of 2 where there is no limit.
    pub limit: [Lanes<S>; 2],
    /// True where the cell was corrected, after rounding had put the search into a wrong one.
    pub is_found_again: Mask<S>,
    /// The end of the last arc: gap, its derivative along the rim, and the slope of the ground.
    pub before: ArcEnd<S>,
}

#[derive(Clone, Copy)]
pub(super) struct ArcEnd<S: Vector> {
    pub gap: Lanes<S>,
    pub rise: Lanes<S>,
    pub slope: [Lanes<S>; 2],
}

/// The end of the next arc.
pub(super) struct NextEnd<S: Vector> {
    pub end: Point<S>,
    /// True where the arc ends at the end of the interval, and where it ends inside its cell.
    pub is_last: Mask<S>,
    pub splits: Mask<S>,
    /// True where a line between columns is next, not one between rows.
    pub by_x: Mask<S>,
    /// True where the rim turns back before it reaches that line.
    pub turns: [Mask<S>; 2],
}

/// An arc over one cell.
pub(super) struct Arc<S: Vector> {
    pub left: GapDerivatives<S>,
    pub right: GapDerivatives<S>,
    /// Length [rad].
    pub length: Lanes<S>,
    /// Lower bound of the gap [m], and of its second derivative.
    pub bound: Lanes<S>,
    pub least_curvature: Lanes<S>,
    /// True where the gap may have a minimum inside.
    pub may_dip: Mask<S>,
    pub is_convex: Mask<S>,
}

#[inline_always]
impl<'a, S: Vector> Search<'a, S> {
    pub(super) fn new(simd: S, ground: &'a Terrain, rims: &'a RimLanes<S>, interval: &'a AngleInterval<S>) -> Self {
        let (zero, unit) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let mut size = [zero; 3];
        for (k, size) in size.iter_mut().enumerate() {
            let (h, u) = (rims.forward[k], rims.up[k]);
            *size = (h * h + u * u).sqrt();
        }
        let lines = both!(k, {
            // A rim parallel to the lines of the grid crosses none.
            let across = Lanes::splat(simd, 1e-12).lt(size[k]);
            let inverse = across.select(unit / across.select(size[k], unit), zero);
            [inverse, rims.forward[k] * inverse, rims.up[k] * inverse]
        });
        Self { simd, ground, rims, interval, size, lines }
    }

    pub(super) fn all(&self, value: f64) -> Lanes<S> {
        Lanes::splat(self.simd, value)
    }

    /// The cell after a point and the signs of the rim's direction there.
    pub(super) fn cell_at(&self, at: &Point<S>) -> [[Lanes<S>; 2]; 2] {
        let (zero, unit) = (self.all(0.0), self.all(1.0));
        let cell = both!(k, (self.rims.centre[k] + at.spoke[k]).floor());
        let sign = both!(k, {
            // At a turning point: the direction after it.
            let rests = at.tangent[k].abs().le(zero);
            let way = rests.select(-at.spoke[k], at.tangent[k]);
            way.lt(zero).select(-unit, unit)
        });
        [cell, sign]
    }

    /// The next line of the grid that a rim crosses: sine and cosine of the contact angle there; true where the rim
    /// turns back before it.
    pub(super) fn crossing(&self, axis: usize, walk: &Walk<S>) -> (Lanes<S>, Lanes<S>, Mask<S>) {
        let (zero, one) = (self.all(0.0), self.all(1.0));
        let (sign, [inverse, p, q]) = (walk.sign[axis], self.lines[axis]);
        let ahead = zero.lt(sign).select(one, zero);
        let line = (walk.cell[axis] + ahead) - self.rims.centre[axis];
        let w = line * inverse;
        let turns = one.le(w * sign);
        let w = turns.select(sign, w);
        let v = sign * (one - w * w).max(zero).sqrt();
        let (sin, cos) = (w * p + v * q, v * p - w * q);
        (zero.lt(cos).select(sin, self.all(2.0)), cos, turns)
    }

    /// The end of the next arc: the next line of the grid, half a radian on, the limit, or the end of the interval.
    pub(super) fn next_end(&self, walk: &Walk<S>, halves: bool) -> NextEnd<S> {
        let start = &walk.start;
        let [x, y] = both!(k, self.crossing(k, walk));
        let by_x = x.0.lt(y.0);
        let (mut sin, mut cos) = (by_x.select(x.0, y.0), by_x.select(x.1, y.1));
        // By rounding, a crossing may be before the last one.
        let back = sin.lt(start.sin);
        (sin, cos) = (back.select(start.sin, sin), back.select(start.cos, cos));
        let [half_sin, half_cos] = LONGEST_ARC.map(|value| self.all(value));
        let (on_sin, on_cos) =
            (start.sin * half_cos + start.cos * half_sin, start.cos * half_cos - start.sin * half_sin);
        let mut splits = on_sin.lt(sin) & self.all(0.0).lt(on_cos);
        (sin, cos) = (splits.select(on_sin, sin), splits.select(on_cos, cos));
        if halves {
            let limited = walk.limit[0].lt(sin);
            (sin, cos) = (limited.select(walk.limit[0], sin), limited.select(walk.limit[1], cos));
            splits = splits | limited;
        }
        let end = self.interval.end;
        let is_last = end[0].le(sin);
        (sin, cos) = (is_last.select(end[0], sin), is_last.select(end[1], cos));
        NextEnd { end: self.rims.point(sin, cos), is_last, splits, by_x, turns: [x.2, y.2] }
    }

    /// Bounds of the gap along an arc, `turn` the sine of its length.
    pub(super) fn arc(
        &self,
        cell: &Cells<S>,
        from: [Lanes<S>; 2],
        [left, right]: [GapDerivatives<S>; 2],
        turn: Lanes<S>,
    ) -> Arc<S> {
        let (zero, unit, size) = (self.all(0.0), self.all(1.0), &self.size);
        let length = turn * turn.mul_add(turn * self.all(0.19), unit);
        let eighth = length * length * self.all(0.125);
        let (along, across) = (cell.twist.mul_add(from[1], cell.along), cell.twist.mul_add(from[0], cell.across));
        let fourth = size[2]
            + along.abs() * size[0]
            + across.abs() * size[1]
            + self.all(8.0) * cell.twist.abs() * size[0] * size[1];
        let slack = fourth * eighth;
        let least_curvature = left.curvature.min(right.curvature) - slack;
        let most_curvature = left.curvature.max(right.curvature) + slack;
        let bound = left.gap.min(right.gap) - most_curvature.max(zero) * eighth;
        let is_convex = zero.le(least_curvature);
        // A monotonic gap has no minimum inside.
        let bent = length * least_curvature;
        let is_steady = zero.lt(left.rise + bent) | (right.rise - bent).lt(zero);
        let may_dip = zero.lt(most_curvature) & (is_convex | !is_steady);
        Arc { left, right, length, bound, least_curvature, may_dip, is_convex }
    }
}
