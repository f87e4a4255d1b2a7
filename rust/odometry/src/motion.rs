//! Measurements of one step of odometry.

/// A wheel is flagged as slipping if its residual exceeds this many standard deviations.
pub const SUSPICIOUS: f64 = 4.0;

/// A residual below this share of the largest distance of a wheel is rounding.
pub const ROUNDING: f64 = 1e-9;

/// Measurements of one step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion<'a> {
    /// Steering angles at its start and end [rad].
    pub steering: [&'a [f64]; 2],
    /// Rotation of every wheel [rad].
    pub turned: &'a [f64],
    /// True if rotations are means of rates at start and end, whose errors the neighbouring steps share.
    pub from_rates: bool,
    /// Duration [s].
    pub dt: f64,
    /// Yaw increment of the gyroscope, less that by its bias [rad].
    pub gyro_turn: Option<f64>,
    /// Variance of that bias [rad²/s²].
    pub bias_variance: f64,
}
