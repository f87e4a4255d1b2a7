//! The named layouts of `Rover` with rollers on their wheels.

use pyo3::prelude::*;
use six_wheel_kinematics::rover::Rover as Core;

use super::per_wheel::PerWheel;
use crate::convert::Rows;
use crate::rover::Rover;

methods! { Rover:
    /// Four mecanum wheels, the usual way round.
    ///
    /// Seen from above, the axes of the rollers on top point to the middle; those of the rollers that touch the
    /// ground form a diamond around it, so that all four have a lever to turn the body.
    #[doc = section!(Parameters)]
    /// wheelbase, track_width : float
    ///     Front to rear axle, and left to right wheel [m]: whole lengths, where other libraries take halves.
    #[doc = parameters!(wheel_radius)]
    /// roller_angle : float
    ///     Between the axes of rollers and wheel [rad]; default an eighth of a turn.
    #[doc = parameters!(scrub_and_trail)]
    #[doc = parameters!(names "Default ``front_left``, ``front_right``, ``rear_left``, ``rear_right``; in that order.")]
    #[doc = raises!("If a length is not finite and positive, or the rollers leave nothing to drive.")]
    #[staticmethod]
    fn mecanum[py: Python<'py>](wheelbase: f64, track_width: f64, wheel_radius: f64, *,
        roller_angle: Option<f64> = None, scrub=None, trail=None, names: Option<Vec<String>> = None, **)
    as "(wheelbase, track_width, wheel_radius, *, roller_angle=0.7853981633974483, scrub=0.0, trail=0.0, names=None)"
    -> PyResult<Self> {
        let angle = roller_angle.unwrap_or(std::f64::consts::FRAC_PI_4);
        let given = PerWheel { scrub, trail, names, ..PerWheel::default() };
        given.fit(py, Core::mecanum(wheelbase, track_width, wheel_radius, angle))
    }

    /// Omni wheels, any number of them and any way round.
    #[doc = section!(Parameters)]
    /// positions : array_like, shape (n, 2)
    ///     ``[x, y]`` of the wheels [m].
    /// headings : array_like, shape (n,)
    ///     Directions in which they drive [rad].
    #[doc = parameters!(wheel_radius)]
    /// roller_angle : float
    ///     Between the axes of rollers and wheel [rad]; default a quarter turn.
    #[doc = parameters!(scrub_and_trail, names "Default ``wheel_0``, ``wheel_1``, ...")]
    #[doc = raises!("If a value is not finite, the radius not positive, or the rollers leave nothing to drive.")]
    #[staticmethod]
    fn omni[py: Python<'py>](positions, headings, wheel_radius: f64, *, roller_angle: Option<f64> = None,
        names: Option<Vec<String>> = None, scrub=None, trail=None, **)
    as "(positions, headings, wheel_radius, *, roller_angle=1.5707963267948966, names=None, scrub=0.0, trail=0.0)"
    -> PyResult<Self> {
        let positions = super::positions(positions)?;
        let headings = Rows::read_numbers("headings", headings)?.finite()?.over(&[positions.len()])?;
        let given = PerWheel { scrub, trail, ..PerWheel::default() };
        given.fit(py, Core::omni(&positions, headings.flat(), names, wheel_radius, roller_angle))
    }
}
