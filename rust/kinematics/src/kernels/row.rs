//! Rows of three numbers in every lane.

use pulp::Simd;

use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::weave::Column;

/// A register of twists.
#[inline(always)]
pub(crate) fn load<S: Vector>(simd: S, columns: &[Column; 3], k: usize) -> [Lanes<S>; 3] {
    [columns[0].load(simd, k), columns[1].load(simd, k), columns[2].load(simd, k)]
}

/// A row times a twist.
#[inline(always)]
pub fn dot<S: Simd>(simd: S, row: &[f64; 3], [vx, vy, omega]: [Lanes<S>; 3]) -> Lanes<S> {
    let [a, b, c] = [row[0], row[1], row[2]];
    vx * Lanes::splat(simd, a) + vy * Lanes::splat(simd, b) + omega * Lanes::splat(simd, c)
}
