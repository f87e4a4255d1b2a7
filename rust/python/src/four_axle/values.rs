//! States, steps and results of `six_wheel.kinematics.four_axle`: plain values of Python, read and written.

use pyo3::prelude::*;
use pyo3::types::PyTuple;
use six_wheel_four_axle::{self as core, Axles, Brake, Brakes, Drives, Pace, State};
use six_wheel_numerics::error::Error;

use crate::convert::{Array, choice, items, memory, number, numbers, raise, refuse, refuse_type};

/// A class of `six_wheel.kinematics.four_axle`.
pub fn value<'py>(py: Python<'py>, class: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("six_wheel.kinematics.four_axle")?.getattr(class)
}

/// Fails unless an argument is one of those classes.
fn check_class(argument: &str, given: &Bound<'_, PyAny>, class: &str) -> PyResult<()> {
    if given.is_instance(&value(given.py(), class)?)? {
        return Ok(());
    }
    Err(refuse_type(argument, format!("be a {class}"), given.get_type().name()?))
}

/// One angle per axle.
pub fn axles(argument: &'static str, given: &Bound<'_, PyAny>) -> PyResult<Axles> {
    numbers(argument, given)
}

/// Wheel speeds, of which some may be None.
pub fn drives(argument: &str, given: &Bound<'_, PyAny>) -> PyResult<Drives> {
    let items = items(argument, given, 5)?;
    let mut drives: Drives = [None; 4];
    if items.len() != drives.len() {
        return Err(refuse(argument, "have shape (4,)", format!("{} values", items.len())));
    }
    for (drive, item) in drives.iter_mut().zip(&items) {
        if !item.is_none() {
            *drive = Some(number(argument, item)?);
        }
    }
    Ok(drives)
}

const BRAKES: [(&str, Brake); 2] = [("locked", Brake::Locked), ("free", Brake::Free)];

/// A brake by its name.
pub fn brake(argument: &str, name: &str) -> PyResult<Brake> {
    choice(argument, name, |name| format!("{name:?}"), &BRAKES)
}

/// The name of a brake.
fn brake_name(brake: Brake) -> &'static str {
    if brake == Brake::Locked { "locked" } else { "free" }
}

/// The attributes `front_brake` and `rear_brake`.
pub fn brakes(given: &Bound<'_, PyAny>) -> PyResult<Brakes> {
    let of = |name: &str| brake(name, &given.getattr(name)?.extract::<String>()?);
    Ok(Brakes { front: of("front_brake")?, rear: of("rear_brake")? })
}

/// A `FourAxleState`.
pub fn read_state(given: &Bound<'_, PyAny>) -> PyResult<State> {
    check_class("state", given, "FourAxleState")?;
    Ok(State {
        angles: given.getattr("steering")?.extract()?,
        brakes: brakes(given)?,
        pose: given.getattr("pose")?.extract::<[f64; 3]>()?.into(),
    })
}

/// A `FourAxleState`.
pub fn write_state<'py>(py: Python<'py>, state: &State) -> PyResult<Bound<'py, PyAny>> {
    let pose: [f64; 3] = state.pose.into();
    let angles = PyTuple::new(py, state.angles)?;
    let (front, rear) = (state.brakes.front, state.brakes.rear);
    value(py, "FourAxleState")?.call1((angles, brake_name(front), brake_name(rear), PyTuple::new(py, pose)?))
}

/// A `FourAxleStep`, without its end.
pub fn read_step(given: &Bound<'_, PyAny>) -> PyResult<core::Step> {
    check_class("sequence", given, "FourAxleStep")?;
    Ok(core::Step {
        action: given.getattr("action")?.extract()?,
        duration: given.getattr("duration")?.extract()?,
        brakes: brakes(given)?,
        speeds: drives("wheel_speeds", &given.getattr("wheel_speeds")?)?,
        end: State::default(),
    })
}

/// A `FourAxleStep`.
pub fn write_step<'py>(py: Python<'py>, step: &core::Step) -> PyResult<Bound<'py, PyAny>> {
    value(py, "FourAxleStep")?.call1((
        &step.action,
        step.duration,
        brake_name(step.brakes.front),
        brake_name(step.brakes.rear),
        PyTuple::new(py, step.speeds)?,
        write_state(py, &step.end)?,
    ))
}

/// A `TurnSequence`.
pub fn write_plan<'py>(py: Python<'py>, plan: &core::Sequence) -> PyResult<Bound<'py, PyAny>> {
    let steps = plan.steps.iter().map(|step| write_step(py, step)).collect::<PyResult<Vec<_>>>()?;
    value(py, "TurnSequence")?.call1((PyTuple::new(py, steps)?, plan.stops, &plan.reason))
}

/// Rows as an array.
pub fn array<'py, const N: usize>(py: Python<'py>, rows: &[[f64; N]]) -> PyResult<Array<'py>> {
    memory::array(py, rows.as_flattened(), &[rows.len(), N])
}

/// Numbers as an array.
pub fn vector<'py, T: numpy::Element>(py: Python<'py>, values: Vec<T>) -> Bound<'py, numpy::PyArray1<T>> {
    numpy::PyArray1::from_vec(py, values)
}

/// The speeds of a plan, from keywords.
pub fn pace(speed: Option<f64>, pivot_rate: Option<f64>, brake_time: Option<f64>) -> Pace {
    Pace { speed: speed.unwrap_or(0.0), pivot_rate: pivot_rate.unwrap_or(0.5), brake_time: brake_time.unwrap_or(0.0) }
}

/// The exception of a core error; its row is that of a sequence, however long.
pub fn raised(error: Error) -> PyErr {
    raise(error, &[usize::MAX])
}
