//! Fusion of a gyroscope with the wheels in a step, and the propagation of the error of its bias, in numbers or
//! registers of steps. The plain core's are `Workspace::fuse` and `Uncertainty::lean_on_bias`.

use crate::arithmetic::Arithmetic;
use crate::spread::Covariance3;

/// Measurement of a gyroscope in a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GyroscopeIncrement<T> {
    /// 1, or 0 where it says nothing: then its gain is 0, which changes nothing.
    pub says: T,
    /// Its turn less its bias [rad].
    pub turn: T,
    /// Deviation of that by a reading at one end [rad].
    pub deviation: T,
    /// Variance of the bias at the start [rad²/s²].
    pub bias_variance: T,
}

/// Gain K of each part of a displacement, by the turn of the gyroscope beyond that of the wheels.
pub(crate) type Gain<T> = [T; 3];

/// The gain, of wheels whose displacement has this covariance, and the variance that it is divided by: where that is not
/// positive, the gain is no number.
#[inline(always)]
pub(crate) fn gain<F: Arithmetic>(
    by: F,
    turned: &GyroscopeIncrement<F::Number>,
    wheels: Covariance3<F::Number>,
    dt: F::Number,
) -> (Gain<F::Number>, F::Number) {
    let [_, _, x, _, y, z] = wheels.into();
    let both_ends = by.number(2.0) * (turned.deviation * turned.deviation);
    let variance = z + both_ends + turned.bias_variance * (dt * dt);
    let gain =
        [by.over(x * turned.says, variance), by.over(y * turned.says, variance), by.over(z * turned.says, variance)];
    (gain, variance)
}

/// Error of the fused displacement by an error e of the wheels' displacement: `(I - K H) e`.
#[inline(always)]
pub(crate) fn remaining_error<F: Arithmetic>(
    by: F,
    [to_x, to_y, to_z]: Gain<F::Number>,
    [x, y, z]: [F::Number; 3],
) -> [F::Number; 3] {
    [by.fused(-to_x, z, x), by.fused(-to_y, z, y), (by.number(1.0) - to_z) * z]
}

/// The same of its covariance, with what readings at one end add.
#[inline(always)]
pub(crate) fn remaining_covariance<F: Arithmetic>(
    by: F,
    [to_x, to_y, to_z]: Gain<F::Number>,
    wheels: Covariance3<F::Number>,
) -> Covariance3<F::Number> {
    let [xx, xy, xz, yy, yz, zz] = wheels.swung(by, [-to_x, -to_y]).into();
    let rest = by.number(1.0) - to_z;
    Covariance3::from([xx, xy, xz * rest, yy, yz * rest, zz * (rest * rest)])
}

/// The displacement that wheels and gyroscope agree on.
#[inline(always)]
pub(crate) fn fused_displacement<F: Arithmetic>(
    by: F,
    gain: Gain<F::Number>,
    [x, y, z]: [F::Number; 3],
    turn: F::Number,
) -> [F::Number; 3] {
    let beyond = turn - z;
    [by.fused(gain[0], beyond, x), by.fused(gain[1], beyond, y), by.fused(gain[2], beyond, z)]
}

/// Propagates a pose error through one step: `e' = F e + end`, `F = [[1, 0, lever_x], [0, 1, lever_y], [0, 0, 1]]`,
/// with `lever = d(end position) / d(yaw)` [m].
#[inline(always)]
pub(crate) fn propagate_error<F: Arithmetic>(
    by: F,
    [lever_x, lever_y]: [F::Number; 2],
    [x, y, z]: [F::Number; 3],
    end: [F::Number; 3],
) -> [F::Number; 3] {
    [by.fused(lever_x, z, x + end[0]), by.fused(lever_y, z, y + end[1]), z + end[2]]
}

/// Covariance that the gyroscope bias b adds in one step: `c g^T + g c^T`, with `g = d(end) / db` (`by_bias`) and `c =
/// F cov(pose, b) + g var(b) / 2`; `cross` is `cov(pose, b)` at the start.
#[inline(always)]
pub(crate) fn bias_covariance<F: Arithmetic>(
    by: F,
    lever: [F::Number; 2],
    cross: [F::Number; 3],
    by_bias: [F::Number; 3],
    variance: F::Number,
) -> Covariance3<F::Number> {
    let [x, y, z] = by_bias;
    let half = variance * by.number(0.5);
    let [p, q, r] = propagate_error(by, lever, cross, [x * half, y * half, z * half]);
    let two = by.number(2.0);
    Covariance3::from([
        two * (x * p),
        by.fused(x, q, y * p),
        by.fused(x, r, z * p),
        two * (y * q),
        by.fused(y, r, z * q),
        two * (z * r),
    ])
}
