//! Squares and products of motions, register by register.
//!
//! Loops instead of closures: closures are compiled separately, without the level's instructions.

use six_wheel_numerics::simd::float::Float;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::vec3::cross2;
use six_wheel_numerics::simd::vector::Vector;

/// Registers that are simulated in lockstep, to hide the latency of a step, a long chain of dependent operations.
pub(crate) const LOCKSTEP: usize = 2;

pub(crate) type Reg<S, R> = Lanes<S, R, LOCKSTEP>;

#[inline(always)]
pub(crate) fn times<S: Vector, R: Float, const M: usize>(simd: S, row: &[R; M], z: &[Reg<S, R>; M]) -> Reg<S, R> {
    let mut sum = z[0] * Reg::splat(simd, row[0]);
    for k in 1..M {
        sum = z[k].mul_add(Reg::splat(simd, row[k]), sum);
    }
    sum
}

/// The same motion in every lane.
#[inline(always)]
pub(crate) fn splat<S: Vector, R: Float, const M: usize>(simd: S, motion: &[f64; 3]) -> [Reg<S, R>; M] {
    let mut parts = [Reg::constant(simd, 0.0); M];
    for (part, value) in parts.iter_mut().zip(motion) {
        *part = Reg::constant(simd, *value);
    }
    parts
}

/// Cross product of an end of a gap and a motion: the signed area between them.
#[inline(always)]
pub(crate) fn area<S: Vector, R: Float, const M: usize>(simd: S, z: &[Reg<S, R>; M], end: [R; 2]) -> Reg<S, R> {
    cross2([Reg::splat(simd, end[0]), Reg::splat(simd, end[1])], [z[0], z[1]])
}

/// Factor of an end in a motion's projection onto it, by its row of [`crate::motion::limits::DirectionGap::shares`].
#[inline(always)]
pub(crate) fn share<S: Vector, R: Float, const M: usize>(simd: S, z: &[Reg<S, R>; M], row: [R; 2]) -> Reg<S, R> {
    z[1].mul_add(Reg::splat(simd, row[1]), z[0] * Reg::splat(simd, row[0]))
}

/// The value of a quadratic form at a motion.
#[inline(always)]
pub(crate) fn value<S: Vector, R: Float, const M: usize>(simd: S, form: &[R; 6], z: &[Reg<S, R>; M]) -> Reg<S, R> {
    let mut k = 0;
    let mut sum = Reg::constant(simd, 0.0);
    for i in 0..M {
        let mut part = z[i] * Reg::splat(simd, form[k]);
        k += 1;
        for other in z.iter().skip(i + 1) {
            part = other.mul_add(Reg::splat(simd, form[k]), part);
            k += 1;
        }
        sum = z[i].mul_add(part, sum);
    }
    sum
}

/// The largest value of some quadratic forms at a motion.
#[inline(always)]
pub(crate) fn largest<S: Vector, R: Float, const M: usize>(simd: S, forms: &[[R; 6]], z: &[Reg<S, R>; M]) -> Reg<S, R> {
    let mut worst = Reg::constant(simd, 0.0);
    for form in forms {
        worst = worst.max(value(simd, form, z));
    }
    worst
}

/// The product `Q z` of a quadratic form's symmetric matrix `Q` with a motion `z`.
#[inline(always)]
pub(crate) fn metric_times<S: Vector, R: Float, const M: usize>(
    simd: S,
    form: &[R; 6],
    z: &[Reg<S, R>; M],
) -> [Reg<S, R>; M] {
    let mut low = [Reg::constant(simd, 0.0); M];
    let half = Reg::constant(simd, 0.5);
    let mut k = 0;
    for i in 0..M {
        for j in i..M {
            let part = Reg::splat(simd, form[k]);
            k += 1;
            if i == j {
                low[i] = z[i].mul_add(part, low[i]);
            } else {
                let part = part * half;
                low[i] = z[j].mul_add(part, low[i]);
                low[j] = z[i].mul_add(part, low[j]);
            }
        }
    }
    low
}

/// A limit counts as met if `norm^2 < 1 + 1e-12`: a rover that brakes by whole steps comes to rest in spite of
/// rounding.
const CLOSE: f64 = 1e-12;

/// Scale `1 / max(1, norm)` of a motion with this squared norm.
#[inline(always)]
pub(crate) fn unit_scale<S: Vector, R: Float>(simd: S, square: Reg<S, R>) -> Reg<S, R> {
    let one = Reg::constant(simd, 1.0);
    let [share, _] = square.max(one).roots();
    square.lt(Reg::constant(simd, 1.0 + CLOSE)).select(one, share)
}

#[inline(always)]
pub(crate) fn inner<S: Vector, R: Float, const M: usize>(a: &[Reg<S, R>; M], b: &[Reg<S, R>; M]) -> Reg<S, R> {
    let mut sum = a[0] * b[0];
    for k in 1..M {
        sum = a[k].mul_add(b[k], sum);
    }
    sum
}
