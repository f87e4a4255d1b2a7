//! Arguments of profiles and transitions, and states that the latter have in common.

use std::str::FromStr;

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use six_wheel_control::profiles::Wheels;
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::Rover as CoreRover;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::threads::workers::BETWEEN_CHECKS;

use super::made::class;
use crate::convert::{
    Broadcast, Name, OrRaise, Results, Rows, compute, is_interrupted, joined, memory, refuse, refuse_shape,
    scalar_or_array,
};
use crate::rover::Rover;

/// One row of numbers.
pub fn row(argument: impl Into<Name>, value: &Bound<'_, PyAny>, width: usize) -> PyResult<Vec<f64>> {
    let row = Rows::read(argument, value, width)?.over(&[])?;
    Ok(row.flat().iter().map(|number| number + 0.0).collect())
}

/// Keywords of a call, in order, without those left at their default.
pub struct Keywords<'py>(pub Bound<'py, PyDict>);

impl<'py> Keywords<'py> {
    pub fn new(py: Python<'py>) -> Self {
        Self(PyDict::new(py))
    }

    /// A limit, infinite if not given.
    pub fn limit(&self, argument: &str, limit: Option<f64>) -> PyResult<f64> {
        let limit = limit.unwrap_or(f64::INFINITY);
        if limit != f64::INFINITY {
            self.0.set_item(argument, limit)?;
        }
        Ok(limit)
    }

    /// A word out of a few.
    pub fn word<T: FromStr<Err = Error> + Default + PartialEq>(
        &self,
        argument: &str,
        word: Option<&str>,
    ) -> PyResult<T> {
        let Some(word) = word else { return Ok(T::default()) };
        let read = word.parse::<T>().or_raise(&[])?;
        if read != T::default() {
            self.0.set_item(argument, word)?;
        }
        Ok(read)
    }

    pub fn duration(&self, duration: Option<f64>) -> PyResult<Option<f64>> {
        if let Some(duration) = duration {
            self.0.set_item("duration", duration)?;
        }
        Ok(duration)
    }

    pub fn previous(&self, rover: &Rover, value: Option<&Bound<'py, PyAny>>) -> PyResult<Option<Vec<f64>>> {
        let angles = value.map(|value| row("previous", value, rover.joints())).transpose()?;
        if let Some(angles) = &angles {
            self.0.set_item("previous", PyTuple::new(self.0.py(), angles)?)?;
        }
        Ok(angles)
    }
}

/// Fails unless a duration or limits are given, and not both.
pub fn one_of(duration: Option<f64>, limited: bool, limits: &str) -> PyResult<()> {
    match (duration.is_some(), limited) {
        (true, false) | (false, true) => Ok(()),
        (true, true) => Err(refuse("duration", format!("not come with {limits}"), "both")),
        (false, false) => Err(refuse("duration", format!("be given, or {limits}"), "neither")),
    }
}

/// `TransitionState` at one time or many.
pub fn states<'py>(
    py: Python<'py>,
    rover: &CoreRover,
    times: &Bound<'py, PyAny>,
    at: impl Fn(f64, &mut Wheels<'_>) -> Option<Twist> + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    let times = Rows::read_numbers("times", times)?.finite()?;
    let (joints, wheels, flat) = (rover.steered().len(), rover.wheels().len(), times.flat());
    let widths = [3, joints, wheels, joints, joints];
    let mut results = Results::fresh(py, widths.map(|width| joined(&times.leading, width)))?;
    let [twists, steering, speeds, rates, accelerations] = results.flat();
    let mut scrubs = memory::filled(0.0, flat.len())?;
    compute(py, flat.len(), || {
        for (k, &time) in flat.iter().enumerate() {
            if k % BETWEEN_CHECKS == BETWEEN_CHECKS - 1 && is_interrupted() {
                return Err(Error::interrupted());
            }
            let (joint, wheel) = (k * joints..(k + 1) * joints, k * wheels..(k + 1) * wheels);
            let mut wheels = Wheels {
                steering: &mut steering[joint.clone()],
                speeds: &mut speeds[wheel],
                rates: &mut rates[joint.clone()],
                accelerations: &mut accelerations[joint],
            };
            let commanded = at(time, &mut wheels);
            let (fitted, scrub) = wheels.scrub(rover)?;
            twists.as_chunks_mut().0[k] = <[f64; 3]>::from(commanded.unwrap_or(fitted));
            scrubs[k] = scrub;
        }
        Ok(())
    })
    .or_raise(&[])?;
    let [twists, steering, speeds, rates, accelerations] = results.finish_arrays()?;
    let scrubs = scalar_or_array(py, scrubs, &times.leading)?;
    class(py, "TransitionState")?.call1((twists, steering, speeds, rates, accelerations, scrubs))
}

/// Reads one number, or one per axis.
pub fn values<'py>(argument: &'static str, value: &Bound<'py, PyAny>) -> PyResult<Rows<'py>> {
    let values = Rows::read_numbers(argument, value)?;
    match values.leading.as_slice() {
        [] | [_] if !values.flat().is_empty() => Ok(values),
        shape => Err(refuse_shape(argument, "be one number or have shape (axes,)", shape)),
    }
}

/// The same for Python: a number, or a tuple.
pub fn to_python<'py>(py: Python<'py>, values: &Rows<'_>) -> PyResult<Bound<'py, PyAny>> {
    // Plus zero: no minus zero.
    let numbers: Vec<f64> = values.flat().iter().map(|number| number + 0.0).collect();
    if values.is_single() {
        Ok(numbers[0].into_pyobject(py)?.into_any())
    } else {
        Ok(PyTuple::new(py, numbers)?.into_any())
    }
}

/// Number of axes of arguments that are one number or one per axis, and whether any is the latter.
pub fn axes(values: &[Rows<'_>]) -> PyResult<(usize, bool)> {
    let mut count: Option<usize> = None;
    for values in values.iter().filter(|values| !values.is_single()) {
        let (known, own) = (count.unwrap_or(values.count()), values.count());
        if known != own {
            let rule = format!("be one number or have shape ({known},)");
            return Err(refuse(values.argument(), rule, format!("shape ({own},)")));
        }
        count = Some(own);
    }
    Ok((count.unwrap_or(1), count.is_some()))
}
