//! `six_wheel.Odometry`.

mod fastcall;
mod input;
pub mod preintegrated;
mod run;
pub mod spatial;
pub mod state;
pub mod values;

use pyo3::prelude::*;
use six_wheel_kinematics::estimate::Method;
use six_wheel_numerics::error::Error;
use six_wheel_odometry::{Odometry as Core, Sample, Settings};

pub use fastcall::install;

use crate::convert::{OrRaise, Rows, numbers, one_twist_first};
use crate::rover::Rover;
use crate::state_lock::Shared;
use input::{by_wheel, deviations, settings};
use state::{OdometryState, Spares};
use values::{Gyroscope, Noise};

/// Dead reckoning that knows its error: the pose of a rover from what its wheels turned.
///
/// A step is exact: the displacement that fits the turns of all wheels best, at the steering angles of its middle, is
/// held as one arc. Its covariance comes from the analytic derivatives of that fit. The first sample is the reference
/// from which the next one counts. Any thread may call any method: it waits while another one is at work.
#[doc = section!(Parameters)]
/// rover : Rover
///     Any vehicle.
/// noise : Noise, optional
///     Standard deviations of readings and slip, default ``Noise()``.
#[doc = parameters!(readings_and_encoders)]
/// method : {'least_squares', 'middle_wheels', 'robust'}
///     Weights of the wheels, as in `Rover.fit`.
/// inflate : bool
///     Count residuals of the wheels beyond the noise as more noise of the step.
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
/// lag : float, default 1.0
///     Largest delay of a pose given to `correct` [s]; 0: not before the last step, which is quicker.
/// history : int, default 1024
///     Samples that are kept for that at most.
/// gyroscope : Gyroscope, optional
///     Of the `yaw_rate` that comes with the samples: its bias is a state, learnt while wheels and gyroscope agree that the
///     rover stands, in which case the pose is held. Its noise stands for that of `noise.yaw_rate`.
/// wheel_noise : array_like of shape (wheels,), or dict of str to float, optional
///     Factor on the slip of `noise` for each wheel, in the order of the wheels or by name; default 1.
/// dimensions : array_like, shape (k, wheels, 9), optional
///     Constant errors of the dimensions, as k independent errors of one standard deviation each: of every wheel
///     its radius, x, y [m], heading [rad], scrub, trail [m], roller angle [rad], and as shares of what is read its turns
///     and its steering angle. `Calibration.dimensions` and that of a parameter file are such. Steps then take longer.
#[doc = raises!("If a parameter makes no sense.")]
///
/// Source: R. Siegwart, I. Nourbakhsh, D. Scaramuzza, Introduction to Autonomous Mobile Robots, 2nd ed., ch. 5.
#[pyclass(frozen, module = "six_wheel")]
pub struct Odometry {
    work: Shared<Work>,
    rover: Py<Rover>,
}

/// The state that one thread at a time works with.
struct Work {
    core: Core,
    spares: Spares,
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
        change(&mut work.core).or_raise(&[])?;
        Ok(self.state_of(&work.core, py))
    }
}

getters! { Odometry, self, py:
    /// Estimate after the last sample.
    state: PyResult<OdometryState> = Ok(self.state_of(&self.work.lock(py)?.core, py));
    /// The rover.
    rover: Py<Rover> = self.rover.clone_ref(py);
    /// Standard deviations of readings and slip.
    noise: PyResult<Noise> = Ok(self.work.lock(py)?.core.settings().noise.into());
    /// Bias of the gyroscope and its standard deviation, a pair [rad/s]; None without one.
    gyroscope_bias: PyResult<Option<(f64, f64)>> = {
        let work = self.work.lock(py)?;
        let bias = work.core.gyroscope_bias();
        Ok(bias.map(|[value, deviation]| (value, deviation)))
    };
}

copied_by! { Odometry,
    "keep its `state`, and start another one with set_pose(state.pose, state.covariance)",
    |this, py| {
        let core = this.work.lock(py)?.core.clone();
        Ok(Self { work: Shared::new(Work { core, spares: Spares::default() }), rover: this.rover.clone_ref(py) })
    }
}

