//! `six_wheel.Gyroscope`.

use pyo3::prelude::*;
use six_wheel_odometry::Gyroscope as Core;

use crate::arguments::{ArgumentKind, constructor_call};
use crate::convert::OrRaise;

/// Error model of a gyroscope about the vertical axis of the body.
///
/// Parameters
/// ----------
/// noise : float, default 0.005
///     Standard deviation of a reading [rad/s].
/// bias : float, default 0.0
///     Reading at rest, as far as is known beforehand [rad/s].
/// bias_noise : float, default 0.05
///     Standard deviation of that [rad/s].
/// bias_walk : float, default 0.0001
///     Random walk of the bias, as a standard deviation after one second [rad/s per root s].
/// scale_noise : float, default 0.0
///     Standard deviation of the factor that its readings are off by, a share of what it turns. It lasts: ten turns the
///     same way err ten times as much as one.
///
/// Raises
/// ------
/// ValueError
///     If a number is not finite or a deviation negative.
#[pyclass(frozen, module = "six_wheel", from_py_object)]
#[derive(Clone, Copy)]
pub struct Gyroscope(pub Core);

impl Gyroscope {
    fn numbers(&self) -> [(&'static str, Option<f64>); 5] {
        let Core { noise, bias, bias_noise, bias_walk, scale_noise } = self.0;
        [
            ("noise", noise),
            ("bias", bias),
            ("bias_noise", bias_noise),
            ("bias_walk", bias_walk),
            ("scale_noise", scale_noise),
        ]
        .map(|(name, number)| (name, Some(number)))
    }
}

impl ArgumentKind for Gyroscope {
    const KIND: &'static str = "a Gyroscope";

    fn remedy(value: &Bound<'_, PyAny>) -> String {
        constructor_call("Gyroscope", "noise", value)
    }
}

getters! { Gyroscope, self, py:
    /// Standard deviation of a reading [rad/s].
    noise: f64 = self.0.noise;
    /// Reading at rest [rad/s].
    bias: f64 = self.0.bias;
    /// Standard deviation of the bias [rad/s].
    bias_noise: f64 = self.0.bias_noise;
    /// Random walk of the bias [rad/s per root s].
    bias_walk: f64 = self.0.bias_walk;
    /// Standard deviation of the factor that its readings are off by.
    scale_noise: f64 = self.0.scale_noise;
}

value_of_numbers!(Gyroscope);

methods! { Gyroscope:
    #[new]
    fn new[](noise: Option<f64> = None, *, bias: Option<f64> = None, bias_noise: Option<f64> = None,
        bias_walk: Option<f64> = None, scale_noise: Option<f64> = None)
    as "(noise=0.005, *, bias=0.0, bias_noise=0.05, bias_walk=0.0001, scale_noise=0.0)" -> PyResult<Self> {
        let usual = Core::default();
        let known = Core {
            noise: noise.unwrap_or(usual.noise),
            bias: bias.unwrap_or(usual.bias),
            bias_noise: bias_noise.unwrap_or(usual.bias_noise),
            bias_walk: bias_walk.unwrap_or(usual.bias_walk),
            scale_noise: scale_noise.unwrap_or(usual.scale_noise),
        };
        known.check().or_raise(&[])?;
        Ok(Self(known))
    }
}
