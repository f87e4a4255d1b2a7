//! The least gap of rims along an interval of contact angles: a rim in every lane.
//!
//! All lanes walk in lockstep from one end of the interval to the other, each from cell to cell of its own. Over one cell the gap
//! is a trigonometric polynomial of second degree in the contact angle. Its second derivative over an arc is bounded by its
//! values at the ends and a bound of the fourth. Where it is positive there is at most one minimum inside, a [`Candidate`]; where
//! it is negative the minimum is an end; on a crease between two cells the gap may fall from both sides. Where its sign may
//! change, a first walk takes a lower bound of the gap. If that is not above the least gap, a second walk halves such arcs, so
//! that a dip and a hump in one cell are both seen.
//!
//! Directions are pairs `(sin t, cos t)`; no angle is computed.

use super::candidate::Candidate;
use super::circles::{Cells, FAR, GapDerivatives, Point, RimLanes, both, cells, floor};
use crate::terrain::Terrain;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;

/// Minima nearer to each other than this are both kept [m].
pub(crate) const TIE: f64 = 2e-7;

/// Arcs shorter than this are points [rad].
const POINT: f64 = 1e-14;

/// Arcs shorter than this are not halved [rad]: the gap inside differs from that at their ends by 1e-17 m or so.
const SHORTEST_ARC: f64 = 1e-8;

/// Sine and cosine of half a radian, the longest arc.
const LONGEST_ARC: [f64; 2] = [0.479_425_538_604_203, 0.877_582_561_890_372_8];

/// Steps of the first and of the second walk at most. Under a rim that crosses more than some hundred lines of the grid, heights
/// no longer describe what the wheel stands on: it is unknown ground.
const STEPS: [usize; 2] = [108, 4096];

/// A part of the lower halves of the rims.
#[derive(Clone, Copy)]
pub(crate) struct AngleInterval<S: Vector> {
    /// Sine and cosine of the contact angle where it begins.
    pub start: [Lanes<S>; 2],
    /// The same where it ends.
    pub end: [Lanes<S>; 2],
    /// Height above the least gap up to which other minima are kept [m].
    pub margin: Lanes<S>,
    /// True if the ends count as minima where the gap falls towards them.
    pub is_closed: bool,
    /// True if arcs along which the curvature may change its sign are halved where they may hold the least gap.
    pub is_exact: bool,
}

impl<S: Vector> AngleInterval<S> {
    /// The lower halves.
    #[inline(always)]
    pub fn lower(simd: S) -> Self {
        let (zero, unit) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let margin = Lanes::splat(simd, TIE);
        Self { start: [-unit, zero], end: [unit, zero], margin, is_closed: true, is_exact: true }
    }
}

/// The least gap of every rim along an interval.
#[derive(Clone, Copy)]
pub(crate) struct GapMinimum<S: Vector> {
    /// The gap [m]; [`FAR`] where there is no minimum.
    pub gap: Lanes<S>,
    /// Sine and cosine of its contact angle.
    pub at: [Lanes<S>; 2],
    /// Derivatives of the ground's height by columns and rows [m].
    pub slope: [Lanes<S>; 2],
    /// The next best minimum, as far as it is up to the margin above the least [m], and sine and cosine of its contact angle.
    pub next_gap: Lanes<S>,
    pub next_at: [Lanes<S>; 2],
    /// Nothing else, the ends of the interval included, is lower than this, as far as it is up to the margin above the gap [m].
    pub others: Lanes<S>,
    /// Lower bound of the gap along arcs whose curvature may change its sign [m].
    unresolved: Lanes<S>,
    /// True if the interval lies over unknown ground, and if it leaves the map.
    pub unknown: Mask<S>,
    pub outside: Mask<S>,
}

