//! `six_wheel.Limits`, `six_wheel.Controller` and what its steps return.

pub mod limits;
pub mod output;
mod quick;
pub mod run;

use std::str::FromStr;

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use six_wheel_control::controller::{Align, Controller as Core, Mode, Options};
use six_wheel_kinematics::geometry::Twist;

use crate::controller::limits::Limits;
use crate::controller::output::ControllerOutput;
use crate::controller::run::ControllerRun;
use crate::convert::{Rows, name, number, one_twist_first, raise};
use crate::given;
use crate::rover::Rover;
use crate::shared::Shared;

pub use quick::install;

/// From wanted twists to joint commands, one step at a time, within limits.
///
/// Every output has one centre of rotation. While only the speed changes, or a limit slows the rover down, the
/// curvature stays. A command the rover cannot follow at once is approached as fast as the limits allow; `reasons`
/// says which of them does. Time is given, never read. Any thread may call any method: it waits while another one is at
/// work.
///
/// Parameters
/// ----------
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
/// discretise : bool
///     Take a command for the motion of one `period` instead of the velocity at its beginning, so that driving
///     sideways while turning does not skew.
/// steering : array_like, shape (steered wheels,), optional
///     Steering angles at the start [rad]; default the first measured ones, or 0.
/// twist : array_like, shape (3,), optional
///     Motion at the start, ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s]; default at rest. It is taken for the
///     possible motion next to it, the joints where that needs them, those with a choice next to `steering`. What is
///     beyond the limits comes down within them.
///
/// Raises
/// ------
/// ValueError
///     If an option makes no sense, or a limit does not for this rover.
#[pyclass(frozen, module = "six_wheel")]
pub struct Controller {
    core: Shared<Core>,
    rover: Py<Rover>,
    joints: usize,
    wheels: usize,
}

