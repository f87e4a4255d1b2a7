//! The named layouts of `Rover` that steer as cars do: one or two steered wheels in front.

use pyo3::prelude::*;
use six_wheel_kinematics::layouts::Drive;
use six_wheel_kinematics::rover::Rover as Core;
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_numerics::error::Error;

use super::per_wheel::PerWheel;
use crate::arguments;
use crate::convert::{OrRaise, number};
use crate::rover::Rover;

fn drive(name: &str) -> PyResult<Drive> {
    name.parse::<Drive>().or_raise(&[])
}

impl Rover {
    /// A layout with a wheelbase, a track width and a wheel radius.
    fn car(
        py: Python<'_>,
        [wheelbase, track_width, wheel_radius]: [&Bound<'_, PyAny>; 3],
        driven: &str,
        given: &PerWheel<'_, '_>,
        layout: impl FnOnce(f64, f64, f64, SteeringRange, Drive) -> Result<Core, Error>,
    ) -> PyResult<Self> {
        let base = number("wheelbase", wheelbase)?;
        let track = number("track_width", track_width)?;
        let radius = number("wheel_radius", wheel_radius)?;
        Self::named(py, Ok(given.fit(layout(base, track, radius, SteeringRange::default(), drive(driven)?))?))
    }
}

#[pymethods]
impl Rover {
    /// A car with Ackermann steering: steered front wheels, fixed rear wheels, origin between the rear ones.
    ///
    /// Each front wheel has an angle of its own; their axles meet in the centre of rotation.
    ///
    /// Parameters
    /// ----------
    /// wheelbase : float
    ///     Rear axle to front axle [m].
    /// track_width : float
    ///     Left to right wheel [m].
    /// wheel_radius : float
    ///     Hub to ground [m].
    /// steering_limit : float, (float, float), sequence or mapping, optional
    ///     Largest steering angle to either side, or smallest and largest [rad]; default a quarter turn, ``math.inf`` for endless.
    ///     Of both front wheels or one each: a mapping by name, or a sequence of pairs.
    /// driven : {'rear', 'front', 'all'}
    ///     Wheels that have motors; the others roll along.
    /// scrub, trail : float, sequence or mapping of str to float, default 0.0
    ///     Contact to the left of the steering axis, and behind it [m]. Of every wheel alike, left and right ones too, or one
    ///     each: in their order, or by name.
    /// names : sequence of str, optional
    ///     Default ``front_left``, ``front_right``, ``rear_left``, ``rear_right``; in that order.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a length or the limit is not finite and positive.
    #[staticmethod]
    #[pyo3(
        signature = (wheelbase, track_width, wheel_radius, *, steering_limit=None, driven="rear", scrub=None, trail=None, names=None),
        text_signature = "(wheelbase, track_width, wheel_radius, *, steering_limit=None, driven='rear', scrub=0.0, trail=0.0, names=None)"
    )]
    fn ackermann(
        py: Python<'_>,
        wheelbase: &Bound<'_, PyAny>,
        track_width: &Bound<'_, PyAny>,
        wheel_radius: &Bound<'_, PyAny>,
        steering_limit: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = arguments::driven)] driven: &str,
        scrub: Option<&Bound<'_, PyAny>>,
        trail: Option<&Bound<'_, PyAny>>,
        names: Option<Vec<String>>,
    ) -> PyResult<Self> {
        let lengths = [wheelbase, track_width, wheel_radius];
        let given = PerWheel { steering_limit, scrub, trail, names };
        Self::car(py, lengths, driven, &given, Core::ackermann)
    }

    /// A tricycle: one steered front wheel, two fixed rear wheels, origin between the rear ones.
    ///
    /// Parameters
    /// ----------
    /// wheelbase : float
    ///     Rear axle to front wheel [m].
    /// track_width : float
    ///     Left to right rear wheel [m].
    /// wheel_radius : float
    ///     Hub to ground [m].
    /// steering_limit : float, (float, float), sequence or mapping, optional
    ///     Largest steering angle to either side, or smallest and largest [rad]; default a quarter turn, ``math.inf`` for endless.
    ///     Of the front wheel: a mapping by name, or a sequence of pairs.
    /// driven : {'front', 'rear', 'all'}
    ///     Wheels that have motors; the others roll along.
    /// scrub, trail : float, sequence or mapping of str to float, default 0.0
    ///     Contact to the left of the steering axis, and behind it [m]. Of every wheel alike, left and right ones too, or one
    ///     each: in their order, or by name.
    /// names : sequence of str, optional
    ///     Default ``front``, ``rear_left``, ``rear_right``; in that order.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a length or the limit is not finite and positive.
    #[staticmethod]
    #[pyo3(
        signature = (wheelbase, track_width, wheel_radius, *, steering_limit=None, driven="front", scrub=None, trail=None, names=None),
        text_signature = "(wheelbase, track_width, wheel_radius, *, steering_limit=None, driven='front', scrub=0.0, trail=0.0, names=None)"
    )]
    fn tricycle(
        py: Python<'_>,
        wheelbase: &Bound<'_, PyAny>,
        track_width: &Bound<'_, PyAny>,
        wheel_radius: &Bound<'_, PyAny>,
        steering_limit: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = arguments::driven)] driven: &str,
        scrub: Option<&Bound<'_, PyAny>>,
        trail: Option<&Bound<'_, PyAny>>,
        names: Option<Vec<String>>,
    ) -> PyResult<Self> {
        let lengths = [wheelbase, track_width, wheel_radius];
        let given = PerWheel { steering_limit, scrub, trail, names };
        Self::car(py, lengths, driven, &given, Core::tricycle)
    }

    /// A bicycle: a steered front wheel, a fixed rear wheel, origin at the rear one.
    ///
    /// Parameters
    /// ----------
    /// wheelbase : float
    ///     Rear wheel to front wheel [m].
    /// wheel_radius : float
    ///     Hub to ground [m].
    /// steering_limit : float, (float, float), sequence or mapping, optional
    ///     Largest steering angle to either side, or smallest and largest [rad]; default a quarter turn, ``math.inf`` for endless.
    ///     Of the front wheel: a mapping by name, or a sequence of pairs.
    /// driven : {'rear', 'front', 'all'}
    ///     Wheels that have motors; the others roll along.
    /// scrub, trail : float, sequence or mapping of str to float, default 0.0
    ///     Contact to the left of the steering axis, and behind it [m]. Of every wheel alike, left and right ones too, or one
    ///     each: in their order, or by name.
    /// names : sequence of str, optional
    ///     Default ``front``, ``rear``; in that order.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a length or the limit is not finite and positive.
    #[staticmethod]
    #[pyo3(
        signature = (wheelbase, wheel_radius, *, steering_limit=None, driven="rear", scrub=None, trail=None, names=None),
        text_signature = "(wheelbase, wheel_radius, *, steering_limit=None, driven='rear', scrub=0.0, trail=0.0, names=None)"
    )]
    fn bicycle(
        py: Python<'_>,
        wheelbase: &Bound<'_, PyAny>,
        wheel_radius: &Bound<'_, PyAny>,
        steering_limit: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = arguments::driven)] driven: &str,
        scrub: Option<&Bound<'_, PyAny>>,
        trail: Option<&Bound<'_, PyAny>>,
        names: Option<Vec<String>>,
    ) -> PyResult<Self> {
        let base = number("wheelbase", wheelbase)?;
        let radius = number("wheel_radius", wheel_radius)?;
        let given = PerWheel { steering_limit, scrub, trail, names };
        Self::named(py, Ok(given.fit(Core::bicycle(base, radius, SteeringRange::default(), drive(driven)?))?))
    }
}