impl<S: Vector> GapMinimum<S> {
    /// No gap, over ground that is known.
    #[inline(always)]
    pub fn none(simd: S) -> Self {
        let (zero, unit, far) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0), Lanes::splat(simd, FAR));
        let at = [zero, unit];
        Self {
            gap: far,
            at,
            slope: [zero; 2],
            next_gap: far,
            next_at: at,
            others: far,
            unresolved: far,
            unknown: unit.below(zero),
            outside: unit.below(zero),
        }
    }

    /// `yes` where true, `no` elsewhere.
    #[inline(always)]
    fn pick(mask: Mask<S>, yes: &Self, no: &Self) -> Self {
        Self {
            gap: mask.select(yes.gap, no.gap),
            at: both!(k, mask.select(yes.at[k], no.at[k])),
            slope: both!(k, mask.select(yes.slope[k], no.slope[k])),
            next_gap: mask.select(yes.next_gap, no.next_gap),
            next_at: both!(k, mask.select(yes.next_at[k], no.next_at[k])),
            others: mask.select(yes.others, no.others),
            unresolved: mask.select(yes.unresolved, no.unresolved),
            unknown: (mask & yes.unknown) | (!mask & no.unknown),
            outside: (mask & yes.outside) | (!mask & no.outside),
        }
    }

    /// Takes in a minimum.
    #[inline(always)]
    fn offer(&mut self, mask: Mask<S>, gap: Lanes<S>, at: [Lanes<S>; 2], slope: [Lanes<S>; 2]) {
        let is_least = mask & gap.below(self.gap);
        let is_next = mask & gap.below(self.next_gap);
        self.next_gap = is_least.select(self.gap, is_next.select(gap, self.next_gap));
        self.next_at = both!(k, is_least.select(self.at[k], is_next.select(at[k], self.next_at[k])));
        self.gap = is_least.select(gap, self.gap);
        self.at = both!(k, is_least.select(at[k], self.at[k]));
        self.slope = both!(k, is_least.select(slope[k], self.slope[k]));
    }
}

/// The least gap of every rim along an interval.
#[inline(always)]
pub(crate) fn find_min_gap<S: Vector>(
    simd: S,
    ground: &Terrain,
    rims: &RimLanes<S>,
    interval: &AngleInterval<S>,
) -> GapMinimum<S> {
    let search = Search::new(simd, ground, rims, interval);
    let far = Lanes::splat(simd, FAR);
    let mut found = GapMinimum::none(simd);
    let (mut ceiling, mut open) = (far, Lanes::splat(simd, 0.0).below(far));
    for halves in [false, true] {
        let walked = search.walk(ceiling, halves);
        found = GapMinimum::pick(open, &walked, &found);
        let lowest = (found.gap + Lanes::splat(simd, TIE)).min(far);
        open = open & found.unresolved.below(far) & found.unresolved.at_most(lowest);
        if !interval.is_exact || !open.any() {
            break;
        }
        ceiling = found.gap;
    }
    found.others = found.others.min(found.unresolved).min(found.next_gap);
    found
}

/// The numbers of a search that stay the same all along.
struct Search<'a, S: Vector> {
    simd: S,
    ground: &'a Terrain,
    rims: &'a RimLanes<S>,
    interval: &'a AngleInterval<S>,
    /// Half the widths of the circles, along columns, rows and heights.
    size: [Lanes<S>; 3],
    /// For columns and rows: one over that, and `forward` and `up` as shares of it.
    lines: [[Lanes<S>; 3]; 2],
}

/// A search on its way.
struct Walk<S: Vector> {
    found: GapMinimum<S>,
    /// Upper bound of the least gap [m].
    ceiling: Lanes<S>,
    candidates: [Candidate<S>; 2],
    /// True in the lanes that have not come to the end.
    active: Mask<S>,
    start: Point<S>,
    /// Lowest column and row of the cell ahead.
    cell: [Lanes<S>; 2],
    /// 1 where the rim goes towards larger columns and rows, -1 elsewhere.
    sign: [Lanes<S>; 2],
    /// Sine and cosine of where the next arc has to end; a sine of 2 where it may be as long as it is.
    limit: [Lanes<S>; 2],
    /// True where the cell has been found again after rounding had led the walk astray.
    is_found_again: Mask<S>,
    /// The end of the last arc: gap, its derivative along the rim, and the slope of the ground.
    before: ArcEnd<S>,
}

#[derive(Clone, Copy)]
struct ArcEnd<S: Vector> {
    gap: Lanes<S>,
    rise: Lanes<S>,
    slope: [Lanes<S>; 2],
}

