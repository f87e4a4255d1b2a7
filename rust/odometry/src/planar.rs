//! Dead reckoning with covariance: the pose from the readings of the wheels, and its error.
//!
//! [`Odometry`] holds the whole state. A step is one arc ([`Twist::exp`]) with the displacement that fits the rotations
//! of all wheels best in least squares, at the steering angles of its middle. Its covariance follows from the analytic
//! derivatives of that fit (`estimate::sensitivity`).

mod correct;
mod direct;
mod update;
mod whole_logs;

use crate::health::{Health, Refusal};
use crate::history::{History, Snapshot};
use crate::motion::Motion;
use crate::propagation::covariance::Covariance3;
use crate::samples::skipped_rows::SkippedRows;
use crate::settings::{Readings, Settings};
use crate::state::{OVERHEAD, State, check_covariance, check_pose};
use crate::step::{Workspace, shared_readings};
use crate::uncertainty::Uncertainty;
use nalgebra::Matrix3;
use six_wheel_kinematics::geometry::{Pose, PoseAccumulator, Twist};
use six_wheel_kinematics::rover::{Inputs, Rover};
use six_wheel_numerics::error::{Error, HUGE, finite};
use six_wheel_numerics::simd::level::Level;

/// The sample at which the next step starts.
#[derive(Clone, Debug)]
pub struct ReferenceSample {
    /// True if there is one.
    pub(crate) known: bool,
    /// [s]
    pub(crate) stamp: f64,
    /// Readings of the wheels, in units of their encoders.
    pub(crate) wheels: Vec<f64>,
    /// Readings of the steering joints, in units of their encoders.
    pub(crate) steering: Vec<f64>,
    /// Steering angles, with whole turns [rad].
    pub(crate) angles: Vec<f64>,
    /// [rad/s]
    pub(crate) yaw_rate: Option<f64>,
}

/// Readings of a step, kept for late poses.
#[derive(Clone, Debug)]
pub(crate) struct StepReadings {
    /// Steering angles at its end [rad].
    pub(crate) angles: Vec<f64>,
    /// Rotation of every wheel [rad].
    pub(crate) turned: Vec<f64>,
    /// Absolute yaw at its end [rad].
    pub(crate) yaw: Option<f64>,
    /// Yaw increment of the gyroscope, less that by its bias [rad].
    pub(crate) gyro_turn: Option<f64>,
}

impl StepReadings {
    fn new(wheels: usize, joints: usize) -> Self {
        Self { angles: vec![0.0; joints], turned: vec![0.0; wheels], yaw: None, gyro_turn: None }
    }
}

impl Snapshot for StepReadings {
    fn copy_from(&mut self, other: &Self) {
        self.angles.copy_from_slice(&other.angles);
        self.turned.copy_from_slice(&other.turned);
        (self.yaw, self.gyro_turn) = (other.yaw, other.gyro_turn);
    }

    fn heap_size(&self) -> usize {
        size_of_val(self.angles.as_slice()) + size_of_val(self.turned.as_slice()) + 2 * OVERHEAD
    }
}

/// A pose from outside and its covariance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PoseMeasurement {
    pub(crate) pose: Pose,
    pub(crate) covariance: Matrix3<f64>,
}

/// Dead reckoning of one rover: its pose, its motion, and their covariances.
#[derive(Clone, Debug)]
pub struct Odometry {
    pub(crate) rover: Rover,
    pub(crate) settings: Settings,
    pub(crate) reference: ReferenceSample,
    pub(crate) state: State,
    pub(crate) residual: Vec<f64>,
    pub(crate) health: Health,
    pub(crate) work: Workspace,
    pub(crate) turned: Vec<f64>,
    pub(crate) angles: Vec<f64>,
    pub(crate) history: History<StepReadings, State, PoseMeasurement>,
    /// Stamp of the last command, if no sample came since.
    pub(crate) commanded: Option<f64>,
    pub(crate) skipped: SkippedRows,
}

getters! {
    Odometry:
    /// The rover.
    rover: &Rover;
    /// The settings.
    settings: &Settings;
    /// Speed at which each wheel's contact slid over the last step [m/s].
    residual: &[f64];
    /// Flags of the last sample.
    health: Health;
}

impl Odometry {
    /// At the origin, without a sample.
    pub fn new(rover: Rover, settings: Settings) -> Result<Self, Error> {
        settings.check(&rover)?;
        let from_rates = settings.readings == Readings::Speeds;
        let (wheels, joints) = (rover.wheels().len(), rover.steered().len());
        let shared = shared_readings(&rover, from_rates);
        let mut uncertainty = Uncertainty::new(shared, settings.constant_error_count());
        uncertainty.bias = settings.gyroscope.map(|known| known.at_start());
        let state =
            State { pose_sums: PoseAccumulator::new([0.0; 3]), twist: Twist::ZERO, velocity: None, uncertainty };
        let reference = ReferenceSample {
            known: false,
            stamp: 0.0,
            wheels: vec![0.0; wheels],
            steering: vec![0.0; joints],
            angles: vec![0.0; joints],
            yaw_rate: None,
        };
        Ok(Self {
            history: History::new(&settings).filled(&StepReadings::new(wheels, joints), &state),
            commanded: None,
            skipped: SkippedRows::new(wheels, joints),
            reference,
            state,
            residual: vec![0.0; wheels],
            health: Health::GOOD,
            work: Workspace::new(&rover, &settings),
            turned: vec![0.0; wheels],
            angles: vec![0.0; joints],
            rover,
            settings,
        })
    }

