//! The named layouts of `Rover`: each only fills a list of wheels.

use std::str::FromStr;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use six_wheel_kinematics::layouts::{Drive, SkidCentres};
use six_wheel_kinematics::presets;
use six_wheel_kinematics::rover::MAX_WHEELS;
use six_wheel_kinematics::rover::Rover as Core;
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_numerics::error::Error;

use crate::convert::{Rows, Scalars, memory, number, raise, refuse};
use crate::given;
use crate::rover::Rover;
use crate::wheel::steering_range;

/// One radius for both sides, or one for each.
fn radii(value: &Bound<'_, PyAny>) -> PyResult<[f64; 2]> {
    match value.extract::<[Bound<'_, PyAny>; 2]>() {
        Ok([left, right]) => Ok([number("wheel_radius[0]", &left)?, number("wheel_radius[1]", &right)?]),
        Err(_) => Ok([number("wheel_radius", value)?; 2]),
    }
}

fn optional(argument: &str, value: Option<&Bound<'_, PyAny>>) -> PyResult<Option<f64>> {
    value.map(|value| number(argument, value)).transpose()
}

/// Positions, one row per wheel.
fn positions(value: &Bound<'_, PyAny>) -> PyResult<Vec<[f64; 2]>> {
    let rows = Rows::read_table("positions", value, 2)?;
    memory::gathered(rows.pairs().iter().copied())
}

fn limit(value: Option<&Bound<'_, PyAny>>) -> PyResult<SteeringRange> {
    Ok(steering_range(value)?.unwrap_or_default())
}

fn drive(name: &str) -> PyResult<Drive> {
    Drive::from_str(name).map_err(|error| raise(error, &[]))
}

impl Rover {
    /// A layout with a wheelbase, a track width and a wheel radius.
    fn car(
        py: Python<'_>,
        [wheelbase, track_width, wheel_radius]: [&Bound<'_, PyAny>; 3],
        steering_limit: Option<&Bound<'_, PyAny>>,
        driven: &str,
        layout: impl FnOnce(f64, f64, f64, SteeringRange, Drive) -> Result<Core, Error>,
    ) -> PyResult<Self> {
        let base = number("wheelbase", wheelbase)?;
        let track = number("track_width", track_width)?;
        let radius = number("wheel_radius", wheel_radius)?;
        let range = limit(steering_limit)?;
        Self::named(py, layout(base, track, radius, range, drive(driven)?))
    }
}

#[pymethods]
impl Rover {
    /// The six-wheel rover with four steered corners and unsteered middle wheels.
    ///
    /// Wheels: front_left, front_right, middle_left, middle_right, rear_left, rear_right; origin between the
    /// middle wheels.
    ///
    /// Parameters
    /// ----------
    /// d1 : float
    ///     Half track of the corner wheels [m].
    /// d2, d3 : float
    ///     Middle axle to rear axle, and to front axle [m].
    /// d4 : float
    ///     Half track of the middle wheels [m]; may be 0.
    /// wheel_radius : float
    ///     Hub to ground [m].
    /// steering_limit : float or (float, float), optional
    ///     Largest steering angle to either side, or smallest and largest [rad]; default a quarter turn.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a dimension or the limit is not finite and positive.
    ///
    /// Source: the corner-steering geometry of NASA's Mars rovers as used by the JPL Open Source Rover.
    #[staticmethod]
    #[pyo3(signature = (d1, d2, d3, d4, wheel_radius, steering_limit=None))]
    fn six_wheel(
        py: Python<'_>,
        d1: &Bound<'_, PyAny>,
        d2: &Bound<'_, PyAny>,
        d3: &Bound<'_, PyAny>,
        d4: &Bound<'_, PyAny>,
        wheel_radius: &Bound<'_, PyAny>,
        steering_limit: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let dimensions = [number("d1", d1)?, number("d2", d2)?, number("d3", d3)?, number("d4", d4)?];
        let radius = number("wheel_radius", wheel_radius)?;
        let range = steering_range(steering_limit)?.unwrap_or_default();
        Self::named(py, Core::six_wheel(dimensions, radius, range))
    }

