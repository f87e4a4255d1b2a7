//! `six_wheel.Suspension`: any chain of parts and wheels.

use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use six_wheel_ground_motion::Prepared;
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_kinematics::units;
use six_wheel_numerics::error::Error;
use six_wheel_terrain::suspension::{Chain, JointRange, TripleBogie};

use crate::classes::{reduce, repr_of_call};
use crate::convert::{OrRaise, Rows, choice, pair_or_one, refuse, shape_text};
use crate::unit_warnings::warn_units;
use crate::wheel::steering_range;

/// A suspension as data: parts that turn about axes of their parents, and wheels mounted on them.
///
/// `RockerBogie` is one of them; `triple_bogie`, `pivoting_axles` and `rigid` make others. What settles on
/// ground works on any.
#[pyclass(frozen, subclass, module = "six_wheel")]
pub struct Suspension {
    /// The parts, joints and wheels.
    pub chain: Chain,
    /// The constants of its motion, in a box: their registers need more alignment than the memory of Python's objects has.
    pub motion: Box<Prepared>,
    /// The name of what made it, and its arguments.
    made: Option<(&'static str, Py<PyDict>)>,
}

impl Suspension {
    /// The face of a chain that a subclass makes.
    pub fn of(chain: Chain) -> Self {
        Self { motion: Box::new(Prepared::new(&chain)), chain, made: None }
    }

