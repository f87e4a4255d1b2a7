//! A register of rows in its rounds: weights by residuals, and the least squares with them.

use super::{Block, LANES, MOST, Plan};
use crate::batch::formulas::cone::dot;
use crate::batch::machine::lanes::{Lanes, Mask};
use crate::batch::machine::vector::Vector;
use crate::batch::machine::weave::{BLOCK, Column};
use crate::estimate::{MEDIANS, SETTLED};

/// Pivot of the normal equations, as a share of their trace, that surely determines a direction.
const DETERMINED: f64 = 1e-10;

/// A register of rows in its rounds.
pub(super) struct Rounds<S: Vector> {
    seen: [[Lanes<S>; 2]; MOST],
    /// About the centre of the pivots, the last one a speed.
    unknowns: [Lanes<S>; 3],
    weights: [Lanes<S>; MOST],
    least: Lanes<S>,
    scale: Lanes<S>,
    pub active: Mask<S>,
    pub sure: Mask<S>,
}

/// These rows of a column.
#[inline(always)]
fn gathered<S: Vector>(simd: S, column: &Column, rows: &[usize]) -> Lanes<S> {
    let mut room = [0.0; LANES];
    for (place, row) in room.iter_mut().zip(rows) {
        *place = column.0[*row % BLOCK];
    }
    Lanes::load(simd, S::as_simd_f64s(&room).0, 0)
}

#[inline(always)]
fn scattered<S: Vector>(lanes: Lanes<S>, column: &mut Column, rows: &[usize]) {
    let mut room = [0.0; LANES];
    lanes.store(S::as_mut_simd_f64s(&mut room).0, 0);
    for (value, row) in room.into_iter().zip(rows) {
        column.0[*row % BLOCK] = value;
    }
}

impl<S: Vector> Rounds<S> {
    /// Some rows, the first `count` of which are meant.
    #[inline(always)]
    pub fn load(simd: S, plan: &Plan, rows: &Block, chosen: &[usize], count: usize) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        let mut order = [0.0; LANES];
        for (k, place) in order.iter_mut().enumerate() {
            *place = k as f64;
        }
        let order = Lanes::load(simd, S::as_simd_f64s(&order).0, 0);
        let mut rounds = Self {
            seen: [[zero; 2]; MOST],
            unknowns: [zero; 3],
            weights: [zero; MOST],
            least: gathered(simd, &rows.least, chosen),
            scale: gathered(simd, &rows.scale, chosen),
            active: order.below(Lanes::splat(simd, count as f64)),
            sure: zero.at_most(zero),
        };
        for (unknown, column) in rounds.unknowns.iter_mut().zip(&rows.unknowns) {
            *unknown = gathered(simd, column, chosen);
        }
        for i in 0..plan.wheels.len() {
            for (seen, column) in rounds.seen[i].iter_mut().zip(&rows.seen[i]) {
                *seen = gathered(simd, column, chosen);
            }
            rounds.weights[i] = gathered(simd, &rows.weights[i], chosen);
        }
        rounds
    }

    #[inline(always)]
    pub fn store(&self, plan: &Plan, rows: &mut Block, chosen: &[usize]) {
        for (unknown, column) in self.unknowns.iter().zip(&mut rows.unknowns) {
            scattered(*unknown, column, chosen);
        }
        for i in 0..plan.wheels.len() {
            scattered(self.weights[i], &mut rows.weights[i], chosen);
        }
        scattered(self.scale, &mut rows.scale, chosen);
    }

    /// One round, where it has not settled.
    #[inline(always)]
    pub fn round(&mut self, simd: S, plan: &Plan) {
        let splat = |number| Lanes::splat(simd, number);
        let (zero, one) = (splat(0.0), splat(1.0));
        let count = plan.wheels.len();
        let squares = squares(simd, plan, &self.seen, &self.unknowns);
        let mut sorted = squares;
        for last in 1..count {
            for at in (1..=last).rev() {
                let (low, high) = (sorted[at - 1], sorted[at]);
                (sorted[at - 1], sorted[at]) = (low.min(high), low.max(high));
            }
        }
        let upper = sorted[count / 2].sqrt();
        let median = if count % 2 == 1 {
            upper
        } else {
            (sorted[count / 2 - 1].sqrt() + upper) * splat(0.5)
        };
        let noise = (median * splat(MEDIANS)).max(self.least);
        // The first one starts at the largest residual.
        let first = splat(f64::MAX).below(self.scale);
        let largest = sorted[count - 1].sqrt().max(self.least);
        self.scale = first.select(largest, self.scale);
        self.scale = self.scale.min(noise.max(self.scale * splat(0.5)));
        // Where nothing disagrees at all, nothing is weighed.
        let active = self.active & zero.below(self.scale);
        let per_square = one.quotient(self.scale * self.scale);
        let mut change = zero;
        let (mut normal, mut right) = ([zero; 6], [zero; 3]);
        for (i, wheel) in plan.wheels.iter().enumerate() {
            let ratio = squares[i].mul_add(per_square, one);
            let next = active.select(one.quotient(ratio * ratio), self.weights[i]);
            change = change.max((next - self.weights[i]).abs());
            self.weights[i] = next;
            for (sum, part) in normal.iter_mut().zip(wheel.normal) {
                *sum = next.mul_add(splat(part), *sum);
            }
            for (sum, part) in right.iter_mut().zip(wheel.moment(simd, self.seen[i])) {
                *sum = next.mul_add(part, *sum);
            }
        }
        let (solved, determined) = solve(simd, normal, right);
        self.sure = self.sure & (determined | !active);
        for (unknown, solved) in self.unknowns.iter_mut().zip(solved) {
            *unknown = active.select(solved, *unknown);
        }
        self.active = active & self.sure & splat(SETTLED).below(change);
    }
}

/// Squared residuals.
#[inline(always)]
pub(super) fn squares<S: Vector>(
    simd: S,
    plan: &Plan,
    seen: &[[Lanes<S>; 2]; MOST],
    unknowns: &[Lanes<S>; 3],
) -> [Lanes<S>; MOST] {
    let mut squares = [Lanes::splat(simd, 0.0); MOST];
    for (i, wheel) in plan.wheels.iter().enumerate() {
        let along = dot(simd, &wheel.rows[0], *unknowns) - seen[i][0];
        let across = dot(simd, &wheel.rows[1], *unknowns) - seen[i][1];
        squares[i] = along.mul_add(along, across * across);
    }
    squares
}

/// The solution of normal equations `00 01 02 11 12 22`, and where they surely have one.
#[inline(always)]
fn solve<S: Vector>(
    simd: S,
    [a, b, c, d, e, f]: [Lanes<S>; 6],
    [x, y, z]: [Lanes<S>; 3],
) -> ([Lanes<S>; 3], Mask<S>) {
    let one = Lanes::splat(simd, 1.0);
    let least = (a + d + f) * Lanes::splat(simd, DETERMINED);
    let first = one.quotient(a);
    let (l10, l20) = (b * first, c * first);
    let second = d - l10 * b;
    let (per_second, m) = (one.quotient(second), e - l20 * b);
    let l21 = m * per_second;
    let third = f - l20 * c - l21 * m;
    let y = y - l10 * x;
    let z = (z - l20 * x - l21 * y).quotient(third);
    let y = y * per_second - l21 * z;
    let x = x * first - l10 * y - l20 * z;
    let sure = least.below(a) & least.below(second) & least.below(third);
    ([x, y, z], sure)
}
