//! `six_wheel.RockerBogie`: a suspension as data.

mod chain;
mod steer;

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use six_wheel_core::suspension::{Dimensions, Steered};
use six_wheel_core::{Error, RockerBogie as Core};

use crate::convert::{Rows, number, raise, refuse, shape_text};
use crate::wheel::{reduce, steering_range};

pub use steer::SteeringCommand;

/// A rover on a rocker-bogie suspension: frames and Jacobians in 3D, and the rover seen from above.
///
/// A differential couples the rockers: the left one turns by `rho`, the right one by ``-rho``. Each
/// carries a front wheel and a bogie, which turns by ``beta[0]`` on the left and ``beta[1]`` on the right
/// and carries a middle and a rear wheel. These angles count about +y, so a positive one lowers what lies
/// ahead of the joint. Steering angles `psi` count counter-clockwise.
///
/// The dimensions are those of the left-hand side with all joints at 0, as vectors ``(x, y, z)`` in the
/// axes of the rover's frame R (x forward, y left, z up) [m]; the right-hand side mirrors them.
///
/// Parameters
/// ----------
/// rocker_pivot : (float, float, float)
///     From the origin of R to the rocker joint. In the papers on Rocky 7: ``(k2, k3, k1)``.
/// rocker_to_front : (float, float, float)
///     From the rocker joint to the centre of the front wheel: ``(k4, 0, -k5)``.
/// rocker_to_bogie : (float, float, float)
///     From the rocker joint to the bogie joint: ``(k6 cos k9, 0, -k6 sin k9)``.
/// bogie_to_middle, bogie_to_rear : (float, float, float)
///     From the bogie joint to the centre of the middle and of the rear wheel: ``(k7, k3b, -k8)`` and
///     ``(-k7, k3b, -k8)``.
/// wheel_radius : float
///     Hub to ground [m]: ``k10``.
/// steered : {'corners', 'front'}
///     Which wheels steer, about the upright axis through their centre.
/// steering_limit : float or (float, float), optional
///     Largest steering angle to either side, or smallest and largest [rad]; default a quarter turn.
///
/// Raises
/// ------
/// ValueError
///     If a number is not finite, the radius or the limit not positive, or a wheel of the left-hand side
///     does not lie to the left.
///
/// Source: M. Tarokh, G. McDermott, S. Hayati, J. Hung, Kinematic modeling of a high mobility Mars rover,
/// ICRA 1999.
#[pyclass(frozen, module = "six_wheel")]
pub struct RockerBogie(pub Core);

impl RockerBogie {
    fn build(core: Result<Core, Error>) -> PyResult<Self> {
        core.map(Self).map_err(|error| raise(error, &[]))
    }

    fn steered(&self) -> &'static [usize] {
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

/// One row of the Denavit-Hartenberg table: ``Rotz(gamma) Transz(d) Transx(a) Rotx(alpha)`` from the parent.
#[pyclass(frozen, get_all, module = "six_wheel")]
pub struct Link {
    /// Name of the frame.
    frame: &'static str,
    /// Name of the frame it starts from; R is the rover's own.
    parent: &'static str,
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

#[pymethods]
impl Link {
    fn __repr__(&self) -> String {
        let joint = self
            .joint
            .as_ref()
            .map_or_else(|| "None".into(), |joint| format!("{joint:?}"));
        format!(
            "Link(frame={:?}, parent={:?}, joint={joint}, sign={:?}, gamma={:?}, d={:?}, a={:?}, alpha={:?})",
            self.frame, self.parent, self.sign, self.gamma, self.d, self.a, self.alpha
        )
    }
}

/// Reads three numbers.
fn vector(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<[f64; 3]> {
    let row = Rows::read(argument, value, 3)?;
    match row.triples() {
        [one] if row.is_single() => Ok(*one),
        _ => {
            let got = format!("shape {}", shape_text(&row.shape()));
            Err(refuse(argument, "hold three numbers", &got))
        }
    }
}

#[pymethods]
impl RockerBogie {
    #[new]
    #[pyo3(
        signature = (rocker_pivot, rocker_to_front, rocker_to_bogie, bogie_to_middle, bogie_to_rear, wheel_radius, steered="corners", steering_limit=None)
    )]
    #[allow(clippy::too_many_arguments)] // they are keywords
    fn new(
        rocker_pivot: &Bound<'_, PyAny>,
        rocker_to_front: &Bound<'_, PyAny>,
        rocker_to_bogie: &Bound<'_, PyAny>,
        bogie_to_middle: &Bound<'_, PyAny>,
        bogie_to_rear: &Bound<'_, PyAny>,
        wheel_radius: &Bound<'_, PyAny>,
        steered: &str,
        steering_limit: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let steered = steered.parse::<Steered>();
        Self::build(Core::new(Dimensions {
            rocker_pivot: vector("rocker_pivot", rocker_pivot)?,
            rocker_to_front: vector("rocker_to_front", rocker_to_front)?,
            rocker_to_bogie: vector("rocker_to_bogie", rocker_to_bogie)?,
            bogie_to_middle: vector("bogie_to_middle", bogie_to_middle)?,
            bogie_to_rear: vector("bogie_to_rear", bogie_to_rear)?,
            wheel_radius: number("wheel_radius", wheel_radius)?,
            steered: steered.map_err(|error| raise(error, &[]))?,
            steering: steering_range(steering_limit)?.unwrap_or_default(),
        }))
    }

