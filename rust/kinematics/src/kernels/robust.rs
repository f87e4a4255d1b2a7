//! Robust fits: rounds of weights by residuals and least squares with them, of whole registers of rows until all rows of a
//! block have settled.
//!
//! A steered wheel without scrub and trail measures its pivot's whole velocity, so what a wheel adds to the normal
//! equations is a constant of the rover times its weight; the rounds need no angle.

mod block;
mod rounds;

use self::block::LANES;
pub(crate) use self::block::{Block, MOST, RobustConstants, RobustWheel};
pub(crate) use self::rounds::{ByMinors, EARLY, IrlsIterations, LATE, NormalSolver};
use super::readings::FitColumns;
use crate::estimate::{NOISE, ROUNDS};
use six_wheel_numerics::columns::{BLOCK, Column};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;

/// Sums of squares of rim speeds whose squares neither overflow nor lose digits [m²/s²].
const SQUARES: [f64; 2] = [1e-100, 1e100];

/// The root of the smallest eigenvalue of the weighted normal equations is exact to 1e-12 if that is above this share
/// of the largest one. Otherwise the singular values of the rows are computed.
const EXACT_ROOT: f64 = 1e-3;

/// Jacobi rotations end when the entries they remove are below this share of the trace.
const DIAGONAL: f64 = 1e-18;
const SWEEPS: usize = 8;

impl<'a> Block<'a> {
    /// No rows yet.
    #[inline]
    pub fn new(readings: &'a mut [[Column; 2]], weights: &'a mut [Column]) -> Self {
        Self {
            kept: FitColumns::new(readings),
            weights,
            least: Column::ZERO,
            scale: Column::ZERO,
            active: [0; BLOCK],
            left: 0,
            rounds: ROUNDS,
        }
    }

    /// Starts from the least squares of a block, with the rare rows left out.
    #[inline(always)]
    pub fn begin<S: Vector>(&mut self, simd: S, constants: &RobustConstants, count: usize) {
        let one = Lanes::splat(simd, 1.0);
        fill(one, self.weights);
        self.scale = Column([f64::INFINITY; BLOCK]);
        let zero = Lanes::splat(simd, 0.0);
        let share = Lanes::splat(simd, NOISE * NOISE / constants.wheels.len() as f64);
        let tiny = Lanes::splat(simd, SQUARES[0]);
        let huge = Lanes::splat(simd, SQUARES[1]);
        for k in 0..count.div_ceil(S::F64_LANES) {
            let rolling = self.kept.rolling.load(simd, k);
            self.least.store(k, rolling * share);
            let sure = rolling.le(zero) | (tiny.le(rolling) & rolling.le(huge));
            let rare = sure.select(self.kept.rare.load(simd, k), one);
            self.kept.rare.store(k, rare);
        }
        (self.left, self.rounds) = (0, ROUNDS);
        for row in 0..count.min(BLOCK) {
            if self.kept.rare.0[row] == 0.0 {
                self.active[self.left] = row;
                self.left += 1;
            }
        }
    }

    /// Copies row `k` of the active rows of another block to the end of this one.
    pub fn take(&mut self, other: &Block<'_>, k: usize) {
        let (from, to) = (other.active[k] % BLOCK, self.left % BLOCK);
        let move_to = |column: &mut Column, other: &Column| column.0[to] = other.0[from];
        for (readings, other) in self.kept.readings.iter_mut().zip(&*other.kept.readings) {
            move_to(&mut readings[0], &other[0]);
            move_to(&mut readings[1], &other[1]);
        }
        for (weight, other) in self.weights.iter_mut().zip(&*other.weights) {
            move_to(weight, other);
        }
        for (unknown, other) in self.kept.unknowns.iter_mut().zip(&other.kept.unknowns) {
            move_to(unknown, other);
        }
        move_to(&mut self.least, &other.least);
        move_to(&mut self.scale, &other.scale);
        self.kept.rare.0[to] = 0.0;
        self.active[to] = to;
        self.rounds = other.rounds;
        self.left += 1;
    }

    /// Index in the block of active row `k`.
    #[inline]
    pub fn row(&self, k: usize) -> usize {
        self.active[k]
    }

