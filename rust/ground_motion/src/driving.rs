//! Commands and measurements for the traction of many rows, and the arrays of its results.

/// Thresholds above which a wheel counts as off the ground: its centre moves across its link faster than on any slope
/// that wheels climb.
#[derive(Clone, Copy, Debug)]
pub struct Lift {
    /// Steepest slope that wheels climb, against the link, at the commanded speed [rad].
    pub angle: f64,
    /// Least velocity across the link that counts [m/s].
    pub speed: f64,
}

/// Tangent of the default angle of 1 rad.
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
    /// Commanded curvature or yaw rate.
    pub turning: Turns<'a>,
    /// Angular velocity of the body in its axes [rad/s].
    pub angular_velocity: &'a [[f64; 3]],
    /// Free angles [rad].
    pub joints: &'a [f64],
    /// Rates of the free angles [rad/s].
    pub joint_rates: &'a [f64],
    /// Present steering angles [rad].
    pub steering: Option<&'a [f64]>,
    /// Measured speeds of the wheels [rad/s].
    pub wheel_speeds: Option<&'a [f64]>,
    /// Thresholds above which a wheel counts as off the ground.
    pub lift: Lift,
}

/// Commands of the wheels, row after row.
#[derive(Debug)]
pub struct Drives<'a> {
    /// Angles of the steering joints [rad].
    pub steering: &'a mut [f64],
    /// Speeds of the wheels [rad/s].
    pub speeds: &'a mut [f64],
    /// Contact angles of the wheels [rad].
    pub contact_angles: &'a mut [f64],
    /// True for wheels that count as off the ground.
    pub lifted: &'a mut [bool],
    /// Vertical speed of the body, one per row [m/s].
    pub vertical: &'a mut [f64],
}