    /// A vehicle whose wheels are all steered.
    ///
    /// Parameters
    /// ----------
    /// positions : array_like, shape (n, 2)
    ///     Pivots ``[x, y]`` of the modules, n from 2 to 64 [m].
    /// wheel_radius : float
    ///     Hub to ground [m].
    /// steering_limit : float or (float, float), optional
    ///     Largest steering angle to either side, or smallest and largest [rad]; default a quarter turn.
    ///     A wider range lets a module keep its direction of rolling; beyond half a turn, turns are counted.
    /// names : sequence of str, optional
    ///     Default ``module_0``, ``module_1``, ...
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a value is not finite, the radius or the limit not positive, or two modules share a point.
    ///
    /// Source: R. Siegwart, I. Nourbakhsh, D. Scaramuzza, Introduction to Autonomous Mobile Robots, 2nd ed., ch. 3.
    #[staticmethod]
    #[pyo3(signature = (positions, wheel_radius, *, steering_limit=None, names=None))]
    fn swerve(
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        wheel_radius: &Bound<'_, PyAny>,
        steering_limit: Option<&Bound<'_, PyAny>>,
        names: Option<Vec<String>>,
    ) -> PyResult<Self> {
        let positions = self::positions(positions)?;
        let (radius, range) = (number("wheel_radius", wheel_radius)?, limit(steering_limit)?);
        Self::named(py, Core::swerve(&positions, names, radius, range))
    }

