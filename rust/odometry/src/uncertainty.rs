//! The error of a pose: its growth along a step, and its decrease by other measurements.
//!
//! A reading of a steering angle is the end of one step and the start of the next: its error enters both. So the
//! error of the pose is kept in two parts: `settled`, and for every such reading the column by which its error
//! still counts. Steps are then independent of each other and the covariance is exact to first order:
//!
//! ```text
//! P = settled + Σ carried carriedᵀ
//! settled' = F settled Fᵀ + L Q Lᵀ + Σ (F carried + L old) (F carried + L old)ᵀ
//! carried' = L new
//! ```
//!
//! The error of a dimension enters every step: it has a column too, which is never settled (`constant_errors`).

mod correction;

use std::ops::{Add, Mul, Sub};

use nalgebra::{Matrix3, Vector3};
use pulp::Scalar;

use crate::propagation::arc::propagate_error;
use crate::propagation::covariance::{Covariance3, lane, numbers};
use crate::propagation::fusion::bias_covariance_increment;
use six_wheel_numerics::simd::lanes::Lanes;

/// A pose's rounding, as a share of its variance: added to every diagonal, so that no direction's variance is negative.
pub(crate) const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// The columns of joints come in whole registers, on every level that has this kernel.
pub(crate) const COLUMNS: usize = 4;

/// Covariance plus [`ROUNDING`], in the lanes, times its trace on the diagonal.
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
    /// Covariance of all that errs in this step alone.
    pub own: Covariance3,
    /// The same of readings that other steps share, as if those at its two ends erred on their own.
    pub ends: Covariance3,
    /// For every error that is the same in all steps, the derivative of the displacement by it.
    pub constant_errors: Vec<[f64; 3]>,
}

impl StepNoise {
    /// Covariance of the displacement, as if the readings at both ends erred on their own.
    #[inline]
    pub fn total(&self) -> Covariance3 {
        self.own.and(self.ends)
    }

    /// No noise: a step in which nothing moved.
    #[inline]
    pub fn clear(&mut self) {
        (self.own, self.ends) = (Covariance3::default(), Covariance3::default());
        self.constant_errors.fill([0.0; 3]);
    }
}

/// Zero of a yaw sensor, learnt from its first reading.
#[derive(Clone, Copy, Debug)]
pub(crate) struct YawOffset {
    /// Reading where the pose's yaw is zero [rad].
    pub value: f64,
    /// Its variance.
    pub variance: f64,
    /// Covariance with the error of the pose.
    pub cross: Vector3<f64>,
}

/// Bias of a gyroscope, as far as it is known.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bias {
    /// Its value [rad/s].
    pub value: f64,
    /// Its variance.
    pub variance: f64,
    /// Covariance of its error with that of the pose.
    pub cross: Vector3<f64>,
}

impl Bias {
    /// Propagates the bias through one step whose end is off by `by_bias` times its error, and adds the variance of its
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

/// Error of a pose by one deviation of the dimensions, and of the zero of a yaw sensor that was read there.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ConstantError {
    pub pose: Vector3<f64>,
    pub yaw_zero: f64,
}

/// Error of a pose in world axes: x [m], y [m], yaw [rad].
#[derive(Clone, Debug)]
pub(crate) struct Uncertainty {
    pub settled: Covariance3,
    pub carried: Vec<[f64; 3]>,
    pub constant_errors: Vec<ConstantError>,
    /// Sum over the columns of their products with themselves.
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

    /// Takes the value of another one without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        self.settled = other.settled;
        self.carried.copy_from_slice(&other.carried);
        self.constant_errors.copy_from_slice(&other.constant_errors);
        self.open = other.open;
        self.yaw_offset = other.yaw_offset;
        self.bias = other.bias;
    }

    /// Starts over from a known covariance.
    pub fn set(&mut self, covariance: Matrix3<f64>) {
        self.settled = Covariance3::of(&covariance);
        self.close();
        self.constant_errors.fill(ConstantError::default());
        self.yaw_offset = None;
        if let Some(bias) = &mut self.bias {
            bias.cross = Vector3::zeros();
        }
    }

    /// No reading before is shared with a step to come.
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

    /// The same without a negative variance in any direction, rounding or not.
    #[inline]
    pub fn reported(&self) -> Covariance3 {
        let covariance = rounded(self.covariance(), ROUNDING);
        if covariance.may_be_negative() {
            return covariance.without_negative();
        }
        covariance
    }

    /// Sets both parts of the covariance after steps that were made by registers.
    #[inline(always)]
    pub fn settle(&mut self, settled: Covariance3, open: Covariance3) {
        (self.settled, self.open) = (settled, open);
    }

    /// True if the error of a gyroscope's last reading still counts.
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
