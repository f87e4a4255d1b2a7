//! A register of rows in its rounds: weights by residuals, and the least squares with them.

use super::block::{Block, LANES, MOST, RobustWheel};
use crate::estimate::{MEDIANS, ROUNDS, SETTLED};
use crate::kernels::normal_equations::solve;
use six_wheel_numerics::columns::{BLOCK, Column};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;

/// Newton's method is tried if no weight changed by more than this in the last round; and the largest number of its
/// rounds.
const NEAR: f64 = 0.1;
const LEAPS: usize = 7;

/// Newton's method replaces the remaining rounds if these would, to first order, reduce the change of the weights to
/// this: [`SETTLED`] with a margin for higher orders, and with `SPARE` of the remaining rounds not counted.
const SURELY_SETTLED: f64 = 1e-13;
const SPARE: usize = 8;

/// Phases of rounds. After each, the rows that have not converged try Newton's method and are gather into full
/// registers: some rows need ten times as many rounds as most. After the early phases, rows of many blocks are iterated
/// together.
pub(crate) const EARLY: [usize; 2] = [6, 8];
pub(crate) const LATE: [usize; 4] = [12, 16, 28, 30];
const _: () = assert!(EARLY[0] + EARLY[1] + LATE[0] + LATE[1] + LATE[2] + LATE[3] == ROUNDS);

/// A matrix in every lane.
type Columns<S> = [[Lanes<S>; 3]; 3];

/// Sorts pairs, one after the other. By variables and not array elements, so that they stay in registers: in memory,
/// sorting took a third of a round.
macro_rules! order {
    ($($low: ident $high: ident),*) => {
        $(($low, $high) = ($low.min($high), $low.max($high));)*
    };
}

/// Solution of the normal equations of a round.
pub(crate) trait NormalSolver<S: Vector> {
    /// The unknowns, and the lanes in which they are determined.
    fn solve(&mut self, simd: S, normal: [Lanes<S>; 6], right: [Lanes<S>; 3]) -> ([Lanes<S>; 3], Mask<S>);
}

/// Solution by minors: [`solve`]. Lanes whose twist is hardly determined count as not determined.
pub(crate) struct ByMinors;

impl<S: Vector> NormalSolver<S> for ByMinors {
    #[inline(always)]
    fn solve(&mut self, simd: S, normal: [Lanes<S>; 6], right: [Lanes<S>; 3]) -> ([Lanes<S>; 3], Mask<S>) {
        solve(simd, normal, right)
    }
}

/// Iteratively reweighted least squares of a register of rows, with up to `WHEELS` wheels.
#[derive(Clone, Copy)]
pub(crate) struct IrlsIterations<S: Vector, const WHEELS: usize> {
    readings: [[Lanes<S>; 2]; WHEELS],
    /// Velocity of the centre of the pivots, and yaw rate times the size of the rover [m/s].
    pub unknowns: [Lanes<S>; 3],
    pub weights: [Lanes<S>; WHEELS],
    /// Squares of the least noise, and of the scale of the last round [m²/s²].
    least: Lanes<S>,
    scale: Lanes<S>,
    /// Largest change of a weight in the last round, and true where that did not change the scale.
    change: Lanes<S>,
    held: Mask<S>,
    /// True where the weights have not converged.
    pub active: Mask<S>,
    /// True where every round had a solution.
    pub sure: Mask<S>,
}

/// Loads these rows of a column.
#[inline(always)]
fn gather<S: Vector>(simd: S, column: &Column, rows: &[usize]) -> Lanes<S> {
    let mut room = [0.0; LANES];
    for (place, row) in room.iter_mut().zip(rows) {
        *place = column.0[*row % BLOCK];
    }
    Lanes::load(simd, S::as_simd_f64s(&room).0, 0)
}

#[inline(always)]
fn scatter<S: Vector>(lanes: Lanes<S>, column: &mut Column, rows: &[usize]) {
    let mut room = [0.0; LANES];
    lanes.store(S::as_mut_simd_f64s(&mut room).0, 0);
    for (value, row) in room.into_iter().zip(rows) {
        column.0[*row % BLOCK] = value;
    }
}

