//! Arithmetic on intervals, one in every lane.
//!
//! Written without closures, which would be compiled as functions without the instructions of the level.

use pulp::Simd;

use crate::suspension::lanes::all;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::polynomials::angle;

/// Lower and upper end.
pub(super) type Interval<S> = [Lanes<S>; 2];

/// Sine and cosine at both ends of an angle's interval.
pub(super) type Turned<S> = [(Lanes<S>, Lanes<S>); 2];

/// An expression for the indices 0 and 1: both ends of an interval, or columns and rows.
macro_rules! both {
    ($k: ident, $value: expr) => {
        [
            {
                let $k = 0;
                $value
            },
            {
                let $k = 1;
                $value
            },
        ]
    };
}
pub(super) use both;

#[inline(always)]
pub(super) fn sum<S: Simd>(a: Interval<S>, b: Interval<S>) -> Interval<S> {
    both!(k, a[k] + b[k])
}

#[inline(always)]
pub(super) fn minus<S: Simd>([low, high]: Interval<S>) -> Interval<S> {
    [-high, -low]
}

#[inline(always)]
pub(super) fn widest<S: Simd>([a, b]: Interval<S>) -> Lanes<S> {
    a.abs().max(b.abs())
}

/// An interval times a positive one.
#[inline(always)]
pub(super) fn times<S: Simd>([low, high]: Interval<S>, [least, most]: Interval<S>) -> Interval<S> {
    [(low * least).min(low * most), (high * least).max(high * most)]
}

/// The interval of an even function that is monotonic in the absolute value, from its values at the ends of an interval
/// and at 0.
#[inline(always)]
pub(super) fn even<S: Simd>([low, high]: Interval<S>, [a, b]: Interval<S>, middle: Lanes<S>) -> Interval<S> {
    let around = (low * high).lt(all(low.simd(), 0.0));
    let (least, most) = (a.min(b), a.max(b));
    [around.select(least.min(middle), least), around.select(most.max(middle), most)]
}

/// True if an interval is inside another.
#[inline(always)]
pub(super) fn inside<S: Simd>([low, high]: Interval<S>, [least, most]: [f64; 2]) -> Mask<S> {
    let simd = low.simd();
    all(simd, least).le(low) & high.le(all(simd, most))
}

/// Arc sine of a number clipped to [-1, 1].
#[inline(always)]
pub(super) fn asin<S: Simd>(x: Lanes<S>) -> Lanes<S> {
    let (simd, one) = (x.simd(), all(x.simd(), 1.0));
    let size = x.abs().min(one);
    let cos = (one - size) * (one + size);
    angle(simd, cos.sqrt(), size).xor_sign(x.sign_bit())
}

/// `sqrt(1 - x²)`: the cosine of a sine, or the sine of a cosine.
#[inline(always)]
pub(super) fn complement<S: Simd>(x: Lanes<S>) -> Lanes<S> {
    let simd = x.simd();
    (all(simd, 1.0) - x * x).max(all(simd, 0.0)).sqrt()
}
