//! Pose, motion and their uncertainty in space, one step at a time.

use std::sync::Arc;

use nalgebra::{Matrix6, RowVector6, UnitQuaternion, Vector3, Vector6};

use super::readings::StepReadings;
use super::sample::{Read, tilting_axes};
use super::settings::Settings3;
use super::site::{ContactSource, Place};
use super::spread::{Errors, StepNoise, TILT};
use super::step::{displace, half_displacement, middle_angles};
use six_wheel_kinematics::geometry::{PoseAccumulator, Sum, wrap_angle};
use six_wheel_numerics::error::{Error, ErrorKind, HUGE, number, numbers};
use six_wheel_odometry::health::{Health, Refusal};
use six_wheel_odometry::history::Snapshot;
use six_wheel_odometry::preintegrated::space::{Motion3, stack};
use six_wheel_odometry::state::read_variance;
use six_wheel_terrain::ground::Status;
use six_wheel_terrain::suspension::{Chain, MAX_WHEELS, PlanPose};
use six_wheel_terrain::terrain::Terrain;

/// A pose in space: `Rz(yaw) Ry(pitch) Rx(roll)` at x, y, z.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose3 {
    /// Position of the body's origin [m].
    pub x: f64,
    /// Position of the body's origin [m].
    pub y: f64,
    /// Position of the body's origin [m].
    pub z: f64,
    /// Positive with the right side down [rad].
    pub roll: f64,
    /// Positive with the nose down [rad].
    pub pitch: f64,
    /// Accumulated over whole turns [rad].
    pub yaw: f64,
}

impl From<[f64; 6]> for Pose3 {
    fn from([x, y, z, roll, pitch, yaw]: [f64; 6]) -> Self {
        Self { x, y, z, roll, pitch, yaw }
    }
}

impl Pose3 {
    /// x, y, z [m], roll, pitch, yaw [rad].
    pub fn numbers(&self) -> [f64; 6] {
        [self.x, self.y, self.z, self.roll, self.pitch, self.yaw]
    }

    /// `world_from_body`
    pub fn motion(&self) -> Motion3 {
        Motion3 {
            rotation: UnitQuaternion::from_euler_angles(self.roll, self.pitch, self.yaw),
            translation: Vector3::new(self.x, self.y, self.z),
        }
    }

    /// From a motion `world_from_body`, with a yaw within half a turn of 0.
    pub fn of(motion: &Motion3) -> Self {
        let (roll, pitch, yaw) = motion.rotation.euler_angles();
        let place = motion.translation;
        Self { x: place.x, y: place.y, z: place.z, roll, pitch, yaw }
    }
}

/// Constants of an odometry.
#[derive(Clone, Debug)]
pub(crate) struct Fixed {
    pub chain: Chain,
    pub ground: Option<Arc<Terrain>>,
    pub settings: Settings3,
    pub radii: [f64; MAX_WHEELS],
    /// Standard deviation of the distance that a wheel's centre moves across the ground over one step [m].
    pub centre_deviation: f64,
}

/// State after a sample, of which the history keeps copies for late poses.
#[derive(Clone, Copy, Debug)]
pub(crate) struct State {
    pub pose_sums: PoseAccumulator,
    /// Height [m].
    pub z: Sum,
    /// Roll and pitch [rad].
    pub roll: f64,
    pub pitch: f64,
    /// Mean twist over the last step [m/s, rad/s].
    pub twist: [f64; 6],
    pub errors: Errors,
    /// Climb of every wheel against the plane of all, as a sine; 0 on a map.
    slopes: [f64; MAX_WHEELS],
    /// Settled pose on the map, if there is one.
    place: Option<Place>,
}

/// Readings of a step, kept for late poses.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepReadings3 {
    /// At its end.
    pub read: Read,
    /// Rotation of every wheel [rad].
    pub turned: [f64; MAX_WHEELS],
}

/// A pose from outside and its covariance, in axes of the world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PoseMeasurement3 {
    pub pose: Motion3,
    pub covariance: Matrix6<f64>,
}

impl Snapshot for StepReadings3 {
    fn copy_from(&mut self, other: &Self) {
        *self = *other;
    }
}

impl Snapshot for State {
    fn copy_from(&mut self, other: &Self) {
        *self = *other;
    }
}

/// Result of a step.
pub(crate) struct StepResult {
    pub noise: StepNoise,
    /// Distance that every contact slid along its rim and to the left [m].
    pub slid: [[f64; 2]; MAX_WHEELS],
    pub slips: bool,
    /// False if there is a map and the rover has not settled on it.
    pub settled: bool,
}

impl State {
    pub fn new(pose: Pose3, covariance: Matrix6<f64>) -> Self {
        let mut errors = Errors::none();
        errors.settled = covariance;
        Self {
            pose_sums: PoseAccumulator::new([pose.x, pose.y, pose.yaw]),
            z: Sum::new(pose.z),
            roll: pose.roll,
            pitch: pose.pitch,
            twist: [0.0; 6],
            errors,
            slopes: [0.0; MAX_WHEELS],
            place: None,
        }
    }

