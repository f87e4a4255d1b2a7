//! The number type of every formula: registers of one level and precision, with the operators of a number.
//!
//! Everything is `#[inline(always)]`: the instructions of a level are only available inside the function that
//! [`super::level::Level::run_any`] has compiled for it, so every function has to be inlined there. Loops instead of
//! `map` for the same reason: a closure might not be inlined.

mod rows;

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use pulp::Simd;

use super::float::Float;
use super::vector::Vector;

/// `N` registers of numbers of precision `T`, in lockstep: the latency of an operation on one of them is hidden by
/// those on the others.
#[derive(Clone, Copy)]
pub struct Lanes<S: Simd, T: Float = f64, const N: usize = 1> {
    simd: S,
    values: [T::Register<S>; N],
}

/// One truth value per lane.
#[derive(Clone, Copy)]
pub struct Mask<S: Simd, T: Float = f64, const N: usize = 1> {
    simd: S,
    values: [T::Mask<S>; N],
}

/// Does the same for every register. Most kernels have one, for which a loop makes them slow to compile.
macro_rules! for_each {
    ($k:ident: $body:block) => {
        if N == 1 {
            let $k = 0;
            $body
        } else {
            for $k in 0..N $body
        }
    };
}

/// Methods that do the same to every register.
macro_rules! every_register {
    ($($(#[$doc:meta])* $name:ident($($other:ident),*) = $operation:ident;)*) => {$(
        $(#[$doc])*
        #[inline(always)]
        pub fn $name(mut self $(, $other: Self)*) -> Self {
            for_each!(k: { self.values[k] = T::$operation(self.simd, self.values[k] $(, $other.values[k])*); });
            self
        }
    )*};
}

/// Comparisons of every register.
macro_rules! comparison {
    ($($(#[$doc:meta])* $name:ident = $operation:ident;)*) => {$(
        $(#[$doc])*
        #[inline(always)]
        pub fn $name(self, other: Self) -> Mask<S, T, N> {
            let mut values = [T::$operation(self.simd, self.values[0], other.values[0]); N];
            if N > 1 {
                for k in 1..N {
                    values[k] = T::$operation(self.simd, self.values[k], other.values[k]);
                }
            }
            Mask { simd: self.simd, values }
        }
    )*};
}

#[inline_always]
impl<S: Simd, T: Float, const N: usize> Lanes<S, T, N> {
    /// The same number in every lane.
    pub fn splat(simd: S, value: T) -> Self {
        Self { simd, values: [T::splat(simd, value); N] }
    }

    /// The same, of a constant.
    pub fn constant(simd: S, value: f64) -> Self {
        Self::splat(simd, T::from_f64(value))
    }

    /// Numbers of all registers.
    pub fn lanes() -> usize {
        N * T::lanes::<S>()
    }

    /// The first numbers of a slice; zeros beyond its last whole register.
    pub fn from_slice(simd: S, numbers: &[T]) -> Self {
        let mut lanes = Self::splat(simd, T::default());
        let registers = T::as_registers::<S>(numbers);
        // A loop of constant length, so that the lanes stay in registers.
        for_each!(k: {
            if let Some(register) = registers.get(k) {
                lanes.values[k] = *register;
            }
        });
        lanes
    }

    /// Writes the lanes to the first numbers of a slice, as far as it has whole registers.
    pub fn copy_to_slice(self, numbers: &mut [T]) {
        let registers = T::as_mut_registers::<S>(numbers);
        for_each!(k: {
            if let Some(register) = registers.get_mut(k) {
                *register = self.values[k];
            }
        });
    }

    /// The token of the level.
    pub fn simd(self) -> S {
        self.simd
    }

    /// Register `k` of them.
    pub fn register(self, k: usize) -> Lanes<S, T> {
        Lanes { simd: self.simd, values: [self.values[k]] }
    }

    /// Replaces register `k`.
    pub fn set_register(&mut self, k: usize, lanes: Lanes<S, T>) {
        self.values[k] = lanes.values[0];
    }

    every_register! {
        /// `self * factor + term`, rounded once.
        mul_add(factor, term) = mul_add;
        /// Square root.
        sqrt() = sqrt;
        /// The larger of two numbers, neither of them NaN.
        max(other) = max;
        /// The smaller of two numbers, neither of them NaN.
        min(other) = min;
        /// Minus the number where `sign` has its sign bit set.
        xor_sign(sign) = xor;
    }

    comparison! {
        /// False where either is NaN.
        lt = less;
        /// False where either is NaN.
        le = less_equal;
    }

    /// Absolute value.
    pub fn abs(mut self) -> Self {
        // Every bit but the sign. pulp's `abs` might not be inlined.
        let bits = T::splat(self.simd, T::ABS);
        for_each!(k: { self.values[k] = T::and(self.simd, self.values[k], bits); });
        self
    }

    /// A zero with the sign of the number.
    pub fn sign_bit(mut self) -> Self {
        let bit = T::splat(self.simd, T::from_f64(-0.0));
        for_each!(k: { self.values[k] = T::and(self.simd, self.values[k], bit); });
        self
    }

    /// The whole number in the lowest bits of `self + ROUND`: true if bit `bit` of it is set.
    pub fn has_bit(self, bit: u32) -> Mask<S, T, N> {
        let mut values = [T::has_bit(self.simd, self.values[0], bit); N];
        if N > 1 {
            for (value, of) in values.iter_mut().zip(self.values).skip(1) {
                *value = T::has_bit(self.simd, of, bit);
            }
        }
        Mask { simd: self.simd, values }
    }

    /// The largest whole number up to a number, which is at most half of [`Float::INTEGERS`] in size.
    pub fn floor(self) -> Self {
        let round = Self::constant(self.simd, T::ROUND);
        let near = (self + round) - round;
        let one = Self::constant(self.simd, 1.0);
        self.lt(near).select(near - one, near)
    }

    /// A whole number plus [`Float::INTEGERS`], as [`Float::to_index`] takes it.
    pub fn as_index(self) -> Self {
        self + Self::constant(self.simd, T::INTEGERS)
    }
}

impl<S: Vector, T: Float, const N: usize> Lanes<S, T, N> {
    /// One over the square root of a number that is not negative, and the root, each with an error of up to two units
    /// in the last place.
    #[inline(always)]
    pub fn roots(self) -> [Self; 2] {
        let number = |value: f64| Self::constant(self.simd, value);
        let (mut inverse, mut root) = (self, self);
        for k in 0..N {
            [inverse.values[k], root.values[k]] = T::roots(self.simd, self.values[k]);
        }
        let odd = self.lt(number(1e-30)) | number(1e36).lt(self);
        if !T::EXACT_ROOTS && odd.any() {
            let exact = self.sqrt();
            root = odd.select(exact, root);
            inverse = odd.select(number(1.0) / exact, inverse);
        }
        [inverse, root]
    }
}

impl<S: Vector, T: Float> Lanes<S, T> {
    /// The four cells around places, `[x, y]` of the first of them: the two of its row, and of the next one.
    ///
    /// # Safety
    ///
    /// The conditions of [`Vector::corners`].
    #[inline(always)]
    pub unsafe fn corners(simd: S, values: &[f32], columns: usize, [x, y]: [Self; 2]) -> [[Self; 2]; 2] {
        // SAFETY: the caller's.
        let cells = unsafe { T::corners(simd, values, columns, [x.values[0], y.values[0]]) };
        cells.map(|row| row.map(|value| Self { simd, values: [value] }))
    }
}

#[inline_always]
impl<S: Simd, T: Float, const N: usize> Mask<S, T, N> {
    /// The same in every lane.
    pub fn splat(simd: S, truth: bool) -> Self {
        let zero = Lanes::constant(simd, 0.0);
        if truth { zero.le(zero) } else { zero.lt(zero) }
    }

    /// `yes` where true, `no` elsewhere.
    pub fn select(self, mut yes: Lanes<S, T, N>, no: Lanes<S, T, N>) -> Lanes<S, T, N> {
        for_each!(k: { yes.values[k] = T::select(self.simd, self.values[k], yes.values[k], no.values[k]); });
        yes
    }

    /// True if any lane is true.
    pub fn any(self) -> bool {
        let mut all = self.values[0];
        if N > 1 {
            for k in 1..N {
                all = T::either(self.simd, all, self.values[k]);
            }
        }
        T::any(self.simd, all)
    }

    /// True if every lane is true.
    pub fn all(self) -> bool {
        !(!self).any()
    }
}

impl<S: Simd> Mask<S> {
    /// The lanes one by one, false beyond the last.
    #[inline(always)]
    pub fn booleans(self) -> [bool; 8] {
        let mut numbers = [0.0; 8];
        self.select(Lanes::splat(self.simd, 1.0), Lanes::splat(self.simd, 0.0)).copy_to_slice(&mut numbers);
        numbers.map(|number| number != 0.0)
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $of:ident, $operation:ident) => {
        impl<S: Simd, T: Float, const N: usize> $trait for $of<S, T, N> {
            type Output = Self;

            #[inline(always)]
            fn $method(mut self, other: Self) -> Self {
                for_each!(k: { self.values[k] = T::$operation(self.simd, self.values[k], other.values[k]); });
                self
            }
        }
    };
}

operator!(Add, add, Lanes, add);
operator!(Sub, sub, Lanes, sub);
operator!(Mul, mul, Lanes, mul);
operator!(Div, div, Lanes, div);
operator!(BitAnd, bitand, Mask, both);
operator!(BitOr, bitor, Mask, either);

/// An operator with a constant, the same in every lane.
macro_rules! with_constant {
    ($trait:ident, $method:ident) => {
        impl<S: Simd, T: Float, const N: usize> $trait<f64> for Lanes<S, T, N> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, constant: f64) -> Self {
                self.$method(Self::constant(self.simd, constant))
            }
        }
    };
}

with_constant!(Add, add);
with_constant!(Sub, sub);
with_constant!(Mul, mul);

impl<S: Simd, T: Float, const N: usize> Neg for Lanes<S, T, N> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.xor_sign(Self::constant(self.simd, -0.0))
    }
}

impl<S: Simd, T: Float, const N: usize> Not for Mask<S, T, N> {
    type Output = Self;

    #[inline(always)]
    fn not(mut self) -> Self {
        for_each!(k: { self.values[k] = T::not(self.simd, self.values[k]); });
        self
    }
}
