//! Symmetric matrices of three rows, as covariances of a displacement or a pose are.
//!
//! nalgebra has no such type, and its products, written for any size, took half the time of a step. Here symmetry is in
//! the type, and every product is a few sums.

use std::ops::{Add, Mul, Sub};

use nalgebra::{Matrix3, Vector3};
use pulp::{Scalar, Simd};

use six_wheel_numerics::jacobi::Jacobi;
use six_wheel_numerics::simd::lanes::Lanes;

/// A symmetric matrix. Sums of squares `v vᵀ` and images `a S aᵀ` keep it positive semidefinite, as covariances are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Covariance3<T = f64> {
    xx: T,
    xy: T,
    xz: T,
    yy: T,
    yz: T,
    zz: T,
}

impl<T> From<[T; 6]> for Covariance3<T> {
    /// The upper half, row by row.
    #[inline(always)]
    fn from([xx, xy, xz, yy, yz, zz]: [T; 6]) -> Self {
        Self { xx, xy, xz, yy, yz, zz }
    }
}

impl<T> From<Covariance3<T>> for [T; 6] {
    #[inline(always)]
    fn from(covariance: Covariance3<T>) -> Self {
        let Covariance3 { xx, xy, xz, yy, yz, zz } = covariance;
        [xx, xy, xz, yy, yz, zz]
    }
}

impl Covariance3 {
    /// The upper half of a matrix.
    #[inline]
    pub fn of(matrix: &Matrix3<f64>) -> Self {
        Self { xx: matrix.m11, xy: matrix.m12, xz: matrix.m13, yy: matrix.m22, yz: matrix.m23, zz: matrix.m33 }
    }

    /// The whole matrix.
    #[inline]
    pub fn matrix(&self) -> Matrix3<f64> {
        Matrix3::new(
            self.xx, self.xy, self.xz, //
            self.xy, self.yy, self.yz, //
            self.xz, self.yz, self.zz,
        )
    }

    /// Variance of the third component.
    pub fn zz(&self) -> f64 {
        self.zz
    }

    /// Covariance of all with the third component.
    pub fn with_z(&self) -> Vector3<f64> {
        Vector3::new(self.xz, self.yz, self.zz)
    }

    /// True if rounding may have left a direction with a negative variance.
    #[inline(always)]
    pub fn may_be_negative(&self) -> bool {
        self.minors().into_iter().any(|value| value < 0.0)
    }

    /// The matrix with the absolute values of its eigenvalues, so that no direction has a negative variance by
    /// rounding.
    #[cold]
    pub fn without_negative(&self) -> Self {
        let matrix = self.matrix();
        let size = matrix.amax(); // squares of which may not be finite
        let parts = Jacobi::new(&(matrix / size));
        let mut positive = Self::default();
        for (k, value) in parts.values.iter().enumerate() {
            positive.add(&parts.turn.column(k).into_owned(), value * size);
        }
        positive
    }

    /// True if every entry is below a bound in magnitude.
    pub fn is_below(&self, bound: f64) -> bool {
        // No covariance exceeds the larger of its two variances. Rounding may make huge variances negative.
        self.diagonal().iter().all(|variance| variance.abs() < bound)
    }

    /// Adds `share v vᵀ`.
    #[inline(always)]
    pub fn add(&mut self, v: &Vector3<f64>, share: f64) {
        let (x, y, z) = (share * v.x, share * v.y, share * v.z);
        self.xx += x * v.x;
        self.xy += x * v.y;
        self.xz += x * v.z;
        self.yy += y * v.y;
        self.yz += y * v.z;
        self.zz += z * v.z;
    }

    /// `a S aᵀ`.
    #[inline(always)]
    pub fn image(&self, a: &Matrix3<f64>) -> Self {
        let row = |i: usize| {
            let (p, q, r) = (a[(i, 0)], a[(i, 1)], a[(i, 2)]);
            Vector3::new(
                p * self.xx + q * self.xy + r * self.xz,
                p * self.xy + q * self.yy + r * self.yz,
                p * self.xz + q * self.yz + r * self.zz,
            )
        };
        let with = |v: &Vector3<f64>, k: usize| v.x * a[(k, 0)] + v.y * a[(k, 1)] + v.z * a[(k, 2)];
        let (first, second, third) = (row(0), row(1), row(2));
        Self {
            xx: with(&first, 0),
            xy: with(&first, 1),
            xz: with(&first, 2),
            yy: with(&second, 1),
            yz: with(&second, 2),
            zz: with(&third, 2),
        }
    }
}

impl<T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T>> Covariance3<T> {
    /// The sum of two.
    #[inline(always)]
    pub fn and(self, other: Self) -> Self {
        Self {
            xx: self.xx + other.xx,
            xy: self.xy + other.xy,
            xz: self.xz + other.xz,
            yy: self.yy + other.yy,
            yz: self.yz + other.yz,
            zz: self.zz + other.zz,
        }
    }

    /// Adds another one.
    #[inline(always)]
    pub(crate) fn add_assign(&mut self, other: &Self) {
        *self = self.and(*other);
    }

