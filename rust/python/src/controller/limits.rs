//! `six_wheel.Limits`: what a motion may not exceed, as data.

use std::hash::{DefaultHasher, Hash, Hasher};

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use six_wheel_control::controller::Limits as Core;
use six_wheel_kinematics::units;

use crate::arguments::{self, ArgumentKind, FromArgument, constructor_call};
use crate::classes::reduce;
use crate::convert::{OrRaise, number};
use crate::rover::Rover;
use crate::unit_warnings::warn_units;

/// Limits of a motion.
///
/// A limit left out, or None, has the default that `on` fills in, and reads as infinity; ``math.inf``, or 1e60 and
/// more, is no limit.
///
/// Linear limits are of the velocity of the body's origin, angular ones of the yaw rate. Speeding up and
/// slowing down count along the motion: they mean the same forwards and backwards.
///
/// Parameters
/// ----------
/// speed, yaw_rate : float, optional
///     Of the body [m/s, rad/s].
/// acceleration, deceleration : float, optional
///     Change of the velocity while speeding up and slowing down [m/s^2]. Slowing down is limited as speeding
///     up is unless told otherwise. Default 9.81, a friction of 1.
/// jerk : float, optional
///     Change of the acceleration [m/s^3].
/// angular_acceleration, angular_deceleration, angular_jerk : float, optional
///     The same of the yaw rate [rad/s^2, rad/s^2, rad/s^3]. Default: the linear limit over the distance of the farthest
///     wheel from the origin [m].
/// lateral_acceleration : float, optional
///     Speed times yaw rate [m/s^2].
/// wheel_speed, wheel_acceleration : float, optional
///     Of every wheel [rad/s, rad/s^2].
/// steering_limit : float, optional
///     Steering angle to either side [rad], inside the ranges of the rover's wheels.
/// steering_rate, steering_acceleration : float, optional
///     Of every steering angle [rad/s, rad/s^2]. Default of the rate: 12 rad/s.
/// halt_deceleration : float, optional
///     Change of the speed of a wheel over the ground during a halt [m/s^2], at least `deceleration`. Default:
///     `deceleration`.
///
/// Raises
/// ------
/// ValueError
///     If a limit is zero, negative or not a number: the rover could not move, or not stop. If `halt_deceleration` is less
///     than `deceleration`.
#[pyclass(frozen, module = "six_wheel", from_py_object)]
#[derive(Clone)]
pub struct Limits(pub Core);

impl Limits {
    /// The arguments that make these limits.
    fn keywords<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let keywords = PyDict::new(py);
        for (name, value) in self.0.pairs() {
            keywords.set_item(name, value)?;
        }
        Ok(keywords)
    }

    /// The call that makes these limits.
    pub fn text(&self) -> String {
        let text = |value: f64| {
            if value.is_infinite() { "float('inf')".into() } else { format!("{value:?}") }
        };
        let given: Vec<String> = self.0.pairs().map(|(name, value)| format!("{name}={}", text(value))).collect();
        format!("Limits({})", given.join(", "))
    }
}

impl ArgumentKind for Limits {
    const KIND: &'static str = "Limits";

    fn remedy(value: &Bound<'_, PyAny>) -> String {
        constructor_call("Limits", "speed", value)
    }
}

impl<'a, 'py> FromArgument<'a, 'py> for Limits {
    fn read(argument: &str, value: &'a Bound<'py, PyAny>) -> PyResult<Self> {
        Bound::<Self>::read(argument, value).map(|limits| limits.get().clone())
    }
}

replaceable!(Limits);

