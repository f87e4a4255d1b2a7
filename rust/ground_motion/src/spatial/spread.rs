//! The error of a pose in space: its covariance in axes of the world, rotations about the body's origin.
//!
//! As in the plane (`odometry::uncertainty`) readings at the end of one step are those at the start of the next, so their errors
//! are kept in columns of their own until both steps are done.

use nalgebra::{Matrix6, UnitQuaternion, Vector3, Vector6};

use six_wheel_odometry::pose_gain::PoseGain;
use six_wheel_odometry::preintegrated::space::{Motion3, left_jacobian, split, stack};
use six_wheel_terrain::suspension::{MAX_FREE, MAX_WHEELS};

/// Columns of the readings that two steps share: steering, wheels that report rates, free angles, tilt, the gyroscope.
pub(crate) const STEERING: usize = 0;
pub(crate) const RATES: usize = STEERING + MAX_WHEELS;
pub(crate) const JOINTS: usize = RATES + MAX_WHEELS;
pub(crate) const TILT: usize = JOINTS + MAX_FREE;
pub(crate) const GYROSCOPE: usize = TILT + 2;
pub(crate) const SHARED: usize = GYROSCOPE + 1;

/// Rounding of a covariance, as a share of its trace: added to the diagonal, so that the variance of no direction is
/// negative.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Derivatives of a pose by the shared readings, each times the reading's standard deviation.
pub(crate) type Columns = [Vector6<f64>; SHARED];

/// Error of one displacement in axes of the body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepNoise {
    /// Covariance of the errors that occur in this step alone.
    pub own: Matrix6<f64>,
    /// Errors by the shared readings at the start of the step.
    pub old: Columns,
    /// Errors by the shared readings at the end of the step.
    pub new: Columns,
}

impl StepNoise {
    pub fn none() -> Self {
        Self { own: Matrix6::zeros(), old: [Vector6::zeros(); SHARED], new: [Vector6::zeros(); SHARED] }
    }

    /// Covariance of the displacement, the errors of readings at both ends independent.
    pub fn total(&self) -> Matrix6<f64> {
        let ends = self.old.iter().chain(&self.new);
        ends.filter(|column| **column != Vector6::zeros())
            .fold(self.own, |total, column| total + column * column.transpose())
    }
}

/// Error of a pose: x, y, z [m], and about the axes of the world [rad].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Errors {
    /// Covariance by the readings whose steps are all done.
    pub settled: Matrix6<f64>,
    /// Errors by the last readings, which the next step shares.
    pub carried: Columns,
}

/// Derivatives of the end of a step by its start and by its displacement.
struct StepJacobian3 {
    /// Translation of the step in axes of the world [m].
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
            let (shift, about) = split(&jacobian.column(k).into_owned());
            // A rotation about the start moves the end.
            let end = turn * (shift + about.cross(&body));
            by_displacement.set_column(k, &stack(&end, &(turn * about)));
        }
        Self { shift: turn * body, by_displacement }
    }

    /// Error of the end by an error of the start.
    fn propagate(&self, error: &Vector6<f64>) -> Vector6<f64> {
        let (shift, about) = split(error);
        stack(&(shift + about.cross(&self.shift)), &about)
    }
}

/// The derivative of the end of a step by its start, from its translation in axes of the world [m].
pub(crate) fn by_start(shift: &Vector3<f64>) -> Matrix6<f64> {
    let mut by_start = Matrix6::identity();
    by_start.fixed_view_mut::<3, 3>(0, 3).copy_from(&-shift.cross_matrix());
    by_start
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

    /// Covariance of the pose, symmetric, and positive semidefinite in spite of rounding.
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

    /// Propagates the error through one step.
    pub fn propagate(&mut self, start: &UnitQuaternion<f64>, tangent: &Vector6<f64>, noise: &StepNoise) {
        let step = StepJacobian3::new(start, tangent);
        let (by_start, by) = (by_start(&step.shift), &step.by_displacement);
        self.settled = by_start * self.settled * by_start.transpose() + by * noise.own * by.transpose();
        let zero = Vector6::zeros();
        for (carried, (old, new)) in self.carried.iter_mut().zip(noise.old.iter().zip(&noise.new)) {
            if *carried != zero || *old != zero {
                let all = step.propagate(carried) + by * old;
                self.settled += all * all.transpose();
            }
            *carried = if *new == zero { zero } else { by * new };
        }
    }

    /// Multiplies every error by this matrix.
    pub fn map(&mut self, by: &Matrix6<f64>) {
        self.settled = by * self.settled * by.transpose();
        for column in &mut self.carried {
            *column = by * *column;
        }
    }

    /// Updates the covariance by a measured pose with this covariance, infinite variances for what was not measured.
    /// Returns the gain. `by_error` is the derivative of the measurement by an error of the pose; `keeps` projects the
    /// gain onto the components that may change.
    pub fn correct(&mut self, measured: &Matrix6<f64>, by_error: &Matrix6<f64>, keeps: &Matrix6<f64>) -> Matrix6<f64> {
        let PoseGain { gain, by_error, noise } = PoseGain::new(&self.covariance(), by_error, measured);
        let gain = keeps * gain;
        self.map(&(Matrix6::identity() - gain * by_error));
        self.settled += gain * noise * gain.transpose();
        gain
    }
}
