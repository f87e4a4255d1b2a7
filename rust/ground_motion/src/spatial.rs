//! Dead reckoning in space: a rover on ground, its attitude from an IMU or from the ground it stands on.
//!
//! The motion of a step is that of [`crate`]: wheels on a map, or on ground without one, where the contacts follow from
//! the joint angles ([`crate::Unmapped`]). A step is one screw, `exp` of SE(3). Measured roll and pitch are used at
//! both ends as read, so their errors do not add up; the yaw comes from the wheels, a gyroscope or the yaw of the
//! attitude. On a map the rover stands where it settles: z, roll and pitch are functions of x, y and yaw.
//!
//! On flat ground, for a rover that stands level, all of it is [`six_wheel_odometry::Odometry`].

mod correct;
mod noise;
mod readings;
mod sample;
pub mod settings;
mod site;
mod spread;
mod state;
mod step;
mod whole_logs;

use std::sync::Arc;

use nalgebra::Matrix6;

pub use noise::size_of_slip;
use sample::Read;
pub use sample::{Attitude, OVERTURNED, Recording3, Sample3, attitude};
pub use settings::Settings3;
use six_wheel_numerics::error::{Error, finite, numbers};
use six_wheel_odometry::SkippedRows;
use six_wheel_odometry::health::{Health, Refusal};
use six_wheel_odometry::history::History;
use six_wheel_odometry::increments::{Counts, add_increments, check_rim_speed, check_steering_rate};
use six_wheel_odometry::state::check_pose;
use six_wheel_terrain::suspension::{Chain, MAX_STATE, MAX_WHEELS, PlanPose};
use six_wheel_terrain::terrain::Terrain;
use spread::StepNoise;
pub use state::Pose3;
use state::{Fixed, PoseMeasurement3, State, StepReadings3};
pub use whole_logs::TrackRows3;

/// Dead reckoning of one rover on ground: its pose, its motion, and their covariances.
#[derive(Clone, Debug)]
pub struct Odometry3 {
    fixed: Fixed,
    /// The sample at which the next step begins.
    reference: Option<Read>,
    state: State,
    /// Errors of the last step's displacement.
    noise: StepNoise,
    /// Slip of every wheel along its rim and to its left over the last step [m/s].
    slip: [[f64; 2]; MAX_WHEELS],
    health: Health,
    history: History<StepReadings3, State, PoseMeasurement3>,
    skipped: SkippedRows,
}

impl Odometry3 {
    /// At the origin, waiting for a first sample.
    pub fn new(chain: Chain, ground: Option<Arc<Terrain>>, settings: Settings3) -> Result<Self, Error> {
        settings.check(&chain)?;
        let (wheels, joints) = (chain.wheels().len(), chain.steering().len());
        let history = History::new(&settings.common);
        let origin = PlanPose::from([0.0; 3]);
        let reach = chain.place(origin, &[0.0; MAX_STATE], &[]).map_or(1.0, |placed| {
            let centres = (0..wheels).map(|wheel| placed.wheel(wheel).centre.norm());
            centres.fold(0.0, f64::max)
        });
        let centre_deviation = settings.centre_deviation(reach);
        let mut radii = [0.0; MAX_WHEELS];
        for (radius, wheel) in radii.iter_mut().zip(chain.wheels()) {
            *radius = wheel.radius;
        }
        Ok(Self {
            fixed: Fixed { chain, ground, settings, radii, centre_deviation },
            reference: None,
            state: State::new(Pose3::default(), Matrix6::zeros()),
            noise: StepNoise::none(),
            slip: [[0.0; 2]; MAX_WHEELS],
            health: Health::GOOD,
            history,
            skipped: SkippedRows::new(wheels, joints),
        })
    }

    /// The suspension.
    pub fn chain(&self) -> &Chain {
        &self.fixed.chain
    }

    /// Settings of the odometry.
    pub fn settings(&self) -> &Settings3 {
        &self.fixed.settings
    }

    /// Pose of the rover.
    pub fn pose(&self) -> Pose3 {
        self.state.pose()
    }

