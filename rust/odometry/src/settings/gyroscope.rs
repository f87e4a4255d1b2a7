//! A gyroscope about the vertical axis of the body: its noise and its bias.

use nalgebra::Vector3;

use crate::uncertainty::Bias;
use six_wheel_numerics::error::{Error, finite, not_negative};

/// Rim speed up to which a wheel is at rest [m/s]: one count of a usual encoder in a step is faster.
pub(crate) const STANDING: f64 = 1e-3;

/// A reading within this many standard deviations of the bias may be the bias alone.
pub(crate) const LIKELY: f64 = 4.0;

/// Yaw increment by a gyroscope in a step [rad]: the mean of its readings at both ends less the bias, times `dt`;
/// without a reading `before` the one at the end alone.
#[inline]
pub(crate) fn turn(before: Option<f64>, rate: f64, bias: Option<Bias>, dt: f64) -> f64 {
    let known = bias.map_or(0.0, |bias| bias.value);
    (mean_rate(before, rate) - known) * dt
}

/// Mean of the readings of a gyroscope at both ends of a step [rad/s].
#[inline]
pub fn mean_rate(before: Option<f64>, rate: f64) -> f64 {
    f64::midpoint(before.unwrap_or(rate), rate)
}

/// Error model of a gyroscope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gyroscope {
    /// Standard deviation of a reading [rad/s].
    pub noise: f64,
    /// Expected reading at rest, before the first sample [rad/s].
    pub bias: f64,
    /// Standard deviation of the bias before the first sample [rad/s].
    pub bias_noise: f64,
    /// Random walk of the bias, as a standard deviation after one second [rad/s per root s].
    pub bias_walk: f64,
    /// Standard deviation of the scale factor of its readings [1].
    pub scale_noise: f64,
}

impl Default for Gyroscope {
    fn default() -> Self {
        Self { noise: 0.005, bias: 0.0, bias_noise: 0.05, bias_walk: 1e-4, scale_noise: 0.0 }
    }
}

impl Gyroscope {
    pub(crate) fn at_start(&self) -> Bias {
        Bias { value: self.bias, variance: self.bias_noise * self.bias_noise, cross: Vector3::zeros() }
    }

    /// Fails unless every number is finite and no deviation negative.
    pub fn check(&self) -> Result<(), Error> {
        finite("bias", &[self.bias])?;
        let deviations = fields!(self: noise, bias_noise, bias_walk, scale_noise);
        deviations.into_iter().try_for_each(|(argument, value)| not_negative(argument, value))
    }
}
