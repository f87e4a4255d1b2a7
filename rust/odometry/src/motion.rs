//! One step of odometry as it is read, and as wheels and a gyroscope share it.

use nalgebra::{Matrix3, Vector3};

/// Standard deviations of disagreement above which a wheel is flagged as slipping.
pub const SUSPICIOUS: f64 = 4.0;

/// Share of a wheel's way below which a residual is rounding.
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
    /// Turn by the gyroscope, less its bias [rad].
    pub gyro_turn: Option<f64>,
    /// Variance of that bias [rad²/s²].
    pub bias_variance: f64,
}

/// Fusion of wheels and gyroscope in one step: `displacement' = displacement + gain (turn - displacement.z)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fusion {
    /// By the turn of the gyroscope.
    pub gain: Vector3<f64>,
    /// By the displacement of the wheels.
    pub rest: Matrix3<f64>,
}

impl Fusion {
    pub(crate) fn none() -> Self {
        Self { gain: Vector3::zeros(), rest: Matrix3::identity() }
    }
}