    /// Differential drive: fixed wheels on two sides. With several wheels per side, skid steering.
    ///
    /// Several axles turn about their mean; on the ground they skid, and `icr_left` and `icr_right`, measured,
    /// say where each side really turns.
    ///
    /// Parameters
    /// ----------
    /// track_width : float
    ///     Left to right wheel [m].
    /// wheel_radius : float or (float, float)
    ///     Hub to ground, of both sides or of left and right [m].
    /// wheels_per_side : int, default 1
    ///     Axles; they are spread over `wheelbase`, front to rear, the origin in their middle.
    /// wheelbase : float, optional
    ///     First to last axle [m]; needed for more than one.
    /// icr_left, icr_right : float, optional
    ///     Lateral positions of the treads' centres of rotation [m]; default half the track width to either
    ///     side. Their distance is the effective track.
    /// icr_forward : float, default 0.0
    ///     Longitudinal position of the centres [m].
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a length is not finite and positive, or the centres lie the wrong way round.
    ///
    /// Source: J. L. Martinez et al., Approximating kinematics for tracked mobile robots, IJRR 24(10), 2005.
    #[staticmethod]
    #[pyo3(
        signature = (track_width, wheel_radius, *, wheels_per_side=1, wheelbase=None, icr_left=None, icr_right=None, icr_forward=None),
        text_signature = "(track_width, wheel_radius, *, wheels_per_side=1, wheelbase=None, icr_left=None, icr_right=None, icr_forward=0.0)"
    )]
    #[allow(clippy::too_many_arguments)] // they are keywords
    fn differential(
        py: Python<'_>,
        track_width: &Bound<'_, PyAny>,
        wheel_radius: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = given::wheels_per_side)] wheels_per_side: i64,
        wheelbase: Option<&Bound<'_, PyAny>>,
        icr_left: Option<&Bound<'_, PyAny>>,
        icr_right: Option<&Bound<'_, PyAny>>,
        icr_forward: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let skid = SkidCentres {
            left: optional("icr_left", icr_left)?,
            right: optional("icr_right", icr_right)?,
            forward: optional("icr_forward", icr_forward)?.unwrap_or_default(),
        };
        let track = number("track_width", track_width)?;
        let wheelbase = optional("wheelbase", wheelbase)?;
        let radii = radii(wheel_radius)?;
        let Ok(per_side) = usize::try_from(wheels_per_side) else {
            let got = wheels_per_side.to_string();
            let rule = format!("be 1 to {}", MAX_WHEELS / 2);
            return Err(refuse("wheels_per_side", &rule, &got));
        };
        if per_side > 1 && wheelbase.is_none() {
            let rule = "be given for more than one wheel per side";
            return Err(refuse("wheelbase", rule, "None"));
        }
        let base = wheelbase.unwrap_or_default();
        Self::named(py, Core::differential(track, radii, per_side, base, skid))
    }

    /// Tracked drive: a left and a right track, each a wheel with the radius of its sprocket.
    ///
    /// Parameters
    /// ----------
    /// track_width : float
    ///     Left to right track, middle to middle [m].
    /// wheel_radius : float or (float, float)
    ///     Sprocket axle to the outside of the track, of both or of left and right [m].
    /// icr_left, icr_right : float, optional
    ///     Lateral positions of the tracks' centres of rotation [m]; default half the track width to either
    ///     side, as without slip. Their distance is the effective track.
    /// icr_forward : float, default 0.0
    ///     Longitudinal position of the centres [m].
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a length is not finite and positive, or the centres lie the wrong way round.
    ///
    /// Source: J. L. Martinez et al., Approximating kinematics for tracked mobile robots, IJRR 24(10), 2005.
    #[staticmethod]
    #[pyo3(
        signature = (track_width, wheel_radius, *, icr_left=None, icr_right=None, icr_forward=None),
        text_signature = "(track_width, wheel_radius, *, icr_left=None, icr_right=None, icr_forward=0.0)"
    )]
    fn tracked(
        py: Python<'_>,
        track_width: &Bound<'_, PyAny>,
        wheel_radius: &Bound<'_, PyAny>,
        icr_left: Option<&Bound<'_, PyAny>>,
        icr_right: Option<&Bound<'_, PyAny>>,
        icr_forward: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        Self::differential(py, track_width, wheel_radius, 1, None, icr_left, icr_right, icr_forward)
    }

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
    /// steering_limit : float or (float, float), optional
    ///     Largest steering angle to either side, or smallest and largest [rad]; default a quarter turn.
    /// driven : {'rear', 'front', 'all'}
    ///     Which wheels have motors; the others roll along.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a length or the limit is not finite and positive.
    #[staticmethod]
    #[pyo3(signature = (wheelbase, track_width, wheel_radius, *, steering_limit=None, driven="rear"))]
    fn ackermann(
        py: Python<'_>,
        wheelbase: &Bound<'_, PyAny>,
        track_width: &Bound<'_, PyAny>,
        wheel_radius: &Bound<'_, PyAny>,
        steering_limit: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = given::driven)] driven: &str,
    ) -> PyResult<Self> {
        let lengths = [wheelbase, track_width, wheel_radius];
        Self::car(py, lengths, steering_limit, driven, Core::ackermann)
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
    /// steering_limit : float or (float, float), optional
    ///     Largest steering angle to either side, or smallest and largest [rad]; default a quarter turn.
    /// driven : {'front', 'rear', 'all'}
    ///     Which wheels have motors; the others roll along.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a length or the limit is not finite and positive.
    #[staticmethod]
    #[pyo3(signature = (wheelbase, track_width, wheel_radius, *, steering_limit=None, driven="front"))]
    fn tricycle(
        py: Python<'_>,
        wheelbase: &Bound<'_, PyAny>,
        track_width: &Bound<'_, PyAny>,
        wheel_radius: &Bound<'_, PyAny>,
        steering_limit: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = given::driven)] driven: &str,
    ) -> PyResult<Self> {
        let lengths = [wheelbase, track_width, wheel_radius];
        Self::car(py, lengths, steering_limit, driven, Core::tricycle)
    }

    /// A bicycle: a steered front wheel, a fixed rear wheel, origin at the rear one.
    ///
    /// Parameters
    /// ----------
    /// wheelbase : float
    ///     Rear wheel to front wheel [m].
    /// wheel_radius : float
    ///     Hub to ground [m].
    /// steering_limit : float or (float, float), optional
    ///     Largest steering angle to either side, or smallest and largest [rad]; default a quarter turn.
    /// driven : {'rear', 'front', 'all'}
    ///     Which wheels have motors; the others roll along.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a length or the limit is not finite and positive.
    #[staticmethod]
    #[pyo3(signature = (wheelbase, wheel_radius, *, steering_limit=None, driven="rear"))]
    fn bicycle(
        py: Python<'_>,
        wheelbase: &Bound<'_, PyAny>,
        wheel_radius: &Bound<'_, PyAny>,
        steering_limit: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = given::driven)] driven: &str,
    ) -> PyResult<Self> {
        let base = number("wheelbase", wheelbase)?;
        let (radius, range) = (number("wheel_radius", wheel_radius)?, limit(steering_limit)?);
        Self::named(py, Core::bicycle(base, radius, range, drive(driven)?))
    }

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
        let angle = optional("roller_angle", roller_angle)?.unwrap_or(std::f64::consts::FRAC_PI_4);
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
        let positions = self::positions(positions)?;
        let headings = Scalars::read("headings", headings)?;
        headings.check_finite("headings")?;
        headings.fit_exactly("headings", &[positions.len()])?;
        let (radius, angle) = (number("wheel_radius", wheel_radius)?, optional("roller_angle", roller_angle)?);
        Self::named(py, Core::omni(&positions, headings.flat(), names, radius, angle))
    }

    /// A published rover by name; `Rover.presets` lists them.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     One of `Rover.presets()`.
    /// steering_limit : float or (float, float), optional
    ///     In place of the published limit [rad]; where none is published, a quarter turn to either side.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If there is no such preset.
    #[staticmethod]
    #[pyo3(signature = (name, *, steering_limit=None))]
    fn preset(
        py: Python<'_>,
        #[pyo3(from_py_with = given::name)] name: &str,
        steering_limit: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        Self::named(py, presets::preset(name, steering_range(steering_limit)?))
    }

    /// Names of the published rovers, each with the source of its dimensions.
    ///
    /// Returns
    /// -------
    /// dict of str to str
    ///     Name to source; iterates over the names.
    #[staticmethod]
    fn presets(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let sources = PyDict::new(py);
        for preset in presets::PRESETS {
            sources.set_item(preset.name, preset.source)?;
        }
        Ok(sources)
    }
}