    /// Iterates the active rows, phase by phase of so many rounds each, until all have converged or the phases end.
    /// After each phase the rows that have not converged are gathered into full registers.
    #[inline(always)]
    pub fn iterate<S: Vector>(&mut self, simd: S, constants: &RobustConstants, phases: &[usize]) {
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        for phase in phases {
            let mut kept = 0;
            self.rounds = self.rounds.saturating_sub(*phase);
            for first in (0..self.left).step_by(2 * S::F64_LANES) {
                let mut chosen = [0; 2 * LANES];
                let chunk = &self.active[first..self.left.min(first + 2 * S::F64_LANES)];
                chosen[..chunk.len()].copy_from_slice(chunk);
                let length = chunk.len();
                let of = |half: usize| &chosen[half * S::F64_LANES..(half + 1) * S::F64_LANES];
                let more = length.saturating_sub(S::F64_LANES);
                let mut pair = [
                    IrlsIterations::<S, MOST>::load(simd, constants.wheels.len(), self, of(0), length),
                    IrlsIterations::<S, MOST>::load(simd, constants.wheels.len(), self, of(1), more),
                ];
                let pair = &mut pair[..1 + usize::from(more > 0)];
                for _ in 0..*phase {
                    let mut active = Mask::splat(simd, false);
                    for rounds in &mut *pair {
                        rounds.round::<false>(simd, &constants.wheels, &mut ByMinors);
                        active = active | rounds.active;
                    }
                    if !active.any() {
                        break;
                    }
                }
                let mut marks = [[0.0; LANES]; 4];
                for (half, rounds) in pair.iter_mut().enumerate() {
                    rounds.newton_iterations(simd, &constants.wheels, self.rounds);
                    let there = length.min((half + 1) * S::F64_LANES) - half * S::F64_LANES;
                    rounds.store(constants.wheels.len(), self, &of(half)[..there]);
                    for (mark, mask) in [(0, rounds.active), (2, !rounds.sure)] {
                        let lanes = mask.select(one, zero);
                        lanes.store(S::as_mut_simd_f64s(&mut marks[mark + half]).0, 0);
                    }
                }
                for (j, row) in chosen.into_iter().enumerate().take(length) {
                    let (half, lane) = (j / S::F64_LANES, j % S::F64_LANES);
                    if marks[2 + half][lane] != 0.0 {
                        self.kept.rare.0[row] = 1.0;
                    } else if marks[half][lane] != 0.0 {
                        // `kept` is at most the index that was read, so that no unread entry is overwritten.
                        self.active[kept] = row;
                        kept += 1;
                    }
                }
            }
            self.left = kept;
            if kept == 0 {
                break;
            }
        }
    }

    /// Smallest singular values. Marks the rare rows; true if there are none.
    #[inline(always)]
    pub fn finish<S: Vector>(
        &mut self,
        simd: S,
        constants: &RobustConstants,
        count: usize,
        sigmas: &mut Column,
    ) -> bool {
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let mut all = Mask::splat(simd, true);
        for k in 0..count.div_ceil(S::F64_LANES) {
            let mut weights = [zero; MOST];
            for (weight, column) in weights.iter_mut().zip(self.weights.iter()) {
                *weight = column.load(simd, k);
            }
            let (least, exact) = smallest(simd, constants, &weights);
            sigmas.store(k, least.sqrt());
            let sure = exact & self.kept.rare.load(simd, k).le(zero);
            self.kept.rare.store(k, sure.select(zero, one));
            all = all & sure;
        }
        all.all()
    }
}

/// Fills columns with a number, register by register; filled as slices, they are compiled to scattered stores.
#[inline(always)]
fn fill<S: Vector>(number: Lanes<S>, columns: &mut [Column]) {
    for column in columns {
        for k in 0..BLOCK / S::F64_LANES {
            column.store(k, number);
        }
    }
}

/// Smallest eigenvalue of the weighted normal equations of the twist, by Jacobi rotations, and the lanes in which its
/// root is exact.
#[inline(always)]
fn smallest<S: Vector>(simd: S, constants: &RobustConstants, weights: &[Lanes<S>; MOST]) -> (Lanes<S>, Mask<S>) {
    let splat = |number| Lanes::splat(simd, number);
    let mut sum = [splat(0.0); 6];
    for (raw, weight) in constants.raw.iter().zip(weights) {
        for (sum, part) in sum.iter_mut().zip(raw) {
            *sum = weight.mul_add(splat(*part), *sum);
        }
    }
    let [mut a, mut b, mut c, mut d, mut e, mut f] = sum;
    let enough = (a + d + f) * splat(DIAGONAL);
    for _ in 0..SWEEPS {
        [a, d, b, c, e] = rotate_axes(simd, [a, d, b, c, e]);
        [a, f, c, b, e] = rotate_axes(simd, [a, f, c, b, e]);
        [d, f, e, b, c] = rotate_axes(simd, [d, f, e, b, c]);
        if !enough.lt(b.abs().max(c.abs()).max(e.abs())).any() {
            break;
        }
    }
    let (least, most) = (a.min(d).min(f), a.max(d).max(f));
    (least, (most * splat(EXACT_ROOT)).lt(least))
}

/// Jacobi rotation of the axes p and q of a symmetric matrix: its entries `pp, qq, pq, pr, qr` after it, with `pq = 0`.
#[inline(always)]
fn rotate_axes<S: Vector>(simd: S, [p, q, pq, pr, qr]: [Lanes<S>; 5]) -> [Lanes<S>; 5] {
    let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let (apart, twice) = (q - p, pq + pq);
    let length = apart.mul_add(apart, twice * twice).sqrt();
    let under = apart.abs() + length;
    let nothing = under.le(zero);
    let tangent = (twice / nothing.select(one, under)).xor_sign(apart.sign_bit());
    let cos = one / tangent.mul_add(tangent, one).sqrt();
    let sin = tangent * cos;
    let moved = tangent * pq;
    [p - moved, q + moved, zero, cos * pr - sin * qr, sin * pr + cos * qr]
}
