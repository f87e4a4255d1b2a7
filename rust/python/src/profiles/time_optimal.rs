//! `six_wheel.kinematics.profiles.time_optimal`.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use six_wheel_control::profiles::{self as core, AxisState, Bounds, Synchronise};

use super::Profile;
use super::inputs::{axes, to_python, values};
use crate::convert::{Broadcast, OrRaise, Rows, refuse};

/// Arguments by name, and as keywords where they differ from their defaults.
struct Given<'py> {
    keywords: Bound<'py, PyDict>,
    all: Vec<Rows<'py>>,
}

impl<'py> Given<'py> {
    fn read(&mut self, argument: &'static str, value: Option<&Bound<'py, PyAny>>, default: f64) -> PyResult<()> {
        let values = value.map_or_else(|| Ok(Rows::number(argument, default)), |value| values(argument, value))?;
        if value.is_some() && (!values.is_single() || values.flat()[0] != default) {
            self.keywords.set_item(argument, to_python(self.keywords.py(), &values)?)?;
        }
        self.all.push(values);
        Ok(())
    }

    /// Reads a lower limit. NaN stands for the mirror image of the upper one, so it may not come from outside.
    fn read_mirrored(&mut self, argument: &'static str, value: Option<&Bound<'py, PyAny>>) -> PyResult<()> {
        self.read(argument, value, f64::NAN)?;
        let read = self.all.last().filter(|_| value.is_some());
        if read.is_some_and(|values| values.flat().iter().any(|number| number.is_nan())) {
            return Err(refuse(argument, "be negative", "nan"));
        }
        Ok(())
    }

    /// The number of an argument for an axis.
    fn at(&self, argument: &str, axis: usize) -> f64 {
        let found = self.all.iter().find(|values| values.argument() == argument);
        found.map_or(f64::NAN, |values| values.steps().get(axis))
    }

    /// Value, velocity and acceleration of every axis, by the names of these arguments.
    fn state(&self, count: usize, names: [&str; 3]) -> Vec<AxisState> {
        let of_axis = |axis| names.map(|name| self.at(name, axis));
        (0..count)
            .map(of_axis)
            .map(|[value, velocity, acceleration]| AxisState { value, velocity, acceleration })
            .collect()
    }

    /// Limits of every axis.
    fn bounds(&self, count: usize) -> Vec<Bounds> {
        let lower = |limit: f64, upper: f64| if limit.is_nan() { -upper } else { limit };
        let of_axis = |axis| {
            let (velocity, acceleration) = (self.at("velocity", axis), self.at("acceleration", axis));
            Bounds {
                velocity,
                min_velocity: lower(self.at("min_velocity", axis), velocity),
                acceleration,
                min_acceleration: lower(self.at("min_acceleration", axis), acceleration),
                jerk: self.at("jerk", axis),
            }
        };
        (0..count).map(of_axis).collect()
    }
}

methods! { Profile:
    /// The fastest course within limits of velocity, acceleration and jerk, from any motion to any other.
    ///
    /// Every argument but the last two is one number or one per axis.
    #[doc = section!(Parameters: ends)]
    /// velocity, acceleration, jerk : float or array_like, shape (axes,)
    ///     Largest magnitudes, per [s], [s^2] and [s^3]; infinite, the default of the last two, where there
    ///     is no limit. A start beyond them is first brought within, as fast as they allow.
    /// start_velocity, start_acceleration, end_velocity, end_acceleration : float or array_like, optional
    ///     State of motion at both ends, default 0. Accelerations count where the jerk is limited.
    /// min_velocity, min_acceleration : float or array_like, optional
    ///     Limits of the other direction, negative, per [s] and [s^2], a number or shape (axes,); default minus the
    ///     largest magnitudes.
    /// duration : float, optional
    ///     Stretch the profile to this time [s]; default the least possible.
    /// synchronise : {'time', 'phase', 'none'}
    ///     Synchronization: all axes arrive together, also stay in proportion to each other (where the moving ends
    ///     allow it), or take their own least time each; with a duration, all take that.
    #[doc = raises!(ValueError)]
    ///     If a value is not finite, a limit not of its sign, an end outside the limits, or the duration
    ///     shorter than the least one, which is named.
    ///
    /// Source: L. Berscheid, T. Kröger, Jerk-limited Real-time Trajectory Generation with Arbitrary Target
    /// States, RSS 2021; computed by the crate rsruckig.
    #[staticmethod]
    fn time_optimal[py: Python<'py>](start, end, *, velocity, acceleration=None, jerk=None, start_velocity=None,
        start_acceleration=None, end_velocity=None, end_acceleration=None, min_velocity=None,
        min_acceleration=None, duration: Option<f64> = None, synchronise: &str = "time", **)
    as "(start, end, *, velocity, acceleration=None, jerk=None, start_velocity=None, start_acceleration=None, end_velocity=None, end_acceleration=None, min_velocity=None, min_acceleration=None, duration=None, synchronise='time')" -> PyResult<Self> {
        let mut given = Given { keywords: PyDict::new(py), all: Vec::new() };
        given.all.push(values("start", start)?);
        given.all.push(values("end", end)?);
        given.read("velocity", Some(velocity), f64::NAN)?;
        given.read("acceleration", acceleration, f64::INFINITY)?;
        given.read("jerk", jerk, f64::INFINITY)?;
        given.read("start_velocity", start_velocity, 0.0)?;
        given.read("start_acceleration", start_acceleration, 0.0)?;
        given.read("end_velocity", end_velocity, 0.0)?;
        given.read("end_acceleration", end_acceleration, 0.0)?;
        given.read_mirrored("min_velocity", min_velocity)?;
        given.read_mirrored("min_acceleration", min_acceleration)?;
        if let Some(duration) = duration {
            given.keywords.set_item("duration", duration)?;
        }
        if synchronise != "time" {
            given.keywords.set_item("synchronise", synchronise)?;
        }
        let (count, is_vector) = axes(&given.all)?;
        let synchronise = synchronise.parse::<Synchronise>().or_raise(&[])?;
        let core = core::time_optimal(
            &given.state(count, ["start", "start_velocity", "start_acceleration"]),
            &given.state(count, ["end", "end_velocity", "end_acceleration"]),
            &given.bounds(count),
            synchronise,
            duration,
        );
        let [start, end] = [to_python(py, &given.all[0])?, to_python(py, &given.all[1])?];
        Self::build(py, "time_optimal", core, is_vector, &[&start, &end], given.keywords)
    }
}
