//! Products of vectors, in lanes and of plain numbers.

use std::ops::{Mul, Sub};

use pulp::Simd;

use super::float::Float;
use super::lanes::Lanes;

/// A vector of three numbers in every lane.
pub type Vec3<S, T = f64, const N: usize = 1> = [Lanes<S, T, N>; 3];

/// `a · b`, its sums rounded once each.
#[inline(always)]
pub fn dot<S: Simd, T: Float, const N: usize>(a: Vec3<S, T, N>, b: Vec3<S, T, N>) -> Lanes<S, T, N> {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

/// `a × b`, its differences rounded once each.
#[inline(always)]
pub fn cross<S: Simd, T: Float, const N: usize>(a: Vec3<S, T, N>, b: Vec3<S, T, N>) -> Vec3<S, T, N> {
    [a[1].mul_add(b[2], -(a[2] * b[1])), a[2].mul_add(b[0], -(a[0] * b[2])), a[0].mul_add(b[1], -(a[1] * b[0]))]
}

/// `|a|`
#[inline(always)]
pub fn norm<S: Simd, T: Float, const N: usize>(a: Vec3<S, T, N>) -> Lanes<S, T, N> {
    dot(a, a).sqrt()
}

/// `a + b`
#[inline(always)]
pub fn add<S: Simd, T: Float, const N: usize>(a: Vec3<S, T, N>, b: Vec3<S, T, N>) -> Vec3<S, T, N> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// `a - b`
#[inline(always)]
pub fn sub<S: Simd, T: Float, const N: usize>(a: Vec3<S, T, N>, b: Vec3<S, T, N>) -> Vec3<S, T, N> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `factor a`
#[inline(always)]
pub fn scale<S: Simd, T: Float, const N: usize>(a: Vec3<S, T, N>, factor: Lanes<S, T, N>) -> Vec3<S, T, N> {
    [a[0] * factor, a[1] * factor, a[2] * factor]
}

/// `a + factor b`, rounded once.
#[inline(always)]
pub fn add_scaled<S: Simd, T: Float, const N: usize>(
    a: Vec3<S, T, N>,
    factor: Lanes<S, T, N>,
    b: Vec3<S, T, N>,
) -> Vec3<S, T, N> {
    [b[0].mul_add(factor, a[0]), b[1].mul_add(factor, a[1]), b[2].mul_add(factor, a[2])]
}

/// `row · vector` with a row of constants, every product and sum rounded.
#[inline(always)]
pub fn row_times<S: Simd, T: Float, const N: usize>(simd: S, row: &[T; 3], [x, y, z]: Vec3<S, T, N>) -> Lanes<S, T, N> {
    x * Lanes::splat(simd, row[0]) + y * Lanes::splat(simd, row[1]) + z * Lanes::splat(simd, row[2])
}

/// `a · b` of rows of any length, every product and sum rounded.
#[inline]
pub fn inner_product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The z component of `a × b` for vectors in the plane.
#[inline(always)]
pub fn cross2<T: Copy + Mul<Output = T> + Sub<Output = T>>(a: [T; 2], b: [T; 2]) -> T {
    a[0] * b[1] - a[1] * b[0]
}