    /// The face of a chain, and how it is made again.
    fn made(chain: Result<Chain, Error>, name: &'static str, arguments: Bound<'_, PyDict>) -> PyResult<Self> {
        let chain = chain.or_raise(&[])?;
        for (name, value) in arguments.copy()?.iter() {
            if value.is_none() {
                arguments.del_item(name)?;
            }
        }
        Ok(Self { made: Some((name, arguments.unbind())), ..Self::of(chain) })
    }
}

/// Stops of a joint: one angle for both sides, a pair, or none.
pub fn joint_range(argument: &'static str, limit: Option<&Bound<'_, PyAny>>) -> PyResult<JointRange> {
    let Some(limit) = limit else { return Ok(JointRange::default()) };
    let range = match pair_or_one(argument, limit)? {
        Ok([lower, upper]) => JointRange { lower, upper },
        Err(limit) => JointRange { lower: -limit, upper: limit },
    };
    range.check(argument).or_raise(&[])?;
    Ok(range)
}

/// Range of a suspension's steered wheels, which is asked about where it is likely in degrees.
pub fn steering(py: Python<'_>, limit: Option<&Bound<'_, PyAny>>) -> PyResult<SteeringRange> {
    let range = steering_range(limit)?.unwrap_or_default();
    warn_units(py, units::steering(range))?;
    Ok(range)
}

/// A place as a tuple.
fn place([x, y, z]: [f64; 3]) -> (f64, f64, f64) {
    (x, y, z)
}

/// The pairs that steer.
fn pairs(steered: &str) -> PyResult<[bool; 3]> {
    let all = [("front", [true, false, false]), ("corners", [true, false, true]), ("all", [true; 3])];
    choice("steered", steered, |name| format!("{name:?}"), &all)
}

argument_kind! { Suspension: "a Suspension, such as a RockerBogie", |_| r#"one like sw.RockerBogie.preset("perseverance")"#.into() }

getters! { Suspension, self, py:
    /// Names of the wheels, in the order of every array.
    wheel_names: PyResult<Bound<'py, PyTuple>> = PyTuple::new(py, self.chain.wheels().iter().map(|wheel| &*wheel.name));
    /// Names of the free angles, in the order of `joints` of a settled pose.
    free_joints: PyResult<Bound<'py, PyTuple>> = PyTuple::new(py, self.chain.joints().iter().map(|joint| &*joint.name));
}

equal_by!(Suspension: chain);
replaceable!(Suspension);

methods! { Suspension:
    /// Six wheels on three bogies, as on ExoMars.
    ///
    /// Left and right bogie each carry a front and a middle wheel and turn about +y, positive with the front
    /// down; the one behind lies across, carries the rear wheels and turns about +x, positive with its right side
    /// down. Free angles beta_1 (left), beta_2 (right), beta_3 (rear). Vectors ``(x, y, z)`` [m] are those of
    /// the left-hand side with all joints at 0, in the axes of the rover.
    #[doc = section!(Parameters)]
    /// bogie_pivot, bogie_to_front, bogie_to_middle : (float, float, float)
    ///     From the rover's origin to the axis of the left bogie, and from there to the centres of its wheels [m].
    /// rear_pivot, rear_to_wheel : (float, float, float)
    ///     From the rover's origin to the axis of the rear bogie, and from there to the centre of its left wheel [m].
    #[doc = parameters!(wheel_radius)]
    /// steered : {'corners', 'front', 'all'}
    ///     Wheels that steer, about the upright axis through their centre.
    #[doc = parameters!(steering_limit)]
    /// bogie_limit : float or (float, float), optional
    ///     Stops of each bogie [rad]; default none.
    #[doc = returns!("Suspension")]
    #[doc = raises!("If a number is not finite, or the radius or a limit makes no sense.")]
    #[staticmethod]
    fn triple_bogie[py: Python<'py>](*, bogie_pivot: [f64; 3], bogie_to_front: [f64; 3], bogie_to_middle: [f64; 3],
        rear_pivot: [f64; 3], rear_to_wheel: [f64; 3], wheel_radius: f64, steered: &str = "corners",
        steering_limit=None, bogie_limit=None, **)
    as "(*, bogie_pivot, bogie_to_front, bogie_to_middle, rear_pivot, rear_to_wheel, wheel_radius, steered='corners', steering_limit=None, bogie_limit=None)" -> PyResult<Self> {
        let of = TripleBogie {
            bogie_pivot,
            bogie_to_front,
            bogie_to_middle,
            rear_pivot,
            rear_to_wheel,
            wheel_radius,
            steered: pairs(steered)?,
            steering: steering(py, steering_limit)?,
            bogie_limit: joint_range("bogie_limit", bogie_limit)?,
        };
        let vectors = [bogie_pivot, bogie_to_front, bogie_to_middle, rear_pivot, rear_to_wheel];
        let [bogie_pivot, bogie_to_front, bogie_to_middle, rear_pivot, rear_to_wheel] = vectors.map(place);
        let arguments = dict!(
            py, bogie_pivot, bogie_to_front, bogie_to_middle, rear_pivot, rear_to_wheel, wheel_radius, steered,
            steering_limit, bogie_limit
        );
        Self::made(Chain::triple_bogie(&of), "triple_bogie", arguments)
    }

    /// Four wheels on two axles that pivot about the vertical in their middle; the rear one also rolls.
    ///
    /// The steering angles are those of the axles, front and rear. The free angle gamma is that of the rear axle about
    /// +x, positive with its right side down. The origin is midway between the pivots.
    #[doc = section!(Parameters)]
    /// wheelbase, track_width : float
    ///     Front to rear axle, left to right wheel [m].
    /// drop : float
    ///     Pivots above the wheel centres [m].
    #[doc = parameters!(wheel_radius, steering_limit)]
    /// roll_limit : float or (float, float), optional
    ///     Stops of the rear axle's roll [rad]; default none.
    #[doc = returns!("Suspension")]
    #[doc = raises!("If a length is not positive or a limit makes no sense.")]
    #[staticmethod]
    pub fn pivoting_axles[py: Python<'py>](*, wheelbase: f64, track_width: f64, drop: f64, wheel_radius: f64,
        steering_limit=None, roll_limit=None, **)
    as "(*, wheelbase, track_width, drop, wheel_radius, steering_limit=None, roll_limit=None)" -> PyResult<Self> {
        let (steer, roll) = (steering(py, steering_limit)?, joint_range("roll_limit", roll_limit)?);
        let chain = Chain::pivoting_axles(wheelbase, track_width, drop, wheel_radius, steer, roll);
        let arguments = dict!(py, wheelbase, track_width, drop, wheel_radius, steering_limit, roll_limit);
        Self::made(chain, "pivoting_axles", arguments)
    }

    /// Three to six wheels on the body itself, of which three touch at a time.
    #[doc = section!(Parameters)]
    /// centres : array_like, shape (wheels, 3)
    ///     Wheel centres in the body, front to rear, left before right [m].
    #[doc = parameters!(wheel_radius, names "Default ``wheel_1`` and so on.")]
    /// steered : sequence of int
    ///     Indices of the wheels that steer, about the upright axis through their centre.
    #[doc = parameters!(steering_limit)]
    #[doc = returns!("Suspension")]
    #[doc = raises!("If there are too few or too many wheels, or a number makes no sense.")]
    #[staticmethod]
    fn rigid[py: Python<'py>](centres, wheel_radius: f64, *, names: Option<Vec<String>> = None,
        steered: Vec<usize> = (Vec::new()), steering_limit=None, **)
    as "(centres, wheel_radius, *, names=None, steered=(), steering_limit=None)" -> PyResult<Self> {
        let rows = Rows::read("centres", centres, 3)?.table()?;
        let range = steering(py, steering_limit)?;
        let count = rows.count();
        let numbered = || (1..=count).map(|wheel| format!("wheel_{wheel}")).collect();
        let names: Vec<String> = names.unwrap_or_else(numbered);
        if names.len() != count {
            return Err(refuse("names", format!("hold {count}, one for each of the centres"), names.len()));
        }
        if let Some(wheel) = steered.iter().find(|&&wheel| wheel >= count) {
            return Err(refuse("steered", format!("hold indices of wheels, of shape {}", shape_text(&[count])), wheel));
        }
        let wheels: Vec<_> = names
            .iter()
            .zip(rows.triples())
            .enumerate()
            .map(|(k, (name, centre))| (name.as_str(), *centre, steered.contains(&k).then_some(range)))
            .collect();
        let centres: Vec<_> = rows.triples().iter().map(|centre| place(*centre)).collect();
        let arguments = dict!(py, centres, wheel_radius, names = &names, steered = &steered, steering_limit);
        Self::made(Chain::rigid(&wheels, wheel_radius), "rigid", arguments)
    }
}

#[pymethods]
impl Suspension {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let Some((name, arguments)) = &self.made else { return Ok("Suspension(...)".into()) };
        repr_of_call(&format!("Suspension.{name}"), [], arguments.bind(py))
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        let centres = self.chain.wheels().iter().flat_map(|wheel| {
            let [x, y, z] = wheel.centre.into();
            [x, y, z, wheel.radius]
        });
        PyTuple::new(py, centres.collect::<Vec<f64>>())?.hash()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let py = slf.py();
        let Some((name, arguments)) = &slf.get().made else {
            return reduce(slf.as_any(), &PyTuple::empty(py), &PyDict::new(py));
        };
        let make = py.get_type::<Self>().getattr(*name)?;
        let partial = py.import("functools")?.call_method(intern!(py, "partial"), (make,), Some(arguments.bind(py)))?;
        (partial, PyTuple::empty(py)).into_pyobject(py)
    }
}
