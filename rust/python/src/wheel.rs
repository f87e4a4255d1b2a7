//! `six_wheel.Wheel`: one wheel, as data.

use std::hash::{DefaultHasher, Hash, Hasher};

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyString, PyTuple};
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_kinematics::units;
use six_wheel_kinematics::wheels::{Pivot, Wheel as Core};

use crate::classes::reduce;
use crate::convert::{OrRaise, pair_or_one, refuse};
use crate::unit_warnings::warn_units;

/// One wheel of a rover: where its pivot is, which way it rolls, whether it steers.
#[doc = section!(Parameters)]
/// name : str
///     Unique within its rover.
/// x, y : float
///     Pivot in body axes, forward and left of the origin [m].
/// radius : float
///     Hub to ground [m].
/// steered : bool
///     True if the wheel has a steering joint with a vertical axis at the pivot.
/// heading : float, default 0.0
///     Direction in which it rolls at steering angle 0 [rad].
/// steering_limit : float or (float, float), optional
///     Largest steering angle to either side, or smallest and largest [rad]. Without it a quarter turn to
///     either side, enough to roll in every direction, backwards if need be.
/// scrub : float, default 0.0
///     Contact to the left of the steering axis [m].
/// trail : float, default 0.0
///     Contact behind the steering axis [m].
/// roller_angle : float, optional
///     Between the axes of its rollers and its own [rad]: a quarter turn for an omni wheel, an eighth for a
///     mecanum wheel.
/// driven : bool, optional
///     True if the wheel has a motor; default True, False for a castor.
/// castor : bool
///     True if the wheel swivels freely behind its pivot, by its trail.
#[doc = raises!("If a number is not finite, the radius or the limit not positive, or a fixed wheel has a limit.")]
///
/// Source: R. Siegwart, I. Nourbakhsh, D. Scaramuzza, Introduction to Autonomous Mobile Robots, 2nd ed., ch. 3.
#[pyclass(frozen, module = "six_wheel", from_py_object)]
#[derive(Clone)]
pub struct Wheel(pub Core);

/// A symmetric limit, a pair of limits, or nothing.
pub fn steering_range(limit: Option<&Bound<'_, PyAny>>) -> PyResult<Option<SteeringRange>> {
    let Some(limit) = limit else { return Ok(None) };
    let range = match pair_or_one("steering_limit", limit)? {
        Ok([lower, upper]) => {
            let range = SteeringRange { lower, upper };
            range.check().map(|()| range)
        }
        Err(limit) => SteeringRange::symmetric(limit),
    };
    range.map(Some).or_raise(&[])
}

/// The argument of [`steering_range`] that makes this range, as Python text.
pub fn steering_limit(range: SteeringRange) -> String {
    match (range.lower == -range.upper, range.upper.is_finite()) {
        (true, true) => format!("{:?}", range.upper),
        (true, false) => "float('inf')".into(),
        _ => format!("({:?}, {:?})", range.lower, range.upper),
    }
}

impl Wheel {
    /// The arguments of the constructor beside name and place that are not the default ones.
    fn keywords<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let wheel = &self.0;
        let keywords = PyDict::new(py);
        keywords.set_item("radius", wheel.radius)?;
        if let Some(range) = wheel.steering() {
            keywords.set_item("steered", true)?;
            if range != SteeringRange::default() {
                keywords.set_item("steering_limit", self.steering_limit(py)?)?;
            }
        }
        for (argument, value) in by_name!(wheel, heading scrub trail).into_iter().filter(|(_, value)| *value != 0.0) {
            keywords.set_item(argument, value)?;
        }
        if let Some(angle) = wheel.roller_angle {
            keywords.set_item("roller_angle", angle)?;
        }
        if wheel.pivot == Pivot::Castor {
            keywords.set_item("castor", true)?;
        } else if !wheel.driven {
            keywords.set_item("driven", false)?;
        }
        Ok(keywords)
    }
}

/// Hashes a wheel so that equal wheels, zeros of either sign included, hash alike.
pub fn hash_wheel(wheel: &Core, state: &mut impl Hasher) {
    wheel.name.hash(state);
    let range = wheel.steering().map(|range| [range.lower, range.upper]);
    let numbers = [wheel.x, wheel.y, wheel.radius, wheel.heading, wheel.scrub, wheel.trail];
    (wheel.driven, wheel.pivot == Pivot::Castor).hash(state);
    let optional = range.into_iter().flatten().chain(wheel.roller_angle);
    for value in numbers.into_iter().chain(optional) {
        (value + 0.0).to_bits().hash(state);
    }
}

