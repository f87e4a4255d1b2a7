//! `six_wheel.Limits`, `six_wheel.Controller` and what its steps return.

pub mod limits;
pub mod output;
mod quick;
pub mod run;

use std::str::FromStr;

use numpy::PyArray1;
use pyo3::prelude::*;
use six_wheel_control::controller::{AlignmentPolicy, Controller as Core, Mode, Options};
use six_wheel_kinematics::geometry::Twist;

use crate::arguments as given;
use crate::controller::limits::Limits;
use crate::controller::output::ControllerOutput;
use crate::convert::{OrRaise, Rows, name, one_twist_first};
use crate::rover::Rover;
use crate::state_lock::Shared;

pub use quick::install;

/// From wanted twists to joint commands, one step at a time, within limits.
///
/// Every output has one centre of rotation. While only the speed changes, or a limit slows the rover down, the
/// curvature stays. A command the rover cannot follow at once is approached as fast as the limits allow; `reasons`
/// says which of them does. Time is given, never read. Any thread may call any method: it waits while another one is at
/// work.
#[doc = section!(Parameters)]
/// rover : Rover
///     What is driven.
/// limits : Limits
///     What its motion may not exceed.
/// timeout : float or None, default 0.5
///     Age of the last command at which the rover stops [s]; None for never.
/// period : float, optional
///     Time between steps [s]: how long the first step counts for, and what `discretise` refers to.
/// max_step : float, default 0.1
///     Longest time one step counts for [s]: after a pause the motion goes on from where it was.
/// mode : {'free', 'crab', 'front_only', 'spin'}
///     Which motions are meant: all the rover can make, those without turning, those with the front wheels
///     alone (the other steered wheels are held at 0), turning on the spot.
/// align : {'cosine', 'hold'} or None
///     What becomes of the drive while measured steering angles differ from the commanded ones: it is reduced
///     by the cosine of the largest error, or waits, or takes no notice.
/// align_tolerance : float, default 0.02
///     Error that is none [rad].
/// following_error : float or None, default 0.2
///     Error of a measured steering angle [rad] above which a joint does not follow its commands; None for any.
/// following_time : float or None, default 0.5
///     Time after which a joint that does not follow is stuck, and the rover halts [s]; None for never.
/// discretise : bool
///     Take a command for the motion of one `period` instead of the velocity at its beginning, so that driving
///     sideways while turning does not skew.
/// steering : array_like, shape (steered wheels,), optional
///     Steering angles at the start [rad]; default the first measured ones, or 0.
/// twist : array_like, shape (3,), optional
///     Motion at the start, ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s]; default at rest. It is taken for the
///     possible motion next to it, the joints where that needs them, those with a choice next to `steering`. What is
///     beyond the limits comes down within them.
#[doc = raises!("If an option makes no sense, or a limit does not for this rover.")]
#[pyclass(frozen, module = "six_wheel")]
pub struct Controller {
    core: Shared<Core>,
    rover: Py<Rover>,
    joints: usize,
    wheels: usize,
}

getters! { Controller, self, py:
    /// True from `halt`, or from the step that finds a stuck joint, until `release`.
    halted: PyResult<bool> = Ok(self.core.lock(py)?.halted());
    /// The rover that is driven.
    rover: Py<Rover> = self.rover.clone_ref(py);
    /// The limits of its motion. They may be replaced at any time, from the next step on: a motion beyond the new ones comes
    /// down within them without a stop, and command, clock and halt stay. ValueError, and no change, if the rover cannot
    /// meet them.
    limits: PyResult<Limits> = Ok(Limits(*self.core.lock(py)?.limits()));
    /// The motion commanded by the last step, ``[vx, vy, omega]``, shape (3,).
    twist: PyResult<Bound<'py, PyArray1<f64>>> = {
        let twist = self.core.lock(py)?.twist();
        Ok(PyArray1::from_slice(py, &<[f64; 3]>::from(twist)))
    };
    /// The steering angles commanded by the last step [rad], shape (steered wheels,).
    steering: PyResult<Bound<'py, PyArray1<f64>>> = Ok(PyArray1::from_slice(py, self.core.lock(py)?.steering()));
    /// Time of the last step [s], or None.
    stamp: PyResult<Option<f64>> = Ok(self.core.lock(py)?.now());
    /// True if body and joints stand still.
    stopped: PyResult<bool> = Ok(self.core.lock(py)?.stopped());
    /// Largest distance that the body's origin moves if a stop begins with the next step [m].
    stopping_distance: PyResult<f64> = Ok(self.core.lock(py)?.stopping_distance());
}

