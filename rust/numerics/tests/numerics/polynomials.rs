//! Arc tangent, sine and cosine of registers against the functions of the standard library.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use six_wheel_numerics::simd::float::Float;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::{Kernel, Level};
use six_wheel_numerics::simd::polynomials::{
    LARGEST_ANGLE, TAN_EIGHTH, angle, direction, sin_cos, sinc_of_square, taylor,
};
use six_wheel_numerics::simd::vector::Vector;

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
    let levels: Vec<_> = Level::available().iter().map(|level| level.run_any(Apply { which, pairs: &pairs })).collect();
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
        sweep(0.0, FRAC_PI_2, 400_000).map(|angle| [angle.cos().max(0.0), angle.sin()]).collect();
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
    let pairs: Vec<[f64; 2]> = sweep(0.0, FRAC_PI_4, 100_000).map(|x| [x, 0.0]).collect();
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
