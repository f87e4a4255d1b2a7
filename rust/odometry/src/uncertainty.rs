//! The error of a pose: its growth along a step, and its decrease by other measurements.
//!
//! A reading of a steering angle is the end of one step and the start of the next: its error enters both. So the
//! covariance of the pose has two parts: `settled`, and for every such reading a column `carried`, the error of the
//! pose by the deviation of the last reading. Steps are then independent of each other and the covariance is exact to
//! first order:
//!
//! ```text
//! P = settled + Σ carried carriedᵀ
//! settled' = F settled Fᵀ + L Q Lᵀ + Σ (F carried + L old) (F carried + L old)ᵀ
//! carried' = L new
//! ```
//!
//! with F and L the derivatives of the end of the step by its start and by the displacement, Q the covariance of the
//! displacement by errors of the step alone, `old` and `new` its errors by the readings at start and end. The error of
//! a dimension enters every step: it has a column too, which is never settled (`constant_errors`).

mod correction;

use std::ops::{Add, Mul, Sub};

use nalgebra::{Matrix3, Vector3};
use pulp::Scalar;

use crate::propagation::arc::propagate_error;
use crate::propagation::covariance::{Covariance3, lane, numbers};
use crate::propagation::fusion::bias_covariance_increment;
use six_wheel_numerics::simd::lanes::Lanes;

/// Rounding of a covariance, as a share of its trace: added to every diagonal entry, so that no direction has a
/// negative variance.
pub(crate) const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Columns of joints are padded to multiples of this: whole registers on every level of the kernel of one step.
pub(crate) const COLUMNS: usize = 4;

/// The covariance plus `rounding` ([`ROUNDING`] in the lanes) times its trace on the diagonal.
#[inline(always)]
pub(crate) fn rounded<T>(mut covariance: Covariance3<T>, rounding: T) -> Covariance3<T>
where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T>,
{
    covariance.add_to_diagonal(rounding * covariance.trace());
    covariance
}

/// Errors of one displacement in body axes.
#[derive(Clone, Debug)]
pub(crate) struct StepNoise {
    /// Covariance by errors of this step alone.
    pub own: Covariance3,
    /// Covariance by readings that the neighbouring steps share, with independent errors at its two ends.
    pub ends: Covariance3,
    /// For every error that is the same in all steps, the derivative of the displacement by it.
    pub constant_errors: Vec<[f64; 3]>,
}

impl StepNoise {
    /// Covariance of the displacement of one step.
    #[inline]
    pub fn total(&self) -> Covariance3 {
        self.own.and(self.ends)
    }

    /// Sets all to zero, for a step without motion.
    #[inline]
    pub fn clear(&mut self) {
        (self.own, self.ends) = (Covariance3::default(), Covariance3::default());
        self.constant_errors.fill([0.0; 3]);
    }
}

/// Zero of a yaw sensor, from its first reading.
#[derive(Clone, Copy, Debug)]
pub(crate) struct YawOffset {
    /// Reading at the yaw 0 of the pose [rad].
    pub value: f64,
    /// Its variance [rad²].
    pub variance: f64,
    /// Covariance with the error of the pose.
    pub cross: Vector3<f64>,
}

/// Estimated bias of a gyroscope.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bias {
    /// Its value [rad/s].
    pub value: f64,
    /// Its variance [rad²/s²].
    pub variance: f64,
    /// Covariance of its error with that of the pose.
    pub cross: Vector3<f64>,
}

impl Bias {
    /// Propagates the bias through one step, whose end has the derivative `by_bias` by it, and adds the variance of its
    /// random walk. Returns the covariance that this adds to the pose.
    #[inline(always)]
    pub fn propagate(
        &mut self,
        lever: [Lanes<Scalar>; 2],
        by_bias: [Lanes<Scalar>; 3],
        variance_increment: f64,
    ) -> Covariance3<Lanes<Scalar>> {
        let (cross, variance) = (lane(self.cross.into()), Lanes::splat(Scalar, self.variance));
        let added = bias_covariance_increment(lever, cross, by_bias, variance);
        let [x, y, z] = by_bias;
        let end = [x * variance, y * variance, z * variance];
        self.cross = numbers(propagate_error(lever, cross, end)).into();
        self.variance += variance_increment;
        added
    }
}

