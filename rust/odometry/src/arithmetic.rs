//! Numbers that a step of odometry is worked out with: one at a time, or a register of successive steps.

use std::ops::{Add, Mul, Neg, Sub};

/// Operations on one number or on a register of numbers, so that one body of code serves both.
pub(crate) trait Arithmetic: Copy {
    type Number: Copy
        + Add<Output = Self::Number>
        + Sub<Output = Self::Number>
        + Mul<Output = Self::Number>
        + Neg<Output = Self::Number>;

    fn number(self, value: f64) -> Self::Number;
    /// `a b + c`
    fn fused(self, a: Self::Number, b: Self::Number, c: Self::Number) -> Self::Number;
    /// `a / b`
    fn over(self, a: Self::Number, b: Self::Number) -> Self::Number;
    fn sqrt(self, a: Self::Number) -> Self::Number;
    /// The smaller of two, neither of them NaN.
    fn least(self, a: Self::Number, b: Self::Number) -> Self::Number;
}

/// One number at a time; `a b + c` is rounded twice, on every machine.
#[derive(Clone, Copy)]
pub(crate) struct Unfused;

/// One number at a time; `a b + c` is the instruction of the level.
#[derive(Clone, Copy)]
pub(crate) struct Fused;

macro_rules! singly {
    ($kind: ident, |$a: ident, $b: ident, $c: ident| $fused: expr) => {
        impl Arithmetic for $kind {
            type Number = f64;

            #[inline(always)]
            fn number(self, value: f64) -> f64 {
                value
            }

            #[inline(always)]
            fn fused(self, $a: f64, $b: f64, $c: f64) -> f64 {
                $fused
            }

            #[inline(always)]
            fn over(self, a: f64, b: f64) -> f64 {
                a / b
            }

            #[inline(always)]
            fn sqrt(self, a: f64) -> f64 {
                a.sqrt()
            }

            #[inline(always)]
            fn least(self, a: f64, b: f64) -> f64 {
                if a < b { a } else { b }
            }
        }
    };
}

singly!(Unfused, |a, b, c| a * b + c);
singly!(Fused, |a, b, c| a.mul_add(b, c));
