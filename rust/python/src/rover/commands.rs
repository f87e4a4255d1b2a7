//! `Rover.commands` and `Rover.readings`: values of joints by name.

use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyEllipsis, PyFloat, PyMapping, PyTuple};

use super::Rover;
use super::joints::Joint;
use crate::convert::{one_twist, refuse};

impl Rover {
    /// Joint name to value with the joint's sign, in the order of `joint_names`; whole arrays for batches.
    pub fn named_values<'py>(
        &self,
        py: Python<'py>,
        steering: &Bound<'py, PyAny>,
        speeds: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let commands = PyDict::new(py);
        let steered = self.core.steered();
        let place = |wheel: usize| steered.iter().position(|&i| i == wheel).unwrap_or_default();
        let angles = self.steering.iter().map(|joint| (joint, steering, place(joint.wheel)));
        let rotations = self.traction.iter().map(|joint| (joint, speeds, joint.wheel));
        for (joint, array, column) in angles.chain(rotations) {
            let values = array.get_item((PyEllipsis::get(py), column))?;
            let single = values.getattr("ndim")?.extract::<usize>()? == 0;
            let values = if single { values.call_method0("item")? } else { values };
            let values = if joint.reversed { values.neg()? } else { values };
            commands.set_item(&joint.name, values)?;
        }
        Ok(commands)
    }
}

methods! { Rover:
    /// Joint commands by joint name, as motor drivers take them.
    #[doc = section!(Parameters: twist "(..., 3)")]
    /// previous : array_like, shape (..., steered wheels), optional
    ///     Present steering angles [rad], in the order of `steered_wheel_names`.
    #[doc = parameters!(dtype, threads)]
    #[doc = returns!("dict of str to float or ndarray")]
    ///     Steering joints [rad], then traction joints [rad/s], in the order of `joint_names`: for a rover
    ///     from a parameter file, the order of the file.
    #[doc = raises!(InfeasibleMotionError, ValueError)]
    ///     As `inverse`.
    fn commands[&self, py: Python<'py>](twist, *more, previous=None, dtype=None, threads: Option<i64> = None)
    as "($self, twist, *, previous=None, dtype=None, threads=None)" -> PyResult<Bound<'py, PyDict>> {
        one_twist("Rover.commands((vx, vy, omega))", 1, more)?;
        let (steering, speeds) =
            self.inverse(py, twist, more, previous, None, None, None, None, dtype, threads, None)?;
        self.named_values(py, steering.as_any(), speeds.as_any())
    }

    /// Values of joints as the arrays of steering and wheels: the inverse of `commands`.
    #[doc = section!(Parameters)]
    /// joints : mapping of str to array_like
    ///     Value of each joint by its name, as a message of joint states has them; others are passed over.
    ///     Angles or speeds [rad, rad/s], of one moment or each of the same shape.
    #[doc = returns!("(ndarray, ndarray), shapes (..., steered wheels) and (..., wheels)")]
    ///     In the order of `steered_wheel_names` and `wheel_names`, with the wheels' signs: what `forward`,
    ///     `Odometry.update` and `Controller.step` take. NaN for a wheel that no joint drives.
    #[doc = raises!("If a joint is missing; the message names it.")]
    fn readings[&self, py: Python<'py>](joints: &Bound<'py, PyMapping>)
    -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let numpy = py.import(intern!(py, "numpy"))?;
        let missing = |name: &str| {
            let listed: Vec<String> =
                (joints.keys().ok()).map(|keys| keys.iter().map(|key| key.to_string()).collect()).unwrap_or_default();
            refuse("joints", format!("hold every joint of the rover, {name:?} too"), listed.join(", "))
        };
        let value = |joint: &Joint| -> PyResult<Bound<'py, PyAny>> {
            let value = joints.get_item(&joint.name).map_err(|_| missing(&joint.name))?;
            numpy.call_method1(intern!(py, "multiply"), (value, joint.sign()))
        };
        let columns = |list: &[Joint], wheels: &[usize]| -> PyResult<Bound<'py, PyAny>> {
            let of = |wheel: usize| list.iter().find(|joint| joint.wheel == wheel);
            let values = wheels.iter().map(|&wheel| match of(wheel) {
                Some(joint) => value(joint),
                None => Ok(PyFloat::new(py, f64::NAN).into_any()),
            });
            let values = values.collect::<PyResult<Vec<_>>>()?;
            if values.is_empty() {
                return numpy.call_method1(intern!(py, "zeros"), (0,));
            }
            let values = numpy.call_method1(intern!(py, "broadcast_arrays"), PyTuple::new(py, values)?)?;
            let stacked = PyDict::new(py);
            stacked.set_item(intern!(py, "axis"), -1)?;
            numpy.call_method(intern!(py, "stack"), (values,), Some(&stacked))
        };
        let every: Vec<usize> = (0..self.count()).collect();
        Ok((columns(&self.steering, self.core.steered())?, columns(&self.traction, &every)?))
    }

    /// Wheel speeds slowed down by one factor, so that the fastest wheel is within its limit and the path stays.
    #[doc = section!(Parameters)]
    /// wheel_speeds : array_like
    ///     Wheel speeds [rad/s], the wheels in the last axis; each row has its own factor.
    /// max_wheel_speed : float or array_like, shape (wheels,)
    ///     Largest speed of all wheels, or of each [rad/s].
    #[doc = returns!("ndarray": "Speeds of the same shape; those that are within the limits are as they were.")]
    #[doc = raises!("If a number is not finite, a limit is not positive, or a shape does not fit.")]
    fn desaturate[slf: &Bound<'py, Self>](wheel_speeds, max_wheel_speed) -> PyResult<Bound<'py, PyAny>> {
        let module = slf.py().import("six_wheel.kinematics.objects.desaturation")?;
        module.call_method1("desaturate", (slf, wheel_speeds, max_wheel_speed))
    }
}