/// Errors by one deviation of the dimensions, which is constant over the run.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ConstantError {
    /// Error of the pose [m, m, rad].
    pub pose: Vector3<f64>,
    /// Error of the zero of a yaw sensor [rad].
    pub yaw_zero: f64,
}

/// Error of a pose in world axes: x [m], y [m], yaw [rad].
#[derive(Clone, Debug)]
pub(crate) struct Uncertainty {
    /// Covariance by errors that no later step shares.
    pub settled: Covariance3,
    /// Errors by the readings that the next step shares, one column per reading.
    pub carried: Vec<[f64; 3]>,
    pub constant_errors: Vec<ConstantError>,
    /// `Σ carried carriedᵀ`
    open: Covariance3,
    pub yaw_offset: Option<YawOffset>,
    pub bias: Option<Bias>,
}

impl Uncertainty {
    pub fn new(shared_readings: usize, deviations: usize) -> Self {
        Self {
            settled: Covariance3::default(),
            carried: vec![[0.0; 3]; shared_readings],
            constant_errors: vec![ConstantError::default(); deviations],
            open: Covariance3::default(),
            yaw_offset: None,
            bias: None,
        }
    }

    /// Copies another one without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        self.settled = other.settled;
        self.carried.copy_from_slice(&other.carried);
        self.constant_errors.copy_from_slice(&other.constant_errors);
        self.open = other.open;
        self.yaw_offset = other.yaw_offset;
        self.bias = other.bias;
    }

    /// Sets the covariance; columns and the zero of a yaw sensor are reset.
    pub fn set(&mut self, covariance: Matrix3<f64>) {
        self.settled = Covariance3::of(&covariance);
        self.close();
        self.constant_errors.fill(ConstantError::default());
        self.yaw_offset = None;
        if let Some(bias) = &mut self.bias {
            bias.cross = Vector3::zeros();
        }
    }

    /// Settles the columns, as no later step shares a reading with the steps so far, and discards the zero of a yaw
    /// sensor.
    pub fn release_shared_readings(&mut self) {
        self.settled.add_assign(&self.open);
        self.close();
        self.yaw_offset = None;
    }

    fn close(&mut self) {
        self.carried.fill([0.0; 3]);
        self.open = Covariance3::default();
    }

    /// Covariance of the pose.
    #[inline]
    pub fn covariance(&self) -> Covariance3 {
        let mut covariance = self.settled.and(self.open);
        for error in &self.constant_errors {
            covariance.add(&error.pose, 1.0);
        }
        covariance
    }

    /// Covariance of the pose without a negative variance in any direction by rounding.
    #[inline]
    pub fn reported(&self) -> Covariance3 {
        let covariance = rounded(self.covariance(), ROUNDING);
        if covariance.may_be_negative() {
            return covariance.without_negative();
        }
        covariance
    }

    /// Sets both parts of the covariance after a step, whose columns are set already.
    #[inline(always)]
    pub fn settle(&mut self, settled: Covariance3, open: Covariance3) {
        (self.settled, self.open) = (settled, open);
    }

    /// True if the next step shares the last reading of a gyroscope.
    pub fn has_gyroscope_error(&self) -> bool {
        self.carried.last() != Some(&[0.0; 3])
    }

    #[inline(always)]
    pub fn propagate_yaw_offset(&mut self, lever: [Lanes<Scalar>; 2]) {
        if let Some(offset) = &mut self.yaw_offset {
            let cross = lane(offset.cross.into());
            offset.cross = numbers(propagate_error(lever, cross, lane([0.0; 3]))).into();
        }
    }
}
