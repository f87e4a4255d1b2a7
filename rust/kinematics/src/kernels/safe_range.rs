//! Sizes of twists, wheels and readings whose squares neither overflow nor lose digits.

use pulp::Simd;

use crate::wheels::Wheel;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;

/// Sizes of twists whose squares neither overflow nor lose digits.
pub(crate) const MIN_SQUARABLE: f64 = 1e-100;
pub(crate) const MAX_SQUARABLE: f64 = 1e100;

/// Powers of two that scale smaller and larger numbers into that range.
pub(crate) const SCALE: [f64; 2] = [f64::from_bits((1023 + 600) << 52), f64::from_bits((1023 - 600) << 52)];

/// Lengths of rovers for which that holds at every pivot [m].
pub(crate) const SAFE_LENGTHS: std::ops::RangeInclusive<f64> = 1e-20..=1e20;

/// Sum of the absolute values of a twist.
#[inline(always)]
fn size<S: Simd>([vx, vy, omega]: [Lanes<S>; 3]) -> Lanes<S> {
    vx.abs() + vy.abs() + omega.abs()
}

/// True where a twist is finite, and its squares neither overflow nor lose digits. False for NaN.
#[inline(always)]
pub fn is_in_safe_range<S: Simd>(simd: S, twist: [Lanes<S>; 3]) -> Mask<S> {
    let size = size(twist);
    let is_zero = size.le(Lanes::splat(simd, 0.0));
    size.le(Lanes::splat(simd, MAX_SQUARABLE)) & (is_zero | Lanes::splat(simd, MIN_SQUARABLE).le(size))
}

/// True if the squares of a wheel's sizes neither overflow nor lose digits.
pub(crate) fn has_safe_lengths(wheel: &Wheel) -> bool {
    let is_safe = |length: f64| length == 0.0 || SAFE_LENGTHS.contains(&length);
    let lengths = [wheel.radius, wheel.x.abs(), wheel.y.abs()];
    let offsets = [wheel.scrub.abs(), wheel.trail.abs()];
    lengths.into_iter().all(is_safe) && offsets.iter().all(|offset| offset < SAFE_LENGTHS.end())
}

/// The first pivot and the one farthest from it [m].
pub(crate) fn distant_pivots(wheels: &[Wheel]) -> [[f64; 2]; 2] {
    let first = [wheels[0].x, wheels[0].y];
    let mut other = first;
    let distance = |[x, y]: [f64; 2]| (x - first[0]).abs() + (y - first[1]).abs();
    for wheel in wheels {
        if distance([wheel.x, wheel.y]) > distance(other) {
            other = [wheel.x, wheel.y];
        }
    }
    [first, other]
}

/// True if the sum of the squares of all numbers is at most `largest²`, so that none is larger. False for NaN.
#[inline(always)]
pub(crate) fn all_within<S: Vector>(simd: S, values: &[f64], largest: f64) -> bool {
    let mut sums = [Lanes::splat(simd, 0.0); 4];
    let (registers, rest) = S::as_simd_f64s(values);
    let (quads, singles) = registers.as_chunks::<4>();
    for quad in quads {
        for (j, sum) in sums.iter_mut().enumerate() {
            let value = Lanes::load(simd, quad, j);
            *sum = value.mul_add(value, *sum);
        }
    }
    for k in 0..singles.len() {
        let value = Lanes::load(simd, singles, k);
        sums[0] = value.mul_add(value, sums[0]);
    }
    let sum = ((sums[0] + sums[1]) + (sums[2] + sums[3])).sum();
    let sum = sum + rest.iter().map(|value| value * value).sum::<f64>();
    sum <= (largest * largest).min(f64::MAX)
}
