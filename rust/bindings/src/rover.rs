//! `six_wheel.Rover`: the class, its wheels and joints, and how it is a value. What it computes has rooms
//! of its own: `layouts`, `kinematics`, `fit`, `admissible`, `mobility`.

use std::hash::{DefaultHasher, Hash, Hasher};

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyMapping, PyTuple};
use six_wheel_core::{Rover as Core, SteeringRange};

use crate::convert::{items, raise, refuse};
use crate::wheel::{Wheel, hash_wheel, reduce, steering_limit};

/// Items of a list that are looked at.
const MOST_ITEMS: usize = 1 << 16;

/// A wheeled vehicle: wheels, and everything that follows from where they are.
///
/// Immutable, hashable, comparable, picklable, and safe on any number of threads: nothing is remembered
/// between calls. Twists are ``[vx, vy, omega]`` in body axes (x forward, y left) [m/s, m/s, rad/s].
///
/// Parameters
/// ----------
/// wheels : sequence of Wheel
///     1 to 64 wheels with different names; arrays of wheel speeds follow their order, arrays of steering
///     angles that of the steered ones.
/// traction_joints, steering_joints : mapping of str to str, optional
///     Joint name to wheel name, one joint for every driven wheel and for every steered one, in the order
///     in which `commands` gives them. Default ``<wheel>_wheel_joint`` and ``<wheel>_steering_joint``.
///
/// Raises
/// ------
/// ValueError
///     If there is no wheel or too many, two share a name, or the joints do not match the wheels.
///
/// Source: R. Siegwart, I. Nourbakhsh, D. Scaramuzza, Introduction to Autonomous Mobile Robots, 2nd ed., ch. 3.
#[pyclass(frozen, module = "six_wheel")]
pub struct Rover {
    pub core: Core,
    wheels: Py<PyTuple>,
    pub traction: Joints,
    pub steering: Joints,
}

/// Joint names, each with the index of its wheel, in the order of the commands.
type Joints = Vec<(String, usize)>;

const TRACTION: &str = "wheel_joint";
const STEERING: &str = "steering_joint";

/// The joints of these wheels under their default names.
fn default_joints(core: &Core, wheels: &[usize], suffix: &str) -> Joints {
    wheels
        .iter()
        .map(|&i| (format!("{}_{suffix}", core.wheels()[i].name), i))
        .collect()
}

/// Reads a mapping of joint names to wheel names, which must name each of these wheels once.
fn read_joints(
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
        let found = wheels
            .iter()
            .copied()
            .find(|&i| core.wheels()[i].name == wheel);
        let Some(index) = found else {
            let names: Vec<_> = wheels
                .iter()
                .map(|&i| core.wheels()[i].name.as_str())
                .collect();
            let rule = format!("map joints to the wheels {}", names.join(", "));
            return Err(refuse(argument, &rule, &format!("{wheel:?} for {joint:?}")));
        };
        if joints.iter().any(|(_, other)| *other == index) {
            return Err(refuse(
                argument,
                "name every wheel once",
                &format!("{wheel:?} twice"),
            ));
        }
        joints.push((joint, index));
    }
    if let Some(&missing) = wheels
        .iter()
        .find(|i| joints.iter().all(|(_, other)| other != *i))
    {
        let got = format!("no joint for {:?}", core.wheels()[missing].name);
        return Err(refuse(argument, "name every wheel once", &got));
    }
    Ok(joints)
}

/// Indices of the wheels with a motor.
fn driven(core: &Core) -> Vec<usize> {
    (0..core.wheels().len())
        .filter(|&i| core.wheels()[i].driven)
        .collect()
}

impl Rover {
    /// The rover of a core one, with joints under their default names.
    pub fn named(py: Python<'_>, core: Result<Core, six_wheel_core::Error>) -> PyResult<Self> {
        Self::build(py, core.map_err(|error| raise(error, &[]))?, None, None)
    }

    /// Number of steered wheels.
    pub fn joints(&self) -> usize {
        self.core.steered().len()
    }

    /// Number of wheels.
    pub fn count(&self) -> usize {
        self.core.wheels().len()
    }

    /// A rover of the core with its joints.
    pub fn build(
        py: Python<'_>,
        core: Core,
        traction: Option<&Bound<'_, PyMapping>>,
        steering: Option<&Bound<'_, PyMapping>>,
    ) -> PyResult<Self> {
        let motors = driven(&core);
        let traction = read_joints(&core, &motors, "traction_joints", traction, TRACTION)?;
        let steering = read_joints(&core, core.steered(), "steering_joints", steering, STEERING)?;
        if let Some((joint, _)) = steering
            .iter()
            .find(|(joint, _)| traction.iter().any(|(other, _)| other == joint))
        {
            let rule = "differ from traction_joints";
            return Err(refuse(
                "steering_joints",
                rule,
                &format!("{joint:?} in both"),
            ));
        }
        let wheels: Vec<Wheel> = core.wheels().iter().cloned().map(Wheel).collect();
        let wheels = PyTuple::new(py, wheels)?.unbind();
        Ok(Self {
            core,
            wheels,
            traction,
            steering,
        })
    }

