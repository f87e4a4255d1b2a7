//! Arguments of one kind, by name: who hands over another is told which argument it was, what is wanted and what came.
//!
//! A parameter of a method says `#[pyo3(from_py_with = given::rover)]`: the function of its name reads it, whatever its
//! type in Rust. What pyo3 would say by itself names the argument in a traceback only.

use pyo3::PyClass;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyString};
use six_wheel_kinematics::presets::PRESETS;

use crate::controller::limits::Limits;
use crate::convert::{ArgumentTypeError, is_of_another_kind, number, refuse, short_repr};
use crate::costmap::Costmap;
use crate::ground::Stand;
use crate::odometry::gyroscope::Gyroscope;
use crate::odometry::preintegrated::Preintegrated;
use crate::odometry::values::Noise;
use crate::rover::Rover;
use crate::suspension::Suspension;
use crate::terrain::Terrain;

/// Letters of a value that are shown.
const LONGEST: usize = 60;

/// What an argument can be read as.
pub trait Wanted<'a, 'py>: Sized {
    /// The value, or why it is none.
    fn read(argument: &str, value: &'a Bound<'py, PyAny>) -> PyResult<Self>;
}

/// A function for each name.
macro_rules! named {
    ($($name:ident)*) => {$(
        pub fn $name<'a, 'py, T: Wanted<'a, 'py>>(value: &'a Bound<'py, PyAny>) -> PyResult<T> {
            T::read(stringify!($name), value)
        }
    )*};
}

named! {
    align align_tolerance allow_underdetermined arm belly castor correlation costmap covariances cover delay
    derivatives discretise driven errors false_alarm frame front gravity ground gyroscope history in_space inflate kernel
    lift_angle lift_speed limits map_error mass max_step method mode name noise other period readings rear residuals
    roughness rover shape slips smoothing spacing stand steer steered synchronise temperature threads timeout unmeasured view
    wheels_per_side within
}

/// "`argument` must be `kind`, got `value`", with a remedy where there is one.
pub fn other_kind(argument: &str, kind: &str, value: &Bound<'_, PyAny>, remedy: &str) -> PyErr {
    let shown = shown(value);
    let remedy = match remedy {
        "" => String::new(),
        remedy => format!(": give {remedy}"),
    };
    ArgumentTypeError::new_err(format!("{argument} must be {kind}, got {shown}{remedy}"))
}

