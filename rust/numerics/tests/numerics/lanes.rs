//! Functions of registers, and registers in lockstep.

use six_wheel_numerics::simd::float::Float;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::{Kernel, Level};
use six_wheel_numerics::simd::vector::Vector;

struct Roots<'a, R>(&'a [R], &'a mut [[R; 2]]);

impl<R: Float> Kernel for Roots<'_, R> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) {
        let lanes = R::lanes::<S>();
        for (from, to) in self.0.chunks(lanes).zip(self.1.chunks_mut(lanes)) {
            let mut columns = [[R::default(); 16]; 3];
            columns[0][..from.len()].copy_from_slice(from);
            let [inverse, root] = Lanes::<S, R>::from_slice(simd, &columns[0]).roots();
            inverse.copy_to_slice(&mut columns[1]);
            root.copy_to_slice(&mut columns[2]);
            for (lane, to) in to.iter_mut().enumerate() {
                *to = [columns[1][lane], columns[2][lane]];
            }
        }
    }
}

/// At every level, in every company.
fn roots<R: Float>(numbers: &[R]) -> Vec<Vec<[R; 2]>> {
    let mut all = Vec::new();
    for level in Level::available() {
        let mut found = vec![[R::default(); 2]; numbers.len()];
        level.run_any(Roots(numbers, &mut found));
        all.push(found);
    }
    all
}

#[test]
fn roots_are_right_to_two_last_places_and_the_same_at_every_level() {
    let extremes = [0.0, 1e-310, 9e-31, 1e-30, 1.0, 1e36, 1.1e36, 1e300, f64::MAX];
    let mut numbers: Vec<f64> = (0..20_000).map(|k| f64::from(k).mul_add(0.0067, -66.0).exp()).collect();
    for (k, extreme) in extremes.into_iter().enumerate() {
        numbers.insert(7 * k, extreme);
    }
    let all = roots(&numbers);
    for (number, [inverse, root]) in numbers.iter().zip(&all[0]) {
        let exact = number.sqrt();
        // A root of a subnormal has all its digits.
        assert!((root - exact).abs() <= 2.0 * f64::EPSILON * exact, "{number}");
        let exact = 1.0 / exact;
        assert!(*inverse == exact || (inverse - exact).abs() <= 2.0 * f64::EPSILON * exact, "{number}");
    }
    for found in &all[1..] {
        assert!(found == &all[0]);
    }
    let singles: Vec<f32> = numbers.iter().map(|number| *number as f32).collect();
    let all = roots(&singles);
    for (number, [inverse, root]) in singles.iter().zip(&all[0]) {
        let exact = number.sqrt();
        assert!(*root == exact || (root - exact).abs() <= 2.0 * f32::EPSILON * exact, "{number}");
        let exact = 1.0 / exact;
        assert!(*inverse == exact, "{number}");
    }
    for found in &all[1..] {
        assert!(found == &all[0]);
    }
}

#[test]
fn what_is_not_a_number_stays_so_and_infinity_is_no_odd_one_out() {
    for found in roots(&[f64::NAN, 4.0, f64::INFINITY, 9.0]) {
        assert!(found[0].iter().all(|part| part.is_nan()));
        assert_eq!(found[1..], [[0.5, 2.0], [0.0, f64::INFINITY], [1.0 / 3.0, 3.0]]);
    }
}

/// Doubles numbers, and writes as many of them as there are lanes of two registers.
struct Double<'a, T>(&'a [T], &'a mut [T]);

impl<T: Float> Kernel for Double<'_, T> {
    type Output = usize;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> usize {
        (Lanes::<S, T, 2>::from_slice(simd, self.0) * 2.0).copy_to_slice(self.1);
        Lanes::<S, T, 2>::lanes()
    }
}

#[test]
fn registers_in_lockstep_hold_successive_numbers_of_a_slice() {
    let numbers: Vec<f32> = (1..=40).map(|k| k as f32).collect();
    for level in Level::available() {
        for count in [0, 1, 16, 17, 40] {
            let mut found = [0.0; 40];
            let lanes = level.run_any(Double(&numbers[..count], &mut found));
            // Only whole registers are read.
            let whole = count.min(lanes) / (lanes / 2) * (lanes / 2);
            for (k, value) in found.iter().enumerate() {
                assert_eq!(*value, if k < whole { 2.0 * numbers[k] } else { 0.0 }, "{level:?} {count} {k}");
            }
        }
    }
}