    /// Sum of the variances.
    #[inline]
    pub fn trace(&self) -> T {
        self.xx + self.yy + self.zz
    }

    /// Adds the same variance to every component.
    #[inline(always)]
    pub fn add_to_diagonal(&mut self, variance: T) {
        self.xx = self.xx + variance;
        self.yy = self.yy + variance;
        self.zz = self.zz + variance;
    }

    /// Variances, and the minors of every two components: a negative one is a direction with a negative variance.
    #[inline(always)]
    pub fn minors(&self) -> [T; 6] {
        [
            self.xx,
            self.yy,
            self.zz,
            self.xx * self.yy - self.xy * self.xy,
            self.xx * self.zz - self.xz * self.xz,
            self.yy * self.zz - self.yz * self.yz,
        ]
    }

    /// Variances.
    #[inline(always)]
    pub fn diagonal(&self) -> [T; 3] {
        [self.xx, self.yy, self.zz]
    }
}

impl Covariance3 {
    /// The matrix in registers of one lane.
    #[inline(always)]
    pub fn lane(self) -> Covariance3<Lanes<Scalar>> {
        Covariance3::from(lane(self.into()))
    }
}

/// Numbers of one step, each in a register of one lane.
#[inline(always)]
pub fn lane<const N: usize>(numbers: [f64; N]) -> [Lanes<Scalar>; N] {
    let mut lanes = [Lanes::splat(Scalar, 0.0); N];
    for (lane, number) in lanes.iter_mut().zip(numbers) {
        *lane = Lanes::splat(Scalar, number);
    }
    lanes
}

/// The numbers of registers of one lane.
#[inline(always)]
pub(crate) fn numbers<const N: usize>(lanes: [Lanes<Scalar>; N]) -> [f64; N] {
    let mut numbers = [0.0; N];
    for (number, lane) in numbers.iter_mut().zip(lanes) {
        *number = lane.sum();
    }
    numbers
}

#[inline_always]
impl<S: Simd> Covariance3<Lanes<S>> {
    /// `L S Lᵀ` with the first two rows of L, whose third is 0, 0, 1: the covariance of the end of a step by that of
    /// its displacement.
    pub fn displacement_image(&self, a: &[[Lanes<S>; 3]; 2]) -> Self {
        let dot = |p: Lanes<S>, q: Lanes<S>, r: Lanes<S>, k: usize| r.mul_add(a[k][2], q.mul_add(a[k][1], p * a[k][0]));
        let (xz, yz) = (dot(self.xz, self.yz, self.zz, 0), dot(self.xz, self.yz, self.zz, 1));
        let first = (dot(self.xx, self.xy, self.xz, 0), dot(self.xy, self.yy, self.yz, 0));
        let second = (dot(self.xx, self.xy, self.xz, 1), dot(self.xy, self.yy, self.yz, 1));
        Self {
            xx: dot(first.0, first.1, xz, 0),
            xy: dot(first.0, first.1, xz, 1),
            xz,
            yy: dot(second.0, second.1, yz, 1),
            yz,
            zz: self.zz,
        }
    }

    /// No error.
    pub fn zero(simd: S) -> Self {
        Self::from([Lanes::splat(simd, 0.0); 6])
    }

    /// The sum with `v vᵀ`.
    pub fn and_square(self, vector: [Lanes<S>; 3]) -> Self {
        self.and_product(vector, vector)
    }

    /// The sum with `factor v vᵀ`.
    pub fn and_scaled_square(self, [x, y, z]: [Lanes<S>; 3], factor: Lanes<S>) -> Self {
        self.and_product([x * factor, y * factor, z * factor], [x, y, z])
    }

    fn and_product(self, [a, b, c]: [Lanes<S>; 3], [x, y, z]: [Lanes<S>; 3]) -> Self {
        Self {
            xx: a.mul_add(x, self.xx),
            xy: a.mul_add(y, self.xy),
            xz: a.mul_add(z, self.xz),
            yy: b.mul_add(y, self.yy),
            yz: b.mul_add(z, self.yz),
            zz: c.mul_add(z, self.zz),
        }
    }

    /// Sum over the lanes.
    pub fn total(self) -> Covariance3 {
        let Self { xx, xy, xz, yy, yz, zz } = self;
        Covariance3::from([xx.sum(), xy.sum(), xz.sum(), yy.sum(), yz.sum(), zz.sum()])
    }

    /// `F S Fᵀ`, `F = [[1, 0, x], [0, 1, y], [0, 0, 1]]` with the yaw lever `[x, y]` [m]: the covariance at the end of
    /// a step by that at its start.
    pub fn propagate(&self, [x, y]: [Lanes<S>; 2]) -> Self {
        let (xz, yz) = (x.mul_add(self.zz, self.xz), y.mul_add(self.zz, self.yz));
        Self {
            xx: x.mul_add(self.xz + xz, self.xx),
            xy: x.mul_add(yz, y.mul_add(self.xz, self.xy)),
            xz,
            yy: y.mul_add(self.yz + yz, self.yy),
            yz,
            zz: self.zz,
        }
    }
}