/// A short value as it is, of a long one its class.
fn shown(value: &Bound<'_, PyAny>) -> String {
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

/// Fails where an argument of a function written in Python is not what its name says; `None` is no rover.
#[pyfunction]
pub fn check_kind(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
    match argument {
        "rover" => Bound::<Rover>::read(argument, value).map(drop),
        "noise" => Option::<Bound<'_, Noise>>::read(argument, value).map(drop),
        "gyroscope" => Option::<Bound<'_, Gyroscope>>::read(argument, value).map(drop),
        "limits" => Option::<Limits>::read(argument, value).map(drop),
        "ground" => Option::<Bound<'_, Terrain>>::read(argument, value).map(drop),
        _ => Err(refuse("argument", "be one that has a kind", argument)),
    }
}

/// What pyo3 reads by itself, under another complaint.
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

impl<'a, 'py> Wanted<'a, 'py> for f64 {
    fn read(argument: &str, value: &'a Bound<'py, PyAny>) -> PyResult<Self> {
        number(argument, value)
    }
}

impl<'a, 'py> Wanted<'a, 'py> for bool {
    fn read(argument: &str, value: &'a Bound<'py, PyAny>) -> PyResult<Self> {
        native(argument, "True or False", value)
    }
}

impl<'a, 'py> Wanted<'a, 'py> for String {
    fn read(argument: &str, value: &'a Bound<'py, PyAny>) -> PyResult<Self> {
        native(argument, "a str", value)
    }
}

/// Whole numbers, but for `True` and `False`.
macro_rules! whole {
    ($kind:ty, $words:literal) => {
        impl<'a, 'py> Wanted<'a, 'py> for $kind {
            fn read(argument: &str, value: &'a Bound<'py, PyAny>) -> PyResult<Self> {
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

impl<'a, 'py> Wanted<'a, 'py> for &'a str {
    fn read(argument: &str, value: &'a Bound<'py, PyAny>) -> PyResult<Self> {
        let text = value.cast::<PyString>();
        text.map_err(|_| other_kind(argument, "a str", value, ""))?.to_str()
    }
}

impl<'a, 'py, T: Wanted<'a, 'py>> Wanted<'a, 'py> for Option<T> {
    fn read(argument: &str, value: &'a Bound<'py, PyAny>) -> PyResult<Self> {
        match value.is_none() {
            true => Ok(None),
            false => T::read(argument, value).map(Some),
        }
    }
}

/// Several numbers, each of which may be the odd one.
macro_rules! numbers {
    ($count:literal: $($kind:ty)*) => {
        impl<'a, 'py> Wanted<'a, 'py> for ($($kind,)*) {
            fn read(argument: &str, value: &'a Bound<'py, PyAny>) -> PyResult<Self> {
                native(argument, concat!($count, " numbers"), value)
            }
        }
    };
}

numbers! { "three": f64 f64 f64 }
numbers! { "four": f64 f64 f64 f64 }

/// A class of this library.
pub trait Kind: PyClass {
    /// With its article.
    const KIND: &'static str;

    /// What to hand over instead of a value of another kind, in Python.
    fn remedy(value: &Bound<'_, PyAny>) -> String;
}

impl<'a, 'py, T: Kind> Wanted<'a, 'py> for Bound<'py, T> {
    fn read(argument: &str, value: &'a Bound<'py, PyAny>) -> PyResult<Self> {
        let found = value.cast::<T>();
        found.cloned().map_err(|_| other_kind(argument, T::KIND, value, &T::remedy(value)))
    }
}

impl<'a, 'py> Wanted<'a, 'py> for Limits {
    fn read(argument: &str, value: &'a Bound<'py, PyAny>) -> PyResult<Self> {
        Bound::<Self>::read(argument, value).map(|limits| limits.get().clone())
    }
}

/// Constructors whose keywords may have come as a dict, and one of them as a number.
fn made(class: &str, keyword: &str, value: &Bound<'_, PyAny>) -> String {
    if value.is_instance_of::<PyDict>() {
        return format!("sw.{class}(**...)");
    }
    let number = value.is_instance_of::<PyFloat>() || value.is_instance_of::<PyInt>();
    let number = if number { shown(value) } else { "...".into() };
    format!("sw.{class}({keyword}={number})")
}

fn word(value: &Bound<'_, PyAny>) -> Option<String> {
    value.extract().ok()
}

impl Kind for Rover {
    const KIND: &'static str = "a Rover";

    fn remedy(value: &Bound<'_, PyAny>) -> String {
        if value.is_instance_of::<Suspension>() {
            return "its planar(...), the rover seen from above".into();
        }
        match word(value) {
            Some(name) if PRESETS.iter().any(|preset| preset.name == name) => {
                format!("sw.Rover.preset({name:?})")
            }
            Some(_) => "sw.load(...) of a file, or sw.Rover.preset(...) of one of Rover.presets()".into(),
            None => "one that sw.Rover makes, or sw.load(...) of a file".into(),
        }
    }
}

impl Kind for Terrain {
    const KIND: &'static str = "a Terrain";

    fn remedy(value: &Bound<'_, PyAny>) -> String {
        match word(value) {
            Some(_) => format!("sw.Terrain.read({})", shown(value)),
            None => "sw.Terrain(heights, spacing=...)".into(),
        }
    }
}

/// Kinds, and what to hand over instead of a value of another one.
macro_rules! kinds {
    ($($class:ident, $kind:literal, $value:pat => $remedy:expr;)*) => {$(
        impl Kind for $class {
            const KIND: &'static str = $kind;

            fn remedy($value: &Bound<'_, PyAny>) -> String {
                $remedy
            }
        }
    )*};
}

kinds! {
    Suspension, "a Suspension, such as a RockerBogie", _ => "one like sw.RockerBogie.perseverance()".into();
    Noise, "a Noise", value => made("Noise", "speed", value);
    Gyroscope, "a Gyroscope", value => made("Gyroscope", "noise", value);
    Limits, "Limits", value => made("Limits", "speed", value);
    Costmap, "a Costmap", _ => "sw.Costmap(costs, spacing=...)".into();
    Preintegrated, "a Preintegrated", _ => String::new();
    Stand, "a Stand", _ => "what settle(...) has returned".into();
}
