//! The least gap of rims along an interval of contact angles: a rim in every lane.
//!
//! A walk is a search in lockstep from one end of the interval to the other: each lane proceeds from cell to cell of
//! its own. Over one cell the gap is a trigonometric polynomial of second degree in the contact angle. Its second
//! derivative over an arc is bounded by its values at the ends and a bound of the fourth. Where it is positive there is
//! at most one minimum inside, a [`Candidate`]; where it is negative the minimum is an end; at a crease between two
//! cells the gap may have a minimum too. Where its sign may change, a first walk takes a lower bound of the gap. If
//! that is not above the least gap, a second walk halves such arcs, so that minima and maxima in one cell are
//! separated.
//!
//! Directions are pairs `(sin t, cos t)`; no angle is computed.

use super::arcs::{Arc, ArcEnd, NextEnd, Search, Walk};
use super::candidate::Candidate;
use super::circles::{FAR, Point, RimLanes, cells};
use super::interval::{AngleInterval, GapMinimum, TIE};
use crate::interval::both;
use crate::terrain::Terrain;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;

/// Arcs shorter than this are points [rad].
const POINT: f64 = 1e-14;

/// Arcs shorter than this are not halved [rad]: the gap inside differs from that at their ends by 1e-17 m or so.
const SHORTEST_ARC: f64 = 1e-8;

/// Largest numbers of steps of the first and of the second walk. A rim that crosses more than some hundred lines of the grid is
/// too large for its cells to describe the ground under it: that ground counts as unknown.
const STEPS: [usize; 2] = [108, 4096];

/// The least gap of every rim along an interval.
#[inline(always)]
pub fn find_min_gap<S: Vector>(
    simd: S,
    ground: &Terrain,
    rims: &RimLanes<S>,
    interval: &AngleInterval<S>,
) -> GapMinimum<S> {
    let search = Search::new(simd, ground, rims, interval);
    let far = Lanes::splat(simd, FAR);
    let mut found = GapMinimum::none(simd);
    let (mut ceiling, mut open) = (far, Lanes::splat(simd, 0.0).lt(far));
    for halves in [false, true] {
        let walked = search.walk(ceiling, halves);
        found = if halves { GapMinimum::pick(open, &walked, &found) } else { walked };
        let lowest = (found.gap + Lanes::splat(simd, TIE)).min(far);
        open = open & found.unresolved.lt(far) & found.unresolved.le(lowest);
        if !interval.is_exact || !open.any() {
            break;
        }
        ceiling = found.gap;
    }
    found.others = found.others.min(found.unresolved).min(found.next_gap);
    found
}

