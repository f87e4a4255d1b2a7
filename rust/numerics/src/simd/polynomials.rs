//! Arc tangent, sine and cosine of whole registers, as polynomials of known error.
//!
//! The coefficients interpolate at Chebyshev nodes, computed with 50 digits. The tests measure the errors against
//! the functions of the standard library.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, FRAC_PI_4};

use pulp::Simd;

use super::float::Float;
use super::lanes::Lanes;

/// Tangent of half an eighth of a turn: the ratio of the sides from which on [`angle`] counts from an eighth.
pub const TAN_EIGHTH: f64 = 0.414_213_562_373_095_03;

/// `(atan(t) / t - 1) / t^2` in powers of `t^2`, for `t` up to tan(pi/8); relative error of the arc tangent 7e-18.
const ATAN: [f64; 11] = [
    -0.333_333_333_333_333_3,
    0.199_999_999_999_955_2,
    -0.142_857_142_846_665_42,
    0.111_111_110_152_562_92,
    -0.090_909_045_781_210_85,
    0.076_921_831_907_606_51,
    -0.066_645_114_464_602_2,
    0.058_581_489_047_951_24,
    -0.050_854_496_960_392_584,
    0.039_231_657_085_083_686,
    -0.019_176_885_636_589_053,
];

/// `(sin(x) / x - 1) / x^2` in powers of `x^2`, for `x` up to pi/4; relative error of the sine 2e-17.
const SIN: [f64; 6] = [
    -0.166_666_666_666_666_66,
    0.008_333_333_333_330_925,
    -0.000_198_412_698_367_224_18,
    2.755_731_608_381_636e-6,
    -2.505_112_794_401_418_8e-8,
    1.591_784_852_480_826_2e-10,
];

/// `(cos(x) - 1 + x^2 / 2) / x^4` in powers of `x^2`, for `x` up to pi/4; relative error of the cosine 1e-18.
const COS: [f64; 6] = [
    0.041_666_666_666_666_664,
    -0.001_388_888_888_888_738_2,
    2.480_158_729_874_307e-5,
    -2.755_731_726_000_883_7e-7,
    2.087_614_382_799_313_3e-9,
    -1.138_245_677_806_130_6e-11,
];

/// Adding this to a double brings the nearest whole number into its lowest bits.
pub const ROUND: f64 = f64::ROUND;

/// Largest angle of [`sin_cos`] in double precision [rad]: its quarter turns are whole numbers of far less than 52 bits.
pub const LARGEST_ANGLE: f64 = 1e9;

/// `(-1)^k / (first + 2 k)!`, Taylor's coefficients in powers of `x^2` of functions that have no closed form at 0. `first`
/// is 0 for `cos x`, 1 for `sin x / x`, 2 for `(1 - cos x) / x^2`, 3 for `(x - sin x) / x^3`, 4 for
/// `(cos x - 1 + x^2 / 2) / x^4`. The error of `N` terms is below the first that is left out.
pub const fn taylor<const N: usize>(first: u32) -> [f64; N] {
    let mut coefficients = [0.0; N];
    // Factorials up to 22! are exact.
    let (mut factorial, mut n, mut k) = (1.0, 0, 0);
    while k < N {
        while n < first + 2 * k as u32 {
            n += 1;
            factorial *= n as f64;
        }
        coefficients[k] = if k % 2 == 0 { 1.0 / factorial } else { -1.0 / factorial };
        k += 1;
    }
    coefficients
}

/// A polynomial by Horner's rule: fewest operations.
#[inline(always)]
pub fn horner<S: Simd, T: Float, const N: usize, const K: usize>(
    simd: S,
    coefficients: [f64; K],
    x: Lanes<S, T, N>,
) -> Lanes<S, T, N> {
    let mut sum = Lanes::constant(simd, coefficients[K - 1]);
    for k in (0..K - 1).rev() {
        sum = sum.mul_add(x, Lanes::constant(simd, coefficients[k]));
    }
    sum
}

/// A polynomial by two interleaved Horner chains: half the latency of one.
#[inline(always)]
fn polynomial<S: Simd, T: Float, const N: usize, const K: usize>(
    simd: S,
    coefficients: [f64; K],
    z: Lanes<S, T, N>,
) -> Lanes<S, T, N> {
    let square = z * z;
    let mut even = Lanes::constant(simd, coefficients[(K - 1) & !1]);
    let mut odd = Lanes::constant(simd, coefficients[(K - 2) | 1]);
    let mut k = (K - 1) & !1;
    while k >= 2 {
        k -= 2;
        even = even.mul_add(square, Lanes::constant(simd, coefficients[k]));
    }
    let mut k = (K - 2) | 1;
    while k >= 3 {
        k -= 2;
        odd = odd.mul_add(square, Lanes::constant(simd, coefficients[k]));
    }
    odd.mul_add(z, even)
}

