//! Arguments of one kind, read by name. A value of another kind is refused with the argument's name, the kind that is
//! expected, and the value.
//!
//! A parameter with a type in a list of [`methods`](crate::classes::parameter_lists) is read by the function of its name here, into any type
//! with [`FromArgument`]: a new name is added to `named!`. A class of this library implements [`ArgumentKind`] in its own
//! file. Errors of pyo3 itself name the argument in a traceback only.

use pyo3::PyClass;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyMapping, PyString};

use crate::convert::{is_of_another_kind, number, numbers, refuse_type, short_repr};

/// Letters of a value that are shown.
const LONGEST: usize = 60;

/// A type that an argument is read as.
pub trait FromArgument<'a, 'py>: Sized {
    /// The value, or the error that names the argument.
    fn read(argument: &'static str, value: &'a Bound<'py, PyAny>) -> PyResult<Self>;
}

/// A reading function for each name of an argument.
macro_rules! named {
    ($($name:ident)*) => {$(
        pub fn $name<'a, 'py, T: FromArgument<'a, 'py>>(value: &'a Bound<'py, PyAny>) -> PyResult<T> {
            T::read(stringify!($name), value)
        }
    )*};
}

named! {
    acceleration align align_tolerance allow_underdetermined angular_acceleration angular_deceleration angular_jerk
    attitude_noise axle_length belly bias bias_noise bias_walk bogie_pivot bogie_to_front bogie_to_middle brake_time
    castor changes correlation cost_weights costmap covariances cover curvature deceleration delay derivatives
    discretise driven drop dt duration end_twist errors false_alarm following_error following_time frame front_brake
    front_to_middle gear_ratio gravity ground gyroscope halt_deceleration heading history icr icr_forward icr_left
    icr_right in_space increments inflate jerk joint_noise joints lag lateral_acceleration lethal level lift_angle
    lift_speed limits map_error mass max_gap max_speed max_steering_rate max_step method middle_to_rear
    middle_track_width mode name names noise offset other outside pair period pivot_rate pivots pose radius ramp
    readings rear_brake rear_pivot rear_to_wheel residuals reversed_joints roller_angle roughness rover scale_noise
    scrub shape side_slip slip slip_threshold slips smoothing spacing speed stamp stand start_twist steer steered
    steering steering_acceleration steering_jerk steering_joints steering_limit steering_rate suspension synchronise
    temperature threads ticks_per_turn timeout tolerance track_width traction_joints trail unmeasured view
    wheel_acceleration wheel_jerk wheel_radius wheel_speed wheelbase wheels_per_side within wraps_at x y yaw yaw_rate
}

/// "`argument` must be `kind`, got `value`", with a remedy where there is one.
pub fn other_kind(argument: &str, kind: &str, value: &Bound<'_, PyAny>, remedy: &str) -> PyErr {
    let shown = shown(value);
    let remedy = match remedy {
        "" => String::new(),
        remedy => format!(": give {remedy}"),
    };
    refuse_type(argument, format!("be {kind}"), format!("{shown}{remedy}"))
}

/// A number, a short text or None as it is, of another value its class with the article.
pub fn shown(value: &Bound<'_, PyAny>) -> String {
    let plain = value.is_none()
        || value.is_instance_of::<PyString>()
        || value.is_instance_of::<PyFloat>()
        || value.is_instance_of::<PyInt>();
    let text = short_repr(value);
    if plain && text.chars().count() <= LONGEST {
        return text;
    }
    let class = value.get_type().name();
    let class = class.map_or_else(|_| "object".into(), |name| name.to_string());
    let vowel = class.starts_with(['a', 'e', 'i', 'o', 'u', 'A', 'E', 'I', 'O', 'U']);
    let article = if vowel || class == "ndarray" { "an" } else { "a" };
    format!("{article} {class}")
}

/// The value as pyo3 reads it, with the error of this library.
fn native<'a, 'py, T: FromPyObject<'a, 'py, Error = PyErr>>(
    argument: &str,
    kind: &str,
    value: &'a Bound<'py, PyAny>,
) -> PyResult<T> {
    let py = value.py();
    value.extract().map_err(|error| match is_of_another_kind(py, &error) {
        true => other_kind(argument, kind, value, ""),
        false => error,
    })
}

impl<'a, 'py> FromArgument<'a, 'py> for f64 {
    fn read(argument: &'static str, value: &'a Bound<'py, PyAny>) -> PyResult<Self> {
        number(argument, value)
    }
}

impl<'a, 'py, const COUNT: usize> FromArgument<'a, 'py> for [f64; COUNT] {
    fn read(argument: &'static str, value: &'a Bound<'py, PyAny>) -> PyResult<Self> {
        numbers(argument, value)
    }
}

/// Whole numbers, but for `True` and `False`.
macro_rules! whole {
    ($kind:ty, $words:literal) => {
        impl<'a, 'py> FromArgument<'a, 'py> for $kind {
            fn read(argument: &'static str, value: &'a Bound<'py, PyAny>) -> PyResult<Self> {
                if value.is_instance_of::<PyBool>() {
                    return Err(other_kind(argument, $words, value, ""));
                }
                native(argument, $words, value)
            }
        }
    };
}

whole! { i64, "a whole number" }
whole! { usize, "a whole number from 0 on" }

impl<'a, 'py> FromArgument<'a, 'py> for &'a str {
    fn read(argument: &'static str, value: &'a Bound<'py, PyAny>) -> PyResult<Self> {
        let text = value.cast::<PyString>();
        text.map_err(|_| other_kind(argument, "a str", value, ""))?.to_str()
    }
}

