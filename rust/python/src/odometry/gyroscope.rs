//! `six_wheel.Gyroscope`.

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use six_wheel_odometry::Gyroscope as Core;

use crate::arguments::{ArgumentKind, constructor_call};
use crate::classes::{hash_of_numbers, reduce};
use crate::convert::{OrRaise, number};

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
    fn numbers(&self) -> [(&'static str, f64); 5] {
        let known = &self.0;
        [
            ("noise", known.noise),
            ("bias", known.bias),
            ("bias_noise", known.bias_noise),
            ("bias_walk", known.bias_walk),
            ("scale_noise", known.scale_noise),
        ]
    }
}

impl ArgumentKind for Gyroscope {
    const KIND: &'static str = "a Gyroscope";

    fn remedy(value: &Bound<'_, PyAny>) -> String {
        constructor_call("Gyroscope", "noise", value)
    }
}

getters! { Gyroscope, this, py:
    /// Standard deviation of a reading [rad/s].
    noise: f64 = this.0.noise;
    /// Reading at rest [rad/s].
    bias: f64 = this.0.bias;
    /// Standard deviation of the bias [rad/s].
    bias_noise: f64 = this.0.bias_noise;
    /// Random walk of the bias [rad/s per root s].
    bias_walk: f64 = this.0.bias_walk;
    /// Standard deviation of the factor that its readings are off by.
    scale_noise: f64 = this.0.scale_noise;
}

equal_by!(Gyroscope: 0);
replaceable!(Gyroscope);

#[pymethods]
impl Gyroscope {
    #[new]
    #[pyo3(
        signature = (noise=None, *, bias=None, bias_noise=None, bias_walk=None, scale_noise=None),
        text_signature = "(noise=0.005, *, bias=0.0, bias_noise=0.05, bias_walk=0.0001, scale_noise=0.0)"
    )]
    fn new(
        noise: Option<&Bound<'_, PyAny>>,
        bias: Option<&Bound<'_, PyAny>>,
        bias_noise: Option<&Bound<'_, PyAny>>,
        bias_walk: Option<&Bound<'_, PyAny>>,
        scale_noise: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let mut known = Core::default();
        let given = [
            ("noise", noise, &mut known.noise),
            ("bias", bias, &mut known.bias),
            ("bias_noise", bias_noise, &mut known.bias_noise),
            ("bias_walk", bias_walk, &mut known.bias_walk),
            ("scale_noise", scale_noise, &mut known.scale_noise),
        ];
        for (argument, value, target) in given {
            if let Some(value) = value {
                *target = number(argument, value)?;
            }
        }
        known.check().or_raise(&[])?;
        Ok(Self(known))
    }

    fn __repr__(&self) -> String {
        let parts = self.numbers().map(|(name, value)| format!("{name}={value:?}"));
        format!("Gyroscope({})", parts.join(", "))
    }

    fn __hash__(&self) -> u64 {
        hash_of_numbers(self.numbers().map(|(_, number)| number))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let keywords = PyDict::new(slf.py());
        for (argument, value) in slf.get().numbers() {
            keywords.set_item(argument, value)?;
        }
        reduce(slf.as_any(), &PyTuple::empty(slf.py()), &keywords)
    }
}
