//! `six_wheel.Rover`: the class, its wheels and joints, and its behaviour as a value. Its calls have modules
//! of its own: `layouts`, `kinematics`, `fit`, `admissible`, `mobility`.

mod admissible;
mod commands;
mod fastcall;
mod files;
mod fit;
pub mod joints;
mod kinematics;
mod layouts;
mod mobility;
mod planar;
mod sensitivity;

use std::hash::{DefaultHasher, Hash, Hasher};

use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict, PyList, PyMapping, PyTuple};
use six_wheel_kinematics::presets::{PRESETS, Preset};
use six_wheel_kinematics::rover::Rover as Core;
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_kinematics::units::{self, UnitSuspicion};
use six_wheel_terrain::suspension::{RockerBogie as Arm, WHEELS};

use crate::classes::{reduce, repr_of_call};
use crate::convert::{OrRaise, items, ready, refuse, refuse_type, short_repr};
use crate::suspension::{RockerBogie, Suspension};
use crate::unit_warnings::warn_units;
use crate::wheel::{Wheel, hash_wheel, steering_limit};

use joints::{Joint, Joints, STEERING, TRACTION, default_joints, read_joints, reverse};

pub use fastcall::install;
pub use fit::TwistFit;
pub use mobility::Mobility;
pub use sensitivity::Sensitivity;

/// Items of a list that are looked at.
const MOST_ITEMS: usize = 1 << 16;

/// A wheeled vehicle: wheels, and everything that follows from where they are.
///
/// Immutable, hashable, comparable, picklable, and safe on any number of threads: nothing is remembered
/// between calls. Twists are ``[vx, vy, omega]`` in body axes (x forward, y left) [m/s, m/s, rad/s].
#[doc = section!(Parameters)]
/// wheels : sequence of Wheel
///     1 to 64 wheels with different names; arrays of wheel speeds follow their order, arrays of steering
///     angles that of the steered ones.
/// traction_joints, steering_joints : mapping of str to str, optional
///     Joint name to wheel name, one joint for every driven wheel and for every steered one, in the order
///     in which `commands` gives them. Default ``<wheel>_wheel_joint`` and ``<wheel>_steering_joint``.
/// reversed_joints : sequence of str, optional
///     Joints that count the other way: a positive speed rolls the wheel backwards, a positive angle steers
///     it clockwise. What goes by a joint's name has the joint's sign (`commands`, `readings`, logs), arrays
///     in the order of the wheels have the wheel's.
/// suspension : RockerBogie, optional
///     Suspension of the six wheels, for a rover whose file describes it.
#[doc = raises!(ValueError)]
///     If there is no wheel or too many, two share a name, the joints do not match the wheels, or a
///     suspension does not have these wheels.
///
/// Source: R. Siegwart, I. Nourbakhsh, D. Scaramuzza, Introduction to Autonomous Mobile Robots, 2nd ed., ch. 3.
#[pyclass(frozen, module = "six_wheel")]
pub struct Rover {
    pub core: Core,
    wheels: Py<PyTuple>,
    pub traction: Joints,
    pub steering: Joints,
    suspension: Option<Py<RockerBogie>>,
}

/// The arguments of the constructor beside the wheels.
#[derive(Default)]
pub struct RoverOptions<'a, 'py> {
    pub traction: Option<&'a Bound<'py, PyMapping>>,
    pub steering: Option<&'a Bound<'py, PyMapping>>,
    pub reversed: Vec<String>,
    pub suspension: Option<Py<RockerBogie>>,
}

/// Indices of the wheels with a motor.
fn driven(core: &Core) -> Vec<usize> {
    (0..core.wheels().len()).filter(|&i| core.wheels()[i].driven).collect()
}

impl Rover {
    fn arm(&self) -> Option<&Arm> {
        self.suspension.as_ref().map(|arm| &arm.get().0)
    }

    /// The rover of a core one, with joints under their default names.
    pub fn named(py: Python<'_>, core: Result<Core, six_wheel_numerics::error::Error>) -> PyResult<Self> {
        let core = core.or_raise(&[])?;
        warn_units(py, units::dimensions(&core))?;
        Self::build(py, core, RoverOptions::default())
    }

