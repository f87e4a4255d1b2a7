//! The named layouts of `Rover`: each only fills a list of wheels.

mod cars;
mod per_wheel;
mod rollers;

use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict, PyTuple};
use six_wheel_kinematics::layouts::SkidCentres;
use six_wheel_kinematics::presets;
use six_wheel_kinematics::rover::{MAX_WHEELS, Rover as Core};
use six_wheel_kinematics::steering::SteeringRange;

use super::Rover;
use crate::convert::{Rows, memory, pair_or_one, refuse, short_repr};
use crate::fastcall::keywords::Given;
use crate::wheel::steering_range;
use per_wheel::PerWheel;

/// Positions, one row per wheel.
pub fn positions(value: &Bound<'_, PyAny>) -> PyResult<Vec<[f64; 2]>> {
    let rows = Rows::read("positions", value, 2)?.table()?;
    memory::gathered(rows.pairs().iter().copied())
}

/// Fails where an argument comes beside others that say the same.
fn refuse_beside(
    argument: &str,
    value: Option<&Bound<'_, PyAny>>,
    names: &str,
    others: [Option<f64>; 2],
) -> PyResult<()> {
    match value {
        Some(value) if others.iter().any(Option::is_some) => {
            Err(refuse(argument, format!("be left out beside {names}, which say the same"), short_repr(value)))
        }
        _ => Ok(()),
    }
}

