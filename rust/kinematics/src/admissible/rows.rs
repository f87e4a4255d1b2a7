//! Admissibility of twists, and the nearest admissible ones, block by block.

use super::cone::{AdmissibleCone, Rates};
use super::projection::Projection;
use six_wheel_numerics::columns::{BLOCK, Column, load, store, transpose_to_columns, transpose_to_rows};
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::level::Kernel;
use six_wheel_numerics::simd::vector::Vector;

/// Decides for each twist if it is possible. Fails at the first one that is not finite.
pub(crate) struct AdmissibleRange<'a> {
    pub cone: &'a AdmissibleCone,
    pub twists: &'a [[f64; 3]],
    pub answers: &'a mut [bool],
}

impl Kernel for AdmissibleRange<'_> {
    type Output = Result<(), Error>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Self::Output {
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let mut twists = [Column::ZERO; 3];
        let mut yes = Column::ZERO;
        let blocks = self.twists.chunks(BLOCK).zip(self.answers.chunks_mut(BLOCK));
        for (block, (rows, answers)) in blocks.enumerate() {
            transpose_to_columns(simd, rows.as_flattened(), &mut twists);
            let mut are_valid = Mask::splat(simd, true);
            for k in 0..rows.len().div_ceil(S::F64_LANES) {
                let admissibility = self.cone.admissibility(simd, load(simd, &twists, k), Rates::Row(&[]));
                are_valid = are_valid & admissibility.is_valid;
                yes.store(k, admissibility.is_possible.select(one, zero));
            }
            for (answer, yes) in answers.iter_mut().zip(yes.0) {
                *answer = yes != 0.0;
            }
            if (!are_valid).any() {
                for (k, twist) in rows.iter().enumerate() {
                    let checked = self.cone.check_speeds((*twist).into());
                    checked.map_err(|error| error.at_row(block * BLOCK + k))?;
                }
            }
        }
        Ok(())
    }
}

/// The nearest possible twists. Fails at the first one without.
pub(crate) struct ProjectRange<'a> {
    pub projection: Projection<'a>,
    pub twists: &'a [[f64; 3]],
    pub projected: &'a mut [[f64; 3]],
}

impl Kernel for ProjectRange<'_> {
    type Output = Result<(), Error>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Self::Output {
        let [mut wanted, mut found] = [[Column::ZERO; 3]; 2];
        let blocks = self.twists.chunks(BLOCK).zip(self.projected.chunks_mut(BLOCK));
        for (block, (rows, targets)) in blocks.enumerate() {
            transpose_to_columns(simd, rows.as_flattened(), &mut wanted);
            let mut are_found = Mask::splat(simd, true);
            for k in 0..rows.len().div_ceil(S::F64_LANES) {
                let (twist, is_found) = self.projection.lanes(simd, load(simd, &wanted, k));
                are_found = are_found & is_found;
                store(twist, &mut found, k);
            }
            transpose_to_rows(simd, &found, targets.as_flattened_mut());
            if (!are_found).any() {
                for (k, twist) in rows.iter().enumerate() {
                    self.projection.of((*twist).into()).map_err(|error| error.at_row(block * BLOCK + k))?;
                }
            }
        }
        Ok(())
    }
}
