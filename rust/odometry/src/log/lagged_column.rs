//! Columns of a block that begin with the row before it.

use six_wheel_numerics::columns::BLOCK;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::vector::Vector;

/// Elements before a column, the last of which holds the row before the first one.
pub(crate) const LEAD: usize = 8;

/// A column with the row before its first.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(crate) struct LaggedColumn(pub [f64; LEAD + BLOCK]);

#[inline_always]
impl LaggedColumn {
    /// Register `k`, of rows that begin `back` rows before.
    pub fn load<S: Vector>(&self, simd: S, k: usize, back: usize) -> Lanes<S> {
        let first = LEAD + k * S::F64_LANES - back;
        let rows = &self.0[first..first + S::F64_LANES];
        Lanes::load(simd, S::as_simd_f64s(rows).0, 0)
    }

    pub fn store<S: Vector>(&mut self, k: usize, lanes: Lanes<S>) {
        let rows = &mut self.0[LEAD..][k * S::F64_LANES..][..S::F64_LANES];
        lanes.store(S::as_mut_simd_f64s(rows).0, 0);
    }
}

/// A row of three columns.
pub(crate) fn row([x, y, z]: &[LaggedColumn; 3], row: usize) -> [f64; 3] {
    [x.0[LEAD + row], y.0[LEAD + row], z.0[LEAD + row]]
}

/// Registers of three columns, of rows that begin `back` rows before.
#[inline(always)]
pub(crate) fn all<S: Vector>(simd: S, [x, y, z]: &[LaggedColumn; 3], k: usize, back: usize) -> [Lanes<S>; 3] {
    [x.load(simd, k, back), y.load(simd, k, back), z.load(simd, k, back)]
}
