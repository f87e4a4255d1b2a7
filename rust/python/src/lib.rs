//! `six_wheel._core`: the Python face of the crates of six_wheel. Shapes, names and errors; no mathematics.

#![allow(clippy::too_many_arguments)] // they are keywords in Python
#![recursion_limit = "512"] // of lists of parameters, which are read one token after the other

#[macro_use]
mod arguments;
#[macro_use]
mod classes;
#[macro_use]
mod fastcall;
mod controller;
mod convert;
mod four_axle;
mod geometry;
mod ground_motion;
mod odometry;
mod planner;
mod profiles;
mod rover;
mod settle;
mod state_lock;
mod suspension;
mod terrain;
mod unit_warnings;
mod wheel;
mod workers;

use pyo3::exceptions::PyImportError;
use pyo3::prelude::*;

use arguments::FromArgument;
use controller::limits::Limits;
use convert::refuse;
use fastcall::{Answer, Arguments};
use odometry::values::{Gyroscope, Noise};
use rover::Rover;
use terrain::Terrain;

/// The compiled core of six_wheel.
///
/// It needs the interpreter's lock: the quick way of single calls (`fastcall`) and the notes of what memory is in use
/// (`convert::memory`) rest on it. Free-threaded interpreters switch it on for that, or are refused.
#[pymodule(gil_used = true)]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    check_lock(py)?;
    state_lock::watch_forks(py)?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    add_classes(module)?;
    add_functions(module)?;
    rover::install(py)?;
    odometry::install(py)?;
    settle::install(py)?;
    ground_motion::install(py)?;
    controller::install(py)?;
    check_keywords(py)
}

/// Puts the check of keywords before the methods that have no quick way; those that have one check theirs there.
fn check_keywords(py: Python<'_>) -> PyResult<()> {
    checked_methods!(py, profiles::Profile: c"at");
    checked_methods!(py, profiles::BodyTransition: c"at");
    checked_methods!(py, profiles::ModuleTransition: c"at");
    checked_methods!(py, profiles::IcrTransition: c"at");
    checked_methods!(py, Rover: c"rollout_cost" c"fit" c"sensitivity" c"mobility" c"icr" c"commands" c"readings"
        c"desaturate" c"urdf");
    checked_methods!(py, odometry::state::OdometryState: c"covariance_6x6" c"twist_covariance_6x6");
    checked_methods!(py, odometry::Odometry: c"run" c"command" c"correct" c"at" c"set_pose" c"reset");
    checked_methods!(py, odometry::spatial::Odometry3: c"update" c"run" c"correct" c"set_pose" c"reset");
    checked_methods!(py, odometry::preintegrated::Preintegrated: c"add" c"covariance_in" c"corrected" c"residual" c"factor"
        c"split" c"merge");
    checked_methods!(py, Terrain: c"height_at" c"gradient_at" c"normal_at" c"contains");
    checked_methods!(py, ground_motion::BodySlip: c"compensate");
    checked_methods!(py, suspension::Suspension: c"slip" c"stability");
    checked_methods!(py, suspension::RockerBogie: c"frames" c"jacobians" c"planar" c"bounds" c"feasible" c"urdf"
        c"icr_offset" c"steer");
    checked_methods!(py, four_axle::FourAxle: c"inverse" c"forward" c"mobility" c"concurrent_angles" c"lock" c"release"
        c"drive" c"turn_sequence" c"aim_sequence" c"simulate");
    checked_methods!(py, Limits: c"on" c"halting_distance" c"stopping_distance");
    checked_methods!(py, controller::Controller: c"run" c"reset");
    checked_methods!(py, controller::run::ControllerRun: c"to_csv");
    checked_methods!(py, planner::Mppi: c"step" c"restore");
    Ok(())
}

/// Alignment of the memory that Python allocates for objects [bytes]. What needs more has to be in a box.
const OBJECT_ALIGNMENT: usize = 16;

fn add_classes(module: &Bound<'_, PyModule>) -> PyResult<()> {
    macro_rules! add {
        ($($class:path)*) => {$(
            const _: () = assert!(align_of::<$class>() <= OBJECT_ALIGNMENT);
            module.add_class::<$class>()?;
        )*};
    }
    add! {
        wheel::Wheel rover::Rover rover::TwistFit rover::Sensitivity rover::Mobility
        odometry::Odometry odometry::state::OdometryState odometry::values::Noise odometry::values::Encoder
        odometry::values::Gyroscope odometry::preintegrated::Preintegrated
        odometry::spatial::Odometry3 odometry::spatial::state::Odometry3State
        profiles::Profile profiles::BodyTransition profiles::ModuleTransition profiles::IcrTransition
        terrain::Terrain suspension::Suspension suspension::RockerBogie suspension::Link
        suspension::PoseBounds suspension::SteeringCommand
        settle::Stand settle::Feasibility settle::Stability settle::MarginJacobian
        ground_motion::GroundCommand ground_motion::GroundMotion ground_motion::Traction
        ground_motion::WheelSlip ground_motion::BodySlip
        four_axle::FourAxle
        controller::limits::Limits controller::Controller controller::output::ControllerOutput
        controller::run::ControllerRun
        planner::costmap::Costmap planner::Mppi planner::MppiPlan
    }
    Ok(())
}

fn add_functions(module: &Bound<'_, PyModule>) -> PyResult<()> {
    macro_rules! add {
        ($($function:path)*) => { $(module.add_function(wrap_pyfunction!($function, module)?)?;)* };
    }
    add! {
        check_kind rover::unit_questions rover::setting_questions rover::ask_settings unit_warnings::without_questions
        ground_motion::body_slip controller::output::reason_bits
        geometry::integrate geometry::rollout geometry::differentiate geometry::exp geometry::log geometry::compose
        geometry::wrap_angle
        workers::simd_levels workers::default_threads workers::set_default_threads
    }
    Ok(())
}

/// Fails where an argument of a function written in Python is not what its name says; `None` is no rover.
#[pyfunction]
fn check_kind(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
    match argument {
        "rover" => Bound::<Rover>::read("rover", value).map(drop),
        "noise" => Option::<Bound<'_, Noise>>::read("noise", value).map(drop),
        "gyroscope" => Option::<Bound<'_, Gyroscope>>::read("gyroscope", value).map(drop),
        "limits" => Option::<Limits>::read("limits", value).map(drop),
        "ground" => Option::<Bound<'_, Terrain>>::read("ground", value).map(drop),
        _ => Err(refuse("argument", "be one that has a kind", argument)),
    }
}

/// Fails in an interpreter that was told to go on without its lock whatever a module needs.
fn check_lock(py: Python<'_>) -> PyResult<()> {
    let sys = py.import("sys")?;
    let has_lock = match sys.getattr_opt("_is_gil_enabled")? {
        Some(asked) => asked.call0()?.extract()?,
        None => true,
    };
    if has_lock {
        return Ok(());
    }
    Err(PyImportError::new_err("six_wheel needs the interpreter's lock: leave out PYTHON_GIL=0 and -X gil=0"))
}