#[inline_always]
impl<S: Vector, const WHEELS: usize> IrlsIterations<S, WHEELS> {
    /// Rows with these readings, starting from the unknowns of least squares with equal weights; `least` is the square
    /// of the least noise [m²/s²].
    pub fn new(simd: S, readings: &[[Lanes<S>; 2]], unknowns: [Lanes<S>; 3], least: Lanes<S>) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        let mut rounds = Self {
            readings: [[zero; 2]; WHEELS],
            unknowns,
            weights: [Lanes::splat(simd, 1.0); WHEELS],
            least,
            scale: Lanes::splat(simd, f64::INFINITY),
            change: zero,
            held: Mask::splat(simd, false),
            active: Mask::splat(simd, true),
            sure: Mask::splat(simd, true),
        };
        for (place, readings) in rounds.readings.iter_mut().zip(readings) {
            *place = *readings;
        }
        rounds
    }

    /// The rows of a block with the indices `chosen`, of which the first `count` are active.
    pub fn load(simd: S, wheels: usize, rows: &Block<'_>, chosen: &[usize], count: usize) -> Self {
        let mut order = [0.0; LANES];
        for (k, place) in order.iter_mut().enumerate() {
            *place = k as f64;
        }
        let order = Lanes::load(simd, S::as_simd_f64s(&order).0, 0);
        let least = gather(simd, &rows.least, chosen);
        let mut unknowns = [least; 3];
        for (unknown, column) in unknowns.iter_mut().zip(&rows.kept.unknowns) {
            *unknown = gather(simd, column, chosen);
        }
        let mut rounds = Self::new(simd, &[], unknowns, least);
        rounds.scale = gather(simd, &rows.scale, chosen);
        rounds.active = order.lt(Lanes::splat(simd, count as f64));
        for i in 0..wheels {
            for (readings, column) in rounds.readings[i].iter_mut().zip(&rows.kept.readings[i]) {
                *readings = gather(simd, column, chosen);
            }
            rounds.weights[i] = gather(simd, &rows.weights[i], chosen);
        }
        rounds
    }

    /// All rounds of one register, without [`Self::newton_iterations`].
    pub fn iterate(&mut self, simd: S, wheels: &[RobustWheel], solver: &mut impl NormalSolver<S>) {
        for _ in 0..ROUNDS {
            self.round::<false>(simd, wheels, solver);
            if !self.active.any() {
                return;
            }
        }
    }

    pub fn store(&self, wheels: usize, rows: &mut Block<'_>, chosen: &[usize]) {
        for (unknown, column) in self.unknowns.iter().zip(&mut rows.kept.unknowns) {
            scatter(*unknown, column, chosen);
        }
        for i in 0..wheels {
            scatter(self.weights[i], &mut rows.weights[i], chosen);
        }
        scatter(self.scale, &mut rows.scale, chosen);
    }

    /// One round in the active lanes: `w_i = (1 / (1 + r_i² / s²))²` with residuals r and scale s (Geman-McClure), and
    /// the least squares with these weights. It is in squares of residuals and scales, with one root and few divisions,
    /// which take most of its time. `NEWTON`: the derivatives of the weights by the twist are in the equations, which
    /// are otherwise constant.
    pub fn round<const NEWTON: bool>(&mut self, simd: S, wheels: &[RobustWheel], solver: &mut impl NormalSolver<S>) {
        let splat = |number| Lanes::splat(simd, number);
        let (zero, one) = (splat(0.0), splat(1.0));
        let count = wheels.len();
        // Lanes without a wheel are sorted to the end.
        let mut squares = [splat(f64::MAX); WHEELS];
        for (i, wheel) in wheels.iter().enumerate() {
            squares[i] = wheel.rows.square(simd, self.readings[i], self.unknowns);
        }
        let sorted = sorted(squares);
        let mut median = sorted[count / 2];
        if count.is_multiple_of(2) {
            let lower = sorted[count / 2 - 1];
            let twice = (lower * median).sqrt();
            median = ((lower + median) + (twice + twice)) * splat(0.25);
        }
        let noise = (median * splat(MEDIANS * MEDIANS)).max(self.least);
        // The scale of the first round is the largest residual.
        let first = splat(f64::MAX).lt(self.scale);
        self.scale = first.select(sorted[count - 1].max(self.least), self.scale);
        let before = self.scale;
        self.scale = before.min(noise.max(before * splat(0.25)));
        self.held = before.le(self.scale);
        // Lanes in which every residual is 0 keep their weights.
        let active = self.active & zero.lt(self.scale);
        let per_square = one / self.scale;
        // One over each ratio, from one over their product: one division.
        let (mut ratios, mut products) = ([one; WHEELS], [one; WHEELS]);
        let mut product = one;
        for i in 0..count {
            ratios[i] = squares[i].mul_add(per_square, one);
            products[i] = product;
            product = product * ratios[i];
        }
        let mut rest = one / product;
        let mut change = zero;
        let (mut normal, mut right) = ([zero; 6], [zero; 3]);
        for (i, wheel) in wheels.iter().enumerate().rev() {
            // The product of the ratios of more wheels may overflow.
            let inverse = if WHEELS == MOST { rest * products[i] } else { one / ratios[i] };
            rest = rest * ratios[i];
            let next = active.select(inverse * inverse, self.weights[i]);
            change = change.max((next - self.weights[i]).abs());
            self.weights[i] = next;
            for (sum, part) in normal.iter_mut().zip(wheel.normal) {
                *sum = next.mul_add(splat(part), *sum);
            }
            for (sum, part) in right.iter_mut().zip(wheel.rows.moment(simd, self.readings[i])) {
                *sum = next.mul_add(part, *sum);
            }
            if NEWTON {
                let slope = wheel.rows.slope(simd, self.readings[i], self.unknowns);
                let share = inverse * next * per_square * splat(-4.0);
                let pull = share * along(slope, self.unknowns);
                add_square(&mut normal, share, slope);
                for (sum, part) in right.iter_mut().zip(slope) {
                    *sum = pull.mul_add(part, *sum);
                }
            }
        }
        let (solved, determined) = solver.solve(simd, normal, right);
        if NEWTON {
            self.held = self.held & determined;
        } else {
            self.sure = self.sure & (determined | !active);
        }
        self.change = change;
        for (unknown, solved) in self.unknowns.iter_mut().zip(solved) {
            *unknown = active.select(solved, *unknown);
        }
        self.active = active & self.sure & splat(SETTLED).lt(change);
    }

    /// Rounds of Newton's method, which converge to the same twist as the `left` remaining rounds: at a constant scale
    /// each of these multiplies the error of the twist by a matrix, whose power bounds the error after all of them.
    /// Nothing is changed if that bound is too large or the scale would change.
    pub fn newton_iterations(&mut self, simd: S, wheels: &[RobustWheel], left: usize) {
        let near = self.change.lt(Lanes::splat(simd, NEAR));
        let trusted = self.active & self.held & near & self.comes_near(simd, wheels, left);
        if !trusted.any() {
            return;
        }
        let mut ahead = Self { active: trusted, held: trusted, ..*self };
        let mut kept = trusted;
        for _ in 0..LEAPS {
            let settled = !ahead.active;
            ahead.round::<true>(simd, wheels, &mut ByMinors);
            kept = kept & (settled | ahead.held);
            ahead.active = ahead.active & kept;
            if !ahead.active.any() {
                break;
            }
        }
        let there = kept & !ahead.active;
        for (unknown, ahead) in self.unknowns.iter_mut().zip(ahead.unknowns) {
            *unknown = there.select(ahead, *unknown);
        }
        for (weight, ahead) in self.weights.iter_mut().zip(ahead.weights) {
            *weight = there.select(ahead, *weight);
        }
        self.active = self.active & !there;
    }

    /// Lanes in which the remaining rounds would let the weights converge, by that bound.
    fn comes_near(&self, simd: S, wheels: &[RobustWheel], left: usize) -> Mask<S> {
        let splat = |number| Lanes::splat(simd, number);
        let zero = splat(0.0);
        let per_square = splat(4.0) / self.scale;
        let (mut normal, mut follow) = ([zero; 6], [zero; 6]);
        for (i, wheel) in wheels.iter().enumerate() {
            let weight = self.weights[i];
            for (sum, part) in normal.iter_mut().zip(wheel.normal) {
                *sum = weight.mul_add(splat(part), *sum);
            }
            let slope = wheel.rows.slope(simd, self.readings[i], self.unknowns);
            add_square(&mut follow, weight * weight.sqrt() * per_square, slope);
        }
        let [a, b, c, d, e, f] = follow;
        let mut step = [[zero; 3]; 3];
        let mut sure = Mask::splat(simd, true);
        for (column, right) in step.iter_mut().zip([[a, b, c], [b, d, e], [c, e, f]]) {
            let (solved, determined) = solve(simd, normal, right);
            (*column, sure) = (solved, sure & determined);
        }
        let mut power = None;
        let mut rest = left.saturating_sub(SPARE) / SPARE * SPARE;
        while rest > 0 {
            if rest % 2 == 1 {
                power = match power {
                    Some(power) => Some(product(power, step)),
                    None => Some(step),
                };
            }
            rest /= 2;
            if rest > 0 {
                step = product(step, step);
            }
        }
        let Some([x, y, z]) = power else {
            return Mask::splat(simd, false);
        };
        // No eigenvalue of the matrix is negative, so that its trace bounds the largest one.
        let most = x[0] + y[1] + z[2];
        sure & (self.change * most).lt(splat(SURELY_SETTLED))
    }
}