    /// Number of steered wheels.
    pub fn joints(&self) -> usize {
        self.core.steered().len()
    }

    /// Names of the wheels and of the steered ones.
    pub fn wheels_and_steered(&self) -> [Vec<&str>; 2] {
        let wheels: Vec<&str> = self.core.wheels().iter().map(|wheel| wheel.name.as_str()).collect();
        let steered = self.core.steered().iter().map(|&i| wheels[i]).collect();
        [wheels, steered]
    }

    /// Number of wheels.
    pub fn count(&self) -> usize {
        self.core.wheels().len()
    }

    /// A rover of the core with what it has beside its wheels.
    pub fn build(py: Python<'_>, core: Core, fittings: RoverOptions<'_, '_>) -> PyResult<Self> {
        ready(py)?;
        let motors = driven(&core);
        let (traction, steering) = (fittings.traction, fittings.steering);
        let mut traction = read_joints(&core, &motors, "traction_joints", traction, TRACTION)?;
        let mut steering = read_joints(&core, core.steered(), "steering_joints", steering, STEERING)?;
        if let Some(joint) = steering.iter().find(|joint| traction.iter().any(|other| other.name == joint.name)) {
            return Err(refuse("steering_joints", "differ from traction_joints", format!("{:?} in both", joint.name)));
        }
        reverse(&fittings.reversed, &mut traction, &mut steering)?;
        let stands = |name: &&str| core.wheels().iter().any(|wheel| wheel.name == **name);
        if fittings.suspension.is_some() && !(WHEELS.iter().all(stands) && core.wheels().len() == 6) {
            let got = format!("{} wheels", core.wheels().len());
            return Err(refuse("suspension", format!("be left out unless the wheels are {}", WHEELS.join(", ")), &got));
        }
        let wheels: Vec<Wheel> = core.wheels().iter().cloned().map(Wheel).collect();
        let wheels =
            py.import("six_wheel.kinematics.objects.wheels")?.call_method1("Wheels", (PyTuple::new(py, wheels)?,))?;
        let wheels = wheels.cast_into::<PyTuple>()?.unbind();
        Ok(Self { core, wheels, traction, steering, suspension: fittings.suspension })
    }

    fn joint_dict<'py>(&self, py: Python<'py>, joints: &Joints) -> PyResult<Bound<'py, PyDict>> {
        joints.iter().map(|joint| (&joint.name, &self.core.wheels()[joint.wheel].name)).into_py_dict(py)
    }

    /// Names of the joints that count the other way, those of the wheels first.
    fn reversed(&self) -> Vec<&str> {
        let joints = self.traction.iter().chain(&self.steering);
        joints.filter(|joint| joint.reversed).map(|joint| joint.name.as_str()).collect()
    }

    /// The arguments beside the wheels that are not the default ones.
    fn keywords<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let keywords = PyDict::new(py);
        let usual = |joints: &Joints, wheels: &[usize], suffix| {
            let default = default_joints(&self.core, wheels, suffix);
            let names = |joint: &Joint| (joint.name.clone(), joint.wheel);
            joints.iter().map(names).eq(default.iter().map(names))
        };
        if !usual(&self.traction, &driven(&self.core), TRACTION) {
            keywords.set_item("traction_joints", self.joint_dict(py, &self.traction)?)?;
        }
        if !usual(&self.steering, self.core.steered(), STEERING) {
            keywords.set_item("steering_joints", self.joint_dict(py, &self.steering)?)?;
        }
        if !self.reversed().is_empty() {
            keywords.set_item("reversed_joints", PyTuple::new(py, self.reversed())?)?;
        }
        if let Some(suspension) = &self.suspension {
            keywords.set_item("suspension", suspension)?;
        }
        Ok(keywords)
    }
}

/// The wheels of a sequence.
fn read_wheels(wheels: &Bound<'_, PyAny>) -> PyResult<Vec<Wheel>> {
    let refused = |place: &str, value: &Bound<'_, PyAny>| {
        refuse_type("wheels", "be a sequence of Wheel", format!("{}{place}", short_repr(value)))
    };
    if wheels.try_iter().is_err() || wheels.is_instance_of::<PyDict>() {
        return Err(refused("", wheels));
    }
    let items = items("wheels", wheels, MOST_ITEMS)?;
    let wheel = |(k, item): (usize, &Bound<'_, PyAny>)| {
        let wheel = item.extract::<Wheel>();
        wheel.map_err(|_| refused(&format!(" at [{k}]"), item))
    };
    items.iter().enumerate().map(wheel).collect()
}

