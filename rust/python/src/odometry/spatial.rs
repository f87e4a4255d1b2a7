//! `six_wheel.Odometry3`.

mod input;
pub mod state;

use numpy::PyArray1;
use pyo3::prelude::*;
use six_wheel_ground_motion::spatial::{Odometry3 as Core, Recording3, Sample3, Settings3, TrackRows3};
use six_wheel_numerics::error::Error;
use six_wheel_odometry::{LogOdometry, Settings};

use super::input::{Columns, build_track, settings, variances};
use super::values::Noise;
use crate::convert::{OrRaise, Output, Rows, compute_rows, is_interrupted, memory, ready};
use crate::state_lock::Shared;
use crate::suspension::Suspension;
use crate::terrain::Terrain;
use input::{attitudes, covariance, pose};
use state::Odometry3State;

/// Dead reckoning in space: the pose of a rover on ground from wheels, and an IMU or the ground itself.
///
/// Roll and pitch come from an IMU, or from where the suspension settles on `ground`. Without ground the joints say how
/// the wheels stand: together they go along the plane they stand about, each alone goes where its centre goes. With
/// ground the contacts, the height, and without an IMU roll and pitch, are those of the settled pose. The wheels'
/// motion is that of `Suspension.forward`, unsteered wheels sharing their side slip; every step is one screw of SE(3).
/// On level ground, for a rover that stands level, all of this is `Odometry`. Any thread may call any method: it waits
/// while another one is at work.
#[doc = section!(Parameters)]
/// suspension : Suspension
///     Any suspension: a `RockerBogie`, or another chain.
/// noise : Noise, optional
///     Standard deviations of readings and slip, default ``Noise()``. `yaw_rate` is that of the gyroscope, and of the
///     turn that attitudes with a yaw tell.
/// ground : Terrain, optional
///     The ground, if it is known.
/// attitude_noise : float, default 0.002
///     Standard deviation of roll and of pitch, as read [rad].
/// joint_noise : float, default 0.001
///     Standard deviation of every joint angle, as read [rad].
#[doc = parameters!(readings_and_encoders)]
/// slip_threshold : float, optional
///     Slip of a wheel from which on a sample is flagged [m/s]; by default four standard deviations of the noise.
/// max_gap : float, optional
///     Time between samples beyond which a step is flagged [s].
/// max_speed : float, optional
///     Rim speed beyond which a sample is refused [m/s].
/// max_steering_rate : float, optional
///     Steering rate beyond which a sample is refused [rad/s].
/// lag : float, default 1.0
///     Largest delay of a pose given to `correct` [s]; 0: not before the last step, which is quicker.
/// history : int, default 1024
///     Samples that are kept for that at most.
#[doc = raises!("If a parameter makes no sense.")]
///
/// Source: N. Seegmiller, A. Kelly, Enhanced 3D kinematic modeling of wheeled mobile robots, RSS 2014.
#[pyclass(frozen, module = "six_wheel")]
pub struct Odometry3 {
    work: Shared<Core>,
    suspension: Py<Suspension>,
    ground: Option<Py<Terrain>>,
}

impl Odometry3 {
    fn widths(&self) -> [usize; 3] {
        let chain = &self.suspension.get().chain;
        [chain.wheels().len(), chain.steering().len(), chain.joints().len()]
    }

    fn state_of(&self, core: &Core, py: Python<'_>) -> Odometry3State {
        Odometry3State::of(core, self.suspension.clone_ref(py))
    }

    /// Changes the core, and answers with the state after that.
    fn change(&self, py: Python<'_>, change: impl FnOnce(&mut Core) -> Result<(), Error>) -> PyResult<Odometry3State> {
        let mut core = self.work.lock(py)?;
        change(&mut core).or_raise(&[])?;
        Ok(self.state_of(&core, py))
    }
}

