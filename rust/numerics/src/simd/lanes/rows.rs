//! Doubles between memory and lanes: columns, rows, tables.

use pulp::Simd;

use super::{Lanes, Mask};
use crate::simd::vector::Vector;

#[inline_always]
impl<S: Simd> Lanes<S> {
    /// A register of a column.
    pub fn load(simd: S, column: &[S::f64s], k: usize) -> Self {
        Self { simd, values: [column[k]] }
    }

    /// Writes register `k` of a column.
    pub fn store(self, column: &mut [S::f64s], k: usize) {
        column[k] = self.values[0];
    }

    fn with(self, value: S::f64s) -> Self {
        Self { values: [value], ..self }
    }

    /// The sum over all lanes.
    pub fn sum(self) -> f64 {
        self.simd.reduce_sum_f64s(self.values[0])
    }
}

#[inline_always]
impl<S: Simd> Lanes<S, f32> {
    /// Numbers of these bits.
    pub fn from_bits(simd: S, bits: S::u32s) -> Self {
        Self { simd, values: [simd.transmute_f32s_u32s(bits)] }
    }

    /// The bits of the numbers.
    pub fn to_bits(self) -> S::u32s {
        self.simd.transmute_u32s_f32s(self.values[0])
    }
}

impl<S: Simd> Mask<S, f32> {
    /// Lanes in which the bits are not all 0.
    #[inline(always)]
    pub fn from_bits(simd: S, bits: S::u32s) -> Self {
        Self { simd, values: [simd.greater_than_u32s(bits, simd.splat_u32s(0))] }
    }
}

#[inline_always]
impl<S: Vector> Lanes<S> {
    /// Every lane `1 << LOG` places on, zeros before it.
    pub fn shift<const LOG: u32>(simd: S, lanes: Self) -> Self {
        lanes.with(simd.shift::<LOG>(lanes.values[0]))
    }

    /// Rows of three numbers, as many as there are lanes, to their columns; 0 where there are fewer.
    pub fn deinterleave3(simd: S, rows: &[f64]) -> [Self; 3] {
        match S::as_simd_f64s(rows).0 {
            [a, b, c, ..] => simd.deinterleave3([*a, *b, *c]).map(|value| Self { simd, values: [value] }),
            _ => [Self::splat(simd, 0.0); 3],
        }
    }

    /// The reverse of [`Self::deinterleave3`].
    pub fn interleave3([x, y, z]: [Self; 3], rows: &mut [f64]) {
        if let [a, b, c, ..] = S::as_mut_simd_f64s(rows).0 {
            [*a, *b, *c] = x.simd.interleave3([x.values[0], y.values[0], z.values[0]]);
        }
    }

    /// Eight columns of as many rows as there are lanes, a row every `width` numbers; all of the eight numbers from each
    /// row's first one on have to be there.
    pub fn columns(simd: S, rows: &[f64], width: usize) -> [Self; 8] {
        let mut eights = [&[0.0; 8]; 8];
        for (lane, eight) in eights.iter_mut().enumerate().take(S::F64_LANES) {
            *eight = rows[lane * width..].first_chunk().unwrap_or(&[0.0; 8]);
        }
        Self::columns_of(simd, &eights)
    }

    /// Columns of rows anywhere in memory, as many rows as there are lanes.
    pub fn columns_of(simd: S, rows: &[&[f64; 8]; 8]) -> [Self; 8] {
        let mut registers = [simd.splat_f64s(0.0); 8];
        for (k, register) in registers.iter_mut().enumerate() {
            let part = &rows[k % S::F64_LANES][k / S::F64_LANES * S::F64_LANES..];
            *register = S::as_simd_f64s(&part[..S::F64_LANES]).0[0];
        }
        let columns = simd.transpose(registers);
        let mut lanes = [Self::splat(simd, 0.0); 8];
        for (lanes, values) in lanes.iter_mut().zip(columns) {
            lanes.values = [values];
        }
        lanes
    }

    /// The reverse of [`Self::columns`]: of each row all eight numbers are written, the rows one after the other.
    pub fn rows(simd: S, columns: [Self; 8], rows: &mut [f64], width: usize) {
        let mut registers = [simd.splat_f64s(0.0); 8];
        for (register, lanes) in registers.iter_mut().zip(columns) {
            *register = lanes.values[0];
        }
        let registers = simd.transpose(registers);
        for row in 0..S::F64_LANES {
            for part in 0..8 / S::F64_LANES {
                let first = row * width + part * S::F64_LANES;
                let target = &mut rows[first..first + S::F64_LANES];
                S::as_mut_simd_f64s(target).0[0] = registers[part * S::F64_LANES + row];
            }
        }
    }

    /// [`Vector::inverse_root`].
    pub fn inverse_root(self) -> Self {
        self.with(self.simd.inverse_root(self.values[0]))
    }

    /// [`Vector::square`] at these places.
    pub fn square(self, table: &[f64], columns: usize) -> [Self; 4] {
        let [a, b, c, d] = self.simd.square(table, columns, self.values[0]);
        [self.with(a), self.with(b), self.with(c), self.with(d)]
    }

    /// [`Vector::pairs`] at these places.
    ///
    /// # Safety
    ///
    /// As there.
    pub unsafe fn pairs(self, table: &[[f32; 2]]) -> Self {
        // SAFETY: by the caller.
        self.with(unsafe { self.simd.pairs(table, self.values[0]) })
    }

    /// [`Vector::exponent`].
    pub fn exponent(self) -> Self {
        self.with(self.simd.exponent(self.values[0]))
    }

    /// The power of two of [`Self::exponent`].
    pub fn power(self) -> Self {
        let bits = self.simd.splat_f64s(f64::INFINITY);
        self.with(self.simd.and_f64s(self.values[0], bits))
    }

    /// [`Vector::least_pairs`].
    pub fn least_pairs(self, other: Self) -> Self {
        self.with(self.simd.least_pairs(self.values[0], other.values[0]))
    }

    /// [`Vector::deinterleave2`].
    pub fn deinterleave2(self) -> [Self; 2] {
        let [first, second] = self.simd.deinterleave2(self.values[0]);
        [self.with(first), self.with(second)]
    }

    /// `a0 a1 .., b0 b1 ..` to `a0 b0 a1 b1 ..`, into as many numbers.
    pub fn zip([a, b]: [Self; 2], pairs: &mut [f64]) {
        if let [first, second, ..] = S::as_mut_simd_f64s(pairs).0 {
            [*first, *second] = a.simd.zip([a.values[0], b.values[0]]);
        }
    }

    /// The last lane in every lane.
    pub fn broadcast_last(self, simd: S) -> Self {
        self.with(simd.broadcast_last(self.values[0]))
    }

    /// The last lane.
    pub fn last(self, simd: S) -> f64 {
        simd.last(self.values[0])
    }
}