/// The end of the next arc.
struct NextEnd<S: Vector> {
    end: Point<S>,
    /// True where the arc ends at the end of the interval, and where it ends inside its cell.
    is_last: Mask<S>,
    splits: Mask<S>,
    /// True where a line between columns is next, not one between rows.
    by_x: Mask<S>,
    /// True where the rim only turns back before that line.
    turns: [Mask<S>; 2],
}

/// An arc over one cell.
struct Arc<S: Vector> {
    left: GapDerivatives<S>,
    right: GapDerivatives<S>,
    /// Length [rad].
    length: Lanes<S>,
    /// Lower bound of the gap [m], and of its second derivative.
    bound: Lanes<S>,
    least_curvature: Lanes<S>,
    /// True where the gap may have a minimum inside.
    may_dip: Mask<S>,
    is_convex: Mask<S>,
}

impl<'a, S: Vector> Search<'a, S> {
    #[inline(always)]
    fn new(simd: S, ground: &'a Terrain, rims: &'a RimLanes<S>, interval: &'a AngleInterval<S>) -> Self {
        let (zero, unit) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
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
        Self { simd, ground, rims, interval, size, lines }
    }

    #[inline(always)]
    fn all(&self, value: f64) -> Lanes<S> {
        Lanes::splat(self.simd, value)
    }

    /// The end of known ground before an arc: of a closed interval the gap is taken to fall towards it, of an open one to rise.
    #[inline(always)]
    fn edge(&self) -> ArcEnd<S> {
        let zero = self.all(0.0);
        let rise = if self.interval.is_closed { f64::NEG_INFINITY } else { f64::INFINITY };
        ArcEnd { gap: self.all(FAR), rise: self.all(rise), slope: [zero; 2] }
    }

    /// The cell ahead of a point and the directions in which the rim goes from there.
    #[inline(always)]
    fn cell_at(&self, at: &Point<S>) -> [[Lanes<S>; 2]; 2] {
        let (zero, unit) = (self.all(0.0), self.all(1.0));
        let cell = both!(k, floor(self.simd, self.rims.centre[k] + at.spoke[k]));
        let sign = both!(k, {
            // Where it turns just there, the direction that it then takes.
            let rests = at.tangent[k].abs().at_most(zero);
            let way = rests.select(-at.spoke[k], at.tangent[k]);
            way.below(zero).select(-unit, unit)
        });
        [cell, sign]
    }

    /// Walks from one end of the interval to the other.
    #[inline(always)]
    fn walk(&self, ceiling: Lanes<S>, halves: bool) -> GapMinimum<S> {
        let (zero, unit, far) = (self.all(0.0), self.all(1.0), self.all(FAR));
        let start = self.rims.point(self.interval.start[0], self.interval.start[1]);
        let [cell, sign] = self.cell_at(&start);
        let mut walk = Walk {
            found: GapMinimum::none(self.simd),
            ceiling,
            candidates: [Candidate::none(self.simd); 2],
            active: zero.below(unit),
            start,
            cell,
            sign,
            limit: [self.all(2.0), zero],
            is_found_again: unit.below(zero),
            before: self.edge(),
        };
        let mut first = far;
        for step in 0..STEPS[usize::from(halves)] {
            let left = self.step(&mut walk, halves);
            if step == 0 {
                first = left;
            }
            if !walk.active.any() {
                break;
            }
        }
        walk.found.unknown = walk.found.unknown | walk.active;
        for k in 0..2 {
            let candidate = walk.candidates[k];
            self.polish(&mut walk, &candidate);
        }
        let last = walk.before;
        if self.interval.is_closed {
            // The gap falls towards the end, or the half circle ends at once.
            let falls = last.gap.below(far) & last.rise.at_most(zero);
            walk.found.offer(falls, last.gap, self.interval.end, last.slope);
        } else {
            walk.found.others = first.min(last.gap);
        }
        walk.found.others = (walk.found.unknown | walk.found.outside).select(-far, walk.found.others);
        walk.found
    }

