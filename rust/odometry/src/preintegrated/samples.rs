//! The samples of a motion.

use crate::samples::recording::Sample;

/// Samples between two instants, first one included.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    /// [s]
    pub stamps: Vec<f64>,
    /// Readings of the steering joints, row after row.
    pub steering: Vec<f64>,
    /// Readings of the wheels, row after row.
    pub wheels: Vec<f64>,
    /// Yaw rates without the bias [rad/s]; NaN where there is none.
    pub rates: Vec<f64>,
    /// Unit quaternions x, y, z, w; none in the plane.
    pub attitudes: Vec<[f64; 4]>,
}

impl Samples {
    /// Adds a sample, with its attitude in space.
    #[inline]
    pub(super) fn push(&mut self, sample: Sample<'_>, attitude: Option<[f64; 4]>) {
        self.stamps.push(sample.stamp);
        self.steering.extend_from_slice(sample.steering);
        self.wheels.extend_from_slice(sample.wheels);
        self.rates.push(sample.yaw_rate.unwrap_or(f64::NAN));
        self.attitudes.extend(attitude);
    }
}
