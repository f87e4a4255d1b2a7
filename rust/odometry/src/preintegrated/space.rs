//! Motions in space: SE(3) exponential, logarithm, adjoint and the Jacobian of the exponential. Motions in the plane
//! are the subgroup with x, y and yaw, closed under all of them.
//!
//! A tangent is `(x, y, z, about x, about y, about z)`, in the order of ROS messages [m, m, m, rad, rad, rad].
//!
//! Source: T. D. Barfoot, State Estimation for Robotics, 2017, ch. 7 (eq. 7.86 for the Jacobian).

use nalgebra::{Matrix3, Matrix6, Rotation3, UnitQuaternion, Vector3, Vector6};

use six_wheel_kinematics::geometry::sinc;
use six_wheel_numerics::error::{Error, finite, number};
use six_wheel_numerics::simd::polynomials::taylor;

/// Largest deviation of `R Rᵀ` from the identity that counts as rounding of the input.
const ORTHOGONAL: f64 = 1e-6;

/// Angle below which the series are used [rad]: their truncation error is below 1e-18.
const SERIES: f64 = 0.3;

/// The functions of [`quotients`] in powers of `t²`. The last one is the difference of the series of `t cos t` and
/// `3 sin t` from their fifth powers on.
const QUOTIENTS: [[f64; 7]; 4] = {
    let (mut last, fifth) = (taylor::<7>(4), taylor::<7>(5));
    let mut k = 0;
    while k < 7 {
        last[k] = (last[k] - 3.0 * fifth[k]) / 2.0;
        k += 1;
    }
    [taylor(2), taylor(3), taylor(4), last]
};

/// `a_from_b`: rotation and translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion3 {
    /// Rotation.
    pub rotation: UnitQuaternion<f64>,
    /// Translation [m].
    pub translation: Vector3<f64>,
}

impl Motion3 {
    /// No motion.
    #[inline]
    pub fn identity() -> Self {
        Self { rotation: UnitQuaternion::identity(), translation: Vector3::zeros() }
    }

    /// In the plane: x [m], y [m], yaw [rad].
    pub fn planar([x, y, yaw]: [f64; 3]) -> Self {
        Self { rotation: UnitQuaternion::from_scaled_axis(Vector3::z() * yaw), translation: Vector3::new(x, y, 0.0) }
    }

    /// The motion along this tangent in one unit of time.
    #[inline]
    pub fn exp(tangent: &Vector6<f64>) -> Self {
        let (linear, turn) = split(tangent);
        Self { rotation: UnitQuaternion::from_scaled_axis(turn), translation: left_jacobian_of_turn(&turn) * linear }
    }

    /// The tangent of this motion, with a rotation of at most half a turn.
    pub fn log(&self) -> Vector6<f64> {
        let turn = self.rotation.scaled_axis();
        let inverse = left_jacobian_of_turn(&turn).try_inverse();
        let linear = inverse.map_or(self.translation, |inverse| inverse * self.translation);
        stack(&linear, &turn)
    }

    /// `a_from_c = a_from_b * b_from_c`
    #[must_use]
    #[inline]
    pub fn compose(&self, next: &Self) -> Self {
        let mut rotation = self.rotation * next.rotation;
        rotation.renormalize_fast();
        Self { rotation, translation: self.translation + self.rotation * next.translation }
    }

