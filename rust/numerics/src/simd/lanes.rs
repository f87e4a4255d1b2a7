//! One register of numbers, with the operators of a number: what the kernels are written in.
//!
//! Everything is `#[inline(always)]`: the instructions of a level are only available inside the function
//! that [`super::Level::run`] has compiled for it, so nothing may be left to call.

mod lockstep;

use std::ops::{Add, BitAnd, BitOr, Mul, Neg, Not, Sub};

use pulp::Simd;

use super::vector::Vector;
pub use lockstep::{Lockstep, Numbers};

/// As many numbers as the registers of the level hold.
#[derive(Clone, Copy)]
pub struct Lanes<S: Simd> {
    simd: S,
    values: S::f64s,
}

/// One truth value per lane.
#[derive(Clone, Copy)]
pub struct Mask<S: Simd> {
    simd: S,
    values: S::m64s,
}

impl<S: Simd> Lanes<S> {
    /// The same number in every lane.
    #[inline(always)]
    pub fn splat(simd: S, value: f64) -> Self {
        Self { simd, values: simd.splat_f64s(value) }
    }

    /// A register of a column.
    #[inline(always)]
    pub fn load(simd: S, column: &[S::f64s], k: usize) -> Self {
        Self { simd, values: column[k] }
    }

    /// Writes register `k` of a column.
    #[inline(always)]
    pub fn store(self, column: &mut [S::f64s], k: usize) {
        column[k] = self.values;
    }

    /// The token of the level.
    #[inline(always)]
    pub fn simd(self) -> S {
        self.simd
    }

    #[inline(always)]
    fn with(self, values: S::f64s) -> Self {
        Self { values, ..self }
    }

    /// `self * factor + term`, rounded once.
    #[inline(always)]
    pub fn mul_add(self, factor: Self, term: Self) -> Self {
        self.with(self.simd.mul_add_f64s(self.values, factor.values, term.values))
    }

    /// `self / divisor`
    #[inline(always)]
    pub fn quotient(self, divisor: Self) -> Self {
        self.with(self.simd.div_f64s(self.values, divisor.values))
    }

    /// Square root.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        self.with(self.simd.sqrt_f64s(self.values))
    }

    /// Absolute value.
    #[inline(always)]
    pub fn abs(self) -> Self {
        // Every bit but the sign. pulp's own may be left to call.
        let bits = self.simd.splat_f64s(f64::from_bits(!(1 << 63)));
        self.with(self.simd.and_f64s(self.values, bits))
    }

    /// The larger of two numbers, neither of them NaN.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        self.with(self.simd.max_f64s(self.values, other.values))
    }

    /// The smaller of two numbers, neither of them NaN.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        self.with(self.simd.min_f64s(self.values, other.values))
    }

    /// The sign bit, on a zero.
    #[inline(always)]
    pub fn sign(self) -> Self {
        let bit = self.simd.splat_f64s(-0.0);
        self.with(self.simd.and_f64s(self.values, bit))
    }

    /// Minus the number where `sign` has its sign bit set.
    #[inline(always)]
    pub fn flip(self, sign: Self) -> Self {
        self.with(self.simd.xor_f64s(self.values, sign.values))
    }

    /// False where either is NaN.
    #[inline(always)]
    pub fn below(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, values: self.simd.less_than_f64s(self.values, other.values) }
    }

    /// False where either is NaN.
    #[inline(always)]
    pub fn at_most(self, other: Self) -> Mask<S> {
        let values = self.simd.less_than_or_equal_f64s(self.values, other.values);
        Mask { simd: self.simd, values }
    }

    /// The whole number in the lowest bits of `self + 1.5 * 2^52`: whether bit `bit` of it is set.
    #[inline(always)]
    pub fn has_bit(self, bit: u64) -> Mask<S> {
        let simd = self.simd;
        let bits = simd.and_u64s(simd.transmute_u64s_f64s(self.values), simd.splat_u64s(1 << bit));
        Mask { simd, values: simd.greater_than_u64s(bits, simd.splat_u64s(0)) }
    }
}

impl<S: Simd> Lanes<S> {
    /// The sum over all lanes.
    #[inline(always)]
    pub fn total(self) -> f64 {
        self.simd.reduce_sum_f64s(self.values)
    }
}

impl<S: Vector> Lanes<S> {
    /// Every lane `1 << LOG` places on, zeros before it.
    #[inline(always)]
    pub fn shift<const LOG: u32>(simd: S, lanes: Self) -> Self {
        lanes.with(simd.shift::<LOG>(lanes.values))
    }

    /// Rows of three numbers, as many as there are lanes, to their columns; 0 where there are fewer.
    #[inline(always)]
    pub fn unbraid(simd: S, rows: &[f64]) -> [Self; 3] {
        match S::as_simd_f64s(rows).0 {
            [a, b, c, ..] => simd.unbraid([*a, *b, *c]).map(|values| Self { simd, values }),
            _ => [Self::splat(simd, 0.0); 3],
        }
    }

    /// The reverse of [`Self::unbraid`].
    #[inline(always)]
    pub fn braid([x, y, z]: [Self; 3], rows: &mut [f64]) {
        if let [a, b, c, ..] = S::as_mut_simd_f64s(rows).0 {
            [*a, *b, *c] = x.simd.braid([x.values, y.values, z.values]);
        }
    }

