//! `six_wheel.Odometry`.

pub mod gyroscope;
mod input;
pub mod preintegrated;
mod quick;
pub mod spatial;
pub mod state;
pub mod values;

use std::str::FromStr;

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use six_wheel_kinematics::estimate::Method;
use six_wheel_numerics::error::Error;
use six_wheel_odometry::{Odometry as Core, Readings, Recording, Sample, Settings, TrackRows};

pub use quick::install;

use crate::convert::{Array, Output, Rows, Scalars, compute, memory, number, numbers, one_twist_first, raise, refuse};
use crate::given;
use crate::rover::Rover;
use crate::shared::Shared;
use input::{Columns, build_track, by_wheel, deviations, encoders, optional, row};
use state::{OdometryState, Spares};
use values::Noise;

/// Dead reckoning that knows its error: the pose of a rover from what its wheels turned.
///
/// A step is exact: the displacement that fits the turns of all wheels best, at the steering angles of its middle, is
/// held as one arc. Its covariance comes from the analytic derivatives of that fit. The first sample is the reference
/// from which the next one counts. Any thread may call any method: it waits while another one is at work.
///
/// Parameters
/// ----------
/// rover : Rover
///     Any vehicle.
/// noise : Noise, optional
///     Standard deviations of readings and slip, default ``Noise()``.
/// readings : {'angles', 'speeds', 'increments'}
///     What is read of the wheels: running totals [rad]; rates at the stamps [rad/s], of which a step takes the mean
///     of its two ends; or what came since the sample before [rad].
/// wheel_encoders, steering_encoders : Encoder, sequence of Encoder or dict of str to Encoder, optional
///     For readings in counts: one for all, one each, or by the name of the wheel.
/// method : {'least_squares', 'middle_wheels', 'robust'}
///     How the wheels are weighed, as in `Rover.fit`.
/// inflate : bool
///     Count what the wheels disagree by beyond the noise as more noise of the step.
/// slip_threshold : float, optional
///     Slip of a wheel from which on a sample is flagged [m/s]; by default four standard deviations of the noise,
///     of a noise that is a guess 0.05 m/s.
/// max_gap : float, optional
///     Time between samples beyond which a step is flagged [s]. It still is one arc.
/// max_speed : float, optional
///     Rim speed beyond which a sample is refused [m/s].
/// max_steering_rate : float, optional
///     Steering rate beyond which a sample is refused [rad/s].
/// smoothing : float, default 0.0
///     Time constant of the first-order filter of `velocity` [s]; 0: none.
/// lag : float, default 0.0
///     How late a pose may come to `correct` [s]; 0: not before the last step.
/// history : int, default 1024
///     Samples that are kept for that at most.
/// gyroscope : Gyroscope, optional
///     Of the `yaw_rate` that comes with the samples: its bias is a state, learnt while wheels and gyroscope agree that the
///     rover stands, in which case the pose is held. Its noise stands for that of `noise.yaw_rate`.
/// wheel_noise : array_like of shape (wheels,), or dict of str to float, optional
///     How many times as much as `noise` says each wheel slips, in the order of the wheels or by name; default 1.
/// dimensions : array_like, shape (k, wheels, 9), optional
///     What the dimensions may be off by all along, as k independent errors of one standard deviation each: of every wheel
///     its radius, x, y [m], heading [rad], scrub, trail [m], roller angle [rad], and as shares of what is read its turns
///     and its steering angle. `Calibration.dimensions` and that of a parameter file are such. Steps then take longer.
///
/// Raises
/// ------
/// ValueError
///     If a parameter makes no sense.
///
/// Source: R. Siegwart, I. Nourbakhsh, D. Scaramuzza, Introduction to Autonomous Mobile Robots, 2nd ed., ch. 5.
#[pyclass(frozen, module = "six_wheel")]
pub struct Odometry {
    work: Shared<Work>,
    rover: Py<Rover>,
}

/// What one thread at a time works with.
struct Work {
    core: Core,
    spares: Spares,
}

