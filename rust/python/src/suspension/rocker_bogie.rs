//! `six_wheel.RockerBogie`.

use std::sync::OnceLock;

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use six_wheel_numerics::error::Error;
use six_wheel_terrain::bounds::BoundsConstants;
use six_wheel_terrain::suspension::{
    Bogie, Differential, Dimensions, JointRange, PRESETS, RockerBogie as Core, Steered,
};

use super::base::{Suspension, joint_range, steering};
use crate::classes::repr_of_call;
use crate::convert::{OrRaise, number, numbers, refuse, refuse_type};

/// A rover on a rocker-bogie suspension: frames and Jacobians in 3D, and the rover seen from above.
///
/// A differential couples the rockers: the left one turns by `rho`, the right one by ``-rho``. Each
/// carries a wheel and a bogie, which turns by ``beta[0]`` on the left and ``beta[1]`` on the right and
/// carries two wheels. These angles count about +y, so a positive one lowers what lies ahead of the joint.
/// Methods take them as `joints`, rows of ``(rho, beta[0], beta[1])``. Steering angles count counter-clockwise.
///
/// The dimensions are those of the left-hand side with all joints at 0, as vectors ``(x, y, z)`` in the
/// axes of the rover's frame R (x forward, y left, z up) [m]; the right-hand side mirrors them. With the bogies
/// behind give `rocker_to_front`, `bogie_to_middle` and `bogie_to_rear`; with the bogies in front
/// `rocker_to_rear`, `bogie_to_front` and `bogie_to_middle`.
#[doc = section!(Parameters)]
/// rocker_pivot : (float, float, float)
///     From the origin of R to the rocker joint [m]. In the papers on Rocky 7: ``(k2, k3, k1)``.
/// rocker_to_front : (float, float, float)
///     From the rocker joint to the centre of the front wheel [m]: ``(k4, 0, -k5)``.
/// rocker_to_bogie : (float, float, float)
///     From the rocker joint to the bogie joint [m]: ``(k6 cos k9, 0, -k6 sin k9)``.
/// bogie_to_middle, bogie_to_rear : (float, float, float)
///     From the bogie joint to the centre of the middle and of the rear wheel [m]: ``(k7, k3b, -k8)`` and
///     ``(-k7, k3b, -k8)``.
/// wheel_radius : float
///     Hub to ground [m]: ``k10``.
/// steered : {'corners', 'front', 'all'}
///     Wheels that steer, about the upright axis through their centre.
#[doc = parameters!(steering_limit)]
/// rocker_to_rear, bogie_to_front : (float, float, float), optional
///     With the bogies in front: from the rocker joint to the centre of the rear wheel, from the bogie joint to
///     that of the front wheel [m].
/// rocker_limit, bogie_limit : float or (float, float), optional
///     Stops of `rho` and of each bogie: largest angle to either side, or smallest and largest [rad]; default
///     none.
/// differential_bar : (float, float, float), optional
///     Half length of a bar across the body, pivoted in its middle, the levers upright on the rockers and the
///     rods ahead of the bar that join them [m]; the right rocker then turns by ``-rho`` only nearly. Default
///     a gear.
#[doc = raises!(ValueError)]
///     If a number is not finite, the radius or a limit not positive, limits exclude 0, or a wheel of the
///     left-hand side does not lie to the left.
///
/// Source: M. Tarokh, G. McDermott, S. Hayati, J. Hung, Kinematic modeling of a high mobility Mars rover,
/// ICRA 1999.
#[pyclass(frozen, extends = Suspension, module = "six_wheel")]
pub struct RockerBogie(pub Core, pub(super) UsualPlans);

/// Those of its bounds, when they have been asked for.
type UsualPlans = OnceLock<[BoundsConstants; 2]>;

impl RockerBogie {
    fn build(core: Result<Core, Error>) -> PyResult<PyClassInitializer<Self>> {
        let core = core.or_raise(&[])?;
        let base = Suspension::of(core.chain().clone());
        Ok(PyClassInitializer::from(base).add_subclass(Self(core, UsualPlans::new())))
    }

