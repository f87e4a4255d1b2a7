//! Measurements of one step of odometry.

/// Standard deviations of disagreement above which a wheel is flagged as slipping.
pub const SUSPICIOUS: f64 = 4.0;

/// Share of a wheel's distance below which a residual is rounding.
pub const ROUNDING: f64 = 1e-9;

/// Measurements of one step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion<'a> {
    /// Steering angles at its start and end [rad].
    pub steering: [&'a [f64]; 2],
    /// Rotation of every wheel [rad].
    pub turned: &'a [f64],
    /// True if that is the mean of readings at its start and end, which other steps share.
    pub from_rates: bool,
    /// Duration [s].
    pub dt: f64,
    /// Yaw increment of the gyroscope, less that by its bias [rad].
    pub gyro_turn: Option<f64>,
    /// Variance of that bias [rad²/s²].
    pub bias_variance: f64,
}