getters! { Wheel, self, py:
    /// Unique within its rover.
    name: &str = &self.0.name;
    /// Pivot, forward of the body's origin [m].
    x: f64 = self.0.x;
    /// Pivot, left of the body's origin [m].
    y: f64 = self.0.y;
    /// Hub to ground [m].
    radius: f64 = self.0.radius;
    /// True if the wheel has a steering joint with a vertical axis at the pivot.
    steered: bool = self.0.steering().is_some();
    /// Direction in which the wheel rolls at steering angle 0 [rad].
    heading: f64 = self.0.heading;
    /// Smallest and largest steering angle [rad]; None for a fixed wheel.
    steering_range: Option<(f64, f64)> = self.0.steering().map(|range| (range.lower, range.upper));
    /// Contact to the left of the steering axis [m].
    scrub: f64 = self.0.scrub;
    /// Contact behind the steering axis [m].
    trail: f64 = self.0.trail;
    /// Between the axes of its rollers and its own [rad]; None without rollers.
    roller_angle: Option<f64> = self.0.roller_angle;
    /// True if the wheel has a motor.
    driven: bool = self.0.driven;
    /// True if the wheel swivels freely behind its pivot.
    castor: bool = self.0.pivot == Pivot::Castor;
    /// The argument of that name [rad]: largest angle to either side, or smallest and largest; None for a
    /// fixed wheel.
    steering_limit: PyResult<Option<Bound<'py, PyAny>>> = {
        let limit = |range: SteeringRange| {
            if range.lower == -range.upper {
                Ok(PyFloat::new(py, range.upper).into_any())
            } else {
                Ok((range.lower, range.upper).into_pyobject(py)?.into_any())
            }
        };
        self.0.steering().map(limit).transpose()
    };
}

equal_by!(Wheel: 0);
replaceable!(Wheel);

methods! { Wheel:
    #[new]
    fn new[py: Python<'py>](name: String, x: f64, y: f64, *, radius: f64, steered: bool = false,
        heading: Option<f64> = None, steering_limit=None, scrub: Option<f64> = None, trail: Option<f64> = None,
        roller_angle: Option<f64> = None, driven: Option<bool> = None, castor: bool = false, **)
    as "(name, x, y, *, radius, steered=False, heading=0.0, steering_limit=None, scrub=0.0, trail=0.0, roller_angle=None, driven=None, castor=False)"
    -> PyResult<Self> {
        let range = steering_range(steering_limit)?;
        if range.is_some() && !steered {
            let text = steering_limit.map_or_else(String::new, ToString::to_string);
            return Err(refuse("steering_limit", "be left out for a wheel that is not steered", &text));
        }
        if castor && (steered || driven == Some(true)) {
            return Err(refuse("castor", "be neither steered nor driven", "a wheel that is"));
        }
        let pivot = match (castor, steered) {
            (true, _) => Pivot::Castor,
            (_, true) => Pivot::Steered(range.unwrap_or_default()),
            _ => Pivot::Fixed,
        };
        let wheel = Core {
            name,
            x,
            y,
            radius,
            heading: heading.unwrap_or_default(),
            pivot,
            scrub: scrub.unwrap_or_default(),
            trail: trail.unwrap_or_default(),
            roller_angle,
            driven: driven.unwrap_or(!castor),
        };
        wheel.check().or_raise(&[])?;
        warn_units(py, units::wheel(&wheel))?;
        Ok(Self(wheel))
    }
}

#[pymethods]
impl Wheel {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let wheel = &self.0;
        let mut text = format!("Wheel({}, {:?}, {:?}", PyString::new(py, &wheel.name).repr()?, wheel.x, wheel.y);
        for (argument, value) in self.keywords(py)?.iter() {
            let range = wheel.steering().filter(|_| argument.eq("steering_limit").unwrap_or_default());
            let value =
                range.map_or_else(|| value.repr().map(|text| text.to_string()), |range| Ok(steering_limit(range)))?;
            text += &format!(", {argument}={value}");
        }
        Ok(text + ")")
    }

    fn __hash__(&self) -> u64 {
        let mut state = DefaultHasher::new();
        hash_wheel(&self.0, &mut state);
        state.finish()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let (py, wheel) = (slf.py(), slf.get());
        let arguments = (wheel.0.name.as_str(), wheel.0.x, wheel.0.y).into_pyobject(py)?;
        reduce(slf.as_any(), &arguments, &wheel.keywords(py)?)
    }
}
