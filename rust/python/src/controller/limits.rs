//! `six_wheel.Limits`: what a motion may not exceed, as data.

use pyo3::prelude::*;
use six_wheel_control::controller::Limits as Core;
use six_wheel_kinematics::units;

use crate::arguments::{FromArgument, constructor_call};
use crate::classes::repr_of_numbers;
use crate::convert::OrRaise;
use crate::rover::Rover;
use crate::unit_warnings::warn_units;

/// Limits of a motion.
///
/// A limit left out, or None, has the default that `on` fills in, and reads as infinity; ``math.inf``, or 1e60 and
/// more, is no limit.
///
/// Linear limits are of the velocity of the body's origin, angular ones of the yaw rate. Speeding up and
/// slowing down count along the motion: they mean the same forwards and backwards.
#[doc = section!(Parameters)]
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
#[doc = raises!(ValueError)]
///     If a limit is zero, negative or not a number: the rover could not move, or not stop. If `halt_deceleration` is less
///     than `deceleration`.
#[pyclass(frozen, module = "six_wheel", from_py_object)]
#[derive(Clone)]
pub struct Limits(pub Core);

impl Limits {
    /// The limits that were given.
    fn numbers(&self) -> impl Iterator<Item = (&'static str, Option<f64>)> {
        self.0.pairs().map(|(name, limit)| (name, Some(limit)))
    }

    /// The call that makes these limits.
    pub fn text(&self) -> String {
        repr_of_numbers("Limits", self.numbers())
    }
}

argument_kind! { Limits: "Limits", |value| constructor_call("Limits", "speed", value) }

impl<'a, 'py> FromArgument<'a, 'py> for Limits {
    fn read(argument: &'static str, value: &'a Bound<'py, PyAny>) -> PyResult<Self> {
        Bound::<Self>::read(argument, value).map(|limits| limits.get().clone())
    }
}

value_of_numbers!(Limits);

getters! { Limits, self, py:
    /// Speed of the body's origin [m/s].
    speed: f64 = self.0.speed;
    /// Yaw rate [rad/s].
    yaw_rate: f64 = self.0.yaw_rate;
    /// Change of the velocity while speeding up [m/s^2].
    acceleration: f64 = self.0.acceleration;
    /// Change of the velocity while slowing down [m/s^2].
    deceleration: f64 = self.0.deceleration;
    /// Change of the acceleration [m/s^3].
    jerk: f64 = self.0.jerk;
    /// Change of the yaw rate while speeding up [rad/s^2].
    angular_acceleration: f64 = self.0.angular_acceleration;
    /// Change of the yaw rate while slowing down [rad/s^2].
    angular_deceleration: f64 = self.0.angular_deceleration;
    /// Change of the angular acceleration [rad/s^3].
    angular_jerk: f64 = self.0.angular_jerk;
    /// Speed times yaw rate [m/s^2].
    lateral_acceleration: f64 = self.0.lateral_acceleration;
    /// Rotation rate of every wheel [rad/s].
    wheel_speed: f64 = self.0.wheel_speed;
    /// Change of the rotation rate of every wheel [rad/s^2].
    wheel_acceleration: f64 = self.0.wheel_acceleration;
    /// Steering angle to either side [rad].
    steering_limit: f64 = self.0.steering_limit;
    /// Rate of every steering angle [rad/s].
    steering_rate: f64 = self.0.steering_rate;
    /// Change of the rate of every steering angle [rad/s^2].
    steering_acceleration: f64 = self.0.steering_acceleration;
    /// Change of the speed of a wheel over the ground during a halt [m/s^2].
    halt_deceleration: f64 = self.0.halt_deceleration;
}

methods! { Limits:
    #[new]
    fn new[py: Python<'py>](*, speed: Option<f64> = None, yaw_rate: Option<f64> = None,
        acceleration: Option<f64> = None, deceleration: Option<f64> = None, jerk: Option<f64> = None,
        angular_acceleration: Option<f64> = None, angular_deceleration: Option<f64> = None,
        angular_jerk: Option<f64> = None, lateral_acceleration: Option<f64> = None, wheel_speed: Option<f64> = None,
        wheel_acceleration: Option<f64> = None, steering_limit: Option<f64> = None, steering_rate: Option<f64> = None,
        steering_acceleration: Option<f64> = None, halt_deceleration: Option<f64> = None, **)
    as "(*, speed=None, yaw_rate=None, acceleration=None, deceleration=None, jerk=None, angular_acceleration=None, angular_deceleration=None, angular_jerk=None, lateral_acceleration=None, wheel_speed=None, wheel_acceleration=None, steering_limit=None, steering_rate=None, steering_acceleration=None, halt_deceleration=None)"
    -> PyResult<Self> {
        let core = Core::new([
            speed, yaw_rate, acceleration, deceleration, jerk, angular_acceleration, angular_deceleration, angular_jerk,
            lateral_acceleration, wheel_speed, wheel_acceleration, steering_limit, steering_rate, steering_acceleration,
            halt_deceleration,
        ]);
        let core = core.or_raise(&[])?;
        warn_units(py, units::settings(Core::NAMES.into_iter().zip(core.values())))?;
        Ok(Self(core))
    }

    /// These limits with the defaults of a rover filled in.
    #[doc = section!(Parameters)]
    /// rover : Rover
    ///     The distance of its farthest wheel from the origin [m] turns linear limits into angular ones.
    #[doc = returns!("Limits")]
    ///     `acceleration` 9.81 m/s^2, `deceleration` as `acceleration`, `angular_acceleration`,
    ///     `angular_deceleration` and `angular_jerk` the linear limit over that distance, `steering_rate` 12 rad/s,
    ///     `halt_deceleration` as `deceleration`, where they were left out. The others have no default and are infinite.
    #[doc = raises!(TypeError: "If `rover` is not a Rover.")]
    fn on[&self](rover: Bound<'py, Rover>) -> Self {
        Self(self.0.on(&rover.get().core))
    }

    /// Way of a halt straight ahead from a steady speed.
    #[doc = section!(Parameters)]
    /// speed : float
    ///     [m/s]
    #[doc = returns!("float": "At the halt_deceleration of these limits [m].")]
    #[doc = raises!("If the speed is not finite.")]
    fn halting_distance[&self](speed: f64) -> PyResult<f64> {
        six_wheel_numerics::error::bounded("speed", &[speed]).or_raise(&[])?;
        Ok(self.0.halting_distance(speed))
    }

    /// Way of the quickest stop straight ahead from a steady speed.
    #[doc = section!(Parameters)]
    /// speed : float
    ///     [m/s]
    #[doc = returns!("float": "At the deceleration and jerk of these limits [m].")]
    #[doc = raises!("If the speed is not finite.")]
    fn stopping_distance[&self](speed: f64) -> PyResult<f64> {
        six_wheel_numerics::error::bounded("speed", &[speed]).or_raise(&[])?;
        Ok(self.0.stopping_distance(speed))
    }
}
