//! The error of a pose in space: axes of the world, at the place where the body is.
//!
//! As in the plane (`odometry::uncertainty`) readings at the end of one step are those at the start of the next, so their errors
//! are kept in columns of their own until both steps are done.

use nalgebra::{Matrix6, UnitQuaternion, Vector3, Vector6};

use six_wheel_odometry::pose_gain::PoseGain;
use six_wheel_odometry::preintegrated::space::{Motion3, left_jacobian};
use six_wheel_terrain::suspension::{MAX_FREE, MAX_WHEELS};

/// Columns of readings that two steps share: steering, wheels that report rates, free angles, tilt, the gyroscope.
pub(crate) const STEERING: usize = 0;
pub(crate) const RATES: usize = STEERING + MAX_WHEELS;
pub(crate) const JOINTS: usize = RATES + MAX_WHEELS;
pub(crate) const TILT: usize = JOINTS + MAX_FREE;
pub(crate) const GYROSCOPE: usize = TILT + 2;
pub(crate) const SHARED: usize = GYROSCOPE + 1;

/// A pose's rounding, as a share of its variance: added to every diagonal, so that no direction's variance is
/// negative.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Columns times their standard deviations.
pub(crate) type Columns = [Vector6<f64>; SHARED];

/// Error of one displacement in axes of the body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepNoise {
    /// Covariance of all that errs in this step alone.
    pub own: Matrix6<f64>,
    /// Per shared reading: its error at the start of the step.
    pub old: Columns,
    /// The same at the end.
    pub new: Columns,
}

impl StepNoise {
    pub const fn none() -> Self {
        Self {
            own: zero(),
            old: [Vector6::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0); SHARED],
            new: [Vector6::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0); SHARED],
        }
    }

    /// Covariance of the displacement, as if the readings at both ends erred on their own.
    pub fn total(&self) -> Matrix6<f64> {
        let ends = self.old.iter().chain(&self.new);
        ends.filter(|column| **column != Vector6::zeros())
            .fold(self.own, |total, column| total + column * column.transpose())
    }
}

const fn zero() -> Matrix6<f64> {
    Matrix6::new(
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    )
}

/// Error of a pose: x, y, z [m], and about the axes of the world [rad].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Errors {
    pub settled: Matrix6<f64>,
    pub carried: Columns,
}

/// Derivatives of the end of a step by its start and by its displacement.
struct StepJacobian3 {
    shift: Vector3<f64>,
    by_displacement: Matrix6<f64>,
}

impl StepJacobian3 {
    /// A step of this tangent from a start with this rotation.
    fn new(start: &UnitQuaternion<f64>, tangent: &Vector6<f64>) -> Self {
        let body = Motion3::exp(tangent).translation;
        let jacobian = left_jacobian(tangent);
        let turn = *start.to_rotation_matrix().matrix();
        let mut by_displacement = Matrix6::zeros();
        for k in 0..6 {
            let (shift, about) = parts(&jacobian.column(k).into_owned());
            // Seen from the end: what turns at the start swings it.
            let end = turn * (shift + about.cross(&body));
            by_displacement.set_column(k, &whole(&end, &(turn * about)));
        }
        Self { shift: turn * body, by_displacement }
    }

    /// Error at the end that an error of the start causes.
    fn carry(&self, error: &Vector6<f64>) -> Vector6<f64> {
        let (shift, about) = parts(error);
        whole(&(shift + about.cross(&self.shift)), &about)
    }
}

fn parts(error: &Vector6<f64>) -> (Vector3<f64>, Vector3<f64>) {
    (Vector3::new(error[0], error[1], error[2]), Vector3::new(error[3], error[4], error[5]))
}

pub(crate) fn whole(shift: &Vector3<f64>, about: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(shift.x, shift.y, shift.z, about.x, about.y, about.z)
}

impl Errors {
    pub fn none() -> Self {
        Self { settled: Matrix6::zeros(), carried: [Vector6::zeros(); SHARED] }
    }

    /// Covariance of the pose.
    pub fn covariance(&self) -> Matrix6<f64> {
        let mut covariance = self.settled;
        for column in self.carried.iter().filter(|column| **column != Vector6::zeros()) {
            covariance += column * column.transpose();
        }
        covariance
    }

    /// The same, symmetric and without a negative variance in any direction, rounding or not.
    pub fn reported(&self) -> Matrix6<f64> {
        let covariance = self.covariance();
        let mut covariance = (covariance + covariance.transpose()) * 0.5;
        for block in [0, 3] {
            let trace: f64 = (block..block + 3).map(|k| covariance[(k, k)]).sum();
            for k in block..block + 3 {
                covariance[(k, k)] += ROUNDING * trace;
            }
        }
        covariance
    }

    /// Goes along one step.
    pub fn propagate(&mut self, start: &UnitQuaternion<f64>, tangent: &Vector6<f64>, noise: &StepNoise) {
        let step = StepJacobian3::new(start, tangent);
        let mut by_start = Matrix6::identity();
        let swing = -step.shift.cross_matrix();
        by_start.fixed_view_mut::<3, 3>(0, 3).copy_from(&swing);
        let by = &step.by_displacement;
        self.settled = by_start * self.settled * by_start.transpose() + by * noise.own * by.transpose();
        let zero = Vector6::zeros();
        for (carried, (old, new)) in self.carried.iter_mut().zip(noise.old.iter().zip(&noise.new)) {
            if *carried != zero || *old != zero {
                let all = step.carry(carried) + by * old;
                self.settled += all * all.transpose();
            }
            *carried = if *new == zero { zero } else { by * new };
        }
    }

    /// Every error through the same matrix.
    pub fn map(&mut self, by: &Matrix6<f64>) {
        self.settled = by * self.settled * by.transpose();
        for column in &mut self.carried {
            *column = by * *column;
        }
    }

    /// A pose from outside with this covariance, infinite where it says nothing: by how much its innovation moves
    /// the pose. `by_error` is the derivative of the measurement by an error, `keeps` projects to what may be moved.
    pub fn correct(&mut self, measured: &Matrix6<f64>, by_error: &Matrix6<f64>, keeps: &Matrix6<f64>) -> Matrix6<f64> {
        let PoseGain { gain, by_error, noise } = PoseGain::new(&self.covariance(), by_error, measured);
        let gain = keeps * gain;
        self.map(&(Matrix6::identity() - gain * by_error));
        self.settled += gain * noise * gain.transpose();
        gain
    }
}