    /// Mean twist over the last step, in axes of the body: `vx, vy, vz, wx, wy, wz` [m/s, rad/s].
    pub fn twist(&self) -> [f64; 6] {
        self.state.twist
    }

    /// Covariance of the pose: x, y, z [m] and about the axes of the world [rad].
    pub fn covariance(&self) -> [[f64; 6]; 6] {
        self.state.errors.reported().into()
    }

    /// Covariance of the twist over the last step; its variances are infinite before the first step after a first
    /// sample or a pose that was set.
    pub fn twist_covariance(&self) -> [[f64; 6]; 6] {
        let rate = 1.0 / self.history.last_duration().powi(2);
        if rate == f64::INFINITY {
            return Matrix6::from_diagonal_element(f64::INFINITY).into();
        }
        let total = self.noise.total() * rate;
        ((total + total.transpose()) * 0.5).into()
    }

    /// Speed at which each wheel's contact slid over the last step, along its rim and to its left [m/s]; NaN in the
    /// air.
    pub fn slip(&self) -> &[[f64; 2]] {
        &self.slip[..self.fixed.chain.wheels().len()]
    }

    /// Health of the last sample.
    pub fn health(&self) -> Health {
        self.health
    }

    /// When the last sample was taken [s]; None before the first one.
    pub fn stamp(&self) -> Option<f64> {
        self.reference.map(|read| read.stamp)
    }

    /// Sets the pose; the next step begins at the last sample. Measured roll and pitch, and on a map z, roll and pitch
    /// of the settled pose, replace those given here. On failure nothing has changed.
    pub fn set_pose(&mut self, pose: Pose3, covariance: [[f64; 6]; 6]) -> Result<(), Error> {
        check_pose(&pose.numbers())?;
        let covariance = state::check_covariance(covariance, false)?;
        let mut state = State::new(pose, covariance);
        if let Some(read) = &self.reference {
            self.fixed.begin(&mut state, read)?;
        }
        self.state = state;
        self.history.clear();
        Ok(())
    }

    /// Resets to a pose: the next sample is a first one. On failure nothing has changed.
    pub fn start_over(&mut self, pose: Pose3, covariance: [[f64; 6]; 6]) -> Result<(), Error> {
        check_pose(&pose.numbers())?;
        let covariance = state::check_covariance(covariance, false)?;
        self.state = State::new(pose, covariance);
        self.reference = None;
        self.slip = [[0.0; 2]; MAX_WHEELS];
        self.health = Health::GOOD;
        self.history.clear();
        self.skipped.clear();
        Ok(())
    }

    /// Updates the state by a sample. On failure nothing has changed.
    pub fn update(&mut self, sample: Sample3<'_>) -> Result<Health, Error> {
        self.update_or_refuse(sample).map_err(|refusal| refusal.error)
    }

    fn update_or_refuse(&mut self, sample: Sample3<'_>) -> Result<Health, Refusal> {
        self.history.make_room(sample.stamp).map_err(|error| Refusal::new(Health::GOOD, error))?;
        self.check_numbers(&sample)?;
        let Some(before) = self.reference else {
            return self.update_first(&sample);
        };
        let dt = sample.stamp - before.stamp;
        Refusal::unless_later(dt, sample.stamp, before.stamp)?;
        let (turned, angles, wrapped) = self.difference(&sample, &before, dt);
        self.check_jump(&turned, &before.angles, &angles, dt).map_err(|error| Refusal::new(Health::JUMP, error))?;
        let after = Read::of(&sample, angles);
        let mut state = self.state;
        let taken = self.fixed.advance([&before, &after], &turned, dt, &mut state)?;
        self.state = state;
        self.noise = taken.noise;
        self.slip = taken.slid.map(|slid| slid.map(|way| way / dt));
        let is_gap = self.fixed.settings.common.max_gap.is_some_and(|gap| dt > gap);
        self.health = Health::WRAPPED.when(wrapped)
            | Health::SLIP.when(taken.slips)
            | Health::GAP.when(is_gap)
            | Health::UNSETTLED.when(!taken.settled);
        self.reference = Some(after);
        self.skipped.clear();
        let readings = StepReadings3 { read: after, turned };
        self.history.push([after.stamp, dt], &self.state, || readings, |kept| *kept = readings);
        Ok(self.health)
    }