    /// One arc of every rim; the gap where it begins, [`FAR`] over unknown ground.
    #[inline(always)]
    fn step(&self, walk: &mut Walk<S>, halves: bool) -> Lanes<S> {
        let (simd, rims) = (self.simd, self.rims);
        let cell = cells(simd, self.ground, walk.cell[0], walk.cell[1]);
        let mut next = self.next_end(walk, halves);
        let from = both!(k, rims.centre[k] - walk.cell[k]);
        let left = rims.derivatives(&cell, from, &walk.start);
        let right = rims.derivatives(&cell, from, &next.end);
        // Unknown or off the map: NaN.
        let known = cell.twist.at_most(self.all(FAR));
        // The arc ends in its cell unless rounding has led the walk astray.
        let strays = both!(k, {
            let place = from[k] + next.end.spoke[k];
            self.all(0.5 + 1e-9).below((place - self.all(0.5)).abs())
        });
        let strays = walk.active & (strays[0] | strays[1]);
        let turn = next.end.sin * walk.start.cos - next.end.cos * walk.start.sin;
        let is_long = walk.active & self.all(POINT).below(turn);
        let arc = self.arc(&cell, from, [left, right], turn);
        let mut real = is_long & known;
        let may_hold = real & arc.may_dip & arc.bound.at_most(walk.ceiling + self.interval.margin);
        let lost = is_long & !known & !(strays & !walk.is_found_again);
        if (lost | strays).any() {
            self.leave_known_ground(walk, lost);
            if !halves {
                walk.found.unresolved = strays.select(-self.all(FAR), walk.found.unresolved);
            }
        }
        let unclear = may_hold & !arc.is_convex;
        if halves {
            let halved = unclear & self.all(SHORTEST_ARC).below(arc.length);
            let again = halved | (strays & !walk.is_found_again);
            real = real & !again;
            self.retry(walk, &mut next, halved, again & !halved);
        } else {
            // Parabolas from its ends say how low the gap may be inside.
            let bent = arc.length * arc.least_curvature * self.all(0.5);
            let low = (left.rise + bent)
                .mul_add(arc.length, left.gap)
                .max((bent - right.rise).mul_add(arc.length, right.gap))
                .max(arc.bound);
            walk.found.unresolved = unclear.select(walk.found.unresolved.min(low), walk.found.unresolved);
        }
        self.keep_candidate(walk, &arc, may_hold & arc.is_convex & real, halves);
        self.keep_crease(walk, &arc, real);
        self.advance(walk, &next, real, &arc);
        known.select(left.gap, self.all(FAR))
    }

    /// A line of the grid that a rim crosses next: sine and cosine there, and whether it only turns back before it.
    #[inline(always)]
    fn crossing(&self, axis: usize, walk: &Walk<S>) -> (Lanes<S>, Lanes<S>, Mask<S>) {
        let (zero, one) = (self.all(0.0), self.all(1.0));
        let (sign, [inverse, p, q]) = (walk.sign[axis], self.lines[axis]);
        let ahead = zero.below(sign).select(one, zero);
        let line = (walk.cell[axis] + ahead) - self.rims.centre[axis];
        let w = line * inverse;
        let turns = one.at_most(w * sign);
        let w = turns.select(sign, w);
        let v = sign * (one - w * w).max(zero).sqrt();
        let (sin, cos) = (w * p + v * q, v * p - w * q);
        (zero.below(cos).select(sin, self.all(2.0)), cos, turns)
    }

    /// The end of the next arc: the next line of the grid, half a radian on, the limit, or the end of the interval.
    #[inline(always)]
    fn next_end(&self, walk: &Walk<S>, halves: bool) -> NextEnd<S> {
        let start = &walk.start;
        let [x, y] = both!(k, self.crossing(k, walk));
        let by_x = x.0.below(y.0);
        let (mut sin, mut cos) = (by_x.select(x.0, y.0), by_x.select(x.1, y.1));
        // Rounding may put a crossing before the last one.
        let back = sin.below(start.sin);
        (sin, cos) = (back.select(start.sin, sin), back.select(start.cos, cos));
        let [half_sin, half_cos] = LONGEST_ARC.map(|value| self.all(value));
        let (on_sin, on_cos) =
            (start.sin * half_cos + start.cos * half_sin, start.cos * half_cos - start.sin * half_sin);
        let mut splits = on_sin.below(sin) & self.all(0.0).below(on_cos);
        (sin, cos) = (splits.select(on_sin, sin), splits.select(on_cos, cos));
        if halves {
            let limited = walk.limit[0].below(sin);
            (sin, cos) = (limited.select(walk.limit[0], sin), limited.select(walk.limit[1], cos));
            splits = splits | limited;
        }
        let end = self.interval.end;
        let is_last = end[0].at_most(sin);
        (sin, cos) = (is_last.select(end[0], sin), is_last.select(end[1], cos));
        NextEnd { end: self.rims.point(sin, cos), is_last, splits, by_x, turns: [x.2, y.2] }
    }

