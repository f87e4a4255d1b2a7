//! `six_wheel.ControllerRun`: what many steps in one call command.

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use six_wheel_control::controller::Steps;

use super::Controller;
use crate::convert::{Results, Rows, compute_rows, is_interrupted, memory};
use crate::rover::Rover;

result_class! {
    /// The commands of `Controller.run`, one row a step.
    pub struct ControllerRun {
        /// Stamps of the steps [s], shape (n,).
        stamps: Py<PyAny>,
        /// Steering angles [rad], shape (n, steered wheels), in the order of `Rover.steered_wheel_names`.
        steering: Py<PyAny>,
        /// Rates of the steering angles [rad/s], shape (n, steered wheels).
        steering_rates: Py<PyAny>,
        /// Wheel speeds [rad/s], shape (n, wheels), in the order of `Rover.wheel_names`.
        wheel_speeds: Py<PyAny>,
        /// The motions they make, rows ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s], shape (n, 3).
        twist: Py<PyAny>,
        /// Bits of `Reason`, shape (n,), uint32.
        reasons: Py<PyArray1<u32>>,
        /// The rover.
        rover: Py<Rover>,
    }
}

methods! { Controller:
    /// Many steps in one call: a log, a plan, a simulation. The same, bit for bit, as the calls one by one.
    #[doc = section!(Parameters)]
    /// twists : array_like, shape (m, 3)
    ///     The commands, rows ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s].
    /// stamps : array_like, shape (m,)
    ///     When the commands were given [s]. They come in this order, each before the first step that is not
    ///     earlier than its stamp.
    /// step_stamps : array_like, shape (n,)
    ///     Stamps of the steps [s], increasing.
    #[doc = returns!("ControllerRun")]
    ///     `stamps`, `steering`, `wheel_speeds`, `twist`, `reasons`, `steering_rates`, one row a step.
    #[doc = raises!(ValueError)]
    ///     If a step is not later than the one before it, a command is later than all of them, one of them is not
    ///     finite, or the shapes do not fit. The controller stays as it was.
    fn run[&self, py: Python<'py>](twists, stamps, step_stamps) -> PyResult<ControllerRun> {
        let times = Rows::read_numbers("step_stamps", step_stamps)?;
        let count = times.flat().len();
        let times = times.over(&[count])?;
        let stamps = Rows::read_numbers("stamps", stamps)?;
        let commands = stamps.flat().len();
        let stamps = stamps.over(&[commands])?;
        let twists = Rows::read("twists", twists, 3)?.over(&[commands])?;

        let widths = [self.joints, self.joints, self.wheels, 3];
        let mut results = Results::fresh(py, widths.map(|width| vec![count, width]))?;
        let mut reasons = memory::filled(0, count)?;
        let [steering, steering_rates, speeds, motions] = results.flat();
        let motions = motions.as_chunks_mut().0;
        let steps = Steps { steering, steering_rates, speeds, twists: motions, reasons: &mut reasons };
        let (stamps, twists, times) = (stamps.flat(), twists.triples(), times.flat());
        let mut guard = self.core.lock(py)?;
        let core = &mut *guard;
        compute_rows(py, count, &[count.max(commands)], || core.run(stamps, twists, times, steps, is_interrupted))?;
        let [steering, steering_rates, wheel_speeds, twist] = results.finish_arrays()?;
        let stamps = memory::array(py, times, &[count])?.into_any().unbind();
        let (rover, reasons) = (self.rover.clone_ref(py), PyArray1::from_vec(py, reasons).unbind());
        Ok(ControllerRun { stamps, steering, steering_rates, wheel_speeds, twist, reasons, rover })
    }
}

getters! { ControllerRun, self, py:
    /// Joint commands by joint name, as `Rover.commands`: arrays (n,) of steering [rad] and wheel speeds [rad/s].
    commands: PyResult<Bound<'py, PyDict>> = {
        let rover = self.rover.get();
        rover.named_values(py, self.steering.bind(py), self.wheel_speeds.bind(py))
    };
}

#[pymethods]
impl ControllerRun {
    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        self.reasons.bind(py).as_any().len()
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("<ControllerRun of {} steps>", self.__len__(py)?))
    }

    /// The columns by name, arrays of shape (n,): time, joint commands, twist, reasons, in the units of `to_arrow`.
    fn to_arrays<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        table(slf)?.call_method0("to_arrays")
    }

    /// The columns as a `pandas.DataFrame`.
    #[doc = raises!(ModuleNotFoundError: "If pandas is not installed; the message has the install line.")]
    fn to_pandas<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        table(slf)?.call_method0("to_pandas")
    }

    /// The columns as a `pyarrow.Table`, each with its ``unit`` in the metadata of its field.
    #[doc = raises!(ModuleNotFoundError: "If pyarrow is not installed; the message has the install line.")]
    fn to_arrow<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        table(slf)?.call_method0("to_arrow")
    }

    /// Write the columns to a CSV file with all their digits.
    #[doc = section!(Parameters)]
    /// path : path
    ///     A file that is there is replaced.
    #[doc = raises!(OSError: "If the file cannot be written.")]
    fn to_csv(slf: &Bound<'_, Self>, path: &Bound<'_, PyAny>) -> PyResult<()> {
        table(slf)?.call_method1("to_csv", (path,)).map(drop)
    }
}

/// The run as a table.
fn table<'py>(run: &Bound<'py, ControllerRun>) -> PyResult<Bound<'py, PyAny>> {
    run.py().import("six_wheel.kinematics.objects.results")?.call_method1("RunTable", (run,))
}