/// Implausible dimensions of a rover: tuples of the key, what is implausible about it, and what is likely.
#[pyfunction]
pub fn unit_questions(rover: &Rover) -> Vec<(&'static str, String, String)> {
    listed(units::dimensions(&rover.core))
}

/// Implausible settings of `Limits`, `Noise` or `FeasibilityLimits`, a dict by name, as [`unit_questions`] lists them.
#[pyfunction]
pub fn setting_questions(settings: &Bound<'_, PyDict>) -> Vec<(&'static str, String, String)> {
    listed(odd_settings(settings))
}

/// Warns of implausible settings.
#[pyfunction]
pub fn ask_settings(settings: &Bound<'_, PyDict>) -> PyResult<()> {
    warn_units(settings.py(), odd_settings(settings))
}

/// Implausible numbers of a dict. Values that are no numbers are skipped; the constructors refuse them.
fn odd_settings(settings: &Bound<'_, PyDict>) -> Vec<UnitSuspicion> {
    let numbers = settings
        .iter()
        .filter_map(|(name, value)| Some((name.extract::<String>().ok()?, value.extract::<f64>().ok()?)));
    let numbers: Vec<_> = numbers.collect();
    units::settings(numbers.iter().map(|(name, value)| (name.as_str(), *value)))
}

fn listed(suspicions: Vec<UnitSuspicion>) -> Vec<(&'static str, String, String)> {
    suspicions.into_iter().map(|odd| (odd.argument, odd.finding, odd.explanation)).collect()
}

argument_kind! { Rover: "a Rover", |value| {
    if value.is_instance_of::<Suspension>() {
        return "its planar(...), the rover seen from above".into();
    }
    match value.extract::<String>() {
        Ok(name) if PRESETS.iter().any(|preset| preset.name == name) => format!("sw.Rover.preset({name:?})"),
        Ok(_) => "sw.load(...) of a file, or sw.Rover.preset(...) of one of Rover.presets()".into(),
        Err(_) => "one that sw.Rover makes, or sw.load(...) of a file".into(),
    }
} }

getters! { Rover, self, py:
    /// The wheels, in the order of every array: ``wheels[0]`` or, by name, ``wheels["front_left"]``.
    wheels: Py<PyTuple> = self.wheels.clone_ref(py);
    /// Names of the wheels, in the order of every array.
    wheel_names: PyResult<Bound<'py, PyTuple>> = PyTuple::new(py, &self.wheels_and_steered()[0]);
    /// Joint name to wheel name of the wheel drives, in the order of the wheels, as in arrays of speeds.
    traction_joints: PyResult<Bound<'py, PyDict>> = self.joint_dict(py, &joints::in_order_of_wheels(&self.traction));
    /// Joint name to wheel name of the steering, in the order of `steered_wheel_names`, as in arrays of angles.
    steering_joints: PyResult<Bound<'py, PyDict>> = self.joint_dict(py, &joints::in_order_of_wheels(&self.steering));
    /// Names of the joints that count the other way.
    reversed_joints: PyResult<Bound<'py, PyTuple>> = PyTuple::new(py, self.reversed());
    /// Suspension of the six wheels, if the rover's file describes it; None otherwise.
    suspension: Option<Py<RockerBogie>> = self.suspension.as_ref().map(|arm| arm.clone_ref(py));
    /// Smallest radius from which on every turn is possible [m]: 0 if all are, infinite if none is.
    ///
    /// It counts along the axle line of the unsteered wheels, or abreast of the origin if there are none.
    min_radius: f64 = self.core.min_radius();
    /// Largest radius up to which every turn is possible [m]: 0 if the rover cannot turn on the spot.
    ///
    /// Between it and `min_radius` some turns are impossible.
    spin_radius: f64 = self.core.spin_radius();
    /// Names of the steered wheels, in the order of steering arrays.
    steered_wheel_names: PyResult<Bound<'py, PyTuple>> = PyTuple::new(py, &self.wheels_and_steered()[1]);
    /// Names of the steering joints, then of the traction joints, each in the order they were given in: that of
    /// `commands`, and for a rover from a parameter file that of the file.
    joint_names: PyResult<Bound<'py, PyTuple>> = {
        let names = self.steering.iter().chain(&self.traction);
        let names = names.map(|joint| &joint.name);
        PyTuple::new(py, names.collect::<Vec<_>>())
    };
}

