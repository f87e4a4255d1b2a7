//! The named layouts of `Rover` with rollers on their wheels.

use pyo3::prelude::*;
use six_wheel_kinematics::rover::Rover as Core;

use super::per_wheel::PerWheel;
use crate::convert::{Scalars, number, optional_number};
use crate::rover::Rover;

#[pymethods]
impl Rover {
    /// Four mecanum wheels, the usual way round.
    ///
    /// Seen from above, the axes of the rollers on top point to the middle; those of the rollers that touch the
    /// ground form a diamond around it, so that all four have a lever to turn the body.
    ///
    /// Parameters
    /// ----------
    /// half_wheelbase, half_track : float
    ///     Middle to axle, and to wheel [m].
    /// wheel_radius : float
    ///     Hub to ground [m].
    /// roller_angle : float
    ///     Between the axes of rollers and wheel [rad]; default an eighth of a turn.
    /// scrub, trail : float, sequence or mapping of str to float, default 0.0
    ///     Contact to the left of the steering axis, and behind it [m]. Of every wheel alike, left and right ones too, or one
    ///     each: in their order, or by name.
    /// names : sequence of str, optional
    ///     Default ``front_left``, ``front_right``, ``rear_left``, ``rear_right``; in that order.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a length is not finite and positive, or the rollers leave nothing to drive.
    #[staticmethod]
    #[pyo3(
        signature = (half_wheelbase, half_track, wheel_radius, *, roller_angle=None, scrub=None, trail=None, names=None),
        text_signature = "(half_wheelbase, half_track, wheel_radius, *, roller_angle=0.7853981633974483, scrub=0.0, trail=0.0, names=None)"
    )]
    fn mecanum(
        py: Python<'_>,
        half_wheelbase: &Bound<'_, PyAny>,
        half_track: &Bound<'_, PyAny>,
        wheel_radius: &Bound<'_, PyAny>,
        roller_angle: Option<&Bound<'_, PyAny>>,
        scrub: Option<&Bound<'_, PyAny>>,
        trail: Option<&Bound<'_, PyAny>>,
        names: Option<Vec<String>>,
    ) -> PyResult<Self> {
        let half_base = number("half_wheelbase", half_wheelbase)?;
        let (half_track, radius) = (number("half_track", half_track)?, number("wheel_radius", wheel_radius)?);
        let angle = optional_number("roller_angle", roller_angle)?.unwrap_or(std::f64::consts::FRAC_PI_4);
        let given = PerWheel { scrub, trail, names, ..PerWheel::default() };
        Self::named(py, Ok(given.fit(Core::mecanum(half_base, half_track, radius, angle))?))
    }

    /// Omni wheels, any number of them and any way round.
    ///
    /// Parameters
    /// ----------
    /// positions : array_like, shape (n, 2)
    ///     ``[x, y]`` of the wheels [m].
    /// headings : array_like, shape (n,)
    ///     Directions in which they drive [rad].
    /// wheel_radius : float
    ///     Hub to ground [m].
    /// roller_angle : float
    ///     Between the axes of rollers and wheel [rad]; default a quarter turn.
    /// scrub, trail : float, sequence or mapping of str to float, default 0.0
    ///     Contact to the left of the steering axis, and behind it [m]. Of every wheel alike, left and right ones too, or one
    ///     each: in their order, or by name.
    /// names : sequence of str, optional
    ///     Default ``wheel_0``, ``wheel_1``, ...
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a value is not finite, the radius not positive, or the rollers leave nothing to drive.
    #[staticmethod]
    #[pyo3(
        signature = (positions, headings, wheel_radius, *, roller_angle=None, names=None, scrub=None, trail=None),
        text_signature = "(positions, headings, wheel_radius, *, roller_angle=1.5707963267948966, names=None, scrub=0.0, trail=0.0)"
    )]
    fn omni(
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        headings: &Bound<'_, PyAny>,
        wheel_radius: &Bound<'_, PyAny>,
        roller_angle: Option<&Bound<'_, PyAny>>,
        names: Option<Vec<String>>,
        scrub: Option<&Bound<'_, PyAny>>,
        trail: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let positions = super::positions(positions)?;
        let headings = Scalars::read_finite("headings", headings)?;
        headings.fit_exactly("headings", &[positions.len()])?;
        let (radius, angle) = (number("wheel_radius", wheel_radius)?, optional_number("roller_angle", roller_angle)?);
        let given = PerWheel { scrub, trail, ..PerWheel::default() };
        Self::named(py, Ok(given.fit(Core::omni(&positions, headings.flat(), names, radius, angle))?))
    }
}
