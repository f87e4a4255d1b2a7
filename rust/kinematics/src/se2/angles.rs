//! Angles of any size: wrapped to half a turn to either side, and their sines and cosines in every lane.

use std::f64::consts::{PI, TAU};

use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::polynomials::{LARGEST_ANGLE, sin_cos};
use six_wheel_numerics::simd::vector::Vector;

/// Lanes of the widest register.
pub(crate) const MAX_LANES: usize = 8;

/// `2 pi` as the sum of two parts: multiples of the first are exact for angles up to [`MANY`].
const TURN: [f64; 2] = {
    let high = f64::from_bits(TAU.to_bits() >> 21 << 21);
    [high, TAU - high]
};

/// Angles from which on whole turns are subtracted by the remainder operator [rad].
const MANY: f64 = 1e6;

/// The angle plus the whole turns that bring it into [-pi, pi]; unchanged if it is there.
pub fn wrap_angle(angle: f64) -> f64 {
    // Exact: the difference has no more digits than `TAU`.
    let rest = if angle.abs() < MANY {
        let turns = f64::from((angle / TAU) as i32);
        (angle - turns * TURN[0]) - turns * TURN[1]
    } else {
        angle % TAU
    };
    if rest > PI {
        rest - TAU
    } else if rest < -PI {
        rest + TAU
    } else {
        rest
    }
}

/// Applies a function to the lanes with numbers beyond `largest`, and to NaN.
#[inline(always)]
fn map_beyond<S: Vector>(simd: S, lanes: Lanes<S>, largest: f64, function: impl Fn(f64) -> f64) -> Lanes<S> {
    if !(!lanes.abs().le(Lanes::splat(simd, largest))).any() {
        return lanes;
    }
    let mut numbers = [0.0; MAX_LANES];
    lanes.store(S::as_mut_simd_f64s(&mut numbers).0, 0);
    for number in &mut numbers {
        if number.abs() > largest {
            *number = function(*number);
        }
    }
    Lanes::load(simd, S::as_simd_f64s(&numbers).0, 0)
}

/// [`wrap_angle`] in every lane.
#[inline(always)]
pub(crate) fn wrap_lanes<S: Vector>(simd: S, angle: Lanes<S>) -> Lanes<S> {
    map_beyond(simd, angle, PI, wrap_angle)
}

/// An angle of the same direction, in [-pi, pi]: multiples of 2 pi itself are subtracted, not of its double.
fn same_direction(angle: f64) -> f64 {
    let (sin, cos) = angle.sin_cos();
    sin.atan2(cos)
}

/// An angle of the same direction in every lane, unchanged up to `largest`, in [-pi, pi] beyond it [rad].
#[inline(always)]
pub fn reduce_lanes<S: Vector>(simd: S, angle: Lanes<S>, largest: f64) -> Lanes<S> {
    map_beyond(simd, angle, largest, same_direction)
}

/// Sine and cosine of angles of any size.
#[inline(always)]
pub fn sin_cos_any<S: Vector>(simd: S, angle: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
    sin_cos(simd, reduce_lanes(simd, angle, LARGEST_ANGLE))
}