methods! { Rover:
    #[new]
    fn new[py: Python<'py>](wheels, *, traction_joints: Option<&Bound<'py, PyMapping>> = None,
        steering_joints: Option<&Bound<'py, PyMapping>> = None,
        reversed_joints: Option<Vec<String>> = None, suspension: native Option<Py<RockerBogie>> = None, **)
    as "(wheels, *, traction_joints=None, steering_joints=None, reversed_joints=None, suspension=None)"
    -> PyResult<Self> {
        let wheels = read_wheels(wheels)?;
        let core = Core::new(wheels.into_iter().map(|wheel| wheel.0).collect());
        let core = core.or_raise(&[])?;
        warn_units(py, units::dimensions(&core))?;
        let fittings = RoverOptions {
            traction: traction_joints,
            steering: steering_joints,
            reversed: reversed_joints.unwrap_or_default(),
            suspension,
        };
        Self::build(py, core, fittings)
    }

    /// The same rover with other wheels, or with other arguments of its constructor.
    ///
    /// Names, order and joints of the wheels stay. Wheels that change no longer stand on the suspension they had, unless
    /// it is given again.
    #[doc = section!(Parameters)]
    /// wheel : str, optional
    ///     Name of the wheel that changes; default every wheel.
    /// **changes
    ///     Arguments of `Wheel` but for its name; `steering_limit` is that of every steered wheel. Without a name arguments of
    ///     `Rover`, too; of them `wheels` may be a dict of some wheels by name, each a `Wheel` or a dict of its changes. None
    ///     leaves one out, so that it has its default.
    #[doc = returns!("Rover")]
    #[doc = raises!(
        TypeError: "If there is no such argument; the message lists those there are.",
        ValueError: "If there is no such wheel, or a wheel or the rover may not be like that."
    )]
    fn replace[slf: &Bound<'py, Self>](wheel=None, /, **changes) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let changes = changes.cloned().unwrap_or_else(|| PyDict::new(py));
        py.import("six_wheel.kinematics.rover_edit")?.call_method1("replace_in_rover", (slf, wheel, changes))
    }
}

#[pymethods]
impl Rover {
    /// `replace`, for `copy.replace`.
    #[pyo3(signature = (**changes))]
    fn __replace__<'py>(slf: &Bound<'py, Self>, changes: Option<&Bound<'py, PyDict>>) -> PyResult<Bound<'py, PyAny>> {
        Self::replace(slf, None, changes)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let keywords = self.keywords(py)?;
        if keywords.is_empty()
            && let Some((name, range)) = Preset::of(&self.core)
        {
            let limit = range.map(|range| format!(", steering_limit={}", steering_limit(range)));
            return Ok(format!("Rover.preset('{name}'{})", limit.unwrap_or_default()));
        }
        if keywords.is_empty()
            && let Some(([half, to_rear, to_middle, middle], radius, range)) = self.core.as_six_wheel()
        {
            let (width, middle_width) = (2.0 * half, 2.0 * middle);
            let mut text = format!("Rover.six_wheel(front_to_middle={to_middle:?}, middle_to_rear={to_rear:?}");
            text += &format!(", track_width={width:?}");
            if middle_width != width {
                text += &format!(", middle_track_width={middle_width:?}");
            }
            text += &format!(", wheel_radius={radius:?}");
            if range != SteeringRange::default() {
                text += &format!(", steering_limit={}", steering_limit(range));
            }
            return Ok(text + ")");
        }
        let wheels = PyList::new(py, self.wheels.bind(py))?;
        repr_of_call("Rover", [wheels.into_any()], &keywords)
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| {
            let other = other.get();
            (&self.core, &self.traction, &self.steering) == (&other.core, &other.traction, &other.steering)
                && self.arm() == other.arm()
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
        reduce(slf.as_any(), &arguments, &rover.keywords(py)?)
    }
}
