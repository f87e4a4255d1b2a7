//! The named layouts of `Rover` with rollers on their wheels.

use pyo3::prelude::*;
use six_wheel_core::Rover as Core;

use super::Rover;
use super::layouts::{self};
use crate::convert::{Scalars, number, optional_number};

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
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a length is not finite and positive, or the rollers leave nothing to drive.
    #[staticmethod]
    #[pyo3(
        signature = (half_wheelbase, half_track, wheel_radius, *, roller_angle=None),
        text_signature = "(half_wheelbase, half_track, wheel_radius, *, roller_angle=0.7853981633974483)"
    )]
    fn mecanum(
        py: Python<'_>,
        half_wheelbase: &Bound<'_, PyAny>,
        half_track: &Bound<'_, PyAny>,
        wheel_radius: &Bound<'_, PyAny>,
        roller_angle: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let half_base = number("half_wheelbase", half_wheelbase)?;
        let (half_track, radius) = (number("half_track", half_track)?, number("wheel_radius", wheel_radius)?);
        let angle = optional_number("roller_angle", roller_angle)?.unwrap_or(std::f64::consts::FRAC_PI_4);
        Self::named(py, Core::mecanum(half_base, half_track, radius, angle))
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
    /// names : sequence of str, optional
    ///     Default ``wheel_0``, ``wheel_1``, ...
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a value is not finite, the radius not positive, or the rollers leave nothing to drive.
    #[staticmethod]
    #[pyo3(
        signature = (positions, headings, wheel_radius, *, roller_angle=None, names=None),
        text_signature = "(positions, headings, wheel_radius, *, roller_angle=1.5707963267948966, names=None)"
    )]
    fn omni(
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        headings: &Bound<'_, PyAny>,
        wheel_radius: &Bound<'_, PyAny>,
        roller_angle: Option<&Bound<'_, PyAny>>,
        names: Option<Vec<String>>,
    ) -> PyResult<Self> {
        let positions = layouts::positions(positions)?;
        let headings = Scalars::read_finite("headings", headings)?;
        headings.fit_exactly("headings", &[positions.len()])?;
        let (radius, angle) = (number("wheel_radius", wheel_radius)?, optional_number("roller_angle", roller_angle)?);
        Self::named(py, Core::omni(&positions, headings.flat(), names, radius, angle))
    }
}
