//! Rows of three numbers in every lane.

use six_wheel_numerics::columns::Column;
use six_wheel_numerics::simd::lanes::Lanes;
pub use six_wheel_numerics::simd::vec3::row_times as dot;
use six_wheel_numerics::simd::vector::Vector;

/// A register of twists.
#[inline(always)]
pub(crate) fn load<S: Vector>(simd: S, columns: &[Column; 3], k: usize) -> [Lanes<S>; 3] {
    [columns[0].load(simd, k), columns[1].load(simd, k), columns[2].load(simd, k)]
}
