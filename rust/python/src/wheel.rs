//! `six_wheel.Wheel`: one wheel, as data.

use std::hash::{DefaultHasher, Hash, Hasher};

use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyString, PyTuple};
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_kinematics::wheels::{Pivot, Wheel as Core};

use crate::convert::{number, raise, refuse};
use crate::given;

/// One wheel of a rover: where its pivot is, which way it rolls, whether it steers.
///
/// Parameters
/// ----------
/// name : str
///     Unique within its rover.
/// x, y : float
///     Pivot in body axes, forward and left of the origin [m].
/// radius : float
///     Hub to ground [m].
/// steered : bool
///     Whether it turns about a vertical axis at the pivot.
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
///     Whether it has a motor; default True, False for a castor.
/// castor : bool
///     Whether it swivels freely behind its pivot, by its trail.
///
/// Raises
/// ------
/// ValueError
///     If a number is not finite, the radius or the limit not positive, or a fixed wheel has a limit.
///
/// Source: R. Siegwart, I. Nourbakhsh, D. Scaramuzza, Introduction to Autonomous Mobile Robots, 2nd ed., ch. 3.
#[pyclass(frozen, module = "six_wheel", from_py_object)]
#[derive(Clone)]
pub struct Wheel(pub Core);

/// A symmetric limit, a pair of limits, or nothing.
pub fn steering_range(limit: Option<&Bound<'_, PyAny>>) -> PyResult<Option<SteeringRange>> {
    let Some(limit) = limit else { return Ok(None) };
    let range = match limit.extract::<[Bound<'_, PyAny>; 2]>() {
        Ok([lower, upper]) => {
            let (lower, upper) = (number("steering_limit[0]", &lower)?, number("steering_limit[1]", &upper)?);
            let range = SteeringRange { lower, upper };
            range.check().map(|()| range)
        }
        Err(_) => SteeringRange::symmetric(number("steering_limit", limit)?),
    };
    range.map(Some).map_err(|error| raise(error, &[]))
}

