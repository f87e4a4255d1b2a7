//! Readings of the wheels, and the methods by which they are fitted.

use nalgebra::Vector3;

use crate::geometry::Twist;

/// Method by which the wheels' readings are weighted against each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Every wheel alike.
    LeastSquares,
    /// The unsteered wheels alone.
    MiddleWheels,
    /// Iteratively reweighted least squares: the weight of a wheel falls with its residual.
    Robust,
}

named_values! {
    Method as "method": "least_squares" => LeastSquares, "middle_wheels" => MiddleWheels, "robust" => Robust
}

/// Treatment of a motion that no reading determines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Unseen {
    /// It is an error.
    #[default]
    Refuse,
    /// It is zero, about the centre of the pivots.
    Zero,
}

/// Result of a fit beside the residuals and weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// The estimate.
    pub twist: Twist,
    /// Number of independent directions of the twist that the readings determine.
    pub rank: usize,
    /// Smallest singular value of the stacked, weighted rows.
    pub sigma_min: f64,
}

/// Both rows of one wheel with their right-hand sides.
#[derive(Clone, Copy, Debug)]
pub struct Reading {
    /// Rolling row.
    pub rolling: Vector3<f64>,
    /// Side-slip row.
    pub side_slip: Vector3<f64>,
    /// Right-hand side of the rolling row [m/s].
    pub rolled: f64,
    /// Right-hand side of the side-slip row [m/s].
    pub slipped: f64,
}

impl Reading {
    /// Rows of a wheel that measures nothing.
    pub const NONE: Self = Self {
        rolling: Vector3::new(0.0, 0.0, 0.0),
        side_slip: Vector3::new(0.0, 0.0, 0.0),
        rolled: 0.0,
        slipped: 0.0,
    };
}

/// Readings of the wheels at one instant, or at many, row after row.
#[derive(Clone, Copy, Debug)]
pub struct Readings<T> {
    /// Angles of the steered wheels [rad].
    pub steering: T,
    /// Speeds of all wheels [rad/s]. NaN where a passive wheel has no encoder.
    pub speeds: T,
    /// Rates of the steered wheels [rad/s]; they matter to wheels with scrub or trail.
    pub steering_rates: Option<T>,
}

/// Readings of the wheels at one instant.
pub type Measured<'a> = Readings<&'a [f64]>;

impl Measured<'_> {
    /// True if every wheel has a reading.
    #[inline]
    pub fn is_complete(&self) -> bool {
        self.speeds.iter().all(|speed| !speed.is_nan())
    }
}