#[pymethods]
impl Controller {
    #[new]
    #[pyo3(
        signature = (rover, limits=None, *, timeout=Some(0.5), period=None, max_step=0.1, mode="free", align=Some("cosine"), align_tolerance=0.02, discretise=false, steering=None, twist=None),
        text_signature = "(rover, limits=None, *, timeout=0.5, period=None, max_step=0.1, mode='free', align='cosine', align_tolerance=0.02, discretise=False, steering=None, twist=None)"
    )]
    #[allow(clippy::too_many_arguments)] // they are keywords
    fn new(
        #[pyo3(from_py_with = given::rover)] rover: Bound<'_, Rover>,
        #[pyo3(from_py_with = given::limits)] limits: Option<Limits>,
        #[pyo3(from_py_with = given::timeout)] timeout: Option<f64>,
        #[pyo3(from_py_with = given::period)] period: Option<f64>,
        #[pyo3(from_py_with = given::max_step)] max_step: f64,
        #[pyo3(from_py_with = given::mode)] mode: &str,
        #[pyo3(from_py_with = given::align)] align: Option<&str>,
        #[pyo3(from_py_with = given::align_tolerance)] align_tolerance: f64,
        #[pyo3(from_py_with = given::discretise)] discretise: bool,
        steering: Option<&Bound<'_, PyAny>>,
        twist: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let chosen = || -> Result<Options, six_wheel_numerics::error::Error> {
            Ok(Options {
                timeout: timeout.unwrap_or(f64::INFINITY),
                period,
                max_step,
                mode: Mode::from_str(mode)?,
                align: align.map(Align::from_str).transpose()?,
                align_tolerance,
                discretise,
            })
        };
        let limits = limits.map_or_else(Default::default, |limits| limits.0);
        let joints = rover.get().joints();
        let steering = Rows::read_beside("steering", steering, joints, &[])?;
        let start = steering.as_ref().map(Rows::flat);
        let twist = Rows::read_beside("twist", twist, 3, &[])?;
        let core = chosen().and_then(|options| {
            let core = Core::new(&rover.get().core, limits, options, start)?;
            match &twist {
                Some(rows) => core.in_motion(Twist::from(rows.triples()[0])),
                None => Ok(core),
            }
        });
        Ok(Self {
            core: Shared::new(core.map_err(|error| raise(error, &[]))?),
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
    ///
    /// Parameters
    /// ----------
    /// twist : array_like, shape (3,)
    ///     ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s].
    /// stamp : float
    ///     When it was given [s], by the clock of `step`.
    /// mode : {'free', 'crab', 'spin'}, optional
    ///     Which motions are meant; default that of the controller.
    ///
    /// Returns
    /// -------
    /// bool
    ///     Whether it was taken.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the stamp is not finite or the shape does not fit.
    #[pyo3(
        signature = (twist, stamp, mode=None, *more),
        text_signature = "($self, twist, stamp, mode=None)"
    )]
    fn command(
        &self,
        py: Python<'_>,
        twist: &Bound<'_, PyAny>,
        stamp: &Bound<'_, PyAny>,
        mode: Option<&Bound<'_, PyAny>>,
        more: &Bound<'_, PyTuple>,
    ) -> PyResult<bool> {
        let call = "Controller.command((vx, vy, omega), stamp)";
        one_twist_first(call, twist, if mode.is_some() { 3 } else { 2 }, more)?;
        let twists = Rows::read("twist", twist, 3)?;
        twists.check_leading("twist", &[])?;
        let stamp = number("stamp", stamp)?;
        let mode = mode.map(|mode| Mode::from_str(&name(mode))).transpose();
        let twist = Twist::from(twists.triples()[0]);
        let mut core = self.core.lock(py)?;
        let taken = mode.and_then(|mode| core.command(twist, stamp, mode));
        taken.map_err(|error| raise(error, &[]))
    }

    /// Move on to a time.
    ///
    /// Parameters
    /// ----------
    /// now : float
    ///     The time [s]; later than that of the last step. The first one starts the clock.
    /// measured : array_like, shape (steered wheels,), optional
    ///     Where the steering joints are [rad].
    ///
    /// Returns
    /// -------
    /// ControllerOutput
    ///     `commands` by joint name, `twist`, `reasons`; `steering`, `steering_rates` and `speeds` in the order of
    ///     the wheels.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the time is not later than the last, or an angle is not finite. The controller stays as it was. Angles
    ///     beyond a limit are none: the joints come back inside at their rates.
    #[pyo3(signature = (now, measured=None))]
    fn step(
        &self,
        py: Python<'_>,
        now: &Bound<'_, PyAny>,
        measured: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<ControllerOutput> {
        let now = number("now", now)?;
        let measured = Rows::read_beside("measured", measured, self.joints, &[])?;
        let mut core = self.core.lock(py)?;
        core.step(now, measured.as_ref().map(Rows::flat)).map_err(|error| raise(error, &[]))?;
        Ok(ControllerOutput::of(&core, self.rover.clone_ref(py)))
    }

    /// Many steps in one call: a log, a plan, a simulation. The same, bit for bit, as the calls one by one.
    ///
    /// Parameters
    /// ----------
    /// stamps : array_like, shape (m,)
    ///     When the commands were given [s]. They come in this order, each before the first step that is not
    ///     earlier than its stamp.
    /// twists : array_like, shape (m, 3)
    ///     The commands, rows ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s].
    /// times : array_like, shape (n,)
    ///     Times of the steps [s], increasing.
    ///
    /// Returns
    /// -------
    /// ControllerRun
    ///     `steering`, `speeds`, `twist`, `reasons`, `steering_rates`, one row a step.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a time is not later than the one before it, a stamp is later than all of them, one of them is not
    ///     finite, or the shapes do not fit. The controller stays as it was.
    fn run<'py>(
        &self,
        py: Python<'py>,
        stamps: &Bound<'py, PyAny>,
        twists: &Bound<'py, PyAny>,
        times: &Bound<'py, PyAny>,
    ) -> PyResult<ControllerRun> {
        ControllerRun::of(py, self, [stamps, twists, times])
    }

    /// Back to where it was when it was made: at rest, without a command and with the clock stopped.
    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        self.core.lock(py)?.reset();
        Ok(())
    }

    /// What is driven.
    #[getter]
    fn rover(&self, py: Python<'_>) -> Py<Rover> {
        self.rover.clone_ref(py)
    }

    /// What its motion may not exceed.
    #[getter]
    fn limits(&self, py: Python<'_>) -> PyResult<Limits> {
        Ok(Limits(*self.core.lock(py)?.limits()))
    }

    /// The motion commanded by the last step, ``[vx, vy, omega]``, shape (3,).
    #[getter]
    fn twist<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let twist = self.core.lock(py)?.twist();
        Ok(PyArray1::from_slice(py, &<[f64; 3]>::from(twist)))
    }

    /// The steering angles commanded by the last step [rad], shape (steered wheels,).
    #[getter]
    fn steering<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(PyArray1::from_slice(py, self.core.lock(py)?.steering()))
    }

    /// Time of the last step [s], or None.
    #[getter]
    fn now(&self, py: Python<'_>) -> PyResult<Option<f64>> {
        Ok(self.core.lock(py)?.now())
    }

    /// Whether body and joints stand still.
    #[getter]
    fn stopped(&self, py: Python<'_>) -> PyResult<bool> {
        Ok(self.core.lock(py)?.stopped())
    }

    /// How far the body's origin moves, at most, if a stop begins with the next step [m].
    #[getter]
    fn stopping_distance(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.core.lock(py)?.stopping_distance())
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let rover = self.rover.bind(py).repr()?;
        let core = self.core.lock(py)?;
        let (options, usual) = (core.options(), Options::default());
        let mut text = format!("Controller({rover}, {}", Limits(*core.limits()).text());
        if options.timeout != usual.timeout {
            let timeout = options.timeout;
            text += &if timeout.is_infinite() { ", timeout=None".into() } else { format!(", timeout={timeout:?}") };
        }
        if let Some(period) = options.period {
            text += &format!(", period={period:?}");
        }
        if options.max_step != usual.max_step {
            text += &format!(", max_step={:?}", options.max_step);
        }
        if options.mode != usual.mode {
            text += &format!(", mode='{}'", options.mode.name());
        }
        if options.align != usual.align {
            let name = options.align.map(|align| format!("'{}'", align.name()));
            text += &format!(", align={}", name.unwrap_or_else(|| "None".into()));
        }
        if options.align_tolerance != usual.align_tolerance {
            text += &format!(", align_tolerance={:?}", options.align_tolerance);
        }
        if options.discretise {
            text += ", discretise=True";
        }
        Ok(text + ")")
    }
}