methods! { Odometry:
    #[new]
    fn new[](rover: Bound<'py, Rover>, noise: Option<Bound<'py, Noise>> = None, *, readings: &str = "angles", increments: bool = false,
        wheel_encoders=None, steering_encoders=None, method: &str = "least_squares", inflate: bool = false,
        slip_threshold: Option<f64> = None, max_gap: Option<f64> = None, max_speed: Option<f64> = None,
        max_steering_rate: Option<f64> = None, smoothing: Option<f64> = None, lag: Option<f64> = None,
        history: usize = 1024, gyroscope: Option<Bound<'py, Gyroscope>> = None, wheel_noise=None, dimensions=None, **)
    as "(rover, noise=None, *, readings='angles', increments=False, wheel_encoders=None, steering_encoders=None, method='least_squares', inflate=False, slip_threshold=None, max_gap=None, max_speed=None, max_steering_rate=None, smoothing=0.0, lag=1.0, history=1024, gyroscope=None, wheel_noise=None, dimensions=None)"
    -> PyResult<Self> {
        let core = &rover.get().core;
        let [wheels, steered] = rover.get().wheels_and_steered();
        let settings = Settings {
            gyroscope: gyroscope.map(|known| known.get().0),
            wheel_noise: by_wheel("wheel_noise", wheel_noise, &wheels)?,
            dimensions: deviations(dimensions, wheels.len())?,
            method: method.parse::<Method>().or_raise(&[])?,
            inflate,
            slip_threshold,
            max_gap,
            max_speed,
            max_steering_rate,
            smoothing: smoothing.unwrap_or(0.0),
            lag: lag.unwrap_or(1.0),
            history,
            ..settings(noise, (readings, increments), [wheel_encoders, steering_encoders], [&wheels, &steered])?
        };
        let core = Core::new(core.clone(), settings).or_raise(&[])?;
        Ok(Self { work: Shared::new(Work { core, spares: Spares::default() }), rover: rover.clone().unbind() })
    }

    /// Takes in one sample.
    #[doc = section!(Parameters)]
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
    #[doc = returns!("OdometryState": "`pose`, `twist`, `covariance`, `residuals` and more.")]
    #[doc = raises!(UnderdeterminedError: "If the wheels do not determine the motion.")]
    /// ValueError
    ///     If a reading is not finite, the stamp not later than the last one, a limit exceeded or a shape wrong. The
    ///     state is as before.
    fn update[&self, py: Python<'py>](steering, wheel_angles, stamp: f64, *, yaw: Option<f64> = None,
        yaw_rate: Option<f64> = None) -> PyResult<OdometryState> {
        let steering = input::steering(steering, self.joints(), &[])?;
        let wheels = Rows::read("wheel_angles", wheel_angles, self.wheels())?.over(&[])?;
        let sample = Sample {
            steering: steering.as_ref().map_or(&[], Rows::flat),
            wheels: wheels.flat(),
            stamp,
            yaw,
            yaw_rate,
        };
        self.change(py, |core| core.update(sample).map(|_| ()))
    }

    /// Open loop, for a rover without readings: it is taken to have held a commanded twist since the last stamp.
    ///
    /// The next sample of `update` is a first one.
    #[doc = section!(Parameters: twist "(3,)")]
    /// stamp : float
    ///     Until when it was held [s]. The first stamp is the reference.
    #[doc = raises!(
        InfeasibleMotionError: "If the rover cannot make the twist.",
        ValueError: "If a value is not finite or the stamp not later than the last one."
    )]
    fn command[&self, py: Python<'py>](twist, stamp: f64, *more)
    as "($self, twist, stamp)" -> PyResult<OdometryState> {
        one_twist_first("Odometry.command((vx, vy, omega), stamp)", twist, 2, more)?;
        let twist: [f64; 3] = numbers("twist", twist)?;
        self.change(py, |core| core.command(twist.into(), stamp).map(|_| ()))
    }

    /// Moves the estimate towards a pose from outside, which may come late: the samples since are taken in again.
    #[doc = section!(Parameters)]
    /// pose : array_like, shape (3,)
    ///     ``[x, y, yaw]`` in the world [m, m, rad].
    /// stamp : float
    ///     When the rover was there [s], not before the last `lag` seconds.
    /// covariance : array_like, shape (3,) or (3, 3), optional
    ///     Variances of x, y and yaw, or their covariance, in world axes. An infinite variance says nothing of that
    ///     direction; zeros take the pose at its word.
    /// std : array_like, shape (3,), optional
    ///     Standard deviations of x, y [m] and yaw [rad], in place of `covariance`.
    #[doc = raises!("If a value is not finite, the covariance is none or the stamp too old. The state is as before.")]
    fn correct[&self, py: Python<'py>](pose: [f64; 3], stamp: f64, covariance=None, *, std=None)
    -> PyResult<OdometryState> {
        let matrix = input::covariance(Some(&input::variances(py, covariance, std)?))?;
        self.change(py, |core| core.correct(pose.into(), stamp, matrix))
    }

    /// The pose at an instant, as of an image: between two samples on the arc of the step, after the last one as if the rover
    /// had gone on as before.
    #[doc = section!(Parameters)]
    /// stamp : float
    ///     The instant [s]: not before the last `lag` seconds, nor more than that, or one step, after the last sample.
    #[doc = returns!("Pose": "``x, y, yaw`` in the world [m, m, rad].")]
    #[doc = raises!("If the stamp is not finite, too old, too late, or there was no sample.")]
    fn at[&self, py: Python<'py>](stamp: f64) -> PyResult<Bound<'py, PyAny>> {
        let pose = self.work.lock(py)?.core.pose_at(stamp).or_raise(&[])?;
        py.import("six_wheel.kinematics.geometry")?.getattr("Pose")?.call_method1("_make", ((pose.x, pose.y, pose.yaw),))
    }

    /// Starts over: the next sample is a first one.
    #[doc = section!(Parameters)]
    /// pose : array_like, shape (3,)
    ///     ``[x, y, yaw]`` in the world [m, m, rad], default the origin.
    /// covariance : array_like, shape (3,) or (3, 3), optional
    ///     Variances of x, y and yaw, or their covariance, in world axes; default 0.
    #[doc = raises!("If a number is not finite, a shape does not fit, or a variance is negative.")]
    fn reset[&self, py: Python<'py>](pose=None, covariance=None)
    as "($self, pose=(0.0, 0.0, 0.0), covariance=None)" -> PyResult<()> {
        let pose = pose.map_or(Ok([0.0; 3]), |pose| numbers("pose", pose))?;
        let matrix = input::covariance(covariance)?;
        self.change(py, |core| {
            core.set_pose(pose.into(), matrix)?;
            core.forget();
            Ok(())
        })
        .map(drop)
    }

    /// Goes on from this pose; the readings count on from the last sample.
    #[doc = section!(Parameters)]
    /// pose : array_like, shape (3,)
    ///     ``[x, y, yaw]`` in the world [m, m, rad].
    /// covariance : array_like, shape (3,) or (3, 3), optional
    ///     Variances of x, y and yaw, or their covariance, in world axes; default 0.
    #[doc = raises!("If a number is not finite, a shape does not fit, or a variance is negative.")]
    fn set_pose[&self, py: Python<'py>](pose, covariance=None) -> PyResult<()> {
        let (pose, matrix) = (numbers("pose", pose)?, input::covariance(covariance)?);
        self.change(py, |core| core.set_pose(pose.into(), matrix)).map(drop)
    }
}

#[pymethods]
impl Odometry {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let state = Py::new(py, self.state(py)?)?;
        Ok(crate::classes::cut(format!("Odometry({})", state.bind(py).repr()?)))
    }
}