    /// `b_from_a`
    #[must_use]
    #[inline]
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.inverse();
        Self { rotation, translation: -(rotation * self.translation) }
    }

    /// Matrix that maps a tangent in axes of b to axes of a: `self exp(t) = exp(adjoint t) self`.
    pub fn adjoint(&self) -> Matrix6<f64> {
        let turn = *self.rotation.to_rotation_matrix().matrix();
        let mut adjoint = Matrix6::zeros();
        set(&mut adjoint, 0, 0, &turn);
        set(&mut adjoint, 0, 3, &(self.translation.cross_matrix() * turn));
        set(&mut adjoint, 3, 3, &turn);
        adjoint
    }

    /// From a homogeneous matrix.
    pub fn from_matrix(argument: &'static str, matrix: &[[f64; 4]; 4]) -> Result<Self, Error> {
        finite(argument, matrix.as_flattened())?;
        let turn = Matrix3::from_fn(|i, k| matrix[i][k]);
        let off = (turn * turn.transpose() - Matrix3::identity()).amax();
        let last = [0.0, 0.0, 0.0, 1.0];
        if off > ORTHOGONAL || turn.determinant() < 0.0 || matrix[3] != last {
            let rule = "be a homogeneous matrix: a rotation, a translation and the row 0, 0, 0, 1";
            let value = format!("one whose axes are off by {}", number(off));
            return Err(Error::value(argument, rule, value));
        }
        let rotation = Rotation3::from_matrix_unchecked(turn);
        Ok(Self {
            rotation: UnitQuaternion::from_rotation_matrix(&rotation),
            translation: Vector3::from_fn(|i, _| matrix[i][3]),
        })
    }

    /// The homogeneous matrix.
    #[inline]
    pub fn matrix(&self) -> [[f64; 4]; 4] {
        let turn = self.rotation.to_rotation_matrix();
        let mut matrix = [[0.0; 4]; 4];
        for (i, row) in matrix.iter_mut().enumerate().take(3) {
            for (k, value) in row.iter_mut().enumerate().take(3) {
                *value = turn[(i, k)];
            }
            row[3] = self.translation[i];
        }
        matrix[3][3] = 1.0;
        matrix
    }
}

/// The linear part and the turn of a tangent.
#[inline]
pub fn split(tangent: &Vector6<f64>) -> (Vector3<f64>, Vector3<f64>) {
    (Vector3::new(tangent[0], tangent[1], tangent[2]), Vector3::new(tangent[3], tangent[4], tangent[5]))
}

/// The tangent of this linear part and turn.
#[inline]
pub fn stack(linear: &Vector3<f64>, turn: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(linear.x, linear.y, linear.z, turn.x, turn.y, turn.z)
}

fn set(matrix: &mut Matrix6<f64>, row: usize, column: usize, block: &Matrix3<f64>) {
    matrix.fixed_view_mut::<3, 3>(row, column).copy_from(block);
}

/// `(1 - cos t) / t²`, `(t - sin t) / t³`, `(t²/2 + cos t - 1) / t⁴` and `(2 t + t cos t - 3 sin t) / (2 t⁵)`.
fn quotients(turn: f64) -> [f64; 4] {
    let square = turn * turn;
    if turn < SERIES {
        return QUOTIENTS.map(|series| series.iter().rev().fold(0.0, |sum, term| sum * square + term));
    }
    let (sin, cos) = turn.sin_cos();
    let half = sinc(turn / 2.0);
    [
        half * half / 2.0,
        (turn - sin) / (square * turn),
        (square / 2.0 + cos - 1.0) / (square * square),
        (2.0 * turn + turn * cos - 3.0 * sin) / (2.0 * square * square * turn),
    ]
}

fn left_jacobian_of_turn(turn: &Vector3<f64>) -> Matrix3<f64> {
    let [first, second, ..] = quotients(turn.norm());
    let cross = turn.cross_matrix();
    Matrix3::identity() + cross * first + cross * cross * second
}

/// Derivative of `exp(tangent)` with respect to the tangent, in axes of its start: `exp(t + d) = exp(left_jacobian(t)
/// d) exp(t)`.
pub fn left_jacobian(tangent: &Vector6<f64>) -> Matrix6<f64> {
    let (linear, turn) = split(tangent);
    let [_, a, b, c] = quotients(turn.norm());
    let (w, t) = (linear.cross_matrix(), turn.cross_matrix());
    let (tw, wt) = (t * w, w * t);
    let twt = tw * t;
    let mixed = w * 0.5 + (tw + wt + twt) * a + (t * tw + wt * t - twt * 3.0) * b + (twt * t + t * twt) * c;
    let mut jacobian = Matrix6::zeros();
    let of_turn = left_jacobian_of_turn(&turn);
    set(&mut jacobian, 0, 0, &of_turn);
    set(&mut jacobian, 0, 3, &mixed);
    set(&mut jacobian, 3, 3, &of_turn);
    jacobian
}

/// The same in axes of its end: `exp(t + d) = exp(t) exp(right_jacobian(t) d)`.
pub fn right_jacobian(tangent: &Vector6<f64>) -> Matrix6<f64> {
    left_jacobian(&-tangent)
}