    /// Eight columns of as many rows as there are lanes, a row every `width` numbers; all of the eight numbers from each
    /// row's first one on have to be there.
    #[inline(always)]
    pub fn columns(simd: S, rows: &[f64], width: usize) -> [Self; 8] {
        let mut eights = [&[0.0; 8]; 8];
        for (lane, eight) in eights.iter_mut().enumerate().take(S::F64_LANES) {
            *eight = rows[lane * width..].first_chunk().unwrap_or(&[0.0; 8]);
        }
        Self::columns_of(simd, &eights)
    }

    /// The same of rows wherever they are, as many as there are lanes.
    #[inline(always)]
    pub fn columns_of(simd: S, rows: &[&[f64; 8]; 8]) -> [Self; 8] {
        let mut registers = [simd.splat_f64s(0.0); 8];
        for (k, register) in registers.iter_mut().enumerate() {
            let part = &rows[k % S::F64_LANES][k / S::F64_LANES * S::F64_LANES..];
            *register = S::as_simd_f64s(&part[..S::F64_LANES]).0[0];
        }
        let columns = simd.transpose(registers);
        let mut lanes = [Self::splat(simd, 0.0); 8];
        for (lanes, values) in lanes.iter_mut().zip(columns) {
            lanes.values = values;
        }
        lanes
    }

    /// The reverse of [`Self::columns`]: of each row all eight numbers are written, the rows one after the other.
    #[inline(always)]
    pub fn rows(simd: S, columns: [Self; 8], rows: &mut [f64], width: usize) {
        let mut registers = [simd.splat_f64s(0.0); 8];
        for (register, lanes) in registers.iter_mut().zip(columns) {
            *register = lanes.values;
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
    #[inline(always)]
    pub fn inverse_root(self) -> Self {
        self.with(self.simd.inverse_root(self.values))
    }

    /// [`Vector::square`] at these places.
    #[inline(always)]
    pub fn square(self, table: &[f64], columns: usize) -> [Self; 4] {
        let [a, b, c, d] = self.simd.square(table, columns, self.values);
        [self.with(a), self.with(b), self.with(c), self.with(d)]
    }

    /// [`Vector::pairs`] at these places.
    ///
    /// # Safety
    ///
    /// As there.
    #[inline(always)]
    pub unsafe fn pairs(self, table: &[[f32; 2]]) -> Self {
        // SAFETY: by the caller.
        self.with(unsafe { self.simd.pairs(table, self.values) })
    }

    /// [`Vector::exponent`].
    #[inline(always)]
    pub fn exponent(self) -> Self {
        self.with(self.simd.exponent(self.values))
    }

    /// The power of two of [`Self::exponent`].
    #[inline(always)]
    pub fn power(self) -> Self {
        let bits = self.simd.splat_f64s(f64::INFINITY);
        self.with(self.simd.and_f64s(self.values, bits))
    }

    /// [`Vector::least_pairs`].
    #[inline(always)]
    pub fn least_pairs(self, other: Self) -> Self {
        self.with(self.simd.least_pairs(self.values, other.values))
    }

    /// [`Vector::unpair`].
    #[inline(always)]
    pub fn unpair(self) -> [Self; 2] {
        let [first, second] = self.simd.unpair(self.values);
        [self.with(first), self.with(second)]
    }

    /// `a0 a1 .., b0 b1 ..` to `a0 b0 a1 b1 ..`, into as many numbers.
    #[inline(always)]
    pub fn zip([a, b]: [Self; 2], pairs: &mut [f64]) {
        if let [first, second, ..] = S::as_mut_simd_f64s(pairs).0 {
            [*first, *second] = a.simd.zip([a.values, b.values]);
        }
    }

    /// The last lane in every lane.
    #[inline(always)]
    pub fn spread(self, simd: S) -> Self {
        self.with(simd.spread(self.values))
    }

    /// The last lane.
    #[inline(always)]
    pub fn last(self, simd: S) -> f64 {
        simd.last(self.values)
    }
}

impl<S: Simd> Mask<S> {
    /// `yes` where true, `no` elsewhere.
    #[inline(always)]
    pub fn select(self, yes: Lanes<S>, no: Lanes<S>) -> Lanes<S> {
        yes.with(self.simd.select_f64s(self.values, yes.values, no.values))
    }

    /// True if any lane is true.
    #[inline(always)]
    pub fn any(self) -> bool {
        self.simd.first_true_m64s(self.values) < S::F64_LANES
    }
}

macro_rules! operator {
    ($trait: ident, $method: ident, $of: ident, $op: ident) => {
        impl<S: Simd> $trait for $of<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let values = self.simd.$op(self.values, other.values);
                Self { values, ..self }
            }
        }
    };
}

operator!(Add, add, Lanes, add_f64s);
operator!(Sub, sub, Lanes, sub_f64s);
operator!(Mul, mul, Lanes, mul_f64s);
operator!(BitAnd, bitand, Mask, and_m64s);
operator!(BitOr, bitor, Mask, or_m64s);

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        let bit = self.simd.splat_f64s(-0.0);
        self.with(self.simd.xor_f64s(self.values, bit))
    }
}

impl<S: Simd> Not for Mask<S> {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self { values: self.simd.not_m64s(self.values), ..self }
    }
}
