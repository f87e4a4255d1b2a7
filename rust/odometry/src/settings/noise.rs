//! Standard deviations of readings and wheels, and their growth.

use six_wheel_numerics::error::{Error, not_negative, positive};

/// Standard deviations of readings and slip. Errors of different wheels and of different readings are
/// independent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Deviation of every wheel's rim speed, as read over one step [m/s].
    pub speed: f64,
    /// Deviation of every steering angle [rad].
    pub steering: f64,
    /// Deviation of the slip of a wheel along its heading while its pivot travels one metre [m per root m]. It grows
    /// with the root of the distance, independently of the sampling rate.
    pub slip: f64,
    /// Deviation of the slip across its heading [m per root m]; with rollers, slip along their axes moves the wheel
    /// along its heading too.
    pub side_slip: f64,
    /// Deviation of an absolute yaw reading [rad]; 0: exact.
    pub yaw: f64,
    /// Deviation of a yaw rate reading [rad/s]; 0: exact.
    pub yaw_rate: f64,
    /// Time over which an error of speed, steering or yaw rate is constant [s]. Readings that come more often share
    /// their error, so that the growth of the variance per second does not depend on their rate. None: errors of
    /// readings are independent.
    pub period: Option<f64>,
}

impl Default for Noise {
    /// The noise of the laboratory tricycle of the OptiOdom recordings, with dimensions measured by tape: the errors at
    /// the ends of its nine runs match it.
    fn default() -> Self {
        Self { slip: 0.03, side_slip: 0.03, ..Self::READINGS }
    }
}

impl Noise {
    /// Noise of readings alone: wheels that do not slip, on a rover whose dimensions are known.
    pub const READINGS: Self =
        Self { speed: 0.01, steering: 0.009, slip: 0.0, side_slip: 0.0, yaw: 0.0, yaw_rate: 0.0, period: None };

    /// True if the noise of the wheels is the default one, not measured on this rover.
    pub fn is_typical(&self) -> bool {
        let wheels = |noise: &Self| [noise.speed, noise.steering, noise.slip, noise.side_slip];
        wheels(self) == wheels(&Self::default())
    }

    /// Fails unless every number is finite and not negative, and the period positive.
    pub fn check(&self) -> Result<(), Error> {
        let deviations = fields!(self: speed, steering, slip, side_slip, yaw, yaw_rate);
        deviations.into_iter().try_for_each(|(argument, value)| not_negative(argument, value))?;
        self.period.map_or(Ok(()), |period| positive("period", period))
    }

    /// Factor of the variances of readings in a step, `period / dt`; 1 without a period.
    #[inline]
    pub fn sharing(&self, dt: f64) -> f64 {
        self.period.map_or(1.0, |period| period / dt)
    }
}
