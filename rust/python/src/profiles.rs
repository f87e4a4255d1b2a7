//! `six_wheel.profiles`: profiles of values, and the transitions of a rover built on them.

mod arguments;
mod made;
mod transitions;

use std::str::FromStr;

use numpy::Element;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use six_wheel_control::profiles as core;
use six_wheel_control::profiles::{Bounds, Moving, Synchronise};

use crate::convert::{Scalars, memory, number, raise, refuse, scalar_or_array, shape_text};
use crate::given;
use made::{Made, class, known_by_its_call};
pub use transitions::{BodyTransition, IcrTransition, ModuleTransition};

/// The course of one value or of several over time, with three derivatives.
///
/// Made by `linear`, `trapezoid`, `s_curve` and `time_optimal` of `six_wheel.profiles`. Immutable, hashable,
/// comparable, picklable.
#[pyclass(frozen, module = "six_wheel.profiles")]
pub struct Profile {
    core: core::Profile,
    /// Whether it has an axis of values, or is one number.
    is_vector: bool,
    made: Made,
}

/// One number, or one per axis.
struct Values {
    numbers: Vec<f64>,
    is_vector: bool,
}

impl Values {
    fn read(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<Self> {
        let scalars = Scalars::read(argument, value)?;
        match scalars.shape.as_slice() {
            [] | [_] if !scalars.flat().is_empty() => Ok(Self {
                numbers: memory::gathered(scalars.flat().iter().copied())?,
                is_vector: !scalars.shape.is_empty(),
            }),
            shape => {
                let rule = "be one number or have shape (axes,)";
                Err(refuse(argument, rule, &format!("shape {}", shape_text(shape))))
            }
        }
    }

    fn or(argument: &str, value: Option<&Bound<'_, PyAny>>, default: f64) -> PyResult<Self> {
        value.map_or_else(|| Ok(Self { numbers: vec![default], is_vector: false }), |value| Self::read(argument, value))
    }

    fn of_axis(&self, axis: usize) -> f64 {
        self.numbers[if self.is_vector { axis } else { 0 }]
    }

    fn to_python<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        // Plus zero: no minus zero.
        let numbers: Vec<f64> = self.numbers.iter().map(|number| number + 0.0).collect();
        if self.is_vector {
            Ok(PyTuple::new(py, numbers)?.into_any())
        } else {
            Ok(numbers[0].into_pyobject(py)?.into_any())
        }
    }
}

/// Number of axes of arguments that are one number or one per axis, and whether any is the latter.
fn axes(values: &[(&str, &Values)]) -> PyResult<(usize, bool)> {
    let mut count: Option<usize> = None;
    for (argument, values) in values.iter().filter(|(_, values)| values.is_vector) {
        let (known, own) = (count.unwrap_or(values.numbers.len()), values.numbers.len());
        if known != own {
            let rule = format!("be one number or have shape ({known},)");
            return Err(refuse(argument, &rule, &format!("shape ({own},)")));
        }
        count = Some(own);
    }
    Ok((count.unwrap_or(1), count.is_some()))
}