methods! { Rover:
    /// The six-wheel rover with four steered corners and unsteered middle wheels.
    ///
    /// Wheels: front_left, front_right, middle_left, middle_right, rear_left, rear_right; origin between the
    /// middle wheels.
    #[doc = section!(Parameters)]
    /// front_to_middle, middle_to_rear : float
    ///     Front axle to middle axle, and middle axle to rear axle [m].
    /// track_width : float
    ///     Left to right corner wheel [m].
    /// middle_track_width : float, optional
    ///     Left to right middle wheel [m]; may be 0, default `track_width`.
    #[doc = parameters!(wheel_radius, steering_limit "Of all corner wheels or one each", scrub_and_trail)]
    #[doc = parameters!(names "Of the wheels, in the order above.")]
    #[doc = raises!("If a dimension or the limit is not finite and positive.")]
    ///
    /// Source: the corner-steering geometry of NASA's Mars rovers as used by the JPL Open Source Rover.
    #[staticmethod]
    fn six_wheel[py: Python<'py>](*, front_to_middle: f64, middle_to_rear: f64, track_width: f64,
        middle_track_width: Option<f64> = None, wheel_radius: f64, steering_limit=None, scrub=None, trail=None,
        names: Option<Vec<String>> = None, **)
    as "(*, front_to_middle, middle_to_rear, track_width, middle_track_width=None, wheel_radius, steering_limit=None, scrub=0.0, trail=0.0, names=None)"
    -> PyResult<Self> {
        let halves = [track_width / 2.0, middle_to_rear, front_to_middle, middle_track_width.unwrap_or(track_width) / 2.0];
        let given = PerWheel { steering_limit, scrub, trail, names };
        given.fit(py, Core::six_wheel(halves, wheel_radius, SteeringRange::default()))
    }

    /// A vehicle whose wheels are all steered.
    #[doc = section!(Parameters)]
    /// positions : array_like, shape (n, 2)
    ///     Pivots ``[x, y]`` of the modules, n from 2 to 64 [m].
    #[doc = parameters!(wheel_radius)]
    /// steering_limit : float, (float, float), sequence or mapping, optional
    ///     Largest steering angle to either side, or smallest and largest [rad]; default endless, ``math.inf`` for endless.
    ///     Of all modules or one each: a mapping by name, or a sequence of pairs.
    ///     Beyond half a turn, turns are counted.
    #[doc = parameters!(scrub_and_trail, names "Default ``module_0``, ``module_1``, ...")]
    #[doc = raises!("If a value is not finite, the radius or the limit not positive, or two modules share a point.")]
    ///
    /// Source: R. Siegwart, I. Nourbakhsh, D. Scaramuzza, Introduction to Autonomous Mobile Robots, 2nd ed., ch. 3.
    #[staticmethod]
    fn swerve[py: Python<'py>](positions, wheel_radius: f64, *, steering_limit=None,
        names: Option<Vec<String>> = None, scrub=None, trail=None, **)
    as "(positions, wheel_radius, *, steering_limit=None, names=None, scrub=0.0, trail=0.0)" -> PyResult<Self> {
        let positions = self::positions(positions)?;
        let given = PerWheel { steering_limit, scrub, trail, names: None };
        given.fit(py, Core::swerve(&positions, names, wheel_radius, SteeringRange::ENDLESS))
    }

    /// Differential drive: fixed wheels on two sides. With several wheels per side, skid steering.
    ///
    /// Several axles turn about their mean; on the ground they skid, and `icr_left` and `icr_right`, measured,
    /// say where each side really turns.
    #[doc = section!(Parameters)]
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
    #[doc = parameters!(scrub_and_trail)]
    ///     Not beside `icr_left`, `icr_right` and `icr_forward`, which say the same.
    /// names : sequence of str, optional
    ///     Of the wheels, front to rear, left before right; default ``left`` and ``right``, behind the axle's where
    ///     there are several.
    #[doc = raises!("If a length is not finite and positive, or the centres lie the wrong way round.")]
    ///
    /// Source: J. L. Martinez et al., Approximating kinematics for tracked mobile robots, IJRR 24(10), 2005.
    #[staticmethod]
    fn differential[py: Python<'py>](track_width: f64, wheel_radius, *, wheels_per_side: i64 = 1,
        wheelbase: Option<f64> = None, icr_left: Option<f64> = None, icr_right: Option<f64> = None,
        icr_forward: Option<f64> = None, scrub=None, trail=None, names: Option<Vec<String>> = None, **)
    as "(track_width, wheel_radius, *, wheels_per_side=1, wheelbase=None, icr_left=None, icr_right=None, icr_forward=0.0, scrub=None, trail=None, names=None)"
    -> PyResult<Self> {
        let given = PerWheel { scrub, trail, names, ..PerWheel::default() };
        refuse_beside("scrub", scrub, "icr_left and icr_right", [icr_left, icr_right])?;
        refuse_beside("trail", trail, "icr_forward", [icr_forward, None])?;
        let skid = SkidCentres {
            left: icr_left,
            right: icr_right,
            forward: icr_forward.unwrap_or_default(),
        };
        let radii = pair_or_one("wheel_radius", wheel_radius)?.unwrap_or_else(|one| [one; 2]);
        let Ok(per_side) = usize::try_from(wheels_per_side) else {
            return Err(refuse("wheels_per_side", format!("be 1 to {}", MAX_WHEELS / 2), wheels_per_side));
        };
        if per_side > 1 && wheelbase.is_none() {
            return Err(refuse("wheelbase", "be given for more than one wheel per side", "None"));
        }
        let base = wheelbase.unwrap_or_default();
        given.fit(py, Core::differential(track_width, radii, per_side, base, skid))
    }

    /// Tracked drive: a left and a right track, each a wheel with the radius of its sprocket.
    #[doc = section!(Parameters)]
    /// track_width : float
    ///     Left to right track, middle to middle [m].
    /// wheel_radius : float or (float, float)
    ///     Sprocket axle to the outside of the track, of both or of left and right [m].
    /// icr_left, icr_right : float, optional
    ///     Lateral positions of the tracks' centres of rotation [m]; default half the track width to either
    ///     side, as without slip. Their distance is the effective track.
    /// icr_forward : float, default 0.0
    ///     Longitudinal position of the centres [m].
    #[doc = parameters!(scrub_and_trail)]
    ///     Not beside `icr_left`, `icr_right` and `icr_forward`, which say the same.
    #[doc = parameters!(names "Of the left and the right track; default ``left`` and ``right``.")]
    #[doc = raises!("If a length is not finite and positive, or the centres lie the wrong way round.")]
    ///
    /// Source: J. L. Martinez et al., Approximating kinematics for tracked mobile robots, IJRR 24(10), 2005.
    #[staticmethod]
    fn tracked[py: Python<'py>](track_width, wheel_radius, *, icr_left: Option<f64> = None,
        icr_right: Option<f64> = None, icr_forward: Option<f64> = None, scrub=None, trail=None,
        names: Option<Vec<String>> = None, **)
    as "(track_width, wheel_radius, *, icr_left=None, icr_right=None, icr_forward=0.0, scrub=None, trail=None, names=None)"
    -> PyResult<Self> {
        let [width, radius] = [track_width, wheel_radius].map(|size| Given(Some(size.clone())));
        let (left, right, forward) = (icr_left, icr_right, icr_forward);
        Self::differential(py, width, radius, &PyTuple::empty(py), 1, None, left, right, forward, scrub, trail, names, None)
    }

    /// A published rover by name; `Rover.presets` lists them.
    #[doc = section!(Parameters)]
    /// name : str
    ///     One of `Rover.presets()`.
    /// steering_limit : float or (float, float), optional
    ///     In place of the published limit [rad]; where none is published, a quarter turn to either side.
    #[doc = raises!("If there is no such preset.")]
    #[staticmethod]
    fn preset[py: Python<'py>](name: &str, *, steering_limit=None, **)
    as "(name, *, steering_limit=None)" -> PyResult<Self> {
        Self::named(py, presets::preset(name, steering_range(steering_limit)?))
    }

    /// Names of the published rovers, each with the source of its dimensions.
    #[doc = returns!("dict of str to str": "Name to source; iterates over the names.")]
    #[staticmethod]
    fn presets[py: Python<'py>]() -> PyResult<Bound<'py, PyDict>> {
        presets::PRESETS.iter().map(|preset| (preset.name, preset.source)).into_py_dict(py)
    }
}