getters! { Odometry3, self, py:
    /// Estimate after the last sample.
    state: PyResult<Odometry3State> = Ok(self.state_of(&*self.work.lock(py)?, py));
    /// The suspension.
    suspension: Py<Suspension> = self.suspension.clone_ref(py);
    /// The ground; None if it is not known.
    ground: Option<Py<Terrain>> = self.ground.as_ref().map(|ground| ground.clone_ref(py));
    /// Standard deviations of readings and slip.
    noise: PyResult<Noise> = Ok(self.work.lock(py)?.settings().common.noise.into());
}

copied_by! { Odometry3,
    "keep its `state`, and start another one with set_pose(state.pose, state.covariance)",
    |this, py| {
        let core = this.work.lock(py)?.clone();
        let ground = this.ground.as_ref().map(|ground| ground.clone_ref(py));
        Ok(Self { work: Shared::new(core), suspension: this.suspension.clone_ref(py), ground })
    }
}

methods! { Odometry3:
    #[new]
    fn new[](suspension: Bound<'py, Suspension>, noise: Option<Bound<'py, Noise>> = None, *,
        ground: Option<Bound<'py, Terrain>> = None, attitude_noise: Option<f64> = None, joint_noise: Option<f64> = None,
        readings: &str = "angles", increments: bool = false, wheel_encoders=None, steering_encoders=None, slip_threshold: Option<f64> = None,
        max_gap: Option<f64> = None, max_speed: Option<f64> = None, max_steering_rate: Option<f64> = None,
        lag: Option<f64> = None, history: usize = 1024, **)
    as "(suspension, noise=None, *, ground=None, attitude_noise=0.002, joint_noise=0.001, readings='angles', increments=False, wheel_encoders=None, steering_encoders=None, slip_threshold=None, max_gap=None, max_speed=None, max_steering_rate=None, lag=1.0, history=1024)"
    -> PyResult<Self> {
        ready(suspension.py())?;
        let chain = &suspension.get().chain;
        let wheels: Vec<&str> = chain.wheels().iter().map(|wheel| &*wheel.name).collect();
        let steered: Vec<&str> = (0..chain.steering().len()).map(|joint| chain.steered_name(joint)).collect();
        let common = Settings {
            slip_threshold,
            max_gap,
            max_speed,
            max_steering_rate,
            lag: lag.unwrap_or(1.0),
            history,
            ..settings(noise, (readings, increments), [wheel_encoders, steering_encoders], [&wheels, &steered])?
        };
        let settings = with_given!(Settings3 { common, ..Settings3::default() }, attitude_noise joint_noise);
        let map = ground.as_ref().map(|ground| ground.get().0.clone());
        let core = Core::new(chain.clone(), map, settings).or_raise(&[])?;
        Ok(Self { work: Shared::new(core), suspension: suspension.clone().unbind(), ground: ground.map(Bound::unbind) })
    }

    /// Takes in one sample.
    #[doc = section!(Parameters)]
    /// steering : array_like, shape (steered wheels,)
    ///     Steering angles [rad], or counts of their encoders; None for a rover that does not steer.
    /// wheel_angles : array_like, shape (wheels,)
    ///     Running totals against the links that carry the wheels [rad], or what `readings` and the encoders say; NaN
    ///     where a wheel has no encoder.
    /// stamp : float
    ///     When they were read [s].
    /// joints : array_like, shape (joints,), optional
    ///     Free angles of the suspension [rad], in the order of `Suspension.free_joints`. Without ground every sample
    ///     has them; on ground NaN where one was not measured.
    /// attitude : array_like, shape (2,), (3,) or (4,), optional
    ///     Of the body, from an IMU: roll and pitch; roll, pitch and yaw; or a quaternion x, y, z, w. The yaw has a zero
    ///     of its own, its changes count. Without ground every sample has one.
    /// yaw_rate : float, optional
    ///     Of a gyroscope about the body's z axis [rad/s], of which a step takes the mean of its two ends.
    #[doc = returns!("Odometry3State": "`pose`, `twist`, `covariance`, `residuals`, `slips` and more.")]
    #[doc = raises!(UnderdeterminedError: "If wheels, joints and attitude do not determine the motion.")]
    /// ValueError
    ///     If a reading is missing or not finite, the attitude upside down, the stamp not later than the last one, the
    ///     rover off the ground, a limit exceeded or a shape wrong. The state is as before.
    fn update[&self, py: Python<'py>](steering, wheel_angles, stamp: f64, *, joints=None, attitude=None,
        yaw_rate: Option<f64> = None) -> PyResult<Odometry3State> {
        let [wheels, steered, free] = self.widths();
        let steering = super::input::steering(steering, steered, &[])?;
        let wheels = Rows::read("wheel_angles", wheel_angles, wheels)?.over(&[])?;
        let joints = Rows::read_beside("joints", joints, free, &[])?;
        let attitude = attitude.map(input::attitude_of).transpose()?;
        let sample = Sample3 {
            steering: steering.as_ref().map_or(&[], Rows::flat),
            wheels: wheels.flat(),
            stamp,
            joints: joints.as_ref().map(Rows::flat),
            attitude,
            yaw_rate,
        };
        self.change(py, |core| core.update(sample).map(|_| ()))
    }

    /// Takes in a whole log, from where the last sample ended; the same numbers as `update`, row by row.
    #[doc = section!(Parameters: log)]
    /// joints : array_like, shape (n, joints), optional
    ///     As in `update`.
    /// attitude : array_like, shape (n, 2), (n, 3) or (n, 4), optional
    ///     As in `update`; on ground rows of NaN go by the ground.
    /// yaw_rate : array_like, shape (n,), optional
    ///     As in `update`; NaN in rows without.
    /// errors : {'flag', 'raise'}
    ///     Leave out rows that cannot be, flagged in `health`, or raise on the first one.
    /// covariances, slips : bool
    ///     True to compute these; those that are not computed are None.
    #[doc = returns!("Track3": "`poses`, `twists`, `covariances`, `slips` and `health`, one row per sample.")]
    #[doc = raises!(ValueError)]
    ///     If a shape does not fit; with ``errors="raise"`` as `update`, the row named.
    fn run[&self, py: Python<'py>](steering, wheel_angles, stamps, *, joints=None, attitude=None, yaw_rate=None,
        errors: &str = "flag", covariances: bool = true, slips: bool = true) -> PyResult<Bound<'py, PyAny>> {
        let [count, steered, free] = self.widths();
        let log = Columns::read(wheel_angles, steering, stamps, errors, [count, steered])?;
        let leading = log.wheels.leading.as_slice();
        let joints = Rows::read_beside("joints", joints, free, leading)?;
        let attitudes = attitude.map(|attitude| attitudes(attitude, leading)).transpose()?;
        let rates = log.optional("yaw_rate", yaw_rate)?;
        let recording = Recording3 {
            steering: log.angles(),
            wheels: log.wheels.flat(),
            stamps: log.stamps.flat(),
            joints: joints.as_ref().map(Rows::flat),
            attitudes: attitudes.as_ref().map(|(numbers, width)| (numbers.flat(), *width)),
            yaw_rates: rates.as_ref().map(Rows::flat),
        };
        let rows = log.wheels.count();
        let output = |shape: &[usize]| Output::fresh(py, shape);
        let wanted = |flag: bool, shape: &[usize]| flag.then(|| output(shape)).transpose();
        let (mut poses, mut twists) = (output(&[rows, 6])?, output(&[rows, 6])?);
        let mut covariances = wanted(covariances, &[rows, 6, 6])?;
        let mut slips = wanted(slips, &[rows, count, 2])?;
        let mut flags = memory::filled(0, rows)?;
        let track = TrackRows3 {
            poses: poses.flat().as_chunks_mut().0,
            twists: twists.flat().as_chunks_mut().0,
            covariances: covariances.as_mut().map(|out| out.flat().as_chunks_mut().0),
            slips: slips.as_mut().map(|out| out.flat().as_chunks_mut().0),
            health: &mut flags,
        };
        let mut core = self.work.lock(py)?;
        let work = &mut *core;
        compute_rows(py, rows, leading, || work.run(recording, log.is_strict, track, is_interrupted))?;
        drop(core);
        let finish = |out: Option<Output<'py>>| out.map(Output::finish).transpose();
        let stamps = memory::array(py, log.stamps.flat(), &[rows])?;
        let (poses, twists, covariances) = (poses.finish()?, twists.finish()?, finish(covariances)?);
        let (suspension, slips, health) = (&self.suspension, finish(slips)?, PyArray1::from_vec(py, flags));
        let keywords = dict!(py, suspension, stamps, poses, twists, covariances, slips, health);
        build_track(&keywords, "Track3")
    }

    /// Moves the estimate towards a pose from outside, which may come late: the samples since are taken in again.
    ///
    /// Roll and pitch that an IMU measures stay as they were measured; on ground z, roll and pitch follow from where
    /// the corrected rover settles.
    #[doc = section!(Parameters)]
    /// pose : array_like, shape (6,), (4, 4) or (3,)
    ///     ``[x, y, z, roll, pitch, yaw]`` [m, rad], the matrix ``world_from_body``, or ``[x, y, yaw]`` with all else 0.
    /// stamp : float
    ///     When the rover was there [s], not before the last `lag` seconds.
    /// covariance : array_like, shape (6,), (6, 6), (3,) or (3, 3), optional
    ///     Variances or covariance of x, y, z and about the axes of the world; of x, y and yaw those of z, roll and pitch
    ///     are infinite. An infinite variance says nothing of that direction; zeros take the pose at its word.
    /// std : array_like, shape (6,) or (3,), optional
    ///     Standard deviations, in place of `covariance`.
    #[doc = raises!("If a value is not finite, the covariance is none or the stamp too old. The state is as before.")]
    fn correct[&self, py: Python<'py>](pose, stamp: f64, covariance=None, *, std=None) -> PyResult<Odometry3State> {
        let pose = self::pose("pose", pose)?;
        let matrix = self::covariance(Some(&variances(py, covariance, std)?), f64::INFINITY)?;
        self.change(py, |core| core.correct(pose, stamp, matrix))
    }

    /// Starts over: the next sample is a first one.
    #[doc = section!(Parameters)]
    /// pose : array_like, shape (6,), (4, 4) or (3,)
    ///     As for `set_pose`, default the origin.
    /// covariance : array_like, shape (6,), (6, 6), (3,) or (3, 3), optional
    ///     As for `set_pose`.
    #[doc = raises!("If a number is not finite, a shape does not fit, or a variance is negative.")]
    fn reset[&self, py: Python<'py>](pose=None, covariance=None)
    as "($self, pose=(0.0, 0.0, 0.0), covariance=None)" -> PyResult<()> {
        let pose = pose.map_or(Ok(Default::default()), |pose| self::pose("pose", pose))?;
        let matrix = self::covariance(covariance, 0.0)?;
        self.change(py, |core| core.start_over(pose, matrix)).map(drop)
    }

    /// Goes on from this pose; the readings count on from the last sample.
    #[doc = section!(Parameters)]
    /// pose : array_like, shape (6,), (4, 4) or (3,)
    ///     As for `correct`. Roll and pitch that an IMU measures are those; on ground z, roll and pitch follow from it.
    /// covariance : array_like, shape (6,), (6, 6), (3,) or (3, 3), optional
    ///     Of x, y, z and about the axes of the world, or of x, y and yaw; default 0.
    #[doc = raises!("If a number is not finite, a shape does not fit, or a variance is negative.")]
    fn set_pose[&self, py: Python<'py>](pose, covariance=None) -> PyResult<()> {
        let (pose, matrix) = (self::pose("pose", pose)?, self::covariance(covariance, 0.0)?);
        self.change(py, |core| core.set_pose(pose, matrix)).map(drop)
    }
}

#[pymethods]
impl Odometry3 {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let state = Py::new(py, self.state(py)?)?;
        Ok(crate::classes::cut(format!("Odometry3({})", state.bind(py).repr()?)))
    }
}
