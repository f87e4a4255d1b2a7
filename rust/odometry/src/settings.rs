//! Settings of odometry, which do not change while it runs.

pub mod dimensions;
pub mod encoder;
pub mod gyroscope;
pub mod noise;
pub(crate) mod quantities;

use self::dimensions::Deviations;
use self::encoder::Encoder;
use self::gyroscope::Gyroscope;
use self::noise::Noise;
use six_wheel_kinematics::estimate::Method;
use six_wheel_kinematics::rover::Rover;
use six_wheel_numerics::error::{Error, not_negative, number};

/// Slip that is flagged if the noise is the default one, not measured on this rover [m/s].
const TYPICAL_SLIP: f64 = 0.05;

/// Kind of the readings of the wheels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Readings {
    /// Running totals.
    #[default]
    Angles,
    /// Rates at the stamps: a step takes the mean of its two ends.
    Speeds,
    /// Increments since the sample before.
    Increments,
}

/// Settings of odometry; each has a default.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Standard deviations of readings and slip.
    pub noise: Noise,
    /// The gyroscope whose rates come with the samples, with its bias as a state; None: the deviation of rates is that
    /// of `noise`.
    pub gyroscope: Option<Gyroscope>,
    /// Factor of the slip noise of each wheel; empty: all 1.
    pub wheel_noise: Vec<f64>,
    /// Errors of the dimensions; empty: they are exact.
    pub dimensions: Deviations,
    /// Kind of the readings of the wheels.
    pub readings: Readings,
    /// One for all wheels or one per wheel; empty: they read radians.
    pub wheel_encoders: Vec<Encoder>,
    /// One for all steering joints or one per joint; empty: they read radians.
    pub steering_encoders: Vec<Encoder>,
    /// Method that weighs the wheels.
    pub method: Method,
    /// True if disagreement of the wheels beyond the noise counts as more noise.
    pub inflate: bool,
    /// Slip of a wheel that is flagged [m/s]; None: four standard deviations of what the noise explains, of the typical
    /// noise [`TYPICAL_SLIP`].
    pub slip_threshold: Option<f64>,
    /// Time between samples beyond which a step is flagged [s].
    pub max_gap: Option<f64>,
    /// Rim speed beyond which a sample is refused [m/s].
    pub max_speed: Option<f64>,
    /// Steering rate beyond which a sample is refused [rad/s].
    pub max_steering_rate: Option<f64>,
    /// Time constant of the first-order filter of `velocity` [s]; 0: none.
    pub smoothing: f64,
    /// Largest delay of a pose from outside [s].
    pub lag: f64,
    /// Largest number of samples that are kept for late poses.
    pub history: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            noise: Noise::default(),
            gyroscope: None,
            wheel_noise: Vec::new(),
            dimensions: Deviations::default(),
            readings: Readings::Angles,
            wheel_encoders: Vec::new(),
            steering_encoders: Vec::new(),
            method: Method::LeastSquares,
            inflate: false,
            slip_threshold: None,
            max_gap: None,
            max_speed: None,
            max_steering_rate: None,
            smoothing: 0.0,
            lag: 0.0,
            history: 1024,
        }
    }
}

impl Settings {
    pub(crate) fn check(&self, rover: &Rover) -> Result<(), Error> {
        self.check_for(rover.wheels().len(), rover.steered().len())?;
        if self.method == Method::MiddleWheels && rover.steered().len() == rover.wheels().len() {
            let rule = "be another one for a rover without unsteered wheels";
            return Err(Error::value("method", rule, "'middle_wheels'"));
        }
        Ok(())
    }

    /// [`Self::check`] for these numbers of wheels and steering joints.
    pub fn check_for(&self, wheels: usize, joints: usize) -> Result<(), Error> {
        self.noise.check()?;
        self.gyroscope.map_or(Ok(()), |known| known.check())?;
        self.dimensions.check_for(wheels)?;
        if !(self.wheel_noise.is_empty() || self.wheel_noise.len() == wheels) {
            return Err(Error::value("wheel_noise", format!("hold {wheels} numbers"), self.wheel_noise.len()));
        }
        self.wheel_noise.iter().try_for_each(|share| not_negative("wheel_noise", *share))?;
        let encoders =
            [("wheel_encoders", &self.wheel_encoders, wheels), ("steering_encoders", &self.steering_encoders, joints)];
        for (argument, encoders, count) in encoders {
            if encoders.len() > 1 && encoders.len() != count {
                return Err(Error::value(argument, format!("be one encoder or {count}"), encoders.len()));
            }
            encoders.iter().try_for_each(Encoder::check)?;
        }
        for (argument, value) in fields!(self: slip_threshold, max_gap, max_speed, max_steering_rate) {
            if let Some(value) = value
                && (value.is_nan() || value <= 0.0)
            {
                return Err(Error::value(argument, "be positive", number(value)));
            }
        }
        not_negative("smoothing", self.smoothing)?;
        not_negative("lag", self.lag)
    }
}

impl Settings {
    /// Variance that the random walk of the gyroscope's bias adds in `dt` [rad²/s²].
    #[inline]
    pub(crate) fn bias_variance_increment(&self, dt: f64) -> f64 {
        let walk = self.gyroscope.map_or(0.0, |known| known.bias_walk);
        walk * walk * dt
    }

    /// Standard deviation of a yaw rate [rad/s].
    #[inline]
    pub(crate) fn rate_noise(&self) -> f64 {
        self.gyroscope.map_or(self.noise.yaw_rate, |known| known.noise)
    }

    /// Standard deviation of the scale factor of the gyroscope.
    pub(crate) fn scale_noise(&self) -> f64 {
        self.gyroscope.map_or(0.0, |known| known.scale_noise)
    }

    /// Number of errors that are constant over the run: those of the dimensions, then the gyroscope's scale.
    pub(crate) fn constant_error_count(&self) -> usize {
        self.dimensions.len() + usize::from(self.scale_noise() > 0.0)
    }

    /// Slip of a wheel that is flagged [m/s]; None: it follows from the variances of the step.
    pub(crate) fn flagged_slip(&self) -> Option<f64> {
        self.slip_threshold.or(self.noise.is_typical().then_some(TYPICAL_SLIP))
    }

    /// The encoder of a wheel.
    #[inline]
    pub fn wheel_encoder(&self, wheel: usize) -> Encoder {
        pick(&self.wheel_encoders, wheel)
    }

    /// The encoder of a steering joint.
    #[inline]
    pub fn steering_encoder(&self, joint: usize) -> Encoder {
        pick(&self.steering_encoders, joint)
    }

    /// Writes the angles of steering joints at their first readings [rad].
    pub fn first_angles(&self, readings: &[f64], angles: &mut [f64]) {
        for (joint, (angle, reading)) in angles.iter_mut().zip(readings).enumerate() {
            *angle = self.steering_encoder(joint).first_angle(*reading);
        }
    }
}

/// The encoder of one joint: its own, the one for all, or one that reads radians.
fn pick(encoders: &[Encoder], index: usize) -> Encoder {
    let own = encoders.get(index).or_else(|| encoders.first());
    own.copied().unwrap_or_default()
}
