//! Registers of either kind of number, so that a planner's cycle is written once for `f32` and `f64`.

use std::ops::{Add, BitAnd, BitOr, Mul, Not, Sub};

use pulp::Simd;

use super::real::Real;
use crate::batch::machine::vector::Vector;

/// Registers with the operators of a number, `N` in lockstep: while one result is on its way, the processor works on the
/// others.
pub(crate) struct Regs<S: Simd, R: Real, const N: usize> {
    simd: S,
    values: [R::Register<S>; N],
}

/// A single one.
pub(crate) type Reg<S, R> = Regs<S, R, 1>;

impl<S: Simd, R: Real, const N: usize> Clone for Regs<S, R, N> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}
impl<S: Simd, R: Real, const N: usize> Copy for Regs<S, R, N> {}

/// One truth value per lane.
pub(crate) struct Truths<S: Simd, R: Real, const N: usize> {
    simd: S,
    values: [R::Truths<S>; N],
}

/// Of a single register.
pub(crate) type Truth<S, R> = Truths<S, R, 1>;

impl<S: Simd, R: Real, const N: usize> Clone for Truths<S, R, N> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}
impl<S: Simd, R: Real, const N: usize> Copy for Truths<S, R, N> {}

// Loops instead of `map`: a closure may be left to call, without the level's instructions.