    pub fn pose(&self) -> Pose3 {
        Pose3 {
            x: self.pose_sums.x.value(),
            y: self.pose_sums.y.value(),
            z: self.z.value(),
            roll: self.roll,
            pitch: self.pitch,
            yaw: self.pose_sums.yaw.value(),
        }
    }

    fn plan(&self) -> PlanPose {
        PlanPose { x: self.pose_sums.x.value(), y: self.pose_sums.y.value(), yaw: self.pose_sums.heading.value() }
    }

    pub fn rotation(&self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_euler_angles(self.roll, self.pitch, self.pose_sums.heading.value())
    }

    /// Derivative of the yaw by an error of the pose.
    pub fn yaw_row(&self) -> RowVector6<f64> {
        let (sin, cos) = self.pose_sums.heading.value().sin_cos();
        let slope = self.pitch.tan();
        RowVector6::new(0.0, 0.0, 0.0, slope * cos, slope * sin, 1.0)
    }

    /// Projection of an error that keeps position and yaw and removes the tilt.
    pub fn tilt_free_projection(&self) -> Matrix6<f64> {
        let mut keeps = Matrix6::from_partial_diagonal(&[1.0; 3]);
        keeps.set_row(5, &self.yaw_row());
        keeps
    }

    /// Adds an error in axes of the world to position and yaw; roll and pitch stay, which are measured or follow from
    /// the map.
    pub fn shift(&mut self, by: &Vector6<f64>) {
        let turn = (self.yaw_row() * by)[0];
        self.pose_sums.shift(by[0], by[1]);
        self.z.add(by[2]);
        self.pose_sums.turn(turn);
    }

    /// Sets roll, pitch and yaw to those of a rotation, the yaw by the shorter way round.
    fn set_rotation(&mut self, rotation: &UnitQuaternion<f64>) {
        let (roll, pitch, yaw) = rotation.euler_angles();
        (self.roll, self.pitch) = (roll, pitch);
        self.pose_sums.turn(wrap_angle(yaw - self.pose_sums.heading.value()));
    }
}

impl Fixed {
    /// Sets tilt and height of a pose by its first readings and the map.
    pub fn begin(&self, state: &mut State, read: &Read) -> Result<(), Error> {
        self.measure_tilt(state, read);
        let Some(ground) = &self.ground else {
            return Ok(());
        };
        match self.stand(state, read, ground) {
            Ok(()) => Ok(()),
            // Off the map the measured tilt and joint angles are used.
            Err(_) if self.has_tilt_and_joints(read) => Ok(()),
            Err(status) => {
                let PlanPose { x, y, .. } = state.plan();
                let value = format!("{} at x {}, y {}", status.name(), number(x), number(y));
                Err(Error::value("pose", "be one at which the rover stands on the ground", value))
            }
        }
    }

    /// True if attitude and joints are measured, so that they give the contacts without a map.
    fn has_tilt_and_joints(&self, read: &Read) -> bool {
        let joints = &read.joints[..self.chain.joints().len()];
        read.attitude.is_some() && joints.iter().all(|joint| !joint.is_nan())
    }

    /// Replaces roll and pitch, and their errors, by those of the measured attitude.
    pub fn measure_tilt(&self, state: &mut State, read: &Read) {
        let Some(attitude) = read.attitude else {
            return;
        };
        state.errors.map(&state.tilt_free_projection());
        (state.roll, state.pitch) = (attitude.roll, attitude.pitch);
        let axes = tilting_axes(state.pose_sums.heading.value(), state.pitch);
        for (k, axis) in axes.into_iter().enumerate() {
            let about = axis * self.settings.attitude_noise;
            state.errors.carried[TILT + k] += stack(&Vector3::zeros(), &about);
        }
    }

    /// Settles a pose on the map: its height follows, and its tilt unless that was measured.
    pub fn stand(&self, state: &mut State, read: &Read, ground: &Terrain) -> Result<(), Status> {
        state.place = None;
        let place = Place::find(&self.chain, ground, state.plan(), &read.angles)?;
        let slopes = place.slopes(&self.chain);
        let [z, roll, pitch, ..] = place.stand.state;
        state.z = Sum::new(z);
        if read.attitude.is_none() {
            (state.roll, state.pitch) = (roll, pitch);
        }
        if let Some(slopes) = slopes {
            let yaw = state.yaw_row();
            let mut rows = [RowVector6::zeros(), RowVector6::zeros(), yaw];
            rows[0][0] = 1.0;
            rows[1][1] = 1.0;
            let mut keeps = Matrix6::identity();
            keeps.row_mut(2).fill(0.0);
            if read.attitude.is_none() {
                keeps.fixed_view_mut::<3, 3>(3, 3).fill(0.0);
            }
            for ((height, about), row) in slopes.iter().zip(&rows) {
                let about = match read.attitude {
                    None => *about,
                    Some(_) => Vector3::zeros(),
                };
                keeps += stack(&Vector3::new(0.0, 0.0, *height), &about) * row;
            }
            state.errors.map(&keeps);
        }
        state.place = Some(place);
        Ok(())
    }

