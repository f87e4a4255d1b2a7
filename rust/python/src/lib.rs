//! `six_wheel._core`: the Python face of the crates of six_wheel. Shapes, names and errors; no mathematics.

mod admissible;
mod batch;
mod controller;
mod convert;
mod costmap;
mod fast;
mod fit;
mod four_axle;
mod geometry;
mod given;
mod ground;
mod joints;
mod kinematics;
mod layouts;
mod mobility;
mod moving;
mod odometry;
mod planner;
mod profiles;
mod rollout;
mod rover;
mod sensitivity;
mod shared;
mod suspension;
mod terrain;
mod wheel;

use pyo3::exceptions::PyImportError;
use pyo3::prelude::*;

/// The compiled core of six_wheel.
///
/// It needs the interpreter's lock: the quick way of single calls (`fast`) and the notes of what memory is in use
/// (`convert::memory`) rest on it. Free-threaded interpreters switch it on for that, or are refused.
#[pymodule(gil_used = true)]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    check_lock(module.py())?;
    shared::watch_forks(module.py())?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<wheel::Wheel>()?;
    module.add_class::<rover::Rover>()?;
    module.add_function(wrap_pyfunction!(rover::unit_questions, module)?)?;
    module.add_function(wrap_pyfunction!(convert::without_questions, module)?)?;
    module.add_function(wrap_pyfunction!(given::check_kind, module)?)?;
    kinematics::install(module.py())?;
    admissible::install(module.py())?;
    module.add_class::<fit::Fit>()?;
    module.add_class::<sensitivity::Sensitivity>()?;
    module.add_class::<mobility::Mobility>()?;
    module.add_class::<odometry::Odometry>()?;
    odometry::install(module.py())?;
    module.add_class::<odometry::state::OdometryState>()?;
    module.add_class::<odometry::spatial::Odometry3>()?;
    module.add_class::<odometry::spatial::state::Odometry3State>()?;
    module.add_class::<odometry::values::Noise>()?;
    module.add_class::<odometry::gyroscope::Gyroscope>()?;
    module.add_class::<odometry::preintegrated::Preintegrated>()?;
    module.add_class::<odometry::values::Encoder>()?;
    module.add_class::<profiles::Profile>()?;
    module.add_class::<profiles::BodyTransition>()?;
    module.add_class::<profiles::ModuleTransition>()?;
    module.add_class::<profiles::IcrTransition>()?;
    module.add_class::<terrain::Terrain>()?;
    module.add_class::<suspension::Suspension>()?;
    ground::install(module.py())?;
    moving::install(module.py())?;
    module.add_class::<moving::GroundCommand>()?;
    module.add_class::<moving::GroundMotion>()?;
    module.add_class::<moving::Traction>()?;
    module.add_class::<moving::WheelSlip>()?;
    module.add_class::<moving::BodySlip>()?;
    module.add_function(wrap_pyfunction!(moving::body_slip, module)?)?;
    module.add_class::<suspension::RockerBogie>()?;
    module.add_class::<ground::Stand>()?;
    module.add_class::<suspension::Link>()?;
    module.add_class::<suspension::Bounds>()?;
    module.add_class::<suspension::Feasible>()?;
    module.add_class::<suspension::Stability>()?;
    module.add_class::<suspension::MarginSlopes>()?;
    module.add_class::<suspension::SteeringCommand>()?;
    module.add_class::<four_axle::FourAxle>()?;
    module.add_class::<controller::limits::Limits>()?;
    module.add_class::<controller::Controller>()?;
    module.add_class::<controller::output::ControllerOutput>()?;
    module.add_class::<controller::run::ControllerRun>()?;
    module.add_class::<costmap::Costmap>()?;
    module.add_class::<planner::Mppi>()?;
    module.add_class::<planner::MppiPlan>()?;
    module.add_function(wrap_pyfunction!(controller::output::reason_bits, module)?)?;
    controller::install(module.py())?;
    module.add_function(wrap_pyfunction!(geometry::integrate, module)?)?;
    module.add_function(wrap_pyfunction!(geometry::rollout, module)?)?;
    module.add_function(wrap_pyfunction!(batch::kernels, module)?)?;
    module.add_function(wrap_pyfunction!(batch::default_threads, module)?)?;
    module.add_function(wrap_pyfunction!(batch::set_default_threads, module)?)?;
    module.add_function(wrap_pyfunction!(geometry::differentiate, module)?)?;
    module.add_function(wrap_pyfunction!(geometry::exp, module)?)?;
    module.add_function(wrap_pyfunction!(geometry::log, module)?)?;
    module.add_function(wrap_pyfunction!(geometry::compose, module)?)?;
    module.add_function(wrap_pyfunction!(geometry::wrap_angle, module)?)?;
    Ok(())
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
