//! Arcs of a rim with one minimum inside, and the minimum.

use super::circles::{FAR, GapDerivatives, Point, RimLanes, cells};
use crate::terrain::Terrain;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;

/// After a step below this [rad] the error is below 1e-11 rad, as the method is of third order.
const CLOSE: f64 = 1e-4;

/// Largest number of steps: bisection alone reduces an arc of half a radian to 1e-16.
const STEPS: usize = 60;

/// An arc over one cell, along which the gap is convex and has its minimum inside.
#[derive(Clone, Copy)]
pub(crate) struct Candidate<S: Vector> {
    /// Lower bound of the gap [m]; [`FAR`] where there is no arc.
    pub bound: Lanes<S>,
    /// Sine and cosine of the contact angle at its start.
    pub sin: Lanes<S>,
    pub cos: Lanes<S>,
    /// Length [rad].
    pub length: Lanes<S>,
    /// First estimate of the minimum, as a share of the length.
    pub share: Lanes<S>,
    /// The cell.
    pub column: Lanes<S>,
    pub row: Lanes<S>,
}

#[inline_always]
impl<S: Vector> Candidate<S> {
    /// No arc.
    pub fn none(simd: S) -> Self {
        let (zero, unit) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        Self {
            bound: Lanes::splat(simd, FAR),
            sin: zero,
            cos: unit,
            length: zero,
            share: zero,
            column: zero,
            row: zero,
        }
    }

    /// `yes` where true, `no` elsewhere.
    pub fn pick(mask: Mask<S>, yes: &Self, no: &Self) -> Self {
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

    /// The minimum inside, by Chebyshev's method (Newton's, of third order) inside its bracket.
    pub fn minimum(&self, simd: S, ground: &Terrain, rims: &RimLanes<S>) -> (Point<S>, GapDerivatives<S>) {
        let (zero, unit, half) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0), Lanes::splat(simd, 0.5));
        let cell = cells(simd, ground, self.column, self.row);
        let from = [rims.centre[0] - self.column, rims.centre[1] - self.row];
        let (mut low, mut high) = (zero, self.length);
        let mut angle = self.length * self.share;
        let (mut at, mut step) = ([self.sin, self.cos], zero);
        let mut near = unit.lt(zero);
        for _ in 0..STEPS {
            let square = angle * angle;
            let sin = angle * series(simd, square, [6.0, 20.0, 42.0]);
            let cos = series(simd, square, [2.0, 12.0, 30.0, 56.0]);
            at = sum_of_angles(simd, [self.sin, self.cos], [sin, cos]);
            let gap = rims.derivatives(&cell, from, &rims.point(at[0], at[1]));
            let falls = gap.rise.le(zero);
            low = falls.select(angle, low);
            high = falls.select(high, angle);
            let inverse = unit / gap.curvature;
            step = gap.rise * inverse;
            step = step * (step * inverse).mul_add(gap.third * half, unit);
            near = step.abs().lt(Lanes::splat(simd, CLOSE));
            let found = near | (high - low).lt(Lanes::splat(simd, 1e-14));
            if found.all() {
                break;
            }
            let next = angle - step;
            let inside = low.le(next) & next.le(high);
            let next = inside.select(next, (low + high) * half);
            angle = found.select(angle, next);
        }
        let step = near.select(-step, zero);
        let square = step * step;
        let sin = step * series(simd, square, [6.0]);
        let at = sum_of_angles(simd, at, [sin, series(simd, square, [2.0])]);
        let at = rims.point(at[0], at[1]);
        (at, rims.derivatives(&cell, from, &at))
    }
}

/// `1 - x / a (1 - x / b (..))` in a squared angle x, with divisors a, b, ..: series of `sin t / t` and `cos t`.
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

/// Sine and cosine of the sum of two angles, normalised by one Newton step: the norm of the arguments is exact to 1e-8.
#[inline(always)]
fn sum_of_angles<S: Vector>(simd: S, [s, c]: [Lanes<S>; 2], [sin, cos]: [Lanes<S>; 2]) -> [Lanes<S>; 2] {
    let [s, c] = [s * cos + c * sin, c * cos - s * sin];
    let scale = Lanes::splat(simd, 1.5) - (s * s + c * c) * Lanes::splat(simd, 0.5);
    [s * scale, c * scale]
}