/// The numbers of each lane in ascending order.
#[inline(always)]
fn sorted<S: Vector, const WHEELS: usize>(mut numbers: [Lanes<S>; WHEELS]) -> [Lanes<S>; WHEELS] {
    if WHEELS == MOST
        && let Some(eight) = numbers.first_chunk_mut::<MOST>()
    {
        let [mut a, mut b, mut c, mut d, mut e, mut f, mut g, mut h] = *eight;
        order!(a c, b d, e g, f h, a e, b f, c g, d h, a b, c d);
        order!(e f, g h, c e, d f, b e, d g, b c, d e, f g);
        *eight = [a, b, c, d, e, f, g, h];
        return numbers;
    }
    // Odd-even merges (K. E. Batcher, Sorting networks and their applications, AFIPS 1968), for powers of two.
    let mut merged = 1;
    while merged < WHEELS {
        let mut distance = merged;
        while distance > 0 {
            let start = distance % merged;
            for low in start..WHEELS - distance {
                let high = low + distance;
                if (low - start) / distance % 2 == 0 && low / (2 * merged) == high / (2 * merged) {
                    (numbers[low], numbers[high]) = (numbers[low].min(numbers[high]), numbers[low].max(numbers[high]));
                }
            }
            distance /= 2;
        }
        merged *= 2;
    }
    numbers
}

#[inline(always)]
fn along<S: Vector>([x, y, z]: [Lanes<S>; 3], [u, v, w]: [Lanes<S>; 3]) -> Lanes<S> {
    x.mul_add(u, y.mul_add(v, z * w))
}

/// Adds a multiple of the products of a row with itself.
#[inline(always)]
fn add_square<S: Vector>(sums: &mut [Lanes<S>; 6], share: Lanes<S>, [x, y, z]: [Lanes<S>; 3]) {
    let [u, v, w] = [share * x, share * y, share * z];
    let pairs = [(u, x), (u, y), (u, z), (v, y), (v, z), (w, z)];
    for (sum, (left, right)) in sums.iter_mut().zip(pairs) {
        *sum = left.mul_add(right, *sum);
    }
}

/// The product of two matrices, column by column.
#[inline(always)]
fn product<S: Vector>(left: Columns<S>, right: Columns<S>) -> Columns<S> {
    let [a, b, c] = left;
    let mut product = right;
    for (column, [x, y, z]) in product.iter_mut().zip(right) {
        for row in 0..3 {
            column[row] = a[row].mul_add(x, b[row].mul_add(y, c[row] * z));
        }
    }
    product
}