/// The argument of [`steering_range`] that makes this range.
pub fn steering_limit(range: SteeringRange) -> String {
    if range.lower == -range.upper { format!("{:?}", range.upper) } else { range.to_string() }
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

#[pymethods]
impl Wheel {
    #[new]
    #[pyo3(
        signature = (name, x, y, *, radius, steered=false, heading=None, steering_limit=None, scrub=None, trail=None, roller_angle=None, driven=None, castor=false),
        text_signature = "(name, x, y, *, radius, steered=False, heading=0.0, steering_limit=None, scrub=0.0, trail=0.0, roller_angle=None, driven=None, castor=False)"
    )]
    #[allow(clippy::too_many_arguments)] // they are keywords
    fn new(
        #[pyo3(from_py_with = given::name)] name: String,
        x: &Bound<'_, PyAny>,
        y: &Bound<'_, PyAny>,
        radius: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = given::steered)] steered: bool,
        heading: Option<&Bound<'_, PyAny>>,
        steering_limit: Option<&Bound<'_, PyAny>>,
        scrub: Option<&Bound<'_, PyAny>>,
        trail: Option<&Bound<'_, PyAny>>,
        roller_angle: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = given::driven)] driven: Option<bool>,
        #[pyo3(from_py_with = given::castor)] castor: bool,
    ) -> PyResult<Self> {
        let optional =
            |argument, value: Option<&Bound<'_, PyAny>>| value.map_or(Ok(0.0), |value| number(argument, value));
        let range = steering_range(steering_limit)?;
        if range.is_some() && !steered {
            let text = steering_limit.map_or_else(String::new, ToString::to_string);
            let rule = "be left out for a wheel that is not steered";
            return Err(refuse("steering_limit", rule, &text));
        }
        if castor && (steered || driven == Some(true)) {
            let rule = "be neither steered nor driven";
            return Err(refuse("castor", rule, "a wheel that is"));
        }
        let pivot = match (castor, steered) {
            (true, _) => Pivot::Castor,
            (_, true) => Pivot::Steered(range.unwrap_or_default()),
            _ => Pivot::Fixed,
        };
        let wheel = Core {
            name,
            x: number("x", x)?,
            y: number("y", y)?,
            radius: number("radius", radius)?,
            heading: optional("heading", heading)?,
            pivot,
            scrub: optional("scrub", scrub)?,
            trail: optional("trail", trail)?,
            roller_angle: roller_angle.map(|angle| number("roller_angle", angle)).transpose()?,
            driven: driven.unwrap_or(!castor),
        };
        wheel.check().map_err(|error| raise(error, &[]))?;
        Ok(Self(wheel))
    }

    /// Unique within its rover.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }

    /// Pivot, forward of the body's origin [m].
    #[getter]
    fn x(&self) -> f64 {
        self.0.x
    }

    /// Pivot, left of the body's origin [m].
    #[getter]
    fn y(&self) -> f64 {
        self.0.y
    }

    /// Hub to ground [m].
    #[getter]
    fn radius(&self) -> f64 {
        self.0.radius
    }

    /// Whether it turns about a vertical axis at the pivot.
    #[getter]
    fn steered(&self) -> bool {
        self.0.steering().is_some()
    }

    /// Direction in which it rolls at steering angle 0 [rad].
    #[getter]
    fn heading(&self) -> f64 {
        self.0.heading
    }

    /// Smallest and largest steering angle [rad]; None for a fixed wheel.
    #[getter]
    fn steering_range(&self) -> Option<(f64, f64)> {
        self.0.steering().map(|range| (range.lower, range.upper))
    }

    /// The argument of that name [rad]: largest angle to either side, or smallest and largest; None for a
    /// fixed wheel.
    #[getter]
    fn steering_limit<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let limit = |range: SteeringRange| {
            if range.lower == -range.upper {
                Ok(PyFloat::new(py, range.upper).into_any())
            } else {
                Ok((range.lower, range.upper).into_pyobject(py)?.into_any())
            }
        };
        self.0.steering().map(limit).transpose()
    }

    /// Contact to the left of the steering axis [m].
    #[getter]
    fn scrub(&self) -> f64 {
        self.0.scrub
    }

    /// Contact behind the steering axis [m].
    #[getter]
    fn trail(&self) -> f64 {
        self.0.trail
    }

    /// Between the axes of its rollers and its own [rad]; None without rollers.
    #[getter]
    fn roller_angle(&self) -> Option<f64> {
        self.0.roller_angle
    }

    /// Whether it has a motor.
    #[getter]
    fn driven(&self) -> bool {
        self.0.driven
    }

    /// Whether it swivels freely behind its pivot.
    #[getter]
    fn castor(&self) -> bool {
        self.0.pivot == Pivot::Castor
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let wheel = &self.0;
        let name = PyString::new(py, &wheel.name).repr()?;
        let mut text = format!("Wheel({name}, {:?}, {:?}, radius={:?}", wheel.x, wheel.y, wheel.radius);
        if let Some(range) = wheel.steering() {
            text += ", steered=True";
            if range != SteeringRange::default() {
                text += &format!(", steering_limit={}", steering_limit(range));
            }
        }
        let rest = [("heading", wheel.heading), ("scrub", wheel.scrub), ("trail", wheel.trail)];
        for (argument, value) in rest.iter().filter(|(_, value)| *value != 0.0) {
            text += &format!(", {argument}={value:?}");
        }
        if let Some(angle) = wheel.roller_angle {
            text += &format!(", roller_angle={angle:?}");
        }
        if wheel.pivot == Pivot::Castor {
            text += ", castor=True";
        } else if !wheel.driven {
            text += ", driven=False";
        }
        Ok(text + ")")
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get().0 == self.0)
    }

    fn __hash__(&self) -> u64 {
        let mut state = DefaultHasher::new();
        hash_wheel(&self.0, &mut state);
        state.finish()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let (py, wheel) = (slf.py(), &slf.get().0);
        let keywords = PyDict::new(py);
        keywords.set_item("radius", wheel.radius)?;
        keywords.set_item("steered", wheel.steering().is_some())?;
        keywords.set_item("heading", wheel.heading)?;
        keywords.set_item("steering_limit", wheel.steering().map(|range| (range.lower, range.upper)))?;
        keywords.set_item("scrub", wheel.scrub)?;
        keywords.set_item("trail", wheel.trail)?;
        keywords.set_item("roller_angle", wheel.roller_angle)?;
        keywords.set_item("driven", wheel.driven)?;
        keywords.set_item("castor", wheel.pivot == Pivot::Castor)?;
        let arguments = (wheel.name.as_str(), wheel.x, wheel.y).into_pyobject(py)?;
        reduce(slf.as_any(), &arguments, &keywords)
    }
}

/// What pickle needs to call a class again with the same arguments.
pub fn reduce<'py>(
    object: &Bound<'py, PyAny>,
    arguments: &Bound<'py, PyTuple>,
    keywords: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyTuple>> {
    let py = object.py();
    let rebuild = py.import("copyreg")?.getattr(intern!(py, "__newobj_ex__"))?;
    let call = (object.get_type(), arguments, keywords);
    (rebuild, call).into_pyobject(py)
}
