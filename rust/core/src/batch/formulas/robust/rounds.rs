//! A register of rows in its rounds: weights by residuals, and the least squares with them.

use super::{Block, LANES, MOST, Plan};
use crate::batch::formulas::readings::solve;
use crate::batch::machine::lanes::{Lanes, Mask};
use crate::batch::machine::vector::Vector;
use crate::batch::machine::weave::{BLOCK, Column};
use crate::estimate::{MEDIANS, SETTLED};

/// Puts pairs in order, one after the other. Names and not places, so that they stay in registers: through memory, this
/// took a third of a round.
macro_rules! order {
    ($($low: ident $high: ident),*) => {
        $(($low, $high) = ($low.min($high), $low.max($high));)*
    };
}

/// A register of rows in its rounds.
pub(super) struct Rounds<S: Vector> {
    seen: [[Lanes<S>; 2]; MOST],
    /// About the centre of the pivots, the last one a speed.
    unknowns: [Lanes<S>; 3],
    weights: [Lanes<S>; MOST],
    /// Squares of the noise at least, and of the scale of the last round [m²/s²].
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
    pub fn load(
        simd: S,
        plan: &Plan,
        rows: &Block<'_, '_>,
        chosen: &[usize],
        count: usize,
    ) -> Self {
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
        for (unknown, column) in rounds.unknowns.iter_mut().zip(&rows.kept.unknowns) {
            *unknown = gathered(simd, column, chosen);
        }
        for i in 0..plan.wheels.len() {
            for (seen, column) in rounds.seen[i].iter_mut().zip(&rows.kept.seen[i]) {
                *seen = gathered(simd, column, chosen);
            }
            rounds.weights[i] = gathered(simd, &rows.weights[i], chosen);
        }
        rounds
    }

    #[inline(always)]
    pub fn store(&self, plan: &Plan, rows: &mut Block<'_, '_>, chosen: &[usize]) {
        for (unknown, column) in self.unknowns.iter().zip(&mut rows.kept.unknowns) {
            scattered(*unknown, column, chosen);
        }
        for i in 0..plan.wheels.len() {
            scattered(self.weights[i], &mut rows.weights[i], chosen);
        }
        scattered(self.scale, &mut rows.scale, chosen);
    }

    /// One round, where it has not settled. In squares of residuals and scales, with one root and few divisions: these
    /// are what takes the time.
    #[inline(always)]
    pub fn round(&mut self, simd: S, plan: &Plan) {
        let splat = |number| Lanes::splat(simd, number);
        let (zero, one) = (splat(0.0), splat(1.0));
        let count = plan.wheels.len();
        // What is not there comes last.
        let mut squares = [splat(f64::MAX); MOST];
        for (i, wheel) in plan.wheels.iter().enumerate() {
            squares[i] = wheel.rows.square(simd, self.seen[i], self.unknowns);
        }
        let [mut a, mut b, mut c, mut d, mut e, mut f, mut g, mut h] = squares;
        order!(a c, b d, e g, f h, a e, b f, c g, d h, a b, c d);
        order!(e f, g h, c e, d f, b e, d g, b c, d e, f g);
        let sorted = [a, b, c, d, e, f, g, h];
        let mut median = sorted[count / 2];
        if count.is_multiple_of(2) {
            let lower = sorted[count / 2 - 1];
            let twice = (lower * median).sqrt();
            median = ((lower + median) + (twice + twice)) * splat(0.25);
        }
        let noise = (median * splat(MEDIANS * MEDIANS)).max(self.least);
        // The first one starts at the largest residual.
        let first = splat(f64::MAX).below(self.scale);
        self.scale = first.select(sorted[count - 1].max(self.least), self.scale);
        self.scale = self.scale.min(noise.max(self.scale * splat(0.25)));
        // Where nothing disagrees at all, nothing is weighed.
        let active = self.active & zero.below(self.scale);
        let per_square = one.quotient(self.scale);
        // One over each of the ratios, from one over their product.
        let (mut ratios, mut before) = ([one; MOST], [one; MOST]);
        let mut product = one;
        for i in 0..count {
            ratios[i] = squares[i].mul_add(per_square, one);
            before[i] = product;
            product = product * ratios[i];
        }
        let mut rest = one.quotient(product);
        let mut change = zero;
        let (mut normal, mut right) = ([zero; 6], [zero; 3]);
        for (i, wheel) in plan.wheels.iter().enumerate().rev() {
            let inverse = rest * before[i];
            rest = rest * ratios[i];
            let next = active.select(inverse * inverse, self.weights[i]);
            change = change.max((next - self.weights[i]).abs());
            self.weights[i] = next;
            for (sum, part) in normal.iter_mut().zip(wheel.normal) {
                *sum = next.mul_add(splat(part), *sum);
            }
            for (sum, part) in right.iter_mut().zip(wheel.rows.moment(simd, self.seen[i])) {
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
