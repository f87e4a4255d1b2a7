//! The named layouts of `Rover` that steer as cars do: one or two steered wheels in front.

use pyo3::prelude::*;
use six_wheel_kinematics::layouts::Drive;
use six_wheel_kinematics::rover::Rover as Core;
use six_wheel_kinematics::steering::SteeringRange;

use super::per_wheel::PerWheel;
use crate::convert::OrRaise;
use crate::rover::Rover;

fn drive(name: &str) -> PyResult<Drive> {
    name.parse::<Drive>().or_raise(&[])
}

methods! { Rover:
    /// A car with Ackermann steering: steered front wheels, fixed rear wheels, origin between the rear ones.
    ///
    /// Each front wheel has an angle of its own; their axles meet in the centre of rotation.
    #[doc = section!(Parameters)]
    /// wheelbase : float
    ///     Rear axle to front axle [m].
    /// track_width : float
    ///     Left to right wheel [m].
    #[doc = parameters!(wheel_radius, steering_limit "Of both front wheels or one each")]
    /// driven : {'rear', 'front', 'all'}
    ///     Wheels that have motors; the others roll along.
    #[doc = parameters!(scrub_and_trail)]
    #[doc = parameters!(names "Default ``front_left``, ``front_right``, ``rear_left``, ``rear_right``; in that order.")]
    #[doc = raises!("If a length or the limit is not finite and positive.")]
    #[staticmethod]
    fn ackermann[py: Python<'py>](wheelbase: f64, track_width: f64, wheel_radius: f64, *, steering_limit=None,
        driven: &str = "rear", scrub=None, trail=None, names: Option<Vec<String>> = None, **)
    as "(wheelbase, track_width, wheel_radius, *, steering_limit=None, driven='rear', scrub=0.0, trail=0.0, names=None)"
    -> PyResult<Self> {
        let given = PerWheel { steering_limit, scrub, trail, names };
        let (driven, range) = (drive(driven)?, SteeringRange::default());
        given.fit(py, Core::ackermann(wheelbase, track_width, wheel_radius, range, driven))
    }

    /// A tricycle: one steered front wheel, two fixed rear wheels, origin between the rear ones.
    #[doc = section!(Parameters)]
    /// wheelbase : float
    ///     Rear axle to front wheel [m].
    /// track_width : float
    ///     Left to right rear wheel [m].
    #[doc = parameters!(wheel_radius, steering_limit "Of the front wheel")]
    /// driven : {'front', 'rear', 'all'}
    ///     Wheels that have motors; the others roll along.
    #[doc = parameters!(scrub_and_trail, names "Default ``front``, ``rear_left``, ``rear_right``; in that order.")]
    #[doc = raises!("If a length or the limit is not finite and positive.")]
    #[staticmethod]
    fn tricycle[py: Python<'py>](wheelbase: f64, track_width: f64, wheel_radius: f64, *, steering_limit=None,
        driven: &str = "front", scrub=None, trail=None, names: Option<Vec<String>> = None, **)
    as "(wheelbase, track_width, wheel_radius, *, steering_limit=None, driven='front', scrub=0.0, trail=0.0, names=None)"
    -> PyResult<Self> {
        let given = PerWheel { steering_limit, scrub, trail, names };
        let (driven, range) = (drive(driven)?, SteeringRange::default());
        given.fit(py, Core::tricycle(wheelbase, track_width, wheel_radius, range, driven))
    }

    /// A bicycle: a steered front wheel, a fixed rear wheel, origin at the rear one.
    #[doc = section!(Parameters)]
    /// wheelbase : float
    ///     Rear wheel to front wheel [m].
    #[doc = parameters!(wheel_radius, steering_limit "Of the front wheel")]
    /// driven : {'rear', 'front', 'all'}
    ///     Wheels that have motors; the others roll along.
    #[doc = parameters!(scrub_and_trail, names "Default ``front``, ``rear``; in that order.")]
    #[doc = raises!("If a length or the limit is not finite and positive.")]
    #[staticmethod]
    fn bicycle[py: Python<'py>](wheelbase: f64, wheel_radius: f64, *, steering_limit=None, driven: &str = "rear",
        scrub=None, trail=None, names: Option<Vec<String>> = None, **)
    as "(wheelbase, wheel_radius, *, steering_limit=None, driven='rear', scrub=0.0, trail=0.0, names=None)"
    -> PyResult<Self> {
        let given = PerWheel { steering_limit, scrub, trail, names };
        given.fit(py, Core::bicycle(wheelbase, wheel_radius, SteeringRange::default(), drive(driven)?))
    }
}
