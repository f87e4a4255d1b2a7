//! The error of a pose: how it grows along a step and shrinks with what is known from outside.
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
//! What dimensions are off by enters every step: it has columns too, which are never settled (`lasting`).

use std::ops::{Add, Mul, Neg};

use nalgebra::{Matrix3, Vector3};

mod turned;

pub(crate) use self::turned::{
    GyroscopeIncrement, bias_covariance, fused_displacement, gain, propagate_error, remaining_covariance,
    remaining_error,
};
use super::arithmetic::{Arithmetic, Unfused};
use super::spread::Covariance3;
use six_wheel_numerics::jacobi::Jacobi;

/// A pose's rounding, as a share of its variance: added to every diagonal, so that no direction's variance is negative.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// The columns of joints come in whole registers, on every level that has this kernel.
pub(crate) const COLUMNS: usize = 4;

/// Covariance plus [`ROUNDING`] times its trace on the diagonal.
#[inline(always)]
pub(crate) fn rounded<F: Arithmetic>(by: F, mut covariance: Covariance3<F::Number>) -> Covariance3<F::Number> {
    covariance.add_to_diagonal(by.number(ROUNDING) * covariance.trace());
    covariance
}

/// Derivatives of the end of a step with respect to its start and to its displacement in body axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepJacobian<T = f64> {
    /// Way in world axes [m]: a turn at the start swings it.
    pub shift: [T; 2],
    /// By the displacement; an error of it leaves the yaw as it is, so the third row is 0, 0, 1.
    pub by_displacement: [[T; 3]; 2],
}

impl<T: Copy + Neg<Output = T>> StepJacobian<T> {
    /// Derivative of the end position with respect to the yaw at the start [m].
    #[inline(always)]
    pub fn lever(&self) -> [T; 2] {
        [-self.shift[1], self.shift[0]]
    }
}

impl<T: Copy + Add<Output = T> + Mul<Output = T>> StepJacobian<T> {
    /// Error of the pose at the end by an error of the displacement.
    #[inline(always)]
    pub fn ended<F: Arithmetic<Number = T>>(&self, by: F, [x, y, z]: [T; 3]) -> [T; 3] {
        let [[a, b, c], [d, e, f]] = self.by_displacement;
        [by.fused(c, z, by.fused(b, y, a * x)), by.fused(f, z, by.fused(e, y, d * x)), z]
    }
}

impl StepJacobian {
    /// The whole matrix by the displacement.
    #[inline]
    pub fn matrix(&self) -> Matrix3<f64> {
        let [[a, b, c], [d, e, f]] = self.by_displacement;
        Matrix3::new(a, b, c, d, e, f, 0.0, 0.0, 1.0)
    }

    /// Error of the pose at the end by an error of the displacement.
    #[inline(always)]
    fn map(&self, error: &Vector3<f64>) -> Vector3<f64> {
        let [x, y] = self.by_displacement.map(|[a, b, c]| a * error.x + b * error.y + c * error.z);
        Vector3::new(x, y, error.z)
    }
}

/// Error of the pose at the end of a step with this lever by an error of the start.
#[inline(always)]
fn carry([x, y]: [f64; 2], error: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(error.x + x * error.z, error.y + y * error.z, error.z)
}

/// Errors of one displacement in body axes.
#[derive(Clone, Debug, Default)]
pub(crate) struct StepNoise {
    /// Covariance of all that errs in this step alone.
    pub own: Covariance3,
    /// The same of readings that other steps share, as if those at its two ends erred on their own.
    pub ends: Covariance3,
    /// Per shared reading: its error at the start of the step, times its standard deviation.
    pub old: Vec<Vector3<f64>>,
    /// The same at the end.
    pub new: Vec<Vector3<f64>>,
    /// Per deviation of the dimensions: what it makes of the displacement.
    pub lasting: Vec<Vector3<f64>>,
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
        self.old.fill(Vector3::zeros());
        self.new.fill(Vector3::zeros());
        self.lasting.fill(Vector3::zeros());
    }

    /// Adds up the columns.
    pub fn sum_ends(&mut self) {
        self.ends = Covariance3::default();
        for column in self.old.iter().chain(&self.new) {
            self.ends.add(column, 1.0);
        }
    }

    /// Multiplies every error by `I - K H` of a correction.
    pub fn multiply(&mut self, rest: &Matrix3<f64>) {
        self.own = self.own.image(rest);
        self.ends = self.ends.image(rest);
        for column in self.old.iter_mut().chain(&mut self.new) {
            *column = rest * *column;
        }
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
    pub fn propagate<F: Arithmetic<Number = f64>>(
        &mut self,
        by: F,
        lever: [f64; 2],
        by_bias: [f64; 3],
        wandered: f64,
    ) -> Covariance3 {
        let cross = self.cross.into();
        let added = bias_covariance(by, lever, cross, by_bias, self.variance);
        let end = by_bias.map(|part| part * self.variance);
        self.cross = propagate_error(by, lever, cross, end).into();
        self.variance += wandered;
        added
    }
}

