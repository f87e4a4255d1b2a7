//! Pose, motion and their uncertainty.

use nalgebra::{Matrix3, Vector3};

use super::history::Snapshot;
use super::uncertainty::Uncertainty;
use six_wheel_kinematics::geometry::{Pose, PoseAccumulator, Twist, wrap_angle};
use six_wheel_numerics::error::{Error, HUGE, finite, numbers};

/// State that changes from sample to sample and is restored when a late pose comes.
#[derive(Clone, Debug)]
pub(crate) struct State {
    /// Pose in world axes [m, m, rad].
    pub pose_sums: PoseAccumulator,
    /// Mean twist over the last step, in body axes [m/s, m/s, rad/s].
    pub twist: Twist,
    /// The twist through a first-order filter; None before the first step.
    pub velocity: Option<Twist>,
    pub uncertainty: Uncertainty,
}

/// Largest overhead of the allocator for a piece of memory [bytes].
pub(crate) const OVERHEAD: usize = 32;

impl Snapshot for State {
    #[inline]
    fn copy_from(&mut self, other: &Self) {
        self.pose_sums = other.pose_sums;
        self.twist = other.twist;
        self.velocity = other.velocity;
        self.uncertainty.copy_from(&other.uncertainty);
    }

    fn heap_size(&self) -> usize {
        let Uncertainty { carried, constant_errors, .. } = &self.uncertainty;
        size_of_val(carried.as_slice()) + size_of_val(constant_errors.as_slice()) + 2 * OVERHEAD
    }
}

impl State {
    #[inline]
    pub fn pose(&self) -> Pose {
        Pose { x: self.pose_sums.x.value(), y: self.pose_sums.y.value(), yaw: self.pose_sums.yaw.value() }
    }

    /// Adds the displacement of a step in world axes.
    #[inline(always)]
    pub fn add_displacement(&mut self, shift: [f64; 2], turn: f64) {
        self.pose_sums.shift(shift[0], shift[1]);
        self.pose_sums.turn(turn);
    }

    /// Sets the mean twist over a step, and updates its first-order filter with the time constant `smoothing` [s].
    #[inline(always)]
    pub fn hold_twist(&mut self, twist: Twist, dt: f64, smoothing: f64) {
        self.twist = twist;
        self.velocity = Some(match self.velocity.filter(|_| smoothing > 0.0) {
            None => twist,
            Some(before) => {
                let share = -(-dt / smoothing).exp_m1();
                Twist {
                    vx: before.vx + share * (twist.vx - before.vx),
                    vy: before.vy + share * (twist.vy - before.vy),
                    omega: before.omega + share * (twist.omega - before.omega),
                }
            }
        });
    }

    /// Corrects the pose by an absolute yaw with this deviation [rad]; the first one sets the zero of the sensor.
    pub fn correct_yaw(&mut self, yaw: f64, deviation: f64) {
        let (predicted, variance) = (self.pose_sums.yaw.value(), deviation * deviation);
        match self.uncertainty.yaw_offset {
            None => self.uncertainty.set_yaw_offset(yaw - predicted, variance),
            Some(offset) => {
                let gain = self.uncertainty.correct_yaw(offset, variance);
                self.shift(&(gain * wrap_angle(yaw - predicted - offset.value)));
            }
        }
    }

    /// Adds a correction to the pose.
    #[inline]
    pub fn shift(&mut self, by: &Vector3<f64>) {
        self.pose_sums.shift(by.x, by.y);
        self.pose_sums.turn(by.z);
    }
}

/// Fails unless every part of a pose is finite and below [`HUGE`] in magnitude, so that sums of squares are finite.
pub fn check_pose(pose: &[f64]) -> Result<(), Error> {
    finite("pose", pose)?;
    if pose.iter().all(|part| part.abs() < HUGE) {
        return Ok(());
    }
    Err(Error::value("pose", format!("be smaller than {HUGE:e} in every part"), numbers(pose)))
}

/// A variance from outside; those from [`HUGE`] on count as infinite: unknown.
#[inline]
pub fn read_variance(value: f64) -> f64 {
    if value < HUGE { value } else { value * f64::INFINITY }
}

/// Fails unless a covariance is symmetric and has no negative variance; infinite variances are those of unknown
/// components.
pub(crate) fn check_covariance(covariance: [[f64; 3]; 3]) -> Result<Matrix3<f64>, Error> {
    let mut matrix = Matrix3::from(covariance);
    for k in 0..3 {
        matrix[(k, k)] = read_variance(matrix[(k, k)]);
    }
    let refused = |rule| Err(Error::value("covariance", rule, numbers(matrix.as_slice())));
    let finite = matrix.map(|value| if value.is_finite() { value } else { 0.0 });
    let diagonal = matrix.diagonal();
    if matrix.iter().any(|value| value.is_nan())
        || matrix.iter().enumerate().any(|(k, value)| k % 4 != 0 && value.abs() >= HUGE)
        || diagonal.iter().any(|value| *value < 0.0)
    {
        return refused("hold variances on its diagonal and finite covariances beside it");
    }
    let scale = |i: usize, k: usize| (finite[(i, i)] * finite[(k, k)]).sqrt();
    for (i, k) in [(0, 1), (0, 2), (1, 2)] {
        let known = diagonal[i].is_finite() && diagonal[k].is_finite();
        if (finite[(i, k)] - finite[(k, i)]).abs() > 1e-9 * scale(i, k) {
            return refused("be symmetric");
        }
        if known && finite[(i, k)].abs() > scale(i, k) * (1.0 + 1e-9) {
            return refused("have no negative variance in any direction");
        }
    }
    let symmetric = (finite + finite.transpose()) / 2.0;
    if symmetric.symmetric_eigenvalues().min() < -1e-9 * symmetric.trace() {
        return refused("have no negative variance in any direction");
    }
    Ok((matrix + matrix.transpose()) / 2.0)
}