#[pymethods]
impl Limits {
    #[new]
    #[pyo3(signature = (*, speed=None, yaw_rate=None, acceleration=None, deceleration=None, jerk=None,
        angular_acceleration=None, angular_deceleration=None, angular_jerk=None, lateral_acceleration=None,
        wheel_speed=None, wheel_acceleration=None, steering_limit=None, steering_rate=None,
        steering_acceleration=None, halt_deceleration=None))]
    fn new(
        py: Python<'_>,
        speed: Option<&Bound<'_, PyAny>>,
        yaw_rate: Option<&Bound<'_, PyAny>>,
        acceleration: Option<&Bound<'_, PyAny>>,
        deceleration: Option<&Bound<'_, PyAny>>,
        jerk: Option<&Bound<'_, PyAny>>,
        angular_acceleration: Option<&Bound<'_, PyAny>>,
        angular_deceleration: Option<&Bound<'_, PyAny>>,
        angular_jerk: Option<&Bound<'_, PyAny>>,
        lateral_acceleration: Option<&Bound<'_, PyAny>>,
        wheel_speed: Option<&Bound<'_, PyAny>>,
        wheel_acceleration: Option<&Bound<'_, PyAny>>,
        steering_limit: Option<&Bound<'_, PyAny>>,
        steering_rate: Option<&Bound<'_, PyAny>>,
        steering_acceleration: Option<&Bound<'_, PyAny>>,
        halt_deceleration: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let given = [
            speed,
            yaw_rate,
            acceleration,
            deceleration,
            jerk,
            angular_acceleration,
            angular_deceleration,
            angular_jerk,
            lateral_acceleration,
            wheel_speed,
            wheel_acceleration,
            steering_limit,
            steering_rate,
            steering_acceleration,
            halt_deceleration,
        ];
        let mut values = [None; Core::NAMES.len()];
        for ((value, given), name) in values.iter_mut().zip(given).zip(Core::NAMES) {
            *value = given.map(|given| number(name, given)).transpose()?;
        }
        let core = Core::new(values).or_raise(&[])?;
        warn_units(py, units::settings(Core::NAMES.into_iter().zip(core.values())))?;
        Ok(Self(core))
    }

    /// Speed of the body's origin [m/s].
    #[getter]
    fn speed(&self) -> f64 {
        self.0.speed
    }

    /// Yaw rate [rad/s].
    #[getter]
    fn yaw_rate(&self) -> f64 {
        self.0.yaw_rate
    }

    /// Change of the velocity while speeding up [m/s^2].
    #[getter]
    fn acceleration(&self) -> f64 {
        self.0.acceleration
    }

    /// Change of the velocity while slowing down [m/s^2].
    #[getter]
    fn deceleration(&self) -> f64 {
        self.0.deceleration
    }

    /// Change of the acceleration [m/s^3].
    #[getter]
    fn jerk(&self) -> f64 {
        self.0.jerk
    }

    /// Change of the yaw rate while speeding up [rad/s^2].
    #[getter]
    fn angular_acceleration(&self) -> f64 {
        self.0.angular_acceleration
    }

    /// Change of the yaw rate while slowing down [rad/s^2].
    #[getter]
    fn angular_deceleration(&self) -> f64 {
        self.0.angular_deceleration
    }

    /// Change of the angular acceleration [rad/s^3].
    #[getter]
    fn angular_jerk(&self) -> f64 {
        self.0.angular_jerk
    }

    /// Speed times yaw rate [m/s^2].
    #[getter]
    fn lateral_acceleration(&self) -> f64 {
        self.0.lateral_acceleration
    }

    /// Rotation rate of every wheel [rad/s].
    #[getter]
    fn wheel_speed(&self) -> f64 {
        self.0.wheel_speed
    }

    /// Change of the rotation rate of every wheel [rad/s^2].
    #[getter]
    fn wheel_acceleration(&self) -> f64 {
        self.0.wheel_acceleration
    }

    /// Steering angle to either side [rad].
    #[getter]
    fn steering_limit(&self) -> f64 {
        self.0.steering_limit
    }

    /// Rate of every steering angle [rad/s].
    #[getter]
    fn steering_rate(&self) -> f64 {
        self.0.steering_rate
    }

    /// Change of the rate of every steering angle [rad/s^2].
    #[getter]
    fn steering_acceleration(&self) -> f64 {
        self.0.steering_acceleration
    }

    /// Change of the speed of a wheel over the ground during a halt [m/s^2].
    #[getter]
    fn halt_deceleration(&self) -> f64 {
        self.0.halt_deceleration
    }

    /// These limits with the defaults of a rover filled in.
    ///
    /// Parameters
    /// ----------
    /// rover : Rover
    ///     The distance of its farthest wheel from the origin [m] turns linear limits into angular ones.
    ///
    /// Returns
    /// -------
    /// Limits
    ///     `acceleration` 9.81 m/s^2, `deceleration` as `acceleration`, `angular_acceleration`,
    ///     `angular_deceleration` and `angular_jerk` the linear limit over that distance, `steering_rate` 12 rad/s,
    ///     `halt_deceleration` as `deceleration`, where they were left out. The others have no default and are infinite.
    fn on(&self, #[pyo3(from_py_with = arguments::rover)] rover: Bound<'_, Rover>) -> Self {
        Self(self.0.on(&rover.get().core))
    }

    /// Way of a halt straight ahead from a steady speed.
    ///
    /// Parameters
    /// ----------
    /// speed : float
    ///     [m/s]
    ///
    /// Returns
    /// -------
    /// float
    ///     At the halt_deceleration of these limits [m].
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the speed is not finite.
    fn halting_distance(&self, speed: &Bound<'_, PyAny>) -> PyResult<f64> {
        let speed = number("speed", speed)?;
        six_wheel_numerics::error::finite("speed", &[speed]).or_raise(&[])?;
        Ok(self.0.halting_distance(speed))
    }

    /// Way of the quickest stop straight ahead from a steady speed.
    ///
    /// Parameters
    /// ----------
    /// speed : float
    ///     [m/s]
    ///
    /// Returns
    /// -------
    /// float
    ///     At the deceleration and jerk of these limits [m].
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the speed is not finite.
    fn stopping_distance(&self, speed: &Bound<'_, PyAny>) -> PyResult<f64> {
        let speed = number("speed", speed)?;
        six_wheel_numerics::error::finite("speed", &[speed]).or_raise(&[])?;
        Ok(self.0.stopping_distance(speed))
    }

    fn __repr__(&self) -> String {
        self.text()
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get().0 == self.0)
    }

    fn __hash__(&self) -> u64 {
        let mut state = DefaultHasher::new();
        (self.0.values().map(f64::to_bits), self.0.given).hash(&mut state);
        state.finish()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let keywords = slf.get().keywords(slf.py())?;
        reduce(slf.as_any(), &PyTuple::empty(slf.py()), &keywords)
    }
}