impl Profile {
    fn build(
        py: Python<'_>,
        maker: &'static str,
        core: Result<core::Profile, six_wheel_numerics::error::Error>,
        is_vector: bool,
        arguments: &[&Bound<'_, PyAny>],
        keywords: Bound<'_, PyDict>,
    ) -> PyResult<Self> {
        Ok(Self {
            core: core.map_err(|error| raise(error, &[]))?,
            is_vector,
            made: Made { maker, arguments: PyTuple::new(py, arguments)?.unbind(), keywords: keywords.unbind() },
        })
    }

    /// A profile of a given shape and duration.
    fn shaped(
        py: Python<'_>,
        maker: &'static str,
        [start, end, duration]: [&Bound<'_, PyAny>; 3],
        ramp: Option<f64>,
        shape: impl FnOnce(&[f64], &[f64], f64) -> Result<core::Profile, six_wheel_numerics::error::Error>,
    ) -> PyResult<Self> {
        let (start, end) = (Values::read("start", start)?, Values::read("end", end)?);
        let duration = number("duration", duration)?;
        let (count, is_vector) = axes(&[("start", &start), ("end", &end)])?;
        let each = |values: &Values| (0..count).map(|i| values.of_axis(i)).collect::<Vec<_>>();
        let core = shape(&each(&start), &each(&end), duration);
        let (start, end) = (start.to_python(py)?, end.to_python(py)?);
        let duration = duration.into_pyobject(py)?.into_any();
        let keywords = PyDict::new(py);
        if let Some(ramp) = ramp {
            keywords.set_item("ramp", ramp)?;
        }
        Self::build(py, maker, core, is_vector, &[&start, &end, &duration], keywords)
    }

    /// One value per axis as an array, or the only one as a float.
    fn per_axis(&self, py: Python<'_>, values: Vec<f64>) -> PyResult<Py<PyAny>> {
        let shape: &[usize] = if self.is_vector { &[values.len()] } else { &[] };
        scalar_or_array(py, values, shape)
    }
}

#[pymethods]
impl Profile {
    /// From start to end at constant velocity.
    ///
    /// Parameters
    /// ----------
    /// start, end : float or array_like, shape (axes,)
    ///     Values at both ends, in any unit.
    /// duration : float
    ///     How long it takes [s].
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a value is not finite, a shape does not fit, or the duration is not positive.
    #[staticmethod]
    fn linear(
        py: Python<'_>,
        start: &Bound<'_, PyAny>,
        end: &Bound<'_, PyAny>,
        duration: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        Self::shaped(py, "linear", [start, end, duration], None, core::linear)
    }

    /// Constant acceleration, constant velocity, constant deceleration: a trapezoid of the velocity.
    ///
    /// Parameters
    /// ----------
    /// start, end : float or array_like, shape (axes,)
    ///     Values at both ends, in any unit.
    /// duration : float
    ///     How long it takes [s].
    /// ramp : float, optional
    ///     How long it accelerates, and decelerates [s]; default a third of the duration, at most a half.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a value is not finite, a shape does not fit, or a time is not as said.
    #[staticmethod]
    #[pyo3(signature = (start, end, duration, *, ramp=None))]
    fn trapezoid(
        py: Python<'_>,
        start: &Bound<'_, PyAny>,
        end: &Bound<'_, PyAny>,
        duration: &Bound<'_, PyAny>,
        ramp: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let ramp = ramp.map(|ramp| number("ramp", ramp)).transpose()?;
        Self::shaped(py, "trapezoid", [start, end, duration], ramp, |start, end, duration| {
            core::trapezoid(start, end, duration, ramp.unwrap_or(duration / 3.0))
        })
    }

    /// A double S: the acceleration rises and falls at constant jerk. `peaks` states what it takes.
    ///
    /// Parameters
    /// ----------
    /// start, end : float or array_like, shape (axes,)
    ///     Values at both ends, in any unit.
    /// duration : float
    ///     How long it takes [s].
    /// ramp : float, optional
    ///     How long it accelerates, and decelerates [s]; the default and most is half the duration, which
    ///     takes the least jerk: over a distance d in the time T, velocity ``2 d / T``, acceleration
    ///     ``8 d / T**2`` and jerk ``32 d / T**3``. Less lowers the velocity, to ``d / (T - ramp)``.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a value is not finite, a shape does not fit, or a time is not as said.
    #[staticmethod]
    #[pyo3(signature = (start, end, duration, *, ramp=None))]
    fn s_curve(
        py: Python<'_>,
        start: &Bound<'_, PyAny>,
        end: &Bound<'_, PyAny>,
        duration: &Bound<'_, PyAny>,
        ramp: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let ramp = ramp.map(|ramp| number("ramp", ramp)).transpose()?;
        Self::shaped(py, "s_curve", [start, end, duration], ramp, |start, end, duration| {
            core::s_curve(start, end, duration, ramp.unwrap_or(duration / 2.0))
        })
    }

    /// The fastest course within limits of velocity, acceleration and jerk, from any motion to any other.
    ///
    /// Every argument but the last two is one number or one per axis.
    ///
    /// Parameters
    /// ----------
    /// start, end : float or array_like, shape (axes,)
    ///     Values at both ends, in any unit.
    /// velocity, acceleration, jerk : float or array_like, shape (axes,)
    ///     Largest magnitudes, per [s], [s^2] and [s^3]; infinite, the default of the last two, where there
    ///     is no limit. A start beyond them is first brought within, as fast as they allow.
    /// start_velocity, start_acceleration, end_velocity, end_acceleration : float or array_like, optional
    ///     How it moves at both ends, default 0. Accelerations count where the jerk is limited.
    /// minimum_velocity, minimum_acceleration : float or array_like, optional
    ///     Limits of the other direction, negative; default those of the one.
    /// duration : float, optional
    ///     Stretch the profile to this time [s]; default the least possible.
    /// synchronise : {'time', 'phase', 'none'}
    ///     Whether all axes arrive together, also stay in proportion to each other (where the moving ends
    ///     allow it), or take their own least time each; with a duration, all take that.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a value is not finite, a limit not of its sign, an end outside the limits, or the duration
    ///     shorter than the least one, which is named.
    ///
    /// Source: L. Berscheid, T. Kröger, Jerk-limited Real-time Trajectory Generation with Arbitrary Target
    /// States, RSS 2021; computed by the crate rsruckig.
    #[staticmethod]
    #[pyo3(signature = (start, end, *, velocity, acceleration=None, jerk=None, start_velocity=None,
        start_acceleration=None, end_velocity=None, end_acceleration=None, minimum_velocity=None,
        minimum_acceleration=None, duration=None, synchronise="time"))]
    #[allow(clippy::too_many_arguments)] // they are keywords
    fn time_optimal(
        py: Python<'_>,
        start: &Bound<'_, PyAny>,
        end: &Bound<'_, PyAny>,
        velocity: &Bound<'_, PyAny>,
        acceleration: Option<&Bound<'_, PyAny>>,
        jerk: Option<&Bound<'_, PyAny>>,
        start_velocity: Option<&Bound<'_, PyAny>>,
        start_acceleration: Option<&Bound<'_, PyAny>>,
        end_velocity: Option<&Bound<'_, PyAny>>,
        end_acceleration: Option<&Bound<'_, PyAny>>,
        minimum_velocity: Option<&Bound<'_, PyAny>>,
        minimum_acceleration: Option<&Bound<'_, PyAny>>,
        duration: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = given::synchronise)] synchronise: &str,
    ) -> PyResult<Self> {
        let keywords = PyDict::new(py);
        let read = |argument, given: Option<&Bound<'_, PyAny>>, default| {
            let values = Values::or(argument, given, default)?;
            if given.is_some() && (values.is_vector || values.numbers[0] != default) {
                keywords.set_item(argument, values.to_python(py)?)?;
            }
            PyResult::Ok(values)
        };
        let ends = [Values::read("start", start)?, Values::read("end", end)?];
        let given = [
            read("velocity", Some(velocity), f64::NAN)?,
            read("acceleration", acceleration, f64::INFINITY)?,
            read("jerk", jerk, f64::INFINITY)?,
            read("start_velocity", start_velocity, 0.0)?,
            read("start_acceleration", start_acceleration, 0.0)?,
            read("end_velocity", end_velocity, 0.0)?,
            read("end_acceleration", end_acceleration, 0.0)?,
        ];
        // NaN stands for the mirror image of the other limit, so it may not come from outside.
        let mirrored = |argument, value: Option<&Bound<'_, PyAny>>| {
            let values = value.map(|value| Values::read(argument, value)).transpose()?;
            match values {
                Some(values) if values.numbers.iter().any(|number| number.is_nan()) => {
                    Err(refuse(argument, "be negative", "nan"))
                }
                Some(values) => {
                    keywords.set_item(argument, values.to_python(py)?)?;
                    Ok(values)
                }
                None => Values::or(argument, None, f64::NAN),
            }
        };
        let slowest = mirrored("minimum_velocity", minimum_velocity)?;
        let weakest = mirrored("minimum_acceleration", minimum_acceleration)?;
        let duration = duration.map(|time| number("duration", time)).transpose()?;
        if let Some(duration) = duration {
            keywords.set_item("duration", duration)?;
        }
        if synchronise != "time" {
            keywords.set_item("synchronise", synchronise)?;
        }
        let names = [
            "velocity",
            "acceleration",
            "jerk",
            "start_velocity",
            "start_acceleration",
            "end_velocity",
            "end_acceleration",
        ];
        let mut all = vec![("start", &ends[0]), ("end", &ends[1])];
        all.extend(names.into_iter().zip(&given));
        all.extend([("minimum_velocity", &slowest), ("minimum_acceleration", &weakest)]);
        let (count, is_vector) = axes(&all)?;
        let moving = |value: &Values, velocity: &Values, acceleration: &Values| {
            let of_axis = |i| Moving {
                value: value.of_axis(i),
                velocity: velocity.of_axis(i),
                acceleration: acceleration.of_axis(i),
            };
            (0..count).map(of_axis).collect::<Vec<_>>()
        };
        let [velocity, acceleration, jerk, ..] = &given;
        let or_mirrored = |limit: f64, other: f64| if limit.is_nan() { -other } else { limit };
        let bounds = |i: usize| Bounds {
            velocity: velocity.of_axis(i),
            minimum_velocity: or_mirrored(slowest.of_axis(i), velocity.of_axis(i)),
            acceleration: acceleration.of_axis(i),
            minimum_acceleration: or_mirrored(weakest.of_axis(i), acceleration.of_axis(i)),
            jerk: jerk.of_axis(i),
        };
        let synchronise = Synchronise::from_str(synchronise).map_err(|error| raise(error, &[]))?;
        let core = core::time_optimal(
            &moving(&ends[0], &given[3], &given[4]),
            &moving(&ends[1], &given[5], &given[6]),
            &(0..count).map(bounds).collect::<Vec<_>>(),
            synchronise,
            duration,
        );
        let [start, end] = [ends[0].to_python(py)?, ends[1].to_python(py)?];
        Self::build(py, "time_optimal", core, is_vector, &[&start, &end], keywords)
    }

    /// How long it takes until the last axis arrives [s].
    #[getter]
    fn duration(&self) -> f64 {
        self.core.duration()
    }

    /// How long each axis takes [s]: a float, or an array of shape (axes,).
    #[getter]
    fn durations(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.per_axis(py, self.core.durations().collect())
    }

    /// Largest magnitudes: a `Peaks` of velocity, acceleration and jerk, each a float or of shape (axes,).
    #[getter]
    fn peaks<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let part = |k: usize| self.per_axis(py, self.core.peaks().map(|peaks| peaks[k]).collect());
        class(py, "Peaks")?.call1((part(0)?, part(1)?, part(2)?))
    }

    /// Value and derivatives at one time or many.
    ///
    /// Before 0 it rests at the start and after its end at the end, without derivatives; at both instants
    /// themselves it has the derivatives asked for there.
    ///
    /// Parameters
    /// ----------
    /// times : float or array_like, shape (...)
    ///     [s]
    ///
    /// Returns
    /// -------
    /// State
    ///     ``value, velocity, acceleration, jerk``, each of shape (...) or (..., axes).
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a time is not finite.
    fn at<'py>(&self, py: Python<'py>, times: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let times = Scalars::read("times", times)?;
        times.check_finite("times")?;
        let width = self.core.width();
        let mut parts: [Vec<f64>; 4] = Default::default();
        let count = memory::count(&[times.flat().len(), width])?;
        for part in &mut parts {
            *part = memory::room(count)?;
        }
        for &time in times.flat() {
            for axis in 0..width {
                let state = self.core.at(axis, time);
                for (part, value) in parts.iter_mut().zip(state) {
                    part.push(value);
                }
            }
        }
        let mut shape = times.shape.clone();
        if self.is_vector {
            shape.push(width);
        }
        let [value, velocity, acceleration, jerk] = parts.map(|part| shaped(py, part, &shape));
        class(py, "State")?.call1((value?, velocity?, acceleration?, jerk?))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        self.made.repr(py)
    }
}

known_by_its_call!(Profile);

/// Numbers in an array of this shape; the only one itself if the shape is empty.
fn shaped<T: Element>(py: Python<'_>, values: Vec<T>, shape: &[usize]) -> PyResult<Py<PyAny>> {
    scalar_or_array(py, values, shape)
}
