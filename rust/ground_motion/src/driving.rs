//! Commands and measurements for the traction of many rows, and the places of its results.

/// From when on a wheel is taken to be off the ground: it moves across its link as no slope would push it.
#[derive(Clone, Copy, Debug)]
pub struct Lift {
    /// Steepest slope that wheels climb, against the link, at the commanded speed [rad].
    pub angle: f64,
    /// Slowest such motion that counts [m/s].
    pub speed: f64,
}

/// Tangent of the default.
const STEEPEST: f64 = 1.557_407_724_654_902_3;

impl Lift {
    /// The steepest slope as a ratio.
    pub(crate) fn slope(self) -> f64 {
        match self.angle {
            1.0 => STEEPEST,
            angle => angle.tan(),
        }
    }
}

impl Default for Lift {
    /// Slopes of 1 rad, from 1 cm/s on.
    fn default() -> Self {
        Self { angle: 1.0, speed: 0.01 }
    }
}

/// Commanded turning, one number or one per row.
#[derive(Clone, Copy, Debug)]
pub enum Turns<'a> {
    /// Yaw rate per speed [1/m].
    Curvature(&'a [f64]),
    /// Yaw rate [rad/s].
    YawRate(&'a [f64]),
}

/// Commanded and measured rates, row after row; all numbers are finite.
#[derive(Clone, Copy, Debug)]
pub struct Driving<'a> {
    /// Commanded forward speed of the body, one or one per row [m/s].
    pub speed: &'a [f64],
    /// Commanded turning.
    pub turning: Turns<'a>,
    /// Rates of the body about its axes [rad/s].
    pub angular_velocity: &'a [[f64; 3]],
    /// Free angles [rad].
    pub joints: &'a [f64],
    /// Their rates [rad/s].
    pub joint_rates: &'a [f64],
    /// Present steering angles [rad].
    pub steering: Option<&'a [f64]>,
    /// Measured speeds of the wheels [rad/s].
    pub wheel_speeds: Option<&'a [f64]>,
    /// When a wheel is off the ground.
    pub lift: Lift,
}

/// Commands of the wheels, row after row.
#[derive(Debug)]
pub struct Drives<'a> {
    /// Of the steering joints [rad].
    pub steering: &'a mut [f64],
    /// Of the wheels [rad/s].
    pub speeds: &'a mut [f64],
    /// Of the wheels [rad].
    pub contact_angles: &'a mut [f64],
    /// Of the wheels.
    pub lifted: &'a mut [bool],
    /// One per row [m/s].
    pub vertical: &'a mut [f64],
}
