//! Arc tangent, sine and cosine of whole registers, as polynomials of known error.
//!
//! The coefficients interpolate at Chebyshev nodes, computed with 50 digits. The tests below measure the errors against
//! the functions of the standard library.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, FRAC_PI_4};

use pulp::Simd;

use super::float::Float;
use super::lanes::Lanes;

const TAN_EIGHTH: f64 = 0.414_213_562_373_095_03;

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::lanes::Lanes;
    use crate::simd::level::Kernel;
    use crate::simd::level::Level;
    use crate::simd::vector::Vector;

    /// Applies a function of two numbers to every pair.
    struct Apply<'a, T> {
        which: Which,
        pairs: &'a [[T; 2]],
    }

    #[derive(Clone, Copy, Debug)]
    enum Which {
        Angle,
        Sin,
        Cos,
        DirectionCos,
        Sinc,
    }

    impl<T: Float> Kernel for Apply<'_, T> {
        type Output = Vec<T>;

        #[inline(always)]
        fn run<S: Vector>(self, simd: S) -> Vec<T> {
            let mut results = Vec::new();
            for [x, y] in self.pairs {
                let (x, y) = (Lanes::<S, T>::splat(simd, *x), Lanes::splat(simd, *y));
                let result = match self.which {
                    Which::Angle => angle(simd, x, y),
                    Which::Sin => sin_cos(simd, x).0,
                    Which::Cos => sin_cos(simd, x).1,
                    Which::DirectionCos => direction(simd, x).1,
                    Which::Sinc => sinc_of_square(simd, x * x),
                };
                let mut lanes = [T::default(); 16];
                result.copy_to_slice(&mut lanes);
                results.push(lanes[0]);
            }
            results
        }
    }

    /// The largest error in units in the last place of what is expected, which is the same at all levels.
    fn worst(which: Which, pairs: &[[f64; 2]], expected: impl Fn(f64, f64) -> f64) -> f64 {
        worst_in::<f64>(which, pairs, expected, |size| size.next_up() - size)
    }

    fn worst_in<T: Float>(
        which: Which,
        pairs: &[[f64; 2]],
        expected: impl Fn(f64, f64) -> f64,
        last_place: impl Fn(f64) -> f64,
    ) -> f64 {
        let pairs: Vec<[T; 2]> = pairs.iter().map(|pair| pair.map(T::from_f64)).collect();
        let levels: Vec<_> =
            Level::available().iter().map(|level| level.run_any(Apply { which, pairs: &pairs })).collect();
        for results in &levels[1..] {
            assert!(results.iter().zip(&levels[0]).all(|(a, b)| a == b), "{which:?}");
        }
        let errors = pairs.iter().zip(&levels[0]).map(|([x, y], result)| {
            let expected = expected(x.to_f64(), y.to_f64());
            (result.to_f64() - expected).abs() / last_place(expected.abs())
        });
        errors.fold(0.0, f64::max)
    }

    /// Evenly spaced numbers, both ends among them.
    fn sweep(from: f64, to: f64, count: u32) -> impl Iterator<Item = f64> {
        (0..=count).map(move |k| from + (to - from) * f64::from(k) / f64::from(count))
    }

    #[test]
    fn angles_are_right_to_two_last_places() {
        let mut pairs: Vec<[f64; 2]> =
            sweep(0.0, std::f64::consts::FRAC_PI_2, 400_000).map(|angle| [angle.cos().max(0.0), angle.sin()]).collect();
        for exponent in -300..=100 {
            let size = 10.0_f64.powi(exponent);
            pairs.extend([[1.0, size], [size, 1.0], [0.3 * size, 0.7 * size]]);
        }
        pairs.extend([[1.0, 0.0], [0.0, 1.0], [1.0, 5e-324], [1.0, 1.0]]);
        pairs.extend([TAN_EIGHTH, TAN_EIGHTH.next_up(), TAN_EIGHTH.next_down()].map(|y| [1.0, y]));
        let worst = worst(Which::Angle, &pairs, |x, y| y.atan2(x));
        assert!(worst <= 2.0, "{worst}");
    }

    #[test]
    fn sines_and_cosines_are_right_to_two_last_places() {
        let pairs: Vec<[f64; 2]> = sweep(-7.0, 7.0, 400_000)
            .chain(sweep(-LARGEST_ANGLE, LARGEST_ANGLE, 100_001))
            .chain((-400..=400).map(|k| f64::from(k) * FRAC_PI_2))
            .chain((-320..9).map(|exponent| 10.0_f64.powi(exponent)))
            .chain([0.0, -0.0, 5e-324, 1e-17])
            .map(|x| [x, 0.0])
            .collect();
        let sin = worst(Which::Sin, &pairs, |x, _| x.sin());
        let cos = worst(Which::Cos, &pairs, |x, _| x.cos());
        assert!(sin <= 2.0 && cos <= 2.0, "{sin} {cos}");
    }

    #[test]
    fn chords_are_right_to_two_last_places() {
        let pairs: Vec<[f64; 2]> = sweep(0.0, std::f64::consts::FRAC_PI_4, 100_000).map(|x| [x, 0.0]).collect();
        let sinc = |x: f64, _| if x == 0.0 { 1.0 } else { x.sin() / x };
        let worst = worst(Which::Sinc, &pairs, sinc);
        assert!(worst <= 2.0, "{worst}");
    }
    #[test]
    fn single_precision_is_right_to_three_last_places() {
        let last_place = |size: f64| f64::from((size as f32).next_up() - size as f32);
        let quadrant: Vec<_> = sweep(0.0, FRAC_PI_2, 20_000).map(|angle| [angle.cos().max(0.0), angle.sin()]).collect();
        let worst = worst_in::<f32>(Which::Angle, &quadrant, |x, y| y.atan2(x), last_place);
        // The single nearest to a quarter turn is itself off by 0.4 of them.
        assert!(worst <= 3.0, "{worst}");
        let angles: Vec<_> = sweep(-7.0, 7.0, 20_000).chain(sweep(-1e4, 1e4, 20_001)).map(|x| [x, 0.0]).collect();
        let sin = worst_in::<f32>(Which::Sin, &angles, |x, _| x.sin(), last_place);
        let cos = worst_in::<f32>(Which::Cos, &angles, |x, _| x.cos(), last_place);
        assert!(sin <= 2.0 && cos <= 2.0, "{sin} {cos}");
        let off = worst_in::<f32>(Which::DirectionCos, &angles, |x, _| x.cos(), |_| f64::from(f32::EPSILON));
        assert!(off <= 1.0, "{off}");
    }

    #[test]
    fn the_series_are_those_of_their_functions() {
        let x: f64 = 0.7;
        let sum = |coefficients: [f64; 8]| coefficients.iter().rev().fold(0.0, |sum, part| sum * x * x + part);
        for (first, expected) in [
            (0, x.cos()),
            (1, x.sin() / x),
            (2, (1.0 - x.cos()) / x.powi(2)),
            (3, (x - x.sin()) / x.powi(3)),
            (4, (x.cos() - 1.0 + x * x / 2.0) / x.powi(4)),
        ] {
            assert!((sum(taylor(first)) - expected).abs() < 2e-15, "{first}");
        }
    }
}