    /// Bounds of the gap along an arc, `turn` the sine of its length.
    #[inline(always)]
    fn arc(
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
        let is_convex = zero.at_most(least_curvature);
        // Where the gap rises or falls all along there is nothing inside.
        let bent = length * least_curvature;
        let is_steady = zero.below(left.rise + bent) | (right.rise - bent).below(zero);
        let may_dip = zero.below(most_curvature) & (is_convex | !is_steady);
        Arc { left, right, length, bound, least_curvature, may_dip, is_convex }
    }

    /// Keeps a convex arc at whose ends the gap falls inwards, if it may hold the least gap: the two lowest are looked at in the
    /// end, others at once if arcs are halved.
    #[inline(always)]
    fn keep_candidate(&self, walk: &mut Walk<S>, arc: &Arc<S>, mask: Mask<S>, halves: bool) {
        let (zero, unit, far) = (self.all(0.0), self.all(1.0), self.all(FAR));
        let Arc { left, right, .. } = arc;
        let dips = left.rise.below(zero) & zero.below(right.rise);
        // Parabolas through both ends, bent as little as the gap is anywhere on the arc, are below it.
        let (bend, turn) = (arc.least_curvature.max(self.all(1e-12)), dips.select(left.rise - right.rise, -unit));
        let inverse = unit.quotient(bend * turn);
        let depth = turn * inverse * self.all(-0.5);
        let bound = (left.rise * left.rise)
            .mul_add(depth, left.gap)
            .max((right.rise * right.rise).mul_add(depth, right.gap))
            .max(arc.bound);
        let candidate = Candidate {
            bound,
            sin: walk.start.sin,
            cos: walk.start.cos,
            length: arc.length,
            share: left.rise * bend * inverse,
            column: walk.cell[0],
            row: walk.cell[1],
        };
        let mask = mask & dips & bound.at_most(walk.ceiling + self.interval.margin);
        let [lowest, second] = walk.candidates;
        let is_lowest = mask & bound.below(lowest.bound);
        let is_second = mask & !is_lowest & bound.below(second.bound);
        let is_kept = is_lowest | is_second;
        let dropped = is_kept.select(second.bound, mask.select(bound, far));
        if !halves {
            walk.found.unresolved = walk.found.unresolved.min(dropped);
        } else if dropped.below(far).any() {
            let other = Candidate::pick(is_kept, &second, &candidate);
            self.polish(walk, &Candidate { bound: dropped, ..other });
        }
        walk.candidates[1] = Candidate::pick(is_lowest, &lowest, &Candidate::pick(is_second, &candidate, &second));
        walk.candidates[0] = Candidate::pick(is_lowest, &candidate, &lowest);
    }

    /// Takes in the minimum of a candidate that may be the least.
    #[inline(always)]
    fn polish(&self, walk: &mut Walk<S>, candidate: &Candidate<S>) {
        // Where there is no candidate there is no arc either, however far the least gap is.
        let wanted =
            candidate.bound.below(self.all(FAR)) & candidate.bound.at_most(walk.ceiling + self.interval.margin);
        if !wanted.any() {
            return;
        }
        let (at, minimum) = candidate.minimum(self.simd, self.ground, self.rims);
        walk.found.offer(wanted, minimum.gap, [at.sin, at.cos], minimum.slope);
        walk.ceiling = walk.ceiling.min(walk.found.gap);
    }