    /// Chooses the instructions of single samples: of a level with at most four numbers in a register, by default the best
    /// there is. The results are the same bits at each of them.
    pub fn set_level(&mut self, level: Level) {
        self.work.constants.level = level;
    }

    /// Pose of the rover.
    #[inline]
    pub fn pose(&self) -> Pose {
        self.state.pose()
    }

    /// Mean twist over the last step, in body axes [m/s, m/s, rad/s].
    #[inline]
    pub fn twist(&self) -> Twist {
        self.state.twist
    }

    /// The twist through a first-order filter with the time constant `smoothing`, which starts with the first step.
    #[inline]
    pub fn velocity(&self) -> Twist {
        self.state.velocity.unwrap_or_default()
    }

    /// Covariance of the pose in world axes, x [m], y [m], yaw [rad]: symmetric, without negative variances.
    #[inline]
    pub fn covariance(&self) -> [[f64; 3]; 3] {
        self.state.uncertainty.reported().matrix().into()
    }

    /// Covariance of the twist over the last step, in body axes. Variances are infinite if no step has been made since
    /// the first sample, a command or a pose from outside.
    #[inline]
    pub fn twist_covariance(&self) -> [[f64; 3]; 3] {
        let [_, upper] = self.upper_halves();
        Covariance3::from(upper).matrix().into()
    }

    /// The upper halves of [`Self::covariance`] and [`Self::twist_covariance`], row by row.
    #[inline]
    pub fn upper_halves(&self) -> [[f64; 6]; 2] {
        let dt = self.history.last_duration();
        let pose = self.state.uncertainty.reported();
        // Infinite where there was no step, or `1 / dt²` overflows.
        let rate = 1.0 / (dt * dt);
        let twist = if rate == f64::INFINITY {
            [f64::INFINITY, 0.0, 0.0, f64::INFINITY, 0.0, f64::INFINITY]
        } else {
            let mut total = self.work.noise.total();
            for error in &self.work.noise.constant_errors {
                total.add(&(*error).into(), 1.0);
            }
            let total = match total.may_be_negative() {
                true => total.without_negative(),
                false => total,
            };
            <[f64; 6]>::from(total).map(|value| value * rate)
        };
        [pose.into(), twist]
    }

    /// Weight of each wheel over the last step, 0 to 1.
    #[inline]
    pub fn weights(&self) -> &[f64] {
        &self.work.fit.weights
    }

    /// Time of the last sample, or end of the last command [s]; None before the first one.
    #[inline]
    pub fn stamp(&self) -> Option<f64> {
        match self.reference.known {
            true => Some(self.reference.stamp),
            false => self.commanded,
        }
    }

    /// Bias of the gyroscope and its standard deviation [rad/s]; None without one.
    pub fn gyroscope_bias(&self) -> Option<[f64; 2]> {
        let bias = self.state.uncertainty.bias?;
        Some([bias.value, bias.variance.sqrt()])
    }

    /// Sets the pose; the next step starts at the last sample.
    #[inline]
    pub fn set_pose(&mut self, pose: Pose, covariance: [[f64; 3]; 3]) -> Result<(), Error> {
        let covariance = check_covariance(covariance)?;
        finite("covariance", covariance.as_slice())?;
        check_pose(&<[f64; 3]>::from(pose))?;
        self.state.pose_sums = PoseAccumulator::new(pose.into());
        self.state.uncertainty.set(covariance);
        self.history.clear();
        Ok(())
    }

    /// Discards every reading, so that the next sample is a first one. The pose stays.
    pub fn forget(&mut self) {
        self.reference.known = false;
        self.reference.yaw_rate = None;
        self.state.twist = Twist::ZERO;
        self.state.velocity = None;
        self.state.uncertainty.release_shared_readings();
        self.residual.fill(0.0);
        self.work.fit.weights.fill(1.0);
        self.health = Health::GOOD;
        self.history.clear();
        self.commanded = None;
        self.skipped.clear();
    }

    /// Open loop: integrates a commanded twist, held constant since the last stamp. The next sample is a first one.
    pub fn command(&mut self, twist: Twist, stamp: f64) -> Result<Health, Error> {
        finite("twist", &<[f64; 3]>::from(twist))?;
        finite("stamp", &[stamp])?;
        let Some(before) = self.stamp() else {
            self.commanded = Some(stamp);
            return Ok(Health::FIRST);
        };
        let dt = stamp - before;
        Refusal::unless_later(dt, stamp, before).map_err(|refusal| refusal.error)?;
        let joints = self.rover.steered().len();
        let (mut steering, mut speeds) = (vec![0.0; joints], vec![0.0; self.rover.wheels().len()]);
        let inputs = Inputs { previous: Some(&self.reference.angles), ..Inputs::default() };
        self.rover.inverse(twist, inputs, &mut steering, &mut speeds)?;
        for speed in &mut speeds {
            *speed *= dt;
        }
        let motion = Motion {
            steering: [&steering, &steering],
            turned: &speeds,
            from_rates: false,
            dt,
            gyro_turn: None,
            bias_variance: 0.0,
        };
        self.work.advance(&self.rover, &self.settings, motion, HUGE, Some(&mut self.state), &mut [])?;
        self.state.uncertainty.release_shared_readings();
        self.residual.fill(0.0);
        self.reference.known = false;
        self.reference.angles.copy_from_slice(&steering);
        self.reference.yaw_rate = None;
        self.skipped.clear();
        self.history.clear();
        self.commanded = Some(stamp);
        self.health = Health::GAP.when(self.settings.max_gap.is_some_and(|gap| dt > gap));
        Ok(self.health)
    }
}
