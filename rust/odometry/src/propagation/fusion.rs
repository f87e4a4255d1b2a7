//! Fusion of a gyroscope with the wheels in a step.
//!
//! The gyroscope measures the yaw increment, `turn = H d + noise`, `H = [0, 0, 1]`. With the covariance P of the wheels'
//! displacement d: `K = P Hᵀ / S`, `d' = d + K (turn - d_yaw)`, errors `e' = (I - K H) e + K noise`.

use pulp::Simd;

use crate::propagation::arc::propagate_error;
use crate::propagation::covariance::Covariance3;
use six_wheel_numerics::simd::lanes::Lanes;

/// Measurement of a gyroscope in a step.
#[derive(Clone, Copy)]
pub(crate) struct GyroscopeIncrement<S: Simd> {
    /// 1, or 0 where there is no reading: then its gain is 0.
    pub is_read: Lanes<S>,
    /// Its yaw increment less that by its bias [rad].
    pub turn: Lanes<S>,
    /// Standard deviation of `turn` by the reading at one end of the step [rad].
    pub deviation: Lanes<S>,
    /// Variance of the bias at the start [rad²/s²].
    pub bias_variance: Lanes<S>,
}

/// Gain K of each part of a displacement [m/rad, m/rad, 1], multiplied by the innovation `turn - d_yaw`.
pub(crate) type KalmanGain<S> = [Lanes<S>; 3];

#[inline_always]
impl<S: Simd> GyroscopeIncrement<S> {
    /// The gain for wheels whose displacement has this covariance: `K = P Hᵀ / S`, `S = P_zz + 2 deviation² + bias
    /// variance dt²`. If neither has any noise, the yaw increment is that of the gyroscope.
    pub fn kalman_gain(&self, wheels: Covariance3<Lanes<S>>, dt: Lanes<S>) -> KalmanGain<S> {
        let [_, _, x, _, y, z] = wheels.into();
        let splat = |number| Lanes::splat(dt.simd(), number);
        let (read, zero) = (self.is_read, splat(0.0));
        let both_ends = splat(2.0) * (self.deviation * self.deviation);
        let variance = z + both_ends + self.bias_variance * (dt * dt);
        let is_noisy = zero.lt(variance);
        [
            is_noisy.select((x * read) / variance, zero),
            is_noisy.select((y * read) / variance, zero),
            is_noisy.select((z * read) / variance, read),
        ]
    }

    /// Error of the fused displacement by the deviation of a reading at one end.
    pub fn error(&self, [x, y, z]: KalmanGain<S>) -> [Lanes<S>; 3] {
        [x * self.deviation, y * self.deviation, z * self.deviation]
    }

    /// The displacement by wheels and gyroscope.
    pub fn posterior_displacement(&self, gain: KalmanGain<S>, [x, y, z]: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
        let innovation = self.turn - z;
        [gain[0].mul_add(innovation, x), gain[1].mul_add(innovation, y), gain[2].mul_add(innovation, z)]
    }
}

/// Error of the fused displacement by an error e of the wheels' displacement: `(I - K H) e`.
#[inline(always)]
pub(crate) fn remaining_error<S: Simd>([to_x, to_y, to_z]: KalmanGain<S>, [x, y, z]: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
    let one = Lanes::splat(z.simd(), 1.0);
    [(-to_x).mul_add(z, x), (-to_y).mul_add(z, y), (one - to_z) * z]
}

/// Covariance P of the wheels' displacement after the fusion, without the gyroscope's own noise: `(I - K H) P (I - K
/// H)ᵀ`.
#[inline(always)]
pub(crate) fn remaining_covariance<S: Simd>(
    [to_x, to_y, to_z]: KalmanGain<S>,
    wheels: Covariance3<Lanes<S>>,
) -> Covariance3<Lanes<S>> {
    let [xx, xy, xz, yy, yz, zz] = wheels.propagate([-to_x, -to_y]).into();
    let rest = Lanes::splat(to_z.simd(), 1.0) - to_z;
    Covariance3::from([xx, xy, xz * rest, yy, yz * rest, zz * (rest * rest)])
}

/// Covariance that the gyroscope bias b adds in one step: `c gᵀ + g cᵀ`, with `g = d(end) / db` (`by_bias`) and `c =
/// F cov(pose, b) + g var(b) / 2`; `cross` is `cov(pose, b)` at the start.
#[inline(always)]
pub(crate) fn bias_covariance_increment<S: Simd>(
    lever: [Lanes<S>; 2],
    cross: [Lanes<S>; 3],
    by_bias: [Lanes<S>; 3],
    variance: Lanes<S>,
) -> Covariance3<Lanes<S>> {
    let [x, y, z] = by_bias;
    let half = variance * Lanes::splat(variance.simd(), 0.5);
    let [p, q, r] = propagate_error(lever, cross, [x * half, y * half, z * half]);
    let two = Lanes::splat(variance.simd(), 2.0);
    Covariance3::from([
        two * (x * p),
        x.mul_add(q, y * p),
        x.mul_add(r, z * p),
        two * (y * q),
        y.mul_add(r, z * q),
        two * (z * r),
    ])
}