    /// Rocky 7: two steered front wheels, limited to 60 degrees.
    ///
    /// Frame R as in the papers, between the bogie joints to 3.5 um, 0.085 m above the ground.
    ///
    /// Source: nealseegmiller/wmrde, Rocky 7 model after Tarokh and McDermott (da081e4).
    #[staticmethod]
    fn rocky7() -> PyResult<Self> {
        Self::build(Core::rocky7())
    }

    /// Perseverance: four steered corners.
    ///
    /// Frame R on the ground under the middle of the middle wheels. No steering limit is published.
    ///
    /// Source: nasa-jpl/m2020-urdf-models, rover/m2020.urdf (c422fc6).
    #[staticmethod]
    fn perseverance() -> PyResult<Self> {
        Self::build(Core::perseverance())
    }

    /// Curiosity, to about 1 cm: four steered corners.
    ///
    /// Frame R on the ground under the middle of the middle wheels. No steering limit is published.
    ///
    /// Source: Project Chrono Curiosity model (BSD-3-Clause), read off a 3D model; origin moved from the
    /// chassis by (-0.089, 0, -0.001), radius half the nominal wheel diameter.
    #[staticmethod]
    fn curiosity() -> PyResult<Self> {
        Self::build(Core::curiosity())
    }

    /// The Denavit-Hartenberg table, one row per frame, parents before children.
    #[getter]
    fn links<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let table = self.0.links();
        let links = table.map(|row| Link {
            frame: row.frame,
            parent: row.parent.map_or("R", |parent| table[parent].frame),
            joint: row.joint.map(|(joint, _)| self.joint_name(joint)),
            sign: row.joint.map_or(0.0, |(_, sign)| sign),
            gamma: row.gamma,
            d: row.d,
            a: row.a,
            alpha: row.alpha.sin.atan2(row.alpha.cos),
        });
        PyTuple::new(py, links)
    }

    /// Names of the joints, in the order of the columns of `jacobians`.
    #[getter]
    fn joint_names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let names = (0..self.0.joint_count()).map(|joint| self.joint_name(joint));
        PyTuple::new(py, names.collect::<Vec<_>>())
    }

    /// The arguments that make this very suspension, by name.
    #[getter]
    fn dimensions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let of = self.0.dimensions();
        let arguments = PyDict::new(py);
        let vectors = [
            ("rocker_pivot", of.rocker_pivot),
            ("rocker_to_front", of.rocker_to_front),
            ("rocker_to_bogie", of.rocker_to_bogie),
            ("bogie_to_middle", of.bogie_to_middle),
            ("bogie_to_rear", of.bogie_to_rear),
        ];
        for (argument, [x, y, z]) in vectors {
            arguments.set_item(argument, (x, y, z))?;
        }
        arguments.set_item("wheel_radius", of.wheel_radius)?;
        arguments.set_item("steered", of.steered.name())?;
        arguments.set_item("steering_limit", (of.steering.lower, of.steering.upper))?;
        Ok(arguments)
    }

    /// The text of a URDF from which `load` makes a rover on this suspension, and which viewers open.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     Of the robot.
    ///
    /// Returns
    /// -------
    /// str
    ///     Rockers, bogies, steering and wheels as links and joints; the base link is the rover's frame R.
    #[pyo3(signature = (name="rover"))]
    fn urdf(slf: &Bound<'_, Self>, name: &str) -> PyResult<String> {
        let module = slf.py().import("six_wheel.urdf")?;
        module
            .call_method1("suspension_urdf", (slf, name))?
            .extract()
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let mut texts = Vec::new();
        for (argument, value) in self.dimensions(py)?.iter() {
            texts.push(format!("{argument}={}", value.repr()?));
        }
        Ok(format!("RockerBogie({})", texts.join(", ")))
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other
            .cast::<Self>()
            .is_ok_and(|other| other.get().0 == self.0)
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        // Numbers hash in Python so that zeros of either sign hash alike.
        PyTuple::new(py, self.dimensions(py)?.values())?.hash()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let py = slf.py();
        reduce(
            slf.as_any(),
            &PyTuple::empty(py),
            &slf.get().dimensions(py)?,
        )
    }
}