    /// One step of the state; after a failure the state is undefined.
    pub fn advance(
        &self,
        [before, after]: [&Read; 2],
        turned: &[f64; MAX_WHEELS],
        dt: f64,
        state: &mut State,
    ) -> Result<StepResult, Refusal> {
        let slopes = state.slopes;
        let readings = StepReadings {
            chain: &self.chain,
            settings: &self.settings,
            radii: &self.radii,
            centre_deviation: self.centre_deviation,
            slopes: &slopes,
            before,
            after,
            turned,
            dt,
        };
        let start = state.rotation();
        let place = match &self.ground {
            None => None,
            Some(ground) => match self.middle(state, &readings, ground) {
                Ok(place) => Some(place),
                Err(_) if self.has_tilt_and_joints(before) && self.has_tilt_and_joints(after) => None,
                Err(status) => return Err(off_ground(state, status)),
            },
        };
        let site = place.as_ref().map_or(ContactSource::Unmapped, ContactSource::Ground);
        let step = displace(&readings, &site).map_err(|error| {
            let flag = match error.kind {
                ErrorKind::Underdetermined => Health::UNDETERMINED,
                _ => Health::NOT_FINITE,
            };
            Refusal::new(flag, error)
        })?;
        state.errors.propagate(&start, &step.tangent, &step.noise);
        let moved = Motion3::exp(&step.tangent);
        let shift = start * moved.translation;
        state.pose_sums.shift(shift.x, shift.y);
        state.z.add(shift.z);
        match (step.yaw, after.attitude) {
            (Some(yaw), Some(attitude)) => {
                state.pose_sums.turn(yaw);
                (state.roll, state.pitch) = (attitude.roll, attitude.pitch);
            }
            _ => {
                state.set_rotation(&(start * moved.rotation));
                self.measure_tilt(state, after);
            }
        }
        state.twist = (step.tangent / dt).into();
        state.slopes = step.slopes;
        let settled = match &self.ground {
            None => true,
            Some(ground) => self.stand(state, after, ground).is_ok() && place.is_some(),
        };
        Ok(StepResult { noise: step.noise, slid: step.slid, slips: step.slips, settled })
    }

    /// Settled pose in the middle of a step.
    fn middle(&self, state: &State, readings: &StepReadings<'_>, ground: &Terrain) -> Result<Place, Status> {
        let as_before = || Vector6::from(state.twist) * (readings.dt * 0.5);
        let ahead = state.place.as_ref().and_then(|place| half_displacement(readings, place));
        let half = Motion3::exp(&ahead.unwrap_or_else(as_before));
        let start = state.rotation();
        let shift = start * half.translation;
        let (_, _, yaw) = (start * half.rotation).euler_angles();
        let plan = state.plan();
        let pose = PlanPose { x: plan.x + shift.x, y: plan.y + shift.y, yaw };
        Place::find(&self.chain, ground, pose, &middle_angles(readings))
    }
}

fn off_ground(state: &State, status: Status) -> Refusal {
    let PlanPose { x, y, .. } = state.plan();
    let value = format!("{} near x {}, y {}", status.name(), number(x), number(y));
    let rule = "hold the rover, or attitude and joints come with every sample";
    Refusal::new(Health::OFF_GROUND, Error::value("ground", rule, value))
}

/// Fails unless a covariance is symmetric without negative variances. Infinite variances, where allowed, are those of
/// directions that were not measured.
pub(crate) fn check_covariance(covariance: [[f64; 6]; 6], may_be_infinite: bool) -> Result<Matrix6<f64>, Error> {
    let mut matrix = Matrix6::from(covariance);
    for k in 0..6 {
        matrix[(k, k)] = read_variance(matrix[(k, k)]);
    }
    let refused = |rule| Err(Error::value("covariance", rule, numbers(matrix.as_slice())));
    let open = |k: usize| may_be_infinite && matrix[(k, k)] == f64::INFINITY;
    for i in 0..6 {
        for k in 0..6 {
            let value = matrix[(i, k)];
            if !(value.abs() < HUGE || i == k && open(i)) || i == k && value < 0.0 {
                return refused("hold variances on its diagonal and finite covariances beside it");
            }
        }
    }
    let known = Matrix6::from_fn(|i, k| if open(i) || open(k) { 0.0 } else { matrix[(i, k)] });
    let size = |i: usize, k: usize| (known[(i, i)] * known[(k, k)]).sqrt();
    for i in 0..6 {
        for k in 0..i {
            if (known[(i, k)] - known[(k, i)]).abs() > 1e-9 * size(i, k) {
                return refused("be symmetric");
            }
        }
    }
    let symmetric = (known + known.transpose()) * 0.5;
    if symmetric.symmetric_eigenvalues().min() < -1e-9 * symmetric.trace() {
        return refused("have no negative variance in any direction");
    }
    Ok((matrix + matrix.transpose()) * 0.5)
}
