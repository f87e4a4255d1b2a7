//! `six_wheel.ControllerRun`: what many steps in one call command.

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use six_wheel_control::controller::Steps;

use super::Controller;
use crate::convert::{Output, Rows, Scalars, compute, memory, raise};
use crate::rover::Rover;

/// What the steps of `Controller.run` command, one row a step.
#[pyclass(frozen, module = "six_wheel")]
pub struct ControllerRun {
    rover: Py<Rover>,
    /// Steering angles [rad], shape (n, steered wheels), in the order of `Rover.steered_names`.
    #[pyo3(get)]
    steering: Py<PyAny>,
    /// Rates of the steering angles [rad/s], shape (n, steered wheels).
    #[pyo3(get)]
    steering_rates: Py<PyAny>,
    /// Wheel speeds [rad/s], shape (n, wheels), in the order of `Rover.wheel_names`.
    #[pyo3(get)]
    speeds: Py<PyAny>,
    /// The motions they make, rows ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s], shape (n, 3).
    #[pyo3(get)]
    twist: Py<PyAny>,
    /// Bits of `Reason`, shape (n,), uint32.
    #[pyo3(get)]
    reasons: Py<PyArray1<u32>>,
}

impl ControllerRun {
    /// Runs a controller.
    pub fn of<'py>(
        py: Python<'py>,
        controller: &Controller,
        [stamps, twists, times]: [&Bound<'py, PyAny>; 3],
    ) -> PyResult<Self> {
        let times = Scalars::read("times", times)?;
        let count = times.flat().len();
        times.fit_exactly("times", &[count])?;
        let stamps = Scalars::read("stamps", stamps)?;
        let commands = stamps.flat().len();
        stamps.fit_exactly("stamps", &[commands])?;
        let twists = Rows::read("twists", twists, 3)?;
        twists.check_leading("twists", &[commands])?;

        let output = |width| Output::fresh(py, &[count, width]);
        let (mut steering, mut rates) = (output(controller.joints)?, output(controller.joints)?);
        let (mut speeds, mut motions) = (output(controller.wheels)?, output(3)?);
        let mut reasons = memory::filled(0, count)?;
        let steps = Steps {
            steering: steering.flat(),
            steering_rates: rates.flat(),
            speeds: speeds.flat(),
            twists: motions.triples(),
            reasons: &mut reasons,
        };
        let (stamps, twists, times) = (stamps.flat(), twists.triples(), times.flat());
        let mut guard = controller.core.lock(py)?;
        let core = &mut *guard;
        compute(py, count, || core.run(stamps, twists, times, steps))
            .map_err(|error| raise(error, &[count.max(commands)]))?;
        let array = |output: Output<'py>| Ok::<_, PyErr>(output.finish()?.into_any().unbind());
        Ok(Self {
            rover: controller.rover.clone_ref(py),
            steering: array(steering)?,
            steering_rates: array(rates)?,
            speeds: array(speeds)?,
            twist: array(motions)?,
            reasons: PyArray1::from_vec(py, reasons).unbind(),
        })
    }
}

methods! { Controller:
    /// Many steps in one call: a log, a plan, a simulation. The same, bit for bit, as the calls one by one.
    ///
    /// Parameters
    /// ----------
    /// stamps : array_like, shape (m,)
    ///     When the commands were given [s]. They come in this order, each before the first step that is not
    ///     earlier than its stamp.
    /// twists : array_like, shape (m, 3)
    ///     The commands, rows ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s].
    /// times : array_like, shape (n,)
    ///     Times of the steps [s], increasing.
    ///
    /// Returns
    /// -------
    /// ControllerRun
    ///     `steering`, `speeds`, `twist`, `reasons`, `steering_rates`, one row a step.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a time is not later than the one before it, a stamp is later than all of them, one of them is not
    ///     finite, or the shapes do not fit. The controller stays as it was.
    fn run[&self, py: Python<'py>](stamps, twists, times) -> PyResult<ControllerRun> {
        ControllerRun::of(py, self, [stamps, twists, times])
    }
}

getters! { ControllerRun, self, py:
    /// Joint commands by joint name, as `Rover.commands`: arrays (n,) of steering [rad] and wheel speeds [rad/s].
    commands: PyResult<Bound<'py, PyDict>> = {
        let rover = self.rover.get();
        rover.named_values(py, self.steering.bind(py), self.speeds.bind(py))
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
}