    /// Makes a sample the reference of the next step.
    fn update_first(&mut self, sample: &Sample3<'_>) -> Result<Health, Refusal> {
        let mut angles = [0.0; MAX_WHEELS];
        self.fixed.settings.common.first_angles(sample.steering, &mut angles);
        let read = Read::of(sample, angles);
        let mut state = self.state;
        self.fixed.begin(&mut state, &read).map_err(|error| Refusal::new(Health::OFF_GROUND, error))?;
        self.state = state;
        self.reference = Some(read);
        self.health = Health::FIRST;
        Ok(Health::FIRST)
    }

    /// Fails unless all readings that are needed are finite.
    fn check_numbers(&self, sample: &Sample3<'_>) -> Result<(), Refusal> {
        let missing = |error| Refusal::new(Health::NOT_FINITE, error);
        finite("steering", sample.steering).map_err(missing)?;
        if sample.wheels.iter().any(|reading| reading.is_infinite()) {
            let error =
                Error::value("wheel_angles", "be finite, or NaN where a wheel has no encoder", numbers(sample.wheels));
            return Err(missing(error));
        }
        if sample.wheels.iter().all(|reading| reading.is_nan()) {
            let error = Error::value("wheel_angles", "be finite", numbers(sample.wheels));
            return Err(missing(error));
        }
        finite("stamp", &[sample.stamp]).map_err(missing)?;
        finite("yaw_rate", &[sample.yaw_rate.unwrap_or(0.0)]).map_err(missing)?;
        if let Some(attitude) = &sample.attitude {
            attitude.check_upright().map_err(|error| Refusal::new(Health::OVERTURNED, error))?;
        }
        let joints = sample.joints.unwrap_or(&[]);
        if joints.iter().any(|angle| angle.is_infinite()) {
            return Err(missing(Error::value("joints", "be finite", numbers(joints))));
        }
        if self.fixed.ground.is_some() {
            return Ok(());
        }
        if sample.attitude.is_none() {
            let rule = "be given where there is no ground to stand on (ground=)";
            return Err(missing(Error::value("attitude", rule, "None")));
        }
        let free = self.fixed.chain.joints().len();
        if free > 0 && sample.joints.is_none() {
            let rule = format!("hold {free} angles where there is no ground to stand on (ground=)");
            return Err(missing(Error::value("joints", rule, "None")));
        }
        finite("joints", joints).map_err(missing)
    }

    /// Rotations of the wheels since the reference, and angles of the steering joints [rad]; true if a counter was
    /// reset.
    fn difference(&self, sample: &Sample3<'_>, before: &Read, dt: f64) -> ([f64; MAX_WHEELS], [f64; MAX_WHEELS], bool) {
        let settings = &self.fixed.settings.common;
        let (mut turned, mut angles) = ([0.0; MAX_WHEELS], before.angles);
        let before = Counts {
            wheels: &before.wheels[..sample.wheels.len()],
            steering: &before.steering[..sample.steering.len()],
        };
        let after = Counts { wheels: sample.wheels, steering: sample.steering };
        let wrapped = add_increments(settings, &self.skipped, [before, after], dt, &mut turned, &mut angles);
        (turned, angles, wrapped)
    }

    /// Fails if the readings mean a motion faster than the rover's limits.
    fn check_jump(
        &self,
        turned: &[f64; MAX_WHEELS],
        before: &[f64; MAX_WHEELS],
        angles: &[f64; MAX_WHEELS],
        dt: f64,
    ) -> Result<(), Error> {
        let Fixed { chain, settings, .. } = &self.fixed;
        let wheels = chain.wheels().iter().zip(turned).map(|(mount, turned)| (&*mount.name, mount.radius, *turned));
        check_rim_speed(&settings.common, &self.skipped, dt, wheels)?;
        let joints = (0..chain.steering().len()).map(|k| (chain.steered_name(k), before[k], angles[k]));
        check_steering_rate(&settings.common, dt, joints)
    }
}
