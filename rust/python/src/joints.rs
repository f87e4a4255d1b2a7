//! The joints of a rover's wheels: by what name, in which order and which way they count. `Rover.commands`
//! speaks to them, `Rover.readings` hears them.

use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyEllipsis, PyFloat, PyMapping, PyTuple};
use six_wheel_kinematics::rover::Rover as Core;

use crate::convert::{one_twist, refuse};
use crate::given;
use crate::rover::Rover;

/// A joint of the robot: what it is called there, the index of its wheel, and which way it counts.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Joint {
    pub name: String,
    pub wheel: usize,
    pub reversed: bool,
}

impl Joint {
    /// Takes the wheel's angle or speed to the joint's and back: 1, or -1 for a reversed joint.
    pub fn sign(&self) -> f64 {
        if self.reversed { -1.0 } else { 1.0 }
    }
}

/// The joints of a kind, in the order of the commands.
pub type Joints = Vec<Joint>;

pub const TRACTION: &str = "wheel_joint";
pub const STEERING: &str = "steering_joint";

/// The joints of these wheels under their default names.
pub fn default_joints(core: &Core, wheels: &[usize], suffix: &str) -> Joints {
    wheels
        .iter()
        .map(|&wheel| Joint { name: format!("{}_{suffix}", core.wheels()[wheel].name), wheel, reversed: false })
        .collect()
}

/// Marks the joints that count the other way, each of which must be there.
pub fn reverse(reversed: &[String], traction: &mut Joints, steering: &mut Joints) -> PyResult<()> {
    for name in reversed {
        let mut joints = traction.iter_mut().chain(steering.iter_mut());
        let Some(joint) = joints.find(|joint| joint.name == *name) else {
            let names: Vec<_> = (traction.iter().chain(steering.iter())).map(|joint| joint.name.as_str()).collect();
            let rule = format!("be some of the joints {}", names.join(", "));
            return Err(refuse("reversed_joints", &rule, &format!("{name:?}")));
        };
        if std::mem::replace(&mut joint.reversed, true) {
            let got = format!("{name:?} twice");
            return Err(refuse("reversed_joints", "name every joint once", &got));
        }
    }
    Ok(())
}

/// Reads a mapping of joint names to wheel names, which must name each of these wheels once.
pub fn read_joints(
    core: &Core,
    wheels: &[usize],
    argument: &str,
    given: Option<&Bound<'_, PyMapping>>,
    suffix: &str,
) -> PyResult<Joints> {
    let Some(given) = given else {
        return Ok(default_joints(core, wheels, suffix));
    };
    let mut joints = Joints::new();
    for item in given.items()?.iter() {
        let (joint, wheel) = item.extract::<(String, String)>()?;
        let found = wheels.iter().copied().find(|&i| core.wheels()[i].name == wheel);
        let Some(index) = found else {
            let names: Vec<_> = wheels.iter().map(|&i| core.wheels()[i].name.as_str()).collect();
            let rule = format!("map joints to the wheels {}", names.join(", "));
            return Err(refuse(argument, &rule, &format!("{wheel:?} for {joint:?}")));
        };
        if joints.iter().any(|other| other.wheel == index) {
            return Err(refuse(argument, "name every wheel once", &format!("{wheel:?} twice")));
        }
        if joints.iter().any(|other| other.name == joint) {
            let got = format!("{joint:?} twice");
            return Err(refuse(argument, "name every joint once", &got));
        }
        joints.push(Joint { name: joint, wheel: index, reversed: false });
    }
    if let Some(&missing) = wheels.iter().find(|&&i| joints.iter().all(|other| other.wheel != i)) {
        let got = format!("no joint for {:?}", core.wheels()[missing].name);
        return Err(refuse(argument, "name every wheel once", &got));
    }
    Ok(joints)
}

/// The same joints in the order in which arrays have their values.
pub fn in_order_of_wheels(joints: &Joints) -> Joints {
    let mut joints = joints.clone();
    joints.sort_by_key(|joint| joint.wheel);
    joints
}

impl Rover {
    /// Joint name to value with the joint's sign, in the order of `command_joints`; whole arrays for batches.
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

#[pymethods]
impl Rover {
    /// Joint commands by joint name: what a motor driver takes.
    ///
    /// Parameters
    /// ----------
    /// twist : array_like, shape (..., 3)
    ///     ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s].
    /// previous : array_like, shape (..., steered wheels), optional
    ///     Present steering angles [rad], in the order of `steered_names`.
    /// dtype : dtype, optional
    ///     float32 for arrays of single precision, default float64.
    /// threads : int, optional
    ///     Threads at most; default that of `set_default_threads`.
    ///
    /// Returns
    /// -------
    /// dict of str to float or ndarray
    ///     Steering joints [rad], then traction joints [rad/s], in the order of `command_joints`: for a rover
    ///     from a parameter file, the order of the file.
    ///
    /// Raises
    /// ------
    /// InfeasibleMotionError, ValueError
    ///     As `inverse`.
    #[pyo3(
        signature = (twist, *more, previous=None, dtype=None, threads=None),
        text_signature = "($self, twist, *, previous=None, dtype=None, threads=None)"
    )]
    fn commands<'py>(
        &self,
        py: Python<'py>,
        twist: &Bound<'py, PyAny>,
        more: &Bound<'py, PyTuple>,
        previous: Option<&Bound<'py, PyAny>>,
        dtype: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = given::threads)] threads: Option<i64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        one_twist("Rover.commands((vx, vy, omega))", 1, more)?;
        let (steering, speeds) =
            self.inverse(py, twist, more, previous, None, None, None, None, dtype, threads, None)?;
        self.named_values(py, steering.as_any(), speeds.as_any())
    }

    /// What the joints say, as the arrays of steering and wheels: the other way round than `commands`.
    ///
    /// Parameters
    /// ----------
    /// joints : mapping of str to array_like
    ///     Value of each joint by its name, as a message of joint states has them; others are passed over.
    ///     Angles or speeds [rad, rad/s], of one moment or each of the same shape.
    ///
    /// Returns
    /// -------
    /// (ndarray, ndarray), shapes (..., steered wheels) and (..., wheels)
    ///     In the order of `steered_names` and `wheel_names`, with the wheels' signs: what `forward`,
    ///     `Odometry.update` and `Controller.step` take. NaN for a wheel that no joint drives.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a joint is missing; the message names it.
    fn readings<'py>(
        &self,
        py: Python<'py>,
        joints: &Bound<'py, PyMapping>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let numpy = py.import(intern!(py, "numpy"))?;
        let missing = |name: &str| {
            let listed: Vec<String> =
                (joints.keys().ok()).map(|keys| keys.iter().map(|key| key.to_string()).collect()).unwrap_or_default();
            let rule = format!("hold every joint of the rover, {name:?} too");
            refuse("joints", &rule, &listed.join(", "))
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
}