/// Types of Python that pyo3 reads.
macro_rules! natives {
    ($($kind:ty, $words:literal;)*) => {$(
        impl<'a, 'py> FromArgument<'a, 'py> for $kind {
            fn read(argument: &'static str, value: &'a Bound<'py, PyAny>) -> PyResult<Self> {
                native(argument, $words, value)
            }
        }
    )*};
}

natives! {
    bool, "True or False";
    String, "a str";
    Vec<String>, "a list of str";
    Vec<usize>, "a list of whole numbers from 0 on";
    (f64, f64, f64), "three numbers";
    (f64, f64, f64, f64), "four numbers";
}

/// Containers of Python, as they are.
macro_rules! containers {
    ($($kind:ty, $words:literal;)*) => {$(
        impl<'a, 'py> FromArgument<'a, 'py> for &'a Bound<'py, $kind> {
            fn read(argument: &'static str, value: &'a Bound<'py, PyAny>) -> PyResult<Self> {
                value.cast().map_err(|_| other_kind(argument, $words, value, ""))
            }
        }
    )*};
}

containers! {
    PyDict, "a dict";
    PyMapping, "a mapping";
}

impl<'a, 'py, T: FromArgument<'a, 'py>> FromArgument<'a, 'py> for Option<T> {
    fn read(argument: &'static str, value: &'a Bound<'py, PyAny>) -> PyResult<Self> {
        if value.is_none() { Ok(None) } else { T::read(argument, value).map(Some) }
    }
}

/// A class of this library that is taken as an argument.
pub trait ArgumentKind: PyClass {
    /// Its name in errors, with the article.
    const KIND: &'static str;

    /// The Python expression that makes one from a value of another kind; empty if there is none.
    const REMEDY: fn(&Bound<'_, PyAny>) -> String = |_| String::new();
}

impl<'a, 'py, T: ArgumentKind> FromArgument<'a, 'py> for Bound<'py, T> {
    fn read(argument: &'static str, value: &'a Bound<'py, PyAny>) -> PyResult<Self> {
        let found = value.cast::<T>();
        found.cloned().map_err(|_| other_kind(argument, T::KIND, value, &T::REMEDY(value)))
    }
}

/// A class that is taken as an argument: `argument_kind! { Class: KIND, REMEDY }`.
macro_rules! argument_kind {
    ($class:ident: $kind:literal $(, $remedy:expr)?) => {
        impl crate::arguments::ArgumentKind for $class {
            const KIND: &'static str = $kind;
            $(const REMEDY: fn(&Bound<'_, PyAny>) -> String = $remedy;)?
        }
    };
}

/// The call of a constructor for a value that is a dict of its keywords, or the number of `keyword`.
pub fn constructor_call(class: &str, keyword: &str, value: &Bound<'_, PyAny>) -> String {
    if value.is_instance_of::<PyDict>() {
        return format!("sw.{class}(**...)");
    }
    let number = value.is_instance_of::<PyFloat>() || value.is_instance_of::<PyInt>();
    let number = if number { shown(value) } else { "...".into() };
    format!("sw.{class}({keyword}={number})")
}
