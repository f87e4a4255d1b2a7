//! What a gyroscope says of a step, in numbers or registers of steps: how it shares the displacement with the wheels, and how
//! the error of its bias goes along. The plain core's are `Workspace::fuse` and `Uncertainty::lean_on_bias`.

use crate::arithmetic::Arithmetic;
use crate::spread::Spread;

/// What a gyroscope says of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turned<T> {
    /// 1, or 0 where it says nothing: then its gain is 0, which changes nothing.
    pub says: T,
    /// What it turned, its bias taken off [rad].
    pub turn: T,
    /// What the deviation of a reading at either end makes of that [rad].
    pub deviation: T,
    /// Variance of the bias at the start [rad²/s²].
    pub bias_variance: T,
}

/// By how much each part of a displacement follows what a gyroscope turned beyond it.
pub(crate) type Gain<T> = [T; 3];

/// The gain, of wheels whose displacement has this covariance, and the variance that it is divided by: where that is not
/// positive, the gain is no number.
#[inline(always)]
pub(crate) fn gain<F: Arithmetic>(
    by: F,
    turned: &Turned<F::Number>,
    wheels: Spread<F::Number>,
    dt: F::Number,
) -> (Gain<F::Number>, F::Number) {
    let [_, _, x, _, y, z] = wheels.into();
    let both_ends = by.number(2.0) * (turned.deviation * turned.deviation);
    let variance = z + both_ends + turned.bias_variance * (dt * dt);
    let gain =
        [by.over(x * turned.says, variance), by.over(y * turned.says, variance), by.over(z * turned.says, variance)];
    (gain, variance)
}

/// What is left of an error of the wheels' displacement.
#[inline(always)]
pub(crate) fn left<F: Arithmetic>(
    by: F,
    [to_x, to_y, to_z]: Gain<F::Number>,
    [x, y, z]: [F::Number; 3],
) -> [F::Number; 3] {
    [by.fused(-to_x, z, x), by.fused(-to_y, z, y), (by.number(1.0) - to_z) * z]
}

/// The same of its covariance, with what readings at one end add.
#[inline(always)]
pub(crate) fn left_of<F: Arithmetic>(
    by: F,
    [to_x, to_y, to_z]: Gain<F::Number>,
    wheels: Spread<F::Number>,
) -> Spread<F::Number> {
    let [xx, xy, xz, yy, yz, zz] = wheels.swung(by, [-to_x, -to_y]).into();
    let rest = by.number(1.0) - to_z;
    Spread::from([xx, xy, xz * rest, yy, yz * rest, zz * (rest * rest)])
}

/// The displacement that wheels and gyroscope agree on.
#[inline(always)]
pub(crate) fn agreed<F: Arithmetic>(
    by: F,
    gain: Gain<F::Number>,
    [x, y, z]: [F::Number; 3],
    turn: F::Number,
) -> [F::Number; 3] {
    let beyond = turn - z;
    [by.fused(gain[0], beyond, x), by.fused(gain[1], beyond, y), by.fused(gain[2], beyond, z)]
}

/// An error that was there before a step, at its end, where the step has the error `end` of the same origin: `lever` is by
/// what an error of the yaw swings the end.
#[inline(always)]
pub(crate) fn met<F: Arithmetic>(
    by: F,
    [lever_x, lever_y]: [F::Number; 2],
    [x, y, z]: [F::Number; 3],
    end: [F::Number; 3],
) -> [F::Number; 3] {
    [by.fused(lever_x, z, x + end[0]), by.fused(lever_y, z, y + end[1]), z + end[2]]
}

/// What a step adds to the covariance of the pose as it leans on a gyroscope, by whose bias the end is off by `by_bias`
/// times as much: `cross` is the covariance with the pose at the start.
#[inline(always)]
pub(crate) fn leant<F: Arithmetic>(
    by: F,
    lever: [F::Number; 2],
    cross: [F::Number; 3],
    by_bias: [F::Number; 3],
    variance: F::Number,
) -> Spread<F::Number> {
    let [x, y, z] = by_bias;
    let half = variance * by.number(0.5);
    let [p, q, r] = met(by, lever, cross, [x * half, y * half, z * half]);
    let two = by.number(2.0);
    Spread::from([
        two * (x * p),
        by.fused(x, q, y * p),
        by.fused(x, r, z * p),
        two * (y * q),
        by.fused(y, r, z * q),
        two * (z * r),
    ])
}
