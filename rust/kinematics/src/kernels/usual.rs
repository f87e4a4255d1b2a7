//! The sizes of twists, wheels and readings that the kernels take: their squares neither overflow nor lose digits.

use pulp::Simd;

use super::steered::absolute;
use crate::wheels::Wheel;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;

/// Sizes of twists whose squares neither overflow nor lose digits. Beyond them, the plain core.
pub(crate) const SMALLEST: f64 = 1e-100;
pub(crate) const LARGEST: f64 = 1e100;

/// Sizes of rovers with which that holds at every pivot.
pub(crate) const SIZES: std::ops::RangeInclusive<f64> = 1e-20..=1e20;

/// Lanes whose twist is surely finite, and its squares are too.
#[inline(always)]
pub fn usual<S: Simd>(simd: S, twist: [Lanes<S>; 3]) -> Mask<S> {
    let [vx, vy, omega] = absolute(twist);
    let size = vx + vy + omega;
    let fits = size.at_most(Lanes::splat(simd, LARGEST));
    let zero = size.at_most(Lanes::splat(simd, 0.0));
    fits & (zero | Lanes::splat(simd, SMALLEST).at_most(size))
}

/// True if the squares of a wheel's sizes neither overflow nor lose digits.
pub(crate) fn is_usual(wheel: &Wheel) -> bool {
    let usual = |length: f64| length == 0.0 || SIZES.contains(&length);
    let lengths = [wheel.radius, wheel.x.abs(), wheel.y.abs()];
    let offsets = [wheel.scrub.abs(), wheel.trail.abs()];
    lengths.into_iter().all(usual) && offsets.iter().all(|offset| offset < SIZES.end())
}

/// Two pivots far apart.
pub(crate) fn pivots_apart(wheels: &[Wheel]) -> [[f64; 2]; 2] {
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

/// True if all numbers are surely at most so large, by the sum of their squares. False for NaN.
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
    let sum = ((sums[0] + sums[1]) + (sums[2] + sums[3])).total();
    let sum = sum + rest.iter().map(|value| value * value).sum::<f64>();
    sum <= (largest * largest).min(f64::MAX)
}