    /// The rover with these vectors, in the order of [`Bogie::names`], and this radius of the wheels. What may be left
    /// out: the limits of steering, rockers and bogies, and the bar of the differential.
    fn read(
        py: Python<'_>,
        bogie: Bogie,
        vectors: [&Bound<'_, PyAny>; 5],
        wheel_radius: &Bound<'_, PyAny>,
        steered: &str,
        [steering_limit, rocker_limit, bogie_limit, bar]: [Option<&Bound<'_, PyAny>>; 4],
    ) -> PyResult<PyClassInitializer<Self>> {
        let names = bogie.names();
        let steering = steering(py, steering_limit)?;
        let read = |k: usize| numbers(names[k], vectors[k]);
        let (rocker_pivot, rocker_to_wheel, rocker_to_bogie) = (read(0)?, read(1)?, read(2)?);
        Self::build(Core::new(Dimensions {
            rocker_pivot,
            rocker_to_wheel,
            rocker_to_bogie,
            bogie_to_wheels: [read(3)?, read(4)?],
            bogie,
            wheel_radius: number("wheel_radius", wheel_radius)?,
            steered: steered.parse::<Steered>().or_raise(&[])?,
            steering,
            rocker_limit: joint_range("rocker_limit", rocker_limit)?,
            bogie_limit: joint_range("bogie_limit", bogie_limit)?,
            differential: match bar {
                None => Differential::Gear,
                Some(bar) => {
                    let [half_length, lever, rod] = numbers("differential_bar", bar)?;
                    Differential::Bar { half_length, lever, rod }
                }
            },
        }))
    }

    pub(super) fn named(py: Python<'_>, core: Result<Core, Error>) -> PyResult<Py<Self>> {
        Py::new(py, Self::build(core)?)
    }

    /// The rover itself.
    pub fn core(&self) -> &Core {
        &self.0
    }

    pub(super) fn steered(&self) -> &'static [usize] {
        self.0.dimensions().steered.wheels()
    }

    /// Name of a joint.
    fn joint_name(&self, joint: usize) -> String {
        match joint {
            0 => "rho".into(),
            1 | 2 => format!("beta_{joint}"),
            _ => format!("psi_{}", self.steered()[joint - 3] + 1),
        }
    }
}

result_class! {
    /// One row of the Denavit-Hartenberg table: ``Rotz(gamma) Transz(d) Transx(a) Rotx(alpha)`` from the parent.
    pub struct Link {
        /// Name of the frame.
        frame: String,
        /// Name of the frame it starts from; R is the rover's own.
        parent: String,
        /// Name of the joint whose angle is added to `gamma`, or None.
        joint: Option<String>,
        /// Sign with which it is; 0 without a joint.
        sign: f64,
        /// Angle about the parent's z axis at joint angle 0 [rad].
        gamma: f64,
        /// Shift along the parent's z axis [m].
        d: f64,
        /// Shift along the new x axis [m].
        a: f64,
        /// Angle about the new x axis [rad].
        alpha: f64,
    }
}

#[pymethods]
impl Link {
    fn __repr__(&self) -> String {
        let joint = self.joint.as_ref().map_or_else(|| "None".into(), |joint| format!("{joint:?}"));
        format!(
            "Link(frame={:?}, parent={:?}, joint={joint}, sign={:?}, gamma={:?}, d={:?}, a={:?}, alpha={:?})",
            self.frame, self.parent, self.sign, self.gamma, self.d, self.a, self.alpha
        )
    }
}

equal_by!(RockerBogie: 0);
pickled_by_keywords!(RockerBogie: dimensions);

getters! { RockerBogie, self, py:
    /// Names of the joints, in the order of the columns of `jacobians`.
    joint_names: PyResult<Bound<'py, PyTuple>> = {
        let names = (0..self.0.joint_count()).map(|joint| self.joint_name(joint));
        PyTuple::new(py, names.collect::<Vec<_>>())
    };
    /// The Denavit-Hartenberg table, one row per frame, parents before children.
    links: PyResult<Bound<'py, PyTuple>> = {
        let table = self.0.links();
        let links = table.map(|row| Link {
            frame: row.frame.into(),
            parent: row.parent.map_or("R", |parent| table[parent].frame).into(),
            joint: row.joint.map(|(joint, _)| self.joint_name(joint)),
            sign: row.joint.map_or(0.0, |(_, sign)| sign),
            gamma: row.gamma,
            d: row.d,
            a: row.a,
            alpha: row.alpha.sin.atan2(row.alpha.cos),
        });
        PyTuple::new(py, links)
    };
    /// The arguments that make this very suspension, by name.
    dimensions: PyResult<Bound<'py, PyDict>> = {
        let of = self.0.dimensions();
        let arguments = PyDict::new(py);
        for (argument, [x, y, z]) in of.vectors() {
            arguments.set_item(argument, (x, y, z))?;
        }
        arguments.set_item("wheel_radius", of.wheel_radius)?;
        arguments.set_item("steered", of.steered.name())?;
        arguments.set_item("steering_limit", (of.steering.lower, of.steering.upper))?;
        let limit = |range: JointRange| (!range.is_open()).then_some((range.lower, range.upper));
        arguments.set_item("rocker_limit", limit(of.rocker_limit))?;
        arguments.set_item("bogie_limit", limit(of.bogie_limit))?;
        let bar = match of.differential {
            Differential::Gear => None,
            Differential::Bar { half_length, lever, rod } => Some((half_length, lever, rod)),
        };
        arguments.set_item("differential_bar", bar)?;
        Ok(arguments)
    };
}

