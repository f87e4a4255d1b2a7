//! `six_wheel.ControllerOutput`: what one step commands.

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyType};
use six_wheel_control::controller::{Controller, reason};

use crate::rover::Rover;

/// The commands of one step of a `Controller`. Arrays are made when they are asked for.
#[pyclass(frozen, module = "six_wheel")]
pub struct ControllerOutput {
    twist: [f64; 3],
    reasons: u32,
    speed_share: f64,
    worst_joint: Option<usize>,
    /// Joint errors follow the other numbers.
    measured: bool,
    /// Steering angles, their rates, wheel speeds, errors of the joints if they were measured.
    numbers: Box<[f64]>,
    joints: usize,
    rover: Py<Rover>,
}

impl ControllerOutput {
    /// Index of the first error of a joint.
    fn errors(&self) -> usize {
        if self.measured { self.numbers.len() - self.joints } else { self.numbers.len() }
    }

    /// The last step of a controller.
    pub fn of(core: &Controller, rover: Py<Rover>) -> Self {
        let (steering, rates, speeds) = (core.steering(), core.steering_rates(), core.speeds());
        let errors = core.joint_errors();
        let mut numbers = Vec::with_capacity(3 * steering.len() + speeds.len());
        numbers.extend_from_slice(steering);
        numbers.extend_from_slice(rates);
        numbers.extend_from_slice(speeds);
        numbers.extend_from_slice(errors.unwrap_or_default());
        Self {
            twist: core.twist().into(),
            reasons: core.reasons(),
            speed_share: core.speed_share(),
            worst_joint: core.worst_joint(),
            measured: errors.is_some(),
            numbers: numbers.into_boxed_slice(),
            joints: steering.len(),
            rover,
        }
    }
}

/// The `Reason` of these bits: one object per value, as an enumeration has it.
fn reason(py: Python<'_>, bits: u32) -> PyResult<Bound<'_, PyAny>> {
    static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    static KNOWN: PyOnceLock<Py<PyDict>> = PyOnceLock::new();
    let known = KNOWN.get_or_init(py, || PyDict::new(py).unbind()).bind(py);
    if let Some(found) = known.get_item(bits)? {
        return Ok(found);
    }
    let made = CLASS.import(py, "six_wheel.kinematics.controller", "Reason")?.call1((bits,))?;
    known.set_item(bits, &made)?;
    Ok(made)
}

getters! { ControllerOutput, self, py:
    /// The rover.
    rover: Py<Rover> = self.rover.clone_ref(py);
    /// Joint commands by joint name, as `Rover.commands`: steering [rad], then wheel speeds [rad/s].
    commands: PyResult<Bound<'py, PyDict>> = {
        let (steering, speeds) = (self.steering(py), self.wheel_speeds(py));
        let rover = self.rover.get();
        rover.named_values(py, steering.as_any(), speeds.as_any())
    };
    /// Steering angles [rad], shape (steered wheels,), in the order of `Rover.steered_wheel_names`.
    steering: Bound<'py, PyArray1<f64>> = PyArray1::from_slice(py, &self.numbers[..self.joints]);
    /// Rates of the steering angles [rad/s], shape (steered wheels,), in the order of `Rover.steered_wheel_names`.
    steering_rates: Bound<'py, PyArray1<f64>> = PyArray1::from_slice(py, &self.numbers[self.joints..2 * self.joints]);
    /// Wheel speeds [rad/s], shape (wheels,), in the order of `Rover.wheel_names`.
    wheel_speeds: Bound<'py, PyArray1<f64>> = PyArray1::from_slice(py, &self.numbers[2 * self.joints..self.errors()]);
    /// Measured steering angles minus the last commands [rad], shape (steered wheels,), or None if the step was given none.
    joint_errors: Option<Bound<'py, PyArray1<f64>>> =
        self.measured.then(|| PyArray1::from_slice(py, &self.numbers[self.errors()..]));
    /// The steering joint that is stuck, or else the one farthest from its command, by its name in `commands`; None if all
    /// are within the tolerance or none was measured.
    worst_joint: PyResult<Option<Bound<'py, PyAny>>> = {
        let names = || self.rover.bind(py).getattr("steering_joints")?.cast_into::<PyDict>().map_err(PyErr::from);
        self.worst_joint.map(|joint| names()?.keys().get_item(joint)).transpose()
    };
    /// Share of the commanded speed that `SPEED`, `YAW_RATE`, `LATERAL_ACCELERATION` and `WHEEL_SPEED` leave; 1 if none of
    /// them binds.
    speed_share: f64 = self.speed_share;
    /// The motion they make, ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s], shape (3,).
    twist: Bound<'py, PyArray1<f64>> = PyArray1::from_slice(py, &self.twist);
    /// The causes for which it is not the motion asked for: a `Reason`, empty if it is.
    reasons: PyResult<Bound<'py, PyAny>> = reason(py, self.reasons);
}

pickled_by_fields! { ControllerOutput, this, py:
    (
        twist: [f64; 3] = this.twist,
        reasons: u32 = this.reasons,
        speed_share: f64 = this.speed_share,
        worst_joint: Option<usize> = this.worst_joint,
        measured: bool = this.measured,
        numbers: Vec<f64> = this.numbers.to_vec(),
        joints: usize = this.joints,
        rover: Py<Rover> = &this.rover,
    )
    Self { twist, reasons, speed_share, worst_joint, measured, numbers: numbers.into(), joints, rover }
}

repr_of_attributes! { ControllerOutput: steering wheel_speeds twist reasons }

/// Name and bit of every reason.
#[pyfunction]
pub fn reason_bits() -> Vec<(&'static str, u32)> {
    reason::ALL.to_vec()
}