    /// Takes in the crease between the last arc and this one, if the gap falls towards it from both sides.
    #[inline(always)]
    fn keep_crease(&self, walk: &mut Walk<S>, arc: &Arc<S>, mask: Mask<S>) {
        let (zero, unit) = (self.all(0.0), self.all(1.0));
        let (rise, slope) = (walk.before.rise, walk.before.slope);
        let falls = mask & rise.at_most(zero) & zero.at_most(arc.left.rise);
        let turned = arc.left.rise - rise;
        let bends = zero.below(turned);
        // The mix of both slopes that is square to the rim; 0 at the edge of known ground.
        let share = bends.select(arc.left.rise.quotient(bends.select(turned, unit)), self.all(0.5));
        let mix = both!(k, share * slope[k] + (unit - share) * arc.left.slope[k]);
        walk.found.offer(falls, arc.left.gap, [walk.start.sin, walk.start.cos], mix);
        walk.ceiling = walk.ceiling.min(walk.found.gap);
    }

    /// Notes unknown ground, and takes in the point where it begins, if the gap falls towards it.
    #[inline(always)]
    fn leave_known_ground(&self, walk: &mut Walk<S>, mask: Mask<S>) {
        let (zero, cell, before) = (self.all(0.0), walk.cell, walk.before);
        let [rows, columns] = self.ground.shape();
        let last = [self.all(columns as f64 - 2.0), self.all(rows as f64 - 2.0)];
        let on_map =
            zero.at_most(cell[0]) & zero.at_most(cell[1]) & cell[0].at_most(last[0]) & cell[1].at_most(last[1]);
        walk.found.unknown = walk.found.unknown | (mask & on_map);
        walk.found.outside = walk.found.outside | (mask & !on_map);
        if self.interval.is_closed {
            let falls = mask & before.gap.below(self.all(FAR)) & before.rise.at_most(zero);
            walk.found.offer(falls, before.gap, [walk.start.sin, walk.start.cos], before.slope);
            walk.ceiling = walk.ceiling.min(walk.found.gap);
        }
        let edge = self.edge();
        walk.before = ArcEnd {
            gap: mask.select(edge.gap, before.gap),
            rise: mask.select(edge.rise, before.rise),
            slope: both!(k, mask.select(edge.slope[k], before.slope[k])),
        };
    }

    /// Begins an arc again: up to its middle, or from the cell that is just ahead where rounding had led astray.
    #[inline(always)]
    fn retry(&self, walk: &mut Walk<S>, next: &mut NextEnd<S>, halved: Mask<S>, strays: Mask<S>) {
        walk.limit = [self.all(2.0), self.all(0.0)];
        let again = halved | strays;
        if !again.any() {
            return;
        }
        let (start, end) = (&walk.start, &next.end);
        let (sin, cos) = (start.sin + end.sin, start.cos + end.cos);
        let scale = self.all(1.0).quotient((sin * sin + cos * cos).sqrt());
        walk.limit = [halved.select(sin * scale, walk.limit[0]), halved.select(cos * scale, walk.limit[1])];
        let on = self.all(1e-7);
        let ahead = self.rims.point(on.mul_add(start.cos, start.sin), start.cos - on * start.sin);
        let [cell, sign] = self.cell_at(&ahead);
        walk.cell = both!(k, strays.select(cell[k], walk.cell[k]));
        walk.sign = both!(k, strays.select(sign[k], walk.sign[k]));
        walk.is_found_again = walk.is_found_again | strays;
        next.end = Point::pick(again, start, end);
        next.splits = next.splits | again;
        next.is_last = next.is_last & !again;
    }

    /// Goes on to the next arc.
    #[inline(always)]
    fn advance(&self, walk: &mut Walk<S>, next: &NextEnd<S>, real: Mask<S>, arc: &Arc<S>) {
        let before = walk.before;
        walk.before = ArcEnd {
            gap: real.select(arc.right.gap, before.gap),
            rise: real.select(arc.right.rise, before.rise),
            slope: both!(k, real.select(arc.right.slope[k], before.slope[k])),
        };
        walk.active = walk.active & !next.is_last;
        let moves = !next.splits;
        let crosses = [moves & next.by_x, moves & !next.by_x];
        for k in 0..2 {
            let turns = crosses[k] & next.turns[k];
            let passes = crosses[k] & !next.turns[k];
            walk.cell[k] = passes.select(walk.cell[k] + walk.sign[k], walk.cell[k]);
            walk.sign[k] = turns.select(-walk.sign[k], walk.sign[k]);
        }
        walk.start = next.end;
    }
}