#[inline_always]
impl<S: Vector> Search<'_, S> {
    /// The end of known ground before an arc: the gap decreases towards it in a closed interval, and increases in an
    /// open one.
    fn edge(&self) -> ArcEnd<S> {
        let zero = self.all(0.0);
        let rise = if self.interval.is_closed { f64::NEG_INFINITY } else { f64::INFINITY };
        ArcEnd { gap: self.all(FAR), rise: self.all(rise), slope: [zero; 2] }
    }

    /// Searches from one end of the interval to the other.
    fn walk(&self, ceiling: Lanes<S>, halves: bool) -> GapMinimum<S> {
        let (zero, unit, far) = (self.all(0.0), self.all(1.0), self.all(FAR));
        let start = self.rims.point(self.interval.start[0], self.interval.start[1]);
        let [cell, sign] = self.cell_at(&start);
        let mut walk = Walk {
            found: GapMinimum::none(self.simd),
            ceiling,
            candidates: [Candidate::none(self.simd); 2],
            active: zero.lt(unit),
            start,
            cell,
            sign,
            limit: [self.all(2.0), zero],
            is_found_again: unit.lt(zero),
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
            // The gap decreases towards the end, or the arc has no length.
            let falls = last.gap.lt(far) & last.rise.le(zero);
            self.offer(&mut walk, falls, last.gap, self.interval.end, last.slope);
        } else {
            walk.found.others = first.min(last.gap);
        }
        walk.found.others = (walk.found.unknown | walk.found.outside).select(-far, walk.found.others);
        walk.found
    }

    /// Searches one arc of every rim. Returns the gap at its start, [`FAR`] over unknown ground.
    fn step(&self, walk: &mut Walk<S>, halves: bool) -> Lanes<S> {
        let (simd, rims) = (self.simd, self.rims);
        let cell = cells(simd, self.ground, walk.cell[0], walk.cell[1]);
        let mut next = self.next_end(walk, halves);
        let from = both!(k, rims.centre[k] - walk.cell[k]);
        let left = rims.derivatives(&cell, from, &walk.start);
        let right = rims.derivatives(&cell, from, &next.end);
        // Unknown or off the map: NaN.
        let known = cell.twist.le(self.all(FAR));
        // The arc ends in its cell unless rounding has put the search into a wrong one.
        let strays = both!(k, {
            let place = from[k] + next.end.spoke[k];
            self.all(0.5 + 1e-9).lt((place - self.all(0.5)).abs())
        });
        let strays = walk.active & (strays[0] | strays[1]);
        let turn = next.end.sin * walk.start.cos - next.end.cos * walk.start.sin;
        let is_long = walk.active & self.all(POINT).lt(turn);
        let arc = self.arc(&cell, from, [left, right], turn);
        let mut real = is_long & known;
        let may_hold = real & arc.may_dip & arc.bound.le(walk.ceiling + self.interval.margin);
        let lost = is_long & !known & !(strays & !walk.is_found_again);
        if (lost | strays).any() {
            self.leave_known_ground(walk, lost);
            if !halves {
                walk.found.unresolved = strays.select(-self.all(FAR), walk.found.unresolved);
            }
        }
        let unclear = may_hold & !arc.is_convex;
        if halves {
            let halved = unclear & self.all(SHORTEST_ARC).lt(arc.length);
            let again = halved | (strays & !walk.is_found_again);
            real = real & !again;
            self.retry(walk, &mut next, halved, again & !halved);
        } else {
            // Lower bound of the gap inside by parabolas from both ends.
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

    /// Keeps a convex arc with a minimum inside that may be the least: the two with the lowest bounds are evaluated at
    /// the end of the walk, others at once if arcs are halved.
    fn keep_candidate(&self, walk: &mut Walk<S>, arc: &Arc<S>, mask: Mask<S>, halves: bool) {
        let (zero, unit, far) = (self.all(0.0), self.all(1.0), self.all(FAR));
        let Arc { left, right, .. } = arc;
        let dips = left.rise.lt(zero) & zero.lt(right.rise);
        // Parabolas from both ends with the least curvature of the arc are below the gap.
        let (bend, turn) = (arc.least_curvature.max(self.all(1e-12)), dips.select(left.rise - right.rise, -unit));
        let inverse = unit / (bend * turn);
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
        let mask = mask & dips & bound.le(walk.ceiling + self.interval.margin);
        let [lowest, second] = walk.candidates;
        let is_lowest = mask & bound.lt(lowest.bound);
        let is_second = mask & !is_lowest & bound.lt(second.bound);
        let is_kept = is_lowest | is_second;
        let dropped = is_kept.select(second.bound, mask.select(bound, far));
        if !halves {
            walk.found.unresolved = walk.found.unresolved.min(dropped);
        } else if dropped.lt(far).any() {
            let other = Candidate::pick(is_kept, &second, &candidate);
            self.polish(walk, &Candidate { bound: dropped, ..other });
        }
        walk.candidates[1] = Candidate::pick(is_lowest, &lowest, &Candidate::pick(is_second, &candidate, &second));
        walk.candidates[0] = Candidate::pick(is_lowest, &candidate, &lowest);
    }

    /// Adds the minimum of a candidate that may be the least.
    fn polish(&self, walk: &mut Walk<S>, candidate: &Candidate<S>) {
        // A bound of `FAR` is that of no candidate.
        let wanted = candidate.bound.lt(self.all(FAR)) & candidate.bound.le(walk.ceiling + self.interval.margin);
        if !wanted.any() {
            return;
        }
        let (at, minimum) = candidate.minimum(self.simd, self.ground, self.rims);
        self.offer(walk, wanted, minimum.gap, [at.sin, at.cos], minimum.slope);
    }

    /// Adds a minimum in the lanes of `mask`.
    fn offer(&self, walk: &mut Walk<S>, mask: Mask<S>, gap: Lanes<S>, at: [Lanes<S>; 2], slope: [Lanes<S>; 2]) {
        walk.found.offer(self.interval.is_closed, mask, gap, at, slope);
        walk.ceiling = walk.ceiling.min(walk.found.gap);
    }

    /// Adds the crease between the last arc and this one, if the gap decreases towards it from both sides.
    fn keep_crease(&self, walk: &mut Walk<S>, arc: &Arc<S>, mask: Mask<S>) {
        let (zero, unit) = (self.all(0.0), self.all(1.0));
        let (rise, slope) = (walk.before.rise, walk.before.slope);
        let falls = mask & rise.le(zero) & zero.le(arc.left.rise);
        let turned = arc.left.rise - rise;
        let bends = zero.lt(turned);
        // The weighted mean of both slopes that is orthogonal to the rim; 0 at the edge of known ground.
        let share = bends.select(arc.left.rise / bends.select(turned, unit), self.all(0.5));
        let mix = both!(k, share * slope[k] + (unit - share) * arc.left.slope[k]);
        self.offer(walk, falls, arc.left.gap, [walk.start.sin, walk.start.cos], mix);
    }

    /// Sets the flags of unknown ground, and adds its first point, if the gap decreases towards it.
    fn leave_known_ground(&self, walk: &mut Walk<S>, mask: Mask<S>) {
        let (zero, cell, before) = (self.all(0.0), walk.cell, walk.before);
        let [rows, columns] = self.ground.shape();
        let last = [self.all(columns as f64 - 2.0), self.all(rows as f64 - 2.0)];
        let on_map = zero.le(cell[0]) & zero.le(cell[1]) & cell[0].le(last[0]) & cell[1].le(last[1]);
        walk.found.unknown = walk.found.unknown | (mask & on_map);
        walk.found.outside = walk.found.outside | (mask & !on_map);
        if self.interval.is_closed {
            let falls = mask & before.gap.lt(self.all(FAR)) & before.rise.le(zero);
            self.offer(walk, falls, before.gap, [walk.start.sin, walk.start.cos], before.slope);
        }
        let edge = self.edge();
        walk.before = ArcEnd {
            gap: mask.select(edge.gap, before.gap),
            rise: mask.select(edge.rise, before.rise),
            slope: both!(k, mask.select(edge.slope[k], before.slope[k])),
        };
    }

    /// Repeats an arc: up to its middle, or from the corrected cell after a wrong one.
    fn retry(&self, walk: &mut Walk<S>, next: &mut NextEnd<S>, halved: Mask<S>, strays: Mask<S>) {
        walk.limit = [self.all(2.0), self.all(0.0)];
        let again = halved | strays;
        if !again.any() {
            return;
        }
        let (start, end) = (&walk.start, &next.end);
        let (sin, cos) = (start.sin + end.sin, start.cos + end.cos);
        let scale = self.all(1.0) / (sin * sin + cos * cos).sqrt();
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

    /// Proceeds to the next arc.
    fn advance(&self, walk: &mut Walk<S>, next: &NextEnd<S>, real: Mask<S>, arc: &Arc<S>) {
        let before = walk.before;
        walk.before = ArcEnd {
            gap: real.select(arc.right.gap, before.gap),
            rise: real.select(arc.right.rise, before.rise),
            slope: both!(k, real.select(arc.right.slope[k], before.slope[k])),
        };
        walk.active = walk.active & !next.is_last;
        let moves = !next.splits;
        for (k, crosses) in [moves & next.by_x, moves & !next.by_x].into_iter().enumerate() {
            let turns = crosses & next.turns[k];
            let passes = crosses & !next.turns[k];
            walk.cell[k] = passes.select(walk.cell[k] + walk.sign[k], walk.cell[k]);
            walk.sign[k] = turns.select(-walk.sign[k], walk.sign[k]);
        }
        walk.start = next.end;
    }
}
