//! One step of odometry as it is read, and as wheels and a gyroscope share it.

use nalgebra::{Matrix3, Vector3};

/// How many standard deviations a wheel may disagree before it is said to slip.
pub const SUSPICIOUS: f64 = 4.0;

/// Share of a wheel's way below which a residual is rounding.
pub const ROUNDING: f64 = 1e-9;

/// What is known of one step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion<'a> {
    /// Steering angles at its start and end [rad].
    pub steering: [&'a [f64]; 2],
    /// What every wheel turned [rad].
    pub turned: &'a [f64],
    /// Whether that is the mean of readings at its start and end, which other steps share.
    pub from_rates: bool,
    /// Duration [s].
    pub dt: f64,
    /// What a gyroscope turned, its bias taken off [rad].
    pub gyro_turn: Option<f64>,
    /// Variance of that bias [rad²/s²].
    pub bias_variance: f64,
}

/// How wheels and a gyroscope share a step: `displacement' = displacement + gain (turn - displacement.z)`.
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