copied_by! { Controller,
    "keep its `steering` and `twist`, and make another one with them",
    |this, py| {
        let core = Shared::new(this.core.lock(py)?.clone());
        Ok(Self { core, rover: this.rover.clone_ref(py), joints: this.joints, wheels: this.wheels })
    }
}

/// The options by name, as Python writes them.
fn shown(options: &Options) -> [(&'static str, String); 9] {
    let number = |value: Option<f64>| value.map_or_else(|| "None".into(), |value| format!("{value:?}"));
    [
        ("timeout", number(Some(options.timeout).filter(|timeout| timeout.is_finite()))),
        ("period", number(options.period)),
        ("max_step", number(Some(options.max_step))),
        ("mode", format!("'{}'", options.mode.name())),
        ("align", options.align.map_or_else(|| "None".into(), |align| format!("'{}'", align.name()))),
        ("align_tolerance", number(Some(options.align_tolerance))),
        ("following_error", number(options.following_error)),
        ("following_time", number(options.following_time)),
        ("discretise", if options.discretise { "True".into() } else { "False".into() }),
    ]
}

methods! { Controller:
    #[new]
    fn new[](rover: Bound<'py, Rover>, limits: Option<Limits> = None, *, timeout: Option<f64> = (Some(0.5)),
        period: Option<f64> = None, max_step: f64 = 0.1, mode: &str = "free", align: Option<&str> = (Some("cosine")),
        align_tolerance: f64 = 0.02, following_error: Option<f64> = (Some(0.2)),
        following_time: Option<f64> = (Some(0.5)), discretise: bool = false, steering=None, twist=None, **)
    as "(rover, limits=None, *, timeout=0.5, period=None, max_step=0.1, mode='free', align='cosine', align_tolerance=0.02, following_error=0.2, following_time=0.5, discretise=False, steering=None, twist=None)"
    -> PyResult<Self> {
        let options = Options {
            timeout: timeout.unwrap_or(f64::INFINITY),
            period,
            max_step,
            mode: Mode::from_str(mode).or_raise(&[])?,
            align: align.map(AlignmentPolicy::from_str).transpose().or_raise(&[])?,
            align_tolerance,
            following_error,
            following_time,
            discretise,
        };
        let limits = limits.map_or_else(Default::default, |limits| limits.0);
        let joints = rover.get().joints();
        let steering = Rows::read_beside("steering", steering, joints, &[])?;
        let start = steering.as_ref().map(Rows::flat);
        let twist = Rows::read_beside("twist", twist, 3, &[])?;
        let core = Core::new(&rover.get().core, limits, options, start).and_then(|core| match &twist {
            Some(rows) => core.in_motion(Twist::from(rows.triples()[0])),
            None => Ok(core),
        });
        Ok(Self {
            core: Shared::new(core.or_raise(&[])?),
            wheels: rover.get().count(),
            rover: rover.unbind(),
            joints,
        })
    }

    /// Take a command.
    ///
    /// One that is not finite is ignored, and flagged by the steps until a good one comes: meanwhile the last good
    /// one ages. One older than the last is ignored, and flagged by the next step. A stamp ahead of the
    /// next step's time counts as that time.
    #[doc = section!(Parameters: twist "(3,)")]
    /// stamp : float
    ///     When it was given [s], by the clock of `step`.
    /// mode : {'free', 'crab', 'spin'}, optional
    ///     Which motions are meant; default that of the controller.
    #[doc = returns!("bool": "Whether it was taken.")]
    #[doc = raises!("If the stamp is not finite or the shape does not fit.")]
    fn command[&self, py: Python<'py>](twist, stamp: f64, mode=None, *more)
    as "($self, twist, stamp, mode=None)" -> PyResult<bool> {
        let call = "Controller.command((vx, vy, omega), stamp)";
        one_twist_first(call, twist, if mode.is_some() { 3 } else { 2 }, more)?;
        let twists = Rows::read("twist", twist, 3)?.over(&[])?;
        let mode = mode.map(|mode| Mode::from_str(&name(mode))).transpose();
        let twist = Twist::from(twists.triples()[0]);
        let mut core = self.core.lock(py)?;
        let taken = mode.and_then(|mode| core.command(twist, stamp, mode));
        taken.or_raise(&[])
    }

    /// Move on to a time.
    #[doc = section!(Parameters)]
    /// stamp : float
    ///     When the joints are commanded [s]; later than the last step. The first one starts the clock.
    /// measured : array_like, shape (steered wheels,), optional
    ///     Where the steering joints are [rad].
    #[doc = returns!("ControllerOutput")]
    ///     `commands` by joint name, `twist`, `reasons`; `steering`, `steering_rates` and `wheel_speeds` in the order of
    ///     the wheels.
    #[doc = raises!(ValueError)]
    ///     If the stamp is not later than that of the last step, or an angle is not finite. The controller stays as it was. Angles
    ///     beyond a limit are none: the joints come back inside at their rates.
    fn step[&self, py: Python<'py>](stamp: f64, measured=None) -> PyResult<ControllerOutput> {
        let measured = Rows::read_beside("measured", measured, self.joints, &[])?;
        let mut core = self.core.lock(py)?;
        core.step(stamp, measured.as_ref().map(Rows::flat)).or_raise(&[])?;
        Ok(ControllerOutput::of(&core, self.rover.clone_ref(py)))
    }

    /// Forget command, clock, halt and fault.
    ///
    /// The body rests. The joints stay where they were last commanded, or start where the next step measures them: a reset
    /// moves none. It is no stop; `halt` is.
    #[doc = section!(Parameters)]
    /// steering : array_like, shape (steered wheels,), optional
    ///     Steering angles to start at instead [rad].
    #[doc = raises!(ValueError)]
    ///     If an angle is not finite or far outside its range, or the shape does not fit. Nothing is changed then.
    fn reset[&self, py: Python<'py>](steering=None) -> PyResult<()> {
        let steering = Rows::read_beside("steering", steering, self.joints, &[])?;
        let result = self.core.lock(py)?.reset(steering.as_ref().map(Rows::flat));
        result.or_raise(&[])
    }
}

#[pymethods]
impl Controller {
    /// Stop by `halt_deceleration` from the next step on, and stay at rest until `release`.
    ///
    /// The centre of rotation stays, joints that turn brake within their limits. Every step has the reason `HALTED`;
    /// `command` takes nothing and returns False.
    fn halt(&self, py: Python<'_>) -> PyResult<()> {
        self.core.lock(py)?.halt();
        Ok(())
    }

    /// End a halt, whatever it came from. Nothing moves before a new command.
    #[doc = returns!("bool": "False, without effect, while body or joints still move.")]
    fn release(&self, py: Python<'_>) -> PyResult<bool> {
        Ok(self.core.lock(py)?.release())
    }

    #[setter]
    fn set_limits(&self, py: Python<'_>, limits: &Bound<'_, PyAny>) -> PyResult<()> {
        let limits: Limits = given::limits(limits)?;
        let result = self.core.lock(py)?.set_limits(limits.0);
        result.or_raise(&[])
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let rover = self.rover.bind(py).repr()?;
        let core = self.core.lock(py)?;
        let mut text = format!("Controller({rover}, {}", Limits(*core.limits()).text());
        for ((name, value), (_, usual)) in shown(core.options()).iter().zip(shown(&Options::default())) {
            if *value != usual {
                text += &format!(", {name}={value}");
            }
        }
        Ok(text + ")")
    }
}
