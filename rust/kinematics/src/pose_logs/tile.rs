//! Tiles of eight steps in every lane, of logs side by side.

use crate::geometry::Steps;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::vector::Vector;

/// Steps of a tile in one lane.
pub const STEPS: usize = 8;

/// Numbers of these steps, twists or poses.
pub const WIDTH: usize = 3 * STEPS;

/// Lanes at most.
pub const LANES: usize = 8;

/// One register per step.
pub type PerStep<S> = [Lanes<S>; STEPS];

/// Transposes one row of numbers per lane to one register per number.
#[inline(always)]
pub(crate) fn columns<S: Vector, const N: usize>(simd: S, rows: &[&[f64; N]; LANES], columns: &mut [S::f64s; N]) {
    for (c, columns) in columns.as_chunks_mut::<8>().0.iter_mut().enumerate() {
        let mut group = *columns;
        for (j, register) in group.iter_mut().enumerate() {
            let square = (8 * c + j) / S::F64_LANES;
            *register = S::as_simd_f64s(rows[j % S::F64_LANES]).0[square];
        }
        *columns = simd.transpose(group);
    }
}

/// Durations of the steps of a tile [s], the same in every lane; 1 s after the end of the log.
#[inline(always)]
pub(crate) fn durations<S: Vector>(simd: S, steps: Steps<'_>, first: usize) -> PerStep<S> {
    let mut dts = [Lanes::splat(simd, 0.0); STEPS];
    for (t, dt) in dts.iter_mut().enumerate() {
        match steps {
            Steps::Constant(constant) => *dt = Lanes::splat(simd, constant),
            Steps::Each(dts) => {
                *dt = Lanes::splat(simd, dts.get(first + t).copied().unwrap_or(1.0));
            }
        }
    }
    dts
}
