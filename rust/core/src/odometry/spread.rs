//! Symmetric matrices of three rows, as covariances of a displacement or a pose are.
//!
//! nalgebra knows no such type, and its general products, which are made for any size, took half the time of a
//! step. Here symmetry is in the type, and every product is a handful of sums.

use nalgebra::{Matrix3, Vector3};

/// A symmetric matrix; a covariance as long as only squares are added and images taken.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Spread {
    xx: f64,
    xy: f64,
    xz: f64,
    yy: f64,
    yz: f64,
    zz: f64,
}

impl Spread {
    /// The upper half of a matrix.
    pub fn of(matrix: &Matrix3<f64>) -> Self {
        Self {
            xx: matrix.m11,
            xy: matrix.m12,
            xz: matrix.m13,
            yy: matrix.m22,
            yz: matrix.m23,
            zz: matrix.m33,
        }
    }

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

    pub fn trace(&self) -> f64 {
        self.xx + self.yy + self.zz
    }

    pub fn is_below(&self, bound: f64) -> bool {
        // No covariance is larger than the larger of its variances.
        self.xx < bound && self.yy < bound && self.zz < bound
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

    /// Adds another one.
    #[inline(always)]
    pub fn add_spread(&mut self, other: &Self) {
        self.xx += other.xx;
        self.xy += other.xy;
        self.xz += other.xz;
        self.yy += other.yy;
        self.yz += other.yz;
        self.zz += other.zz;
    }

    /// Adds the same variance to every component.
    pub fn add_to_diagonal(&mut self, variance: f64) {
        self.xx += variance;
        self.yy += variance;
        self.zz += variance;
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

    /// As the third component swings the other two by this lever.
    #[inline(always)]
    pub fn swung(&self, [x, y]: [f64; 2]) -> Self {
        let (xz, yz) = (self.xz + x * self.zz, self.yz + y * self.zz);
        Self {
            xx: self.xx + x * (self.xz + xz),
            xy: self.xy + y * self.xz + x * yz,
            xz,
            yy: self.yy + y * (self.yz + yz),
            yz,
            zz: self.zz,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_those_of_the_whole_matrices() {
        let mut spread = Spread::default();
        spread.add(&Vector3::new(1.0, -2.0, 0.5), 1.0);
        spread.add(&Vector3::new(0.3, 0.7, -1.1), 2.0);
        let a = Matrix3::new(1.0, 0.2, -0.4, 0.5, -1.0, 0.3, 0.1, 0.0, 2.0);
        let whole = a * spread.matrix() * a.transpose();
        assert!((spread.image(&a).matrix() - whole).amax() < 1e-14);
        let lever = [0.4, -0.9];
        let swing = Matrix3::new(1.0, 0.0, lever[0], 0.0, 1.0, lever[1], 0.0, 0.0, 1.0);
        assert!((spread.swung(lever).matrix() - spread.image(&swing).matrix()).amax() < 1e-14);
        assert_eq!(Spread::of(&spread.matrix()), spread);
    }
}