methods! { RockerBogie:
    #[new]
    fn new[py: Python<'py>](rocker_pivot=None, rocker_to_front=None, rocker_to_bogie=None, bogie_to_middle=None,
        bogie_to_rear=None, wheel_radius=None, steered: &str = "corners", steering_limit=None, *, rocker_to_rear=None,
        bogie_to_front=None, rocker_limit=None, bogie_limit=None, differential_bar=None, **)
    as "(rocker_pivot, rocker_to_front=None, rocker_to_bogie=None, bogie_to_middle=None, bogie_to_rear=None, wheel_radius=None, steered='corners', steering_limit=None, *, rocker_to_rear=None, bogie_to_front=None, rocker_limit=None, bogie_limit=None, differential_bar=None)"
    -> PyResult<PyClassInitializer<Self>> {
        let (bogie, vectors, unused) = match (rocker_to_rear, bogie_to_front) {
            (None, None) => (Bogie::Behind, [rocker_to_front, rocker_to_bogie, bogie_to_middle, bogie_to_rear], [None; 2]),
            _ => (
                Bogie::InFront,
                [rocker_to_rear, rocker_to_bogie, bogie_to_front, bogie_to_middle],
                [rocker_to_front.map(|_| "rocker_to_front"), bogie_to_rear.map(|_| "bogie_to_rear")],
            ),
        };
        if let Some(argument) = unused.into_iter().flatten().next() {
            return Err(refuse(argument, "be left out beside rocker_to_rear or bogie_to_front, which put the bogies in front", "a value"));
        }
        let [wheel, to_bogie, first, second] = vectors;
        let all = [rocker_pivot, wheel, to_bogie, first, second, wheel_radius];
        let names = bogie.names().into_iter().chain(["wheel_radius"]);
        let missing: Vec<_> = names.zip(all).filter(|(_, value)| value.is_none()).map(|(name, _)| name).collect();
        let [Some(pivot), Some(wheel), Some(to_bogie), Some(first), Some(second), Some(radius)] = all else {
            return Err(refuse_type(&missing.join(", "), "be given", "nothing"));
        };
        let optional = [steering_limit, rocker_limit, bogie_limit, differential_bar];
        Self::read(py, bogie, [pivot, wheel, to_bogie, first, second], radius, steered, optional)
    }

    /// A rover whose bogies are behind and carry the middle and the rear wheels, as on Perseverance.
    #[doc = section!(Parameters)]
    /// rocker_pivot, rocker_to_front, rocker_to_bogie, bogie_to_middle, bogie_to_rear : (float, float, float)
    ///     The vectors of the left-hand side with all joints at 0, as of the class [m].
    #[doc = parameters!(wheel_radius)]
    /// steered, steering_limit, rocker_limit, bogie_limit, differential_bar
    ///     As of the class.
    #[doc = raises!("As of the class.")]
    #[staticmethod]
    fn bogie_behind[py: Python<'py>](rocker_pivot, rocker_to_front, rocker_to_bogie, bogie_to_middle, bogie_to_rear,
        wheel_radius, steered: &str = "corners", steering_limit=None, *, rocker_limit=None, bogie_limit=None,
        differential_bar=None, **)
    as "(rocker_pivot, rocker_to_front, rocker_to_bogie, bogie_to_middle, bogie_to_rear, wheel_radius, steered='corners', steering_limit=None, *, rocker_limit=None, bogie_limit=None, differential_bar=None)"
    -> PyResult<Py<Self>> {
        let optional = [steering_limit, rocker_limit, bogie_limit, differential_bar];
        let vectors = [rocker_pivot, rocker_to_front, rocker_to_bogie, bogie_to_middle, bogie_to_rear];
        Py::new(py, Self::read(py, Bogie::Behind, vectors, wheel_radius, steered, optional)?)
    }

    /// A rover whose bogies are in front and carry the front and the middle wheels, as on the Open Source Rover.
    #[doc = section!(Parameters)]
    /// rocker_pivot, rocker_to_rear, rocker_to_bogie, bogie_to_front, bogie_to_middle : (float, float, float)
    ///     The vectors of the left-hand side with all joints at 0, as of the class [m].
    #[doc = parameters!(wheel_radius)]
    /// steered, steering_limit, rocker_limit, bogie_limit, differential_bar
    ///     As of the class.
    #[doc = raises!("As of the class.")]
    #[staticmethod]
    fn bogie_in_front[py: Python<'py>](rocker_pivot, rocker_to_rear, rocker_to_bogie, bogie_to_front, bogie_to_middle,
        wheel_radius, steered: &str = "corners", steering_limit=None, *, rocker_limit=None, bogie_limit=None,
        differential_bar=None, **)
    as "(rocker_pivot, rocker_to_rear, rocker_to_bogie, bogie_to_front, bogie_to_middle, wheel_radius, steered='corners', steering_limit=None, *, rocker_limit=None, bogie_limit=None, differential_bar=None)"
    -> PyResult<Py<Self>> {
        let optional = [steering_limit, rocker_limit, bogie_limit, differential_bar];
        let vectors = [rocker_pivot, rocker_to_rear, rocker_to_bogie, bogie_to_front, bogie_to_middle];
        Py::new(py, Self::read(py, Bogie::InFront, vectors, wheel_radius, steered, optional)?)
    }

    /// The text of a URDF from which `load` makes a rover on this suspension, and which viewers open.
    #[doc = section!(Parameters)]
    /// name : str
    ///     Of the robot.
    #[doc = returns!("str")]
    ///     Rockers, bogies, steering and wheels as links and joints; the base link is the rover's frame R.
    #[doc = raises!(TypeError: "If the name is not a str.")]
    fn urdf[slf: &Bound<'py, Self>](name: &str = "rover") -> PyResult<String> {
        let module = slf.py().import("six_wheel.robot_description.urdf")?;
        module.call_method1("suspension_urdf", (slf, name))?.extract()
    }
}

#[pymethods]
impl RockerBogie {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let preset = PRESETS.iter().find(|preset| Core::preset(preset.name).is_ok_and(|made| made == self.0));
        preset.map_or_else(
            || repr_of_call("RockerBogie", [], &self.dimensions(py)?),
            |preset| Ok(format!("RockerBogie.preset('{}')", preset.name)),
        )
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        // Numbers hash in Python so that zeros of either sign hash alike.
        PyTuple::new(py, self.dimensions(py)?.values())?.hash()
    }
}
