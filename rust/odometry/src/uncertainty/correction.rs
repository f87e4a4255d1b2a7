//! Corrections of a pose's error by other measurements: a yaw, a pose, a gyroscope at rest.

use nalgebra::{Matrix3, Vector3};

use super::{Uncertainty, YawOffset};
use crate::propagation::covariance::Covariance3;
use crate::propagation::pose_gain::PoseGain;

impl Uncertainty {
    /// Corrects the bias by a reading at rest [rad/s] with this variance. Returns the correction of the pose, whose
    /// error correlates with that of the bias.
    pub fn correct_bias(&mut self, rate: f64, variance: f64) -> Vector3<f64> {
        let Some(mut bias) = self.bias else {
            return Vector3::zeros();
        };
        let innovation_variance = bias.variance + variance;
        if innovation_variance == 0.0 {
            return Vector3::zeros();
        }
        let innovation = rate - bias.value;
        let (gain, pose_gain) = (bias.variance / innovation_variance, bias.cross / innovation_variance);
        let decrease = pose_gain * bias.cross.transpose();
        self.settled = Covariance3::of(&(self.settled.matrix() - decrease));
        bias.value += gain * innovation;
        bias.variance *= 1.0 - gain;
        bias.cross *= 1.0 - gain;
        self.bias = Some(bias);
        pose_gain * innovation
    }

    /// Sets the zero of a yaw sensor [rad] by its first reading, with the variance of the reading.
    pub fn set_yaw_offset(&mut self, value: f64, variance: f64) {
        let cross = -self.settled.with_z();
        let variance = variance + self.settled.zz();
        self.yaw_offset = Some(YawOffset { value, variance, cross });
        for error in &mut self.constant_errors {
            error.yaw_zero = -error.pose.z;
        }
    }

    /// Corrects by a reading of the yaw sensor with this variance. Returns the gain of the pose by the innovation.
    pub fn correct_yaw(&mut self, offset: YawOffset, variance: f64) -> Vector3<f64> {
        let (mut cross, mut of_zero) = (offset.cross, offset.variance);
        for error in &self.constant_errors {
            cross += error.pose * error.yaw_zero;
            of_zero += error.yaw_zero * error.yaw_zero;
        }
        let along = self.covariance().with_z() + cross;
        let innovation_variance = along.z + cross.z + of_zero + variance;
        let gain = if innovation_variance > 0.0 { along / innovation_variance } else { Vector3::z() };
        let rest = Matrix3::identity() - gain * Vector3::z().transpose();
        let mixed = rest * offset.cross * gain.transpose();
        self.multiply(&rest);
        for error in &mut self.constant_errors {
            error.pose -= gain * error.yaw_zero;
        }
        let settled = self.settled.matrix() - (mixed + mixed.transpose());
        self.settled = Covariance3::of(&settled);
        self.settled.add(&gain, variance + offset.variance);
        self.yaw_offset = Some(YawOffset { cross: rest * offset.cross - gain * offset.variance, ..offset });
        gain
    }

    /// Corrects by a pose from outside with this covariance, infinite for unknown components. Returns the gain of the
    /// pose by the innovation.
    pub fn correct(&mut self, measured: &Matrix3<f64>) -> Matrix3<f64> {
        let PoseGain { gain, by_error, noise } =
            PoseGain::new(&self.covariance().matrix(), &Matrix3::identity(), measured);
        self.multiply(&(Matrix3::identity() - gain * by_error));
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
        for error in &mut self.constant_errors {
            error.pose = rest * error.pose;
        }
        if let Some(offset) = &mut self.yaw_offset {
            offset.cross = rest * offset.cross;
        }
        if let Some(bias) = &mut self.bias {
            bias.cross = rest * bias.cross;
        }
    }
}