/// Error of a pose by one deviation of the dimensions, and of the zero of a yaw sensor that was read there.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Lasting {
    pub pose: Vector3<f64>,
    pub yaw_zero: f64,
}

/// Error of a pose in world axes: x [m], y [m], yaw [rad].
#[derive(Clone, Debug)]
pub(crate) struct Uncertainty {
    pub settled: Covariance3,
    pub carried: Vec<[f64; 3]>,
    pub lasting: Vec<Lasting>,
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
            lasting: vec![Lasting::default(); deviations],
            open: Covariance3::default(),
            yaw_offset: None,
            bias: None,
        }
    }

    /// Takes the value of another one without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        self.settled = other.settled;
        self.carried.copy_from_slice(&other.carried);
        self.lasting.copy_from_slice(&other.lasting);
        self.open = other.open;
        self.yaw_offset = other.yaw_offset;
        self.bias = other.bias;
    }

    /// Starts over from a known covariance.
    pub fn set(&mut self, covariance: Matrix3<f64>) {
        self.settled = Covariance3::of(&covariance);
        self.close();
        self.lasting.fill(Lasting::default());
        self.yaw_offset = None;
        if let Some(bias) = &mut self.bias {
            bias.cross = Vector3::zeros();
        }
    }

    /// No reading before is shared with a step to come.
    pub fn let_go(&mut self) {
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
        for lasting in &self.lasting {
            covariance.add(&lasting.pose, 1.0);
        }
        covariance
    }

    /// The same without a negative variance in any direction, rounding or not.
    #[inline]
    pub fn reported(&self) -> Covariance3 {
        let covariance = rounded(Unfused, self.covariance());
        if covariance.may_be_negative() {
            return covariance.without_negative();
        }
        covariance
    }

    /// Goes along one step.
    pub fn propagate(&mut self, step: &StepJacobian, noise: &StepNoise) {
        for (lasting, by) in self.lasting.iter_mut().zip(&noise.lasting) {
            lasting.pose = carry(step.lever(), &lasting.pose) + step.map(by);
        }
        let mut settled = self.settled.swung(Unfused, step.lever());
        settled.add_assign(&noise.own.image(&step.matrix()));
        let ends = noise.old.iter().zip(&noise.new);
        self.open = Covariance3::default();
        for (carried, (old, new)) in self.carried.iter_mut().zip(ends) {
            let whole = carry(step.lever(), &Vector3::from(*carried)) + step.map(old);
            settled.add(&whole, 1.0);
            let column = step.map(new);
            self.open.add(&column, 1.0);
            *carried = column.into();
        }
        self.settled = settled;
        self.carry_yaw_offset(step.lever());
    }

    /// Sets both parts of the covariance after steps that were made by registers.
    #[inline(always)]
    pub fn settle(&mut self, settled: Covariance3, open: Covariance3) {
        (self.settled, self.open) = (settled, open);
    }

    /// True if the error of a gyroscope's last reading still counts.
    pub fn leans_on_gyroscope(&self) -> bool {
        self.carried.last() != Some(&[0.0; 3])
    }

    /// Propagates the bias of a gyroscope through one step with this gain and random walk. A gain of 0 means no
    /// reading: the correlation with the pose is propagated all the same.
    pub fn lean_on_bias(&mut self, step: &StepJacobian, gain: &Vector3<f64>, dt: f64, walk: f64) {
        if let Some(bias) = &mut self.bias {
            let by_bias = step.map(&(gain * -dt)).into();
            let added = bias.propagate(Unfused, step.lever(), by_bias, walk);
            self.settled.add_assign(&added);
        }
    }

    /// Corrects the bias by a reading at rest. Returns the correction of the pose, whose error correlates with that of
    /// the bias.
    pub fn learn_bias(&mut self, rate: f64, variance: f64) -> Vector3<f64> {
        let Some(mut bias) = self.bias else {
            return Vector3::zeros();
        };
        let spread = bias.variance + variance;
        if spread == 0.0 {
            return Vector3::zeros();
        }
        let innovation = rate - bias.value;
        let (gain, along) = (bias.variance / spread, bias.cross / spread);
        let less = along * bias.cross.transpose();
        self.settled = Covariance3::of(&(self.settled.matrix() - less));
        bias.value += gain * innovation;
        bias.variance *= 1.0 - gain;
        bias.cross *= 1.0 - gain;
        self.bias = Some(bias);
        along * innovation
    }

    #[inline(always)]
    pub fn carry_yaw_offset(&mut self, lever: [f64; 2]) {
        if let Some(offset) = &mut self.yaw_offset {
            offset.cross = carry(lever, &offset.cross);
        }
    }

    /// The zero of a yaw sensor, from its first reading at this pose.
    pub fn set_yaw_offset(&mut self, value: f64, variance: f64) {
        let cross = -self.settled.with_z();
        let variance = variance + self.settled.zz();
        self.yaw_offset = Some(YawOffset { value, variance, cross });
        for lasting in &mut self.lasting {
            lasting.yaw_zero = -lasting.pose.z;
        }
    }

    /// Corrects by a reading of the yaw sensor with this variance. Returns the gain of the pose by the innovation.
    pub fn correct_yaw(&mut self, offset: YawOffset, variance: f64) -> Vector3<f64> {
        let (mut cross, mut of_zero) = (offset.cross, offset.variance);
        for lasting in &self.lasting {
            cross += lasting.pose * lasting.yaw_zero;
            of_zero += lasting.yaw_zero * lasting.yaw_zero;
        }
        let along = self.covariance().with_z() + cross;
        let spread = along.z + cross.z + of_zero + variance;
        let gain = if spread > 0.0 { along / spread } else { Vector3::z() };
        let rest = Matrix3::identity() - gain * Vector3::z().transpose();
        let mixed = rest * offset.cross * gain.transpose();
        self.multiply(&rest);
        for lasting in &mut self.lasting {
            lasting.pose -= gain * lasting.yaw_zero;
        }
        let settled = self.settled.matrix() - (mixed + mixed.transpose());
        self.settled = Covariance3::of(&settled);
        self.settled.add(&gain, variance + offset.variance);
        self.yaw_offset = Some(YawOffset { cross: rest * offset.cross - gain * offset.variance, ..offset });
        gain
    }

    /// Corrects by a pose from outside with this covariance, infinite where the pose is unknown. Returns the gain of
    /// the pose by the innovation.
    pub fn correct(&mut self, measured: &Matrix3<f64>) -> Matrix3<f64> {
        let mut known = Matrix3::zeros();
        let mut noise = *measured;
        for i in 0..3 {
            if measured[(i, i)].is_finite() {
                known[(i, i)] = 1.0;
            } else {
                noise.row_mut(i).fill(0.0);
                noise.column_mut(i).fill(0.0);
            }
        }
        let covariance = self.covariance().matrix();
        let unknown = Matrix3::identity() - known;
        let spread = known * (covariance + noise) * known + unknown;
        let gain = if noise == Matrix3::zeros() {
            // Taken at its word: the pose is what is measured, and the rest follows as far as it is tied to it.
            spread.cholesky().map_or(known, |spread| covariance * known * spread.inverse())
        } else {
            covariance * known * Jacobi::new(&spread).inverse(f64::EPSILON * spread.amax())
        };
        let rest = Matrix3::identity() - gain * known;
        self.multiply(&rest);
        self.settled.add_assign(&Covariance3::of(&noise).image(&gain));
        gain
    }

    /// Multiplies every error by `I - K H` of a correction.
    fn multiply(&mut self, rest: &Matrix3<f64>) {
        self.settled = self.settled.image(rest);
        self.open = self.open.image(rest);
        for column in &mut self.carried {
            *column = (rest * Vector3::from(*column)).into();
        }
        for lasting in &mut self.lasting {
            lasting.pose = rest * lasting.pose;
        }
        if let Some(offset) = &mut self.yaw_offset {
            offset.cross = rest * offset.cross;
        }
        if let Some(bias) = &mut self.bias {
            bias.cross = rest * bias.cross;
        }
    }
}
