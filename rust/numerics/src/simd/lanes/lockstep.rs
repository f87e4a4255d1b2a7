//! Arithmetic that a polynomial needs of its variable, be it one register or several in lockstep.

use std::ops::{Add, Mul, Neg, Sub};

use pulp::Simd;

use super::{Lanes, Mask};

/// Arithmetic that a polynomial needs of its variable: a register, or several in lockstep.
pub trait Numbers<S: Simd>:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// Lanes in which a condition is true.
    type Mask: Copy;

    /// The same number everywhere.
    fn all(simd: S, value: f64) -> Self;
    /// [`Lanes::mul_add`].
    fn fused(self, factor: Self, term: Self) -> Self;
    /// [`Lanes::quotient`].
    fn over(self, divisor: Self) -> Self;
    /// [`Lanes::max`] and [`Lanes::min`].
    fn sorted(self, other: Self) -> [Self; 2];
    /// [`Lanes::flip`].
    fn flipped(self, sign: Self) -> Self;
    /// [`Lanes::below`].
    fn less(self, other: Self) -> Self::Mask;
    /// [`Lanes::has_bit`].
    fn bit(self, bit: u64) -> Self::Mask;
    /// [`Mask::select`].
    fn either(mask: Self::Mask, yes: Self, no: Self) -> Self;
}

impl<S: Simd> Numbers<S> for Lanes<S> {
    type Mask = Mask<S>;

    #[inline(always)]
    fn all(simd: S, value: f64) -> Self {
        Self::splat(simd, value)
    }

    #[inline(always)]
    fn fused(self, factor: Self, term: Self) -> Self {
        self.mul_add(factor, term)
    }

    #[inline(always)]
    fn over(self, divisor: Self) -> Self {
        self.quotient(divisor)
    }

    #[inline(always)]
    fn sorted(self, other: Self) -> [Self; 2] {
        [self.max(other), self.min(other)]
    }

    #[inline(always)]
    fn flipped(self, sign: Self) -> Self {
        self.flip(sign)
    }

    #[inline(always)]
    fn less(self, other: Self) -> Mask<S> {
        self.below(other)
    }

    #[inline(always)]
    fn bit(self, bit: u64) -> Mask<S> {
        self.has_bit(bit)
    }

    #[inline(always)]
    fn either(mask: Mask<S>, yes: Self, no: Self) -> Self {
        mask.select(yes, no)
    }
}

/// Several registers in lockstep: while one result is on its way, the processor works on the others.
#[derive(Clone, Copy)]
pub struct Lockstep<T, const N: usize>(pub [T; N]);

macro_rules! lockstep {
    ($trait: ident, $method: ident) => {
        impl<S: Simd, const N: usize> $trait for Lockstep<Lanes<S>, N> {
            type Output = Self;

            #[inline(always)]
            fn $method(mut self, other: Self) -> Self {
                for i in 0..N {
                    self.0[i] = self.0[i].$method(other.0[i]);
                }
                self
            }
        }
    };
}

lockstep!(Add, add);
lockstep!(Sub, sub);
lockstep!(Mul, mul);

impl<S: Simd, const N: usize> Neg for Lockstep<Lanes<S>, N> {
    type Output = Self;

    #[inline(always)]
    fn neg(mut self) -> Self {
        for i in 0..N {
            self.0[i] = -self.0[i];
        }
        self
    }
}

impl<S: Simd, const N: usize> Numbers<S> for Lockstep<Lanes<S>, N> {
    type Mask = Lockstep<Mask<S>, N>;

    #[inline(always)]
    fn all(simd: S, value: f64) -> Self {
        Self([Lanes::splat(simd, value); N])
    }

    #[inline(always)]
    fn fused(mut self, factor: Self, term: Self) -> Self {
        for i in 0..N {
            self.0[i] = self.0[i].mul_add(factor.0[i], term.0[i]);
        }
        self
    }

    #[inline(always)]
    fn over(mut self, divisor: Self) -> Self {
        for i in 0..N {
            self.0[i] = self.0[i].quotient(divisor.0[i]);
        }
        self
    }

    #[inline(always)]
    fn sorted(self, other: Self) -> [Self; 2] {
        let mut sorted = [self, other];
        for i in 0..N {
            [sorted[0].0[i], sorted[1].0[i]] = self.0[i].sorted(other.0[i]);
        }
        sorted
    }

    #[inline(always)]
    fn flipped(mut self, sign: Self) -> Self {
        for i in 0..N {
            self.0[i] = self.0[i].flip(sign.0[i]);
        }
        self
    }

    #[inline(always)]
    fn less(self, other: Self) -> Self::Mask {
        let mut mask = Lockstep([self.0[0].below(other.0[0]); N]);
        for i in 1..N {
            mask.0[i] = self.0[i].below(other.0[i]);
        }
        mask
    }

    #[inline(always)]
    fn bit(self, bit: u64) -> Self::Mask {
        let mut mask = Lockstep([self.0[0].has_bit(bit); N]);
        for i in 1..N {
            mask.0[i] = self.0[i].has_bit(bit);
        }
        mask
    }

    #[inline(always)]
    fn either(mask: Self::Mask, mut yes: Self, no: Self) -> Self {
        for i in 0..N {
            yes.0[i] = mask.0[i].select(yes.0[i], no.0[i]);
        }
        yes
    }
}