/// The angle of a vector in the first quadrant, `x >= 0` and `y >= 0`. NaN for the zero vector.
#[inline(always)]
pub fn angle<S: Simd, T: Float, const N: usize>(simd: S, x: Lanes<S, T, N>, y: Lanes<S, T, N>) -> Lanes<S, T, N> {
    let number = |value: f64| Lanes::constant(simd, value);
    let (large, small) = (x.max(y), x.min(y));
    // The angle is counted from 0, an eighth or a quarter turn, the nearest of them: one division for all three.
    let eighth = (large * number(TAN_EIGHTH)).lt(small);
    let over = eighth.select(small - large, small);
    let under = eighth.select(small + large, large);
    let t = over / under;
    let z = t * t;
    let rest = (t * z).mul_add(polynomial(simd, ATAN, z), t);
    let from = eighth.select(number(FRAC_PI_4), number(0.0));
    let near = from + rest;
    let from_quarter = number(FRAC_PI_2) - near;
    x.lt(y).select(from_quarter, near)
}

/// Sine and cosine of angles up to [`LARGEST_ANGLE`] to either side; up to 1e4 rad in single precision.
#[inline(always)]
pub fn sin_cos<S: Simd, T: Float, const N: usize>(simd: S, angle: Lanes<S, T, N>) -> (Lanes<S, T, N>, Lanes<S, T, N>) {
    let round = Lanes::constant(simd, T::ROUND);
    let shifted = angle.mul_add(Lanes::constant(simd, FRAC_2_PI), round);
    let quarters = round - shifted;
    let mut rest = angle;
    for part in T::QUARTER_TURN {
        rest = quarters.mul_add(Lanes::constant(simd, part), rest);
    }
    let z = rest * rest;
    let sin = (rest * z).mul_add(polynomial(simd, SIN, z), rest);
    let cos = cos_of_rest(simd, z);
    in_quarter(simd, shifted, sin, cos)
}

/// Sine and cosine of angles up to a hundred turns, for directions: their absolute errors are those of [`sin_cos`], but
/// not the relative error of a sine near zero.
#[inline(always)]
pub fn direction<S: Simd, T: Float, const N: usize>(
    simd: S,
    angle: Lanes<S, T, N>,
) -> (Lanes<S, T, N>, Lanes<S, T, N>) {
    let round = Lanes::constant(simd, T::ROUND);
    let shifted = angle.mul_add(Lanes::constant(simd, FRAC_2_PI), round);
    let quarters = round - shifted;
    let [first, second, _] = T::QUARTER_TURN;
    let rest = quarters.mul_add(Lanes::constant(simd, first), angle);
    let rest = quarters.mul_add(Lanes::constant(simd, second), rest);
    let z = rest * rest;
    let sin = (rest * z).mul_add(polynomial(simd, SIN, z), rest);
    let head = z.mul_add(Lanes::constant(simd, -0.5), Lanes::constant(simd, 1.0));
    let cos = (z * z).mul_add(polynomial(simd, COS, z), head);
    in_quarter(simd, shifted, sin, cos)
}

/// Sine and cosine after a number of quarter turns, which is in the lowest bits of `shifted`.
#[inline(always)]
fn in_quarter<S: Simd, T: Float, const N: usize>(
    simd: S,
    shifted: Lanes<S, T, N>,
    sin: Lanes<S, T, N>,
    cos: Lanes<S, T, N>,
) -> (Lanes<S, T, N>, Lanes<S, T, N>) {
    let (odd, half) = (shifted.has_bit(0), shifted.has_bit(1));
    let (minus, zero) = (Lanes::constant(simd, -0.0), Lanes::constant(simd, 0.0));
    let sign = half.select(minus, zero);
    let crossed = odd.select(minus, zero);
    (odd.select(cos, sin).xor_sign(sign), odd.select(sin, cos).xor_sign(sign).xor_sign(crossed))
}

/// Cosine of an angle up to pi/4, given its square z: the rounding error of `1 - z / 2` is added back.
#[inline(always)]
fn cos_of_rest<S: Simd, T: Float, const N: usize>(simd: S, z: Lanes<S, T, N>) -> Lanes<S, T, N> {
    let (one, half) = (Lanes::constant(simd, 1.0), Lanes::constant(simd, 0.5) * z);
    let head = one - half;
    let lost = (one - head) - half;
    head + (z * z).mul_add(polynomial(simd, COS, z), lost)
}

/// `sin(x) / x` for `x` up to pi/4, given the square of `x`.
#[inline(always)]
pub fn sinc_of_square<S: Simd, T: Float, const N: usize>(simd: S, z: Lanes<S, T, N>) -> Lanes<S, T, N> {
    z.mul_add(polynomial(simd, SIN, z), Lanes::constant(simd, 1.0))
}