/// Methods of one register, of all in lockstep.
macro_rules! alone {
    ($($(#[$doc:meta])* $name:ident: $function:ident;)*) => {
        $($(#[$doc])*
        #[inline(always)]
        pub fn $name(mut self) -> Self {
            for value in &mut self.values {
                *value = R::$function(self.simd, *value);
            }
            self
        })*
    };
}

/// The same of two.
macro_rules! paired {
    ($($(#[$doc:meta])* $name:ident: $function:ident;)*) => {
        $($(#[$doc])*
        #[inline(always)]
        pub fn $name(mut self, other: Self) -> Self {
            for (value, other) in self.values.iter_mut().zip(other.values) {
                *value = R::$function(self.simd, *value, other);
            }
            self
        })*
    };
}

impl<S: Simd, R: Real, const N: usize> Regs<S, R, N> {
    /// Numbers of all of them.
    #[inline(always)]
    pub fn lanes() -> usize {
        N * R::lanes::<S>()
    }

    /// The same number in every lane.
    #[inline(always)]
    pub fn splat(simd: S, value: R) -> Self {
        Self {
            simd,
            values: [R::splat(simd, value); N],
        }
    }

    /// The same, of a constant.
    #[inline(always)]
    pub fn all(simd: S, value: f64) -> Self {
        Self::splat(simd, R::of(value))
    }

    /// The first numbers of a slice, which has enough of them.
    #[inline(always)]
    pub fn load(simd: S, from: &[R]) -> Self {
        let mut loaded = Self::splat(simd, R::default());
        for (k, value) in loaded.values.iter_mut().enumerate() {
            *value = R::load(simd, &from[k * R::lanes::<S>()..]);
        }
        loaded
    }

    #[inline(always)]
    pub fn store(self, to: &mut [R]) {
        for (k, value) in self.values.into_iter().enumerate() {
            R::store::<S>(&mut to[k * R::lanes::<S>()..], value);
        }
    }

    /// `self * factor + term`, rounded once.
    #[inline(always)]
    pub fn mul_add(mut self, factor: Self, term: Self) -> Self {
        for k in 0..N {
            let (factor, term) = (factor.values[k], term.values[k]);
            self.values[k] = R::fused(self.simd, self.values[k], factor, term);
        }
        self
    }

    alone! {
        sqrt: sqrt;
        abs: abs;
    }

    paired! {
        over: div;
        max: max;
        min: min;
        /// Minus the number where `sign` has its sign bit set.
        flip: xor;
    }

    /// The sign bit, on a zero.
    #[inline(always)]
    pub fn sign(mut self) -> Self {
        let bit = R::splat(self.simd, R::of(-0.0));
        for value in &mut self.values {
            *value = R::and(self.simd, *value, bit);
        }
        self
    }

    /// A number that is not negative to the next whole number below.
    #[inline(always)]
    pub fn floor(self) -> Self {
        let whole = Self::all(self.simd, R::WHOLE);
        let near = (self + whole) - whole;
        let one = Self::all(self.simd, 1.0);
        self.below(near).select(near - one, near)
    }

    /// A whole number as [`Real::count`] takes it.
    #[inline(always)]
    pub fn counted(self) -> Self {
        self + Self::all(self.simd, R::WHOLE)
    }

    #[inline(always)]
    pub fn below(self, other: Self) -> Truths<S, R, N> {
        let mut values = [R::below(self.simd, self.values[0], other.values[0]); N];
        for (k, value) in values.iter_mut().enumerate().skip(1) {
            *value = R::below(self.simd, self.values[k], other.values[k]);
        }
        Truths {
            simd: self.simd,
            values,
        }
    }
}

impl<S: Simd> Reg<S, f32> {
    /// Numbers of their bits.
    #[inline(always)]
    pub fn of_bits(simd: S, bits: S::u32s) -> Self {
        Self {
            simd,
            values: [simd.transmute_f32s_u32s(bits)],
        }
    }

    #[inline(always)]
    pub fn bits(self) -> S::u32s {
        self.simd.transmute_u32s_f32s(self.values[0])
    }
}

impl<S: Vector, R: Real> Reg<S, R> {
    /// The four cells around places, `[x, y]` of the first of them: the two of its row, and of the next one.
    ///
    /// # Safety
    ///
    /// As [`Vector::corners`].
    #[inline(always)]
    pub unsafe fn corners(
        simd: S,
        values: &[f32],
        columns: usize,
        [x, y]: [Self; 2],
    ) -> [[Self; 2]; 2] {
        // SAFETY: the caller's.
        let cells = unsafe { R::corners(simd, values, columns, [x.values[0], y.values[0]]) };
        cells.map(|row| {
            row.map(|value| Self {
                simd,
                values: [value],
            })
        })
    }
}

impl<S: Simd> Truth<S, f32> {
    #[inline(always)]
    pub fn of(simd: S, value: S::m32s) -> Self {
        Self {
            simd,
            values: [value],
        }
    }
}

impl<S: Simd, R: Real, const N: usize> Truths<S, R, N> {
    /// `yes` where true, `no` elsewhere.
    #[inline(always)]
    pub fn select(self, yes: Regs<S, R, N>, no: Regs<S, R, N>) -> Regs<S, R, N> {
        let mut chosen = yes;
        for k in 0..N {
            chosen.values[k] = R::select(self.simd, self.values[k], yes.values[k], no.values[k]);
        }
        chosen
    }

    #[inline(always)]
    pub fn any(self) -> bool {
        let mut all = self.values[0];
        for value in &self.values[1..] {
            all = R::either(self.simd, all, *value);
        }
        R::any(self.simd, all)
    }
}

macro_rules! operator {
    ($trait:ident, $name:ident, $function:ident, $of:ident) => {
        impl<S: Simd, R: Real, const N: usize> $trait for $of<S, R, N> {
            type Output = Self;
            #[inline(always)]
            fn $name(mut self, other: Self) -> Self {
                for (value, other) in self.values.iter_mut().zip(other.values) {
                    *value = R::$function(self.simd, *value, other);
                }
                self
            }
        }
    };
}
operator!(Add, add, add, Regs);
operator!(Sub, sub, sub, Regs);
operator!(Mul, mul, mul, Regs);
operator!(BitAnd, bitand, both, Truths);
operator!(BitOr, bitor, either, Truths);

impl<S: Simd, R: Real, const N: usize> Not for Truths<S, R, N> {
    type Output = Self;
    #[inline(always)]
    fn not(mut self) -> Self {
        for value in &mut self.values {
            *value = R::not(self.simd, *value);
        }
        self
    }
}