/// What the wheels report, by name.
fn readings_named(name: &str) -> PyResult<Readings> {
    match name {
        "angles" => Ok(Readings::Angles),
        "speeds" => Ok(Readings::Speeds),
        "increments" => Ok(Readings::Increments),
        _ => {
            let rule = "be 'angles', 'speeds' or 'increments'";
            Err(refuse("readings", rule, &format!("'{name}'")))
        }
    }
}

impl Odometry {
    fn joints(&self) -> usize {
        self.rover.get().joints()
    }

    fn wheels(&self) -> usize {
        self.rover.get().count()
    }

    fn state_of(&self, core: &Core, py: Python<'_>) -> OdometryState {
        OdometryState::of(core, self.rover.clone_ref(py))
    }

    /// Changes the core, and answers with the state after that.
    fn change(&self, py: Python<'_>, change: impl FnOnce(&mut Core) -> Result<(), Error>) -> PyResult<OdometryState> {
        let mut work = self.work.lock(py)?;
        change(&mut work.core).map_err(|error| raise(error, &[]))?;
        Ok(self.state_of(&work.core, py))
    }
}

#[pymethods]
impl Odometry {
    #[new]
    #[pyo3(
        signature = (rover, noise=None, *, readings="angles", wheel_encoders=None, steering_encoders=None, method="least_squares", inflate=false, slip_threshold=None, max_gap=None, max_speed=None, max_steering_rate=None, smoothing=None, lag=None, history=1024, gyroscope=None, wheel_noise=None, dimensions=None),
        text_signature = "(rover, noise=None, *, readings='angles', wheel_encoders=None, steering_encoders=None, method='least_squares', inflate=False, slip_threshold=None, max_gap=None, max_speed=None, max_steering_rate=None, smoothing=0.0, lag=0.0, history=1024, gyroscope=None, wheel_noise=None, dimensions=None)"
    )]
    #[allow(clippy::too_many_arguments)] // they are keywords
    fn new(
        #[pyo3(from_py_with = given::rover)] rover: Bound<'_, Rover>,
        #[pyo3(from_py_with = given::noise)] noise: Option<Bound<'_, Noise>>,
        #[pyo3(from_py_with = given::readings)] readings: &str,
        wheel_encoders: Option<&Bound<'_, PyAny>>,
        steering_encoders: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = given::method)] method: &str,
        #[pyo3(from_py_with = given::inflate)] inflate: bool,
        slip_threshold: Option<&Bound<'_, PyAny>>,
        max_gap: Option<&Bound<'_, PyAny>>,
        max_speed: Option<&Bound<'_, PyAny>>,
        max_steering_rate: Option<&Bound<'_, PyAny>>,
        smoothing: Option<&Bound<'_, PyAny>>,
        lag: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = given::history)] history: usize,
        #[pyo3(from_py_with = given::gyroscope)] gyroscope: Option<Bound<'_, gyroscope::Gyroscope>>,
        wheel_noise: Option<&Bound<'_, PyAny>>,
        dimensions: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let core = &rover.get().core;
        let wheels: Vec<&str> = core.wheels().iter().map(|wheel| wheel.name.as_str()).collect();
        let steered: Vec<&str> = core.steered().iter().map(|&i| wheels[i]).collect();
        let readings = readings_named(readings)?;
        let settings = Settings {
            noise: noise.map(|noise| noise.get().0).unwrap_or_default(),
            gyroscope: gyroscope.map(|known| known.get().0),
            wheel_noise: by_wheel("wheel_noise", wheel_noise, &wheels)?,
            dimensions: deviations(dimensions, wheels.len())?,
            readings,
            wheel_encoders: encoders("wheel_encoders", wheel_encoders, &wheels)?,
            steering_encoders: encoders("steering_encoders", steering_encoders, &steered)?,
            method: Method::from_str(method).map_err(|error| raise(error, &[]))?,
            inflate,
            slip_threshold: optional("slip_threshold", slip_threshold)?,
            max_gap: optional("max_gap", max_gap)?,
            max_speed: optional("max_speed", max_speed)?,
            max_steering_rate: optional("max_steering_rate", max_steering_rate)?,
            smoothing: optional("smoothing", smoothing)?.unwrap_or(0.0),
            lag: optional("lag", lag)?.unwrap_or(0.0),
            history,
        };
        let core = Core::new(core.clone(), settings).map_err(|error| raise(error, &[]))?;
        Ok(Self { work: Shared::new(Work { core, spares: Spares::default() }), rover: rover.clone().unbind() })
    }

    /// Takes in one sample.
    ///
    /// Parameters
    /// ----------
    /// steering : array_like, shape (steered wheels,)
    ///     Steering angles [rad], or counts of their encoders; None for a rover that does not steer.
    /// wheel_angles : array_like, shape (wheels,)
    ///     Running totals [rad], or what `readings` and the encoders say; NaN where a passive wheel has no encoder.
    /// stamp : float
    ///     When they were read [s].
    /// yaw : float, optional
    ///     Absolute yaw from a sensor with a zero of its own [rad]; the first one tells where that is.
    /// yaw_rate : float, optional
    ///     Yaw rate of a gyroscope [rad/s], of which a step takes the mean of its two ends.
    ///
    /// Returns
    /// -------
    /// OdometryState
    ///     `pose`, `twist`, `covariance`, `residual` and more.
    ///
    /// Raises
    /// ------
    /// UnderdeterminedError
    ///     If the wheels do not determine the motion.
    /// ValueError
    ///     If a reading is not finite, the stamp not later than the last one, a limit exceeded or a shape wrong. The
    ///     state is as before.
    #[pyo3(signature = (steering, wheel_angles, stamp, *, yaw=None, yaw_rate=None))]
    fn update(
        &self,
        py: Python<'_>,
        steering: &Bound<'_, PyAny>,
        wheel_angles: &Bound<'_, PyAny>,
        stamp: &Bound<'_, PyAny>,
        yaw: Option<&Bound<'_, PyAny>>,
        yaw_rate: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<OdometryState> {
        let steering = row("steering", steering, self.joints())?;
        let wheels = row("wheel_angles", wheel_angles, self.wheels())?;
        let sample = Sample {
            steering: steering.as_ref().map_or(&[][..], |rows| rows.flat()),
            wheels: wheels.as_ref().map_or(&[], Rows::flat),
            stamp: number("stamp", stamp)?,
            yaw: optional("yaw", yaw)?,
            yaw_rate: optional("yaw_rate", yaw_rate)?,
        };
        self.change(py, |core| core.update(sample).map(|_| ()))
    }

    /// Takes in a whole log, from where the last sample ended; the same numbers as `update`, row by row.
    ///
    /// Parameters
    /// ----------
    /// steering : array_like, shape (n, steered wheels)
    ///     As in `update`; None for a rover that does not steer.
    /// wheel_angles : array_like, shape (n, wheels)
    ///     As in `update`.
    /// stamps : array_like, shape (n,)
    ///     When they were read [s].
    /// yaw, yaw_rate : array_like, shape (n,), optional
    ///     As in `update`; NaN in rows without.
    /// errors : {'flag', 'raise'}
    ///     Leave out rows that cannot be, flagged in `health`, or raise on the first one.
    /// covariances, residuals : bool
    ///     Whether to compute these; what is not is None.
    ///
    /// Returns
    /// -------
    /// Track
    ///     `poses`, `twists`, `covariances`, `residuals`, `weights` (of the robust method) and `health`, one row per
    ///     sample.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a shape does not fit; with ``errors="raise"`` as `update`, the row named.
    #[pyo3(signature = (steering, wheel_angles, stamps, *, yaw=None, yaw_rate=None, errors="flag", covariances=true, residuals=true))]
    #[allow(clippy::too_many_arguments)] // they are keywords
    fn run<'py>(
        &self,
        py: Python<'py>,
        steering: &Bound<'py, PyAny>,
        wheel_angles: &Bound<'py, PyAny>,
        stamps: &Bound<'py, PyAny>,
        yaw: Option<&Bound<'py, PyAny>>,
        yaw_rate: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = given::errors)] errors: &str,
        #[pyo3(from_py_with = given::covariances)] covariances: bool,
        #[pyo3(from_py_with = given::residuals)] residuals: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let count = self.wheels();
        let widths = [count, self.joints()];
        let log = Columns::read(wheel_angles, steering, stamps, errors, widths)?;
        let yaws = log.optional("yaw", yaw)?;
        let rates = log.optional("yaw_rate", yaw_rate)?;
        let recording = Recording {
            steering: log.angles(),
            wheels: log.wheels.flat(),
            stamps: log.stamps.flat(),
            yaws: yaws.as_ref().map(Scalars::flat),
            yaw_rates: rates.as_ref().map(Scalars::flat),
        };
        let rows = log.wheels.count();
        let output = |shape: &[usize]| Output::fresh(py, shape);
        let wanted = |flag: bool, shape: &[usize]| flag.then(|| output(shape)).transpose();
        let is_robust = self.work.lock(py)?.core.settings().method == Method::Robust;
        let (mut poses, mut twists) = (output(&[rows, 3])?, output(&[rows, 3])?);
        let mut covariances = wanted(covariances, &[rows, 3, 3])?;
        let mut residuals = wanted(residuals, &[rows, count])?;
        let mut weights = wanted(is_robust, &[rows, count])?;
        let mut flags = memory::filled(0, rows)?;
        let track = TrackRows {
            poses: poses.triples(),
            twists: twists.triples(),
            covariances: covariances.as_mut().map(|out| out.flat().as_chunks_mut().0),
            residuals: residuals.as_mut().map(Output::flat),
            weights: weights.as_mut().map(Output::flat),
            health: &mut flags,
        };
        let mut work = self.work.lock(py)?;
        let core = &mut work.core;
        compute(py, rows, || core.run(recording, log.is_strict, track))
            .map_err(|error| raise(error, &log.wheels.leading))?;
        drop(work);
        let finish = |out: Option<Output<'py>>| -> PyResult<Option<Array<'py>>> { out.map(Output::finish).transpose() };
        let keywords = PyDict::new(py);
        keywords.set_item("rover", &self.rover)?;
        keywords.set_item("stamps", memory::array(py, log.stamps.flat(), &[rows])?)?;
        keywords.set_item("poses", poses.finish()?)?;
        keywords.set_item("twists", twists.finish()?)?;
        keywords.set_item("covariances", finish(covariances)?)?;
        keywords.set_item("residuals", finish(residuals)?)?;
        keywords.set_item("weights", finish(weights)?)?;
        keywords.set_item("health", PyArray1::from_vec(py, flags))?;
        build_track(&keywords, "Track")
    }

    /// Open loop, for a rover without readings: it is taken to have held a commanded twist since the last stamp.
    ///
    /// The next sample of `update` is a first one.
    ///
    /// Parameters
    /// ----------
    /// twist : array_like, shape (3,)
    ///     ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s].
    /// stamp : float
    ///     Until when it was held [s]. The first stamp is the reference.
    ///
    /// Raises
    /// ------
    /// InfeasibleMotionError
    ///     If the rover cannot make the twist.
    /// ValueError
    ///     If a value is not finite or the stamp not later than the last one.
    #[pyo3(signature = (twist, stamp, *more), text_signature = "($self, twist, stamp)")]
    fn command(
        &self,
        py: Python<'_>,
        twist: &Bound<'_, PyAny>,
        stamp: &Bound<'_, PyAny>,
        more: &Bound<'_, PyTuple>,
    ) -> PyResult<OdometryState> {
        one_twist_first("Odometry.command((vx, vy, omega), stamp)", twist, 2, more)?;
        let (twist, stamp) = (numbers("twist", twist)?, number("stamp", stamp)?);
        self.change(py, |core| core.command(twist.into(), stamp).map(|_| ()))
    }

    /// Moves the estimate towards a pose from outside, which may come late: the samples since are taken in again.
    ///
    /// Parameters
    /// ----------
    /// pose : array_like, shape (3,)
    ///     ``[x, y, yaw]`` in the world [m, m, rad].
    /// stamp : float
    ///     When the rover was there [s], not before the last `lag` seconds.
    /// covariance : array_like, shape (3,) or (3, 3)
    ///     Variances of x, y and yaw, or their covariance, in world axes. An infinite variance says nothing of that
    ///     direction; zeros take the pose at its word.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a value is not finite, the covariance is none or the stamp too old. The state is as before.
    fn correct(
        &self,
        py: Python<'_>,
        pose: &Bound<'_, PyAny>,
        stamp: &Bound<'_, PyAny>,
        covariance: &Bound<'_, PyAny>,
    ) -> PyResult<OdometryState> {
        let (pose, stamp) = (numbers("pose", pose)?, number("stamp", stamp)?);
        let matrix = input::covariance(Some(covariance))?;
        self.change(py, |core| core.correct(pose.into(), stamp, matrix))
    }

    /// Goes on from this pose; the readings count on from the last sample.
    ///
    /// Parameters
    /// ----------
    /// pose : array_like, shape (3,)
    ///     ``[x, y, yaw]`` in the world [m, m, rad].
    /// covariance : array_like, shape (3,) or (3, 3), optional
    ///     Variances of x, y and yaw, or their covariance, in world axes; default 0.
    #[pyo3(signature = (pose, covariance=None))]
    fn set_pose(&self, py: Python<'_>, pose: &Bound<'_, PyAny>, covariance: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let (pose, matrix) = (numbers("pose", pose)?, input::covariance(covariance)?);
        self.change(py, |core| core.set_pose(pose.into(), matrix))?;
        Ok(())
    }

    /// Starts over: the next sample is a first one.
    ///
    /// Parameters
    /// ----------
    /// pose : array_like, shape (3,)
    ///     ``[x, y, yaw]`` in the world [m, m, rad], default the origin.
    /// covariance : array_like, shape (3,) or (3, 3), optional
    ///     Variances of x, y and yaw, or their covariance, in world axes; default 0.
    #[pyo3(signature = (pose=None, covariance=None), text_signature = "($self, pose=(0.0, 0.0, 0.0), covariance=None)")]
    fn reset(
        &self,
        py: Python<'_>,
        pose: Option<&Bound<'_, PyAny>>,
        covariance: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let pose = pose.map_or(Ok([0.0; 3]), |pose| numbers("pose", pose))?;
        let matrix = input::covariance(covariance)?;
        self.change(py, |core| {
            core.set_pose(pose.into(), matrix)?;
            core.forget();
            Ok(())
        })?;
        Ok(())
    }

    /// Where the rover is after the last sample.
    #[getter]
    fn state(&self, py: Python<'_>) -> PyResult<OdometryState> {
        Ok(self.state_of(&self.work.lock(py)?.core, py))
    }

    /// Bias of the gyroscope and its standard deviation, a pair [rad/s]; None without one.
    #[getter]
    fn gyroscope_bias(&self, py: Python<'_>) -> PyResult<Option<(f64, f64)>> {
        let work = self.work.lock(py)?;
        let bias = work.core.gyroscope_bias();
        Ok(bias.map(|[value, deviation]| (value, deviation)))
    }

    /// The rover.
    #[getter]
    fn rover(&self, py: Python<'_>) -> Py<Rover> {
        self.rover.clone_ref(py)
    }

    /// Standard deviations of readings and slip.
    #[getter]
    fn noise(&self, py: Python<'_>) -> PyResult<Noise> {
        Ok(Noise(self.work.lock(py)?.core.settings().noise))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let state = Py::new(py, self.state(py)?)?;
        Ok(format!("Odometry({})", state.bind(py).repr()?))
    }
}