    fn joint_dict<'py>(&self, py: Python<'py>, joints: &Joints) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (joint, wheel) in joints {
            dict.set_item(joint, &self.core.wheels()[*wheel].name)?;
        }
        Ok(dict)
    }

    /// The joint arguments that are not the default ones.
    fn joint_keywords<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let keywords = PyDict::new(py);
        if self.traction != default_joints(&self.core, &driven(&self.core), TRACTION) {
            keywords.set_item("traction_joints", self.joint_dict(py, &self.traction)?)?;
        }
        if self.steering != default_joints(&self.core, self.core.steered(), STEERING) {
            keywords.set_item("steering_joints", self.joint_dict(py, &self.steering)?)?;
        }
        Ok(keywords)
    }
}

#[pymethods]
impl Rover {
    #[new]
    #[pyo3(signature = (wheels, *, traction_joints=None, steering_joints=None))]
    fn new(
        py: Python<'_>,
        wheels: &Bound<'_, PyAny>,
        traction_joints: Option<&Bound<'_, PyMapping>>,
        steering_joints: Option<&Bound<'_, PyMapping>>,
    ) -> PyResult<Self> {
        let wheels = items("wheels", wheels, MOST_ITEMS)?;
        let wheels: Vec<Wheel> = wheels
            .iter()
            .map(|item| Ok(item.extract()?))
            .collect::<PyResult<_>>()?;
        let core = Core::new(wheels.into_iter().map(|wheel| wheel.0).collect());
        let core = core.map_err(|error| raise(error, &[]))?;
        Self::build(py, core, traction_joints, steering_joints)
    }

    /// The wheels, in the order of every array.
    #[getter]
    fn wheels(&self, py: Python<'_>) -> Py<PyTuple> {
        self.wheels.clone_ref(py)
    }

    /// Names of the wheels, in the order of every array.
    #[getter]
    fn wheel_names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(
            py,
            self.core.wheels().iter().map(|wheel| wheel.name.as_str()),
        )
    }

    /// Names of the steered wheels, in the order of steering arrays.
    #[getter]
    fn steered_names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let names = self
            .core
            .steered()
            .iter()
            .map(|&i| self.core.wheels()[i].name.as_str());
        PyTuple::new(py, names.collect::<Vec<_>>())
    }

    /// Joint name to wheel name of the wheel drives, in the order of `commands`.
    #[getter]
    fn traction_joints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.joint_dict(py, &self.traction)
    }

    /// Joint name to wheel name of the steering, in the order of `commands`.
    #[getter]
    fn steering_joints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.joint_dict(py, &self.steering)
    }

    /// Smallest radius from which on every turn is possible [m]: 0 if all are, infinite if none is.
    ///
    /// It counts along the axle line of the unsteered wheels, or abreast of the origin if there are none.
    #[getter]
    fn min_radius(&self) -> f64 {
        self.core.min_radius()
    }

    /// Largest radius up to which every turn is possible [m]: 0 if the rover cannot turn on the spot.
    ///
    /// Between it and `min_radius` some turns are impossible.
    #[getter]
    fn spin_radius(&self) -> f64 {
        self.core.spin_radius()
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let keywords = self.joint_keywords(py)?;
        if keywords.is_empty()
            && let Some(([d1, d2, d3, d4], radius, range)) = self.core.as_six_wheel()
        {
            let mut text = format!(
                "Rover.six_wheel(d1={d1:?}, d2={d2:?}, d3={d3:?}, d4={d4:?}, wheel_radius={radius:?}"
            );
            if range != SteeringRange::default() {
                text += &format!(", steering_limit={}", steering_limit(range));
            }
            return Ok(text + ")");
        }
        let wheels = PyList::new(py, self.wheels.bind(py))?.repr()?;
        let mut text = format!("Rover({wheels}");
        for (keyword, value) in keywords.iter() {
            text += &format!(", {keyword}={}", value.repr()?);
        }
        Ok(text + ")")
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| {
            let other = other.get();
            (&self.core, &self.traction, &self.steering)
                == (&other.core, &other.traction, &other.steering)
        })
    }

    fn __hash__(&self) -> u64 {
        let mut state = DefaultHasher::new();
        for wheel in self.core.wheels() {
            hash_wheel(wheel, &mut state);
        }
        (&self.traction, &self.steering).hash(&mut state);
        state.finish()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let (py, rover) = (slf.py(), slf.get());
        let arguments = (rover.wheels.bind(py),).into_pyobject(py)?;
        reduce(slf.as_any(), &arguments, &rover.joint_keywords(py)?)
    }
}
