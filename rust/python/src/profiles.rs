//! `six_wheel.kinematics.profiles`: profiles of values, and the transitions of a rover built on them.

mod inputs;
mod made;
mod time_optimal;
mod transitions;

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use six_wheel_control::profiles as core;

use crate::convert::{OrRaise, Results, Rows, joined, scalar_or_array};
use inputs::{axes, to_python, values};
use made::{ConstructorCall, class, known_by_its_call, printed_by_its_call};
pub use transitions::{BodyTransition, IcrTransition, ModuleTransition};

/// The course of one value or of several over time, with three derivatives.
///
/// Made by `linear`, `trapezoid`, `s_curve` and `time_optimal` of `six_wheel.kinematics.profiles`. Immutable, hashable,
/// comparable, picklable.
#[pyclass(frozen, module = "six_wheel.kinematics.profiles")]
pub struct Profile {
    core: core::Profile,
    /// True for an axis of values, false for one number.
    is_vector: bool,
    made: ConstructorCall,
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
        let (arguments, keywords) = (PyTuple::new(py, arguments)?.unbind(), keywords.unbind());
        Ok(Self { core: core.or_raise(&[])?, is_vector, made: ConstructorCall { maker, arguments, keywords } })
    }

    /// A profile of a given shape and duration.
    fn shaped(
        py: Python<'_>,
        maker: &'static str,
        [start, end]: [&Bound<'_, PyAny>; 2],
        duration: f64,
        ramp: Option<f64>,
        shape: impl FnOnce(&[f64], &[f64], f64) -> Result<core::Profile, six_wheel_numerics::error::Error>,
    ) -> PyResult<Self> {
        let ends = [values("start", start)?, values("end", end)?];
        let (count, is_vector) = axes(&ends)?;
        let each = |k: usize| (0..count).map(|i| ends[k].steps().get(i)).collect::<Vec<_>>();
        let core = shape(&each(0), &each(1), duration);
        let (start, end) = (to_python(py, &ends[0])?, to_python(py, &ends[1])?);
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

getters! { Profile, self, py:
    /// Time until the last axis arrives [s].
    duration: f64 = self.core.duration();
    /// Duration of each axis [s]: a float, or an array of shape (axes,).
    durations: PyResult<Py<PyAny>> = self.per_axis(py, self.core.durations().collect());
    /// Largest magnitudes: a `Peaks` of velocity, acceleration and jerk, each a float or of shape (axes,).
    peaks: PyResult<Bound<'py, PyAny>> = {
        let part = |k: usize| self.per_axis(py, self.core.peaks().map(|peaks| peaks[k]).collect());
        class(py, "Peaks")?.call1((part(0)?, part(1)?, part(2)?))
    };
}

methods! { Profile:
    /// From start to end at constant velocity.
    #[doc = section!(Parameters: ends, duration)]
    #[doc = raises!("If a value is not finite, a shape does not fit, or the duration is not positive.")]
    #[staticmethod]
    fn linear[py: Python<'py>](start, end, duration: f64, **)
    as "(start, end, duration)" -> PyResult<Self> {
        Self::shaped(py, "linear", [start, end], duration, None, core::linear)
    }

    /// Constant acceleration, constant velocity, constant deceleration: a trapezoid of the velocity.
    #[doc = section!(Parameters: ends, duration)]
    /// ramp : float, optional
    ///     Duration of the acceleration, and of the deceleration [s]; default a third of the duration, at most a half.
    #[doc = raises!("If a value is not finite, a shape does not fit, or a time is not as said.")]
    #[staticmethod]
    fn trapezoid[py: Python<'py>](start, end, duration: f64, *, ramp: Option<f64> = None, **)
    as "(start, end, duration, *, ramp=None)" -> PyResult<Self> {
        Self::shaped(py, "trapezoid", [start, end], duration, ramp, |start, end, duration| {
            core::trapezoid(start, end, duration, ramp.unwrap_or(duration / 3.0))
        })
    }

    /// A double S: the acceleration rises and falls at constant jerk. `peaks` states what it takes.
    #[doc = section!(Parameters: ends, duration)]
    /// ramp : float, optional
    ///     Duration of the acceleration, and of the deceleration [s]; the default and most is half the duration, which
    ///     takes the least jerk: over a distance d in the time T, velocity ``2 d / T``, acceleration
    ///     ``8 d / T**2`` and jerk ``32 d / T**3``. Less lowers the velocity, to ``d / (T - ramp)``.
    #[doc = raises!("If a value is not finite, a shape does not fit, or a time is not as said.")]
    #[staticmethod]
    fn s_curve[py: Python<'py>](start, end, duration: f64, *, ramp: Option<f64> = None, **)
    as "(start, end, duration, *, ramp=None)" -> PyResult<Self> {
        Self::shaped(py, "s_curve", [start, end], duration, ramp, |start, end, duration| {
            core::s_curve(start, end, duration, ramp.unwrap_or(duration / 2.0))
        })
    }

    /// Value and derivatives at one time or many.
    ///
    /// Before 0 it rests at the start and after its end at the end, without derivatives; at both instants
    /// themselves it has the derivatives asked for there.
    #[doc = section!(Parameters)]
    /// times : float or array_like, shape (...)
    ///     [s]
    #[doc = returns!("State": "``value, velocity, acceleration, jerk``, each of shape (...) or (..., axes).")]
    #[doc = raises!("If a time is not finite.")]
    fn at[&self, py: Python<'py>](times) -> PyResult<Bound<'py, PyAny>> {
        let times = Rows::read_numbers("times", times)?.finite()?;
        let width = self.core.width();
        let shape = if self.is_vector { joined(&times.leading, width) } else { times.leading.clone() };
        let mut results = Results::fresh(py, [(); 4].map(|()| shape.clone()))?;
        let mut parts = results.flat();
        for (k, &time) in times.flat().iter().enumerate() {
            for axis in 0..width {
                for (part, value) in parts.iter_mut().zip(self.core.at(axis, time)) {
                    part[k * width + axis] = value;
                }
            }
        }
        let [value, velocity, acceleration, jerk] = results.finish()?;
        class(py, "State")?.call1((value, velocity, acceleration, jerk))
    }
}

known_by_its_call!(Profile);
printed_by_its_call!(Profile);
