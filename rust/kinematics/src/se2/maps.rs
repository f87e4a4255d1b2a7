//! Maps of SE(2) in every lane: from twists to poses and back, one pose after another.
//!
//! ```text
//! exp       chord = sinc(yaw / 2) dt R(yaw / 2) v,    yaw = omega dt
//! log       v = R(-yaw / 2) chord / (sinc(yaw / 2) dt),    omega = yaw / dt
//! compose   p + R(yaw) q
//! ```
//!
//! (E. Eade, Lie Groups for 2D and 3D Transformations, 2017, sec. 5.) The angle from the heading at the start to the
//! chord of an arc is half the yaw. So nothing cancels as the yaw tends to 0, unlike in (1 - cos yaw) / yaw.

use crate::se2::angles::{sin_cos_any, wrap_lanes};
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::{Kernel, Level};
use six_wheel_numerics::simd::polynomials::sinc_of_square;
use six_wheel_numerics::simd::vector::Vector;

/// Half of a step's turn up to which the chord is a polynomial [rad].
pub(crate) const LARGEST_HALF_TURN: f64 = std::f64::consts::FRAC_PI_4;

/// A twist, or a pose.
type Row<S> = [Lanes<S>; 3];

/// A map of one or two rows of three numbers, and a duration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Map {
    /// [`crate::geometry::Twist::exp`].
    Exp,
    /// [`crate::geometry::Pose::log`].
    Log,
    /// [`crate::geometry::Pose::compose`] of a pose with the second one.
    Compose,
    /// The twist from a pose to the second one.
    Between,
}

impl Map {
    /// The map of one row.
    #[inline]
    pub fn of(self, first: [f64; 3], second: [f64; 3], dt: f64) -> [f64; 3] {
        Level::Scalar.run_any(OneRow { map: self, first, second, dt })
    }

    /// The map of a row in every lane.
    #[inline(always)]
    pub(crate) fn lanes<S: Vector>(self, simd: S, first: Row<S>, second: Row<S>, dt: Lanes<S>) -> Row<S> {
        match self {
            Self::Exp => exp(simd, first, dt),
            Self::Log => log(simd, first, dt),
            Self::Compose => compose(simd, first, second),
            Self::Between => log(simd, between(simd, first, second), dt),
        }
    }
}

/// One row.
struct OneRow {
    map: Map,
    first: [f64; 3],
    second: [f64; 3],
    dt: f64,
}

impl Kernel for OneRow {
    type Output = [f64; 3];

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> [f64; 3] {
        let lanes = |row: [f64; 3]| row.map(|number| Lanes::splat(simd, number));
        let (first, second) = (lanes(self.first), lanes(self.second));
        let mapped = self.map.lanes(simd, first, second, Lanes::splat(simd, self.dt));
        mapped.map(|number| number.last(simd))
    }
}

/// `(x, y)` rotated by an angle.
#[inline(always)]
fn rotate<S: Vector>((sin, cos): (Lanes<S>, Lanes<S>), [x, y]: [Lanes<S>; 2]) -> [Lanes<S>; 2] {
    [cos * x - sin * y, sin * x + cos * y]
}

/// Length of the chord over that of an arc, `sin h / h`, by half its yaw increment h [rad].
#[inline(always)]
pub fn chord_ratio<S: Vector>(simd: S, half: Lanes<S>) -> Lanes<S> {
    let chord = sinc_of_square(simd, half * half);
    let is_large = !half.abs().le(Lanes::splat(simd, LARGEST_HALF_TURN));
    if !is_large.any() {
        return chord;
    }
    let (sin, _) = sin_cos_any(simd, half);
    is_large.select(sin / half, chord)
}

/// `sin(x) / x`, given the sine: exact to rounding for every x but 0, where it is 1.
#[inline(always)]
fn sinc<S: Vector>(simd: S, x: Lanes<S>, sin: Lanes<S>) -> Lanes<S> {
    let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let is_zero = x.abs().le(zero);
    is_zero.select(one, sin / is_zero.select(one, x))
}

#[inline(always)]
fn exp<S: Vector>(simd: S, [vx, vy, omega]: Row<S>, dt: Lanes<S>) -> Row<S> {
    let yaw = omega * dt;
    let half = yaw * Lanes::splat(simd, 0.5);
    let (sin, cos) = sin_cos_any(simd, half);
    let length = sinc(simd, half, sin) * dt;
    let [x, y] = rotate((sin, cos), [vx, vy]);
    [x * length, y * length, yaw]
}

/// The twist whose yaw increment is in [-pi, pi].
#[inline(always)]
fn log<S: Vector>(simd: S, [x, y, yaw]: Row<S>, dt: Lanes<S>) -> Row<S> {
    let yaw = wrap_lanes(simd, yaw);
    let half = yaw * Lanes::splat(simd, 0.5);
    let (sin, cos) = sin_cos_any(simd, half);
    let length = sinc(simd, half, sin) * dt;
    let [vx, vy] = rotate((-sin, cos), [x, y]);
    [vx / length, vy / length, yaw / dt]
}

#[inline(always)]
fn compose<S: Vector>(simd: S, [x, y, yaw]: Row<S>, [ahead, left, turn]: Row<S>) -> Row<S> {
    let [dx, dy] = rotate(sin_cos_any(simd, yaw), [ahead, left]);
    [x + dx, y + dy, yaw + turn]
}

/// `first_from_second`: the second pose in the frame of the first.
#[inline(always)]
fn between<S: Vector>(simd: S, [x, y, yaw]: Row<S>, second: Row<S>) -> Row<S> {
    let (sin, cos) = sin_cos_any(simd, yaw);
    let [ahead, left] = rotate((-sin, cos), [second[0] - x, second[1] - y]);
    [ahead, left, second[2] - yaw]
}
