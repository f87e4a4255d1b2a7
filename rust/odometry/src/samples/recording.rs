//! Samples of a log, one or all of them, and the rows of their results.

/// Readings at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a> {
    /// Readings of the steering joints.
    pub steering: &'a [f64],
    /// Readings of the wheels. NaN where a passive wheel has no encoder.
    pub wheels: &'a [f64],
    /// Time of the readings [s].
    pub stamp: f64,
    /// Absolute yaw of a sensor whose zero is unknown [rad].
    pub yaw: Option<f64>,
    /// Yaw rate of a gyroscope [rad/s].
    pub yaw_rate: Option<f64>,
}

/// Columns of a log: one row per sample.
#[derive(Clone, Copy, Debug)]
pub struct Recording<'a> {
    /// Readings of the steering joints, row after row.
    pub steering: &'a [f64],
    /// Readings of the wheels, row after row.
    pub wheels: &'a [f64],
    /// Time of the readings [s].
    pub stamps: &'a [f64],
    /// Absolute yaw [rad]; NaN where there was none.
    pub yaws: Option<&'a [f64]>,
    /// Yaw rates [rad/s]; NaN where there was none.
    pub yaw_rates: Option<&'a [f64]>,
}

impl<'a> Recording<'a> {
    /// Row `k` of a log with these numbers of wheels and steering joints.
    pub fn row(&self, wheels: usize, joints: usize, k: usize) -> Sample<'a> {
        let at = |values: Option<&'a [f64]>| values.map(|values| values[k]).filter(|value| !value.is_nan());
        Sample {
            steering: &self.steering[k * joints..(k + 1) * joints],
            wheels: &self.wheels[k * wheels..(k + 1) * wheels],
            stamp: self.stamps[k],
            yaw: at(self.yaws),
            yaw_rate: at(self.yaw_rates),
        }
    }

    /// End of up to `most` rows from `first` on, of which only the last one may have a yaw, a finite one.
    pub(crate) fn until_yaw(&self, first: usize, most: usize) -> usize {
        let end = self.stamps.len().min(first + most);
        let with_yaw = self.yaws.and_then(|yaws| {
            let found = yaws[first..end].iter().position(|yaw| !yaw.is_nan());
            found.map(|k| first + k)
        });
        with_yaw.map_or(end, |row| {
            let is_finite = self.yaws.is_some_and(|yaws| yaws[row].is_finite());
            row + usize::from(is_finite)
        })
    }
}

/// Output of a log, one row per sample.
#[derive(Debug)]
pub struct TrackRows<'a> {
    /// Poses [m, m, rad].
    pub poses: &'a mut [[f64; 3]],
    /// Twists [m/s, m/s, rad/s].
    pub twists: &'a mut [[f64; 3]],
    /// Covariances of the poses; None: they are not written.
    pub covariances: Option<&'a mut [[f64; 9]]>,
    /// Residuals of the wheels [m/s], row after row; None: they are not written.
    pub residuals: Option<&'a mut [f64]>,
    /// Weights of the wheels, row after row; None: they are not written.
    pub weights: Option<&'a mut [f64]>,
    /// Flags.
    pub health: &'a mut [u32],
}
