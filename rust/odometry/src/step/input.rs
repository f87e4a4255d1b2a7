//! Input and output of a step.

use crate::settings::Settings;
use crate::state::State;

/// Rotations of the wheels in a step.
#[derive(Clone, Copy, Debug)]
pub(crate) enum WheelInput<'a> {
    /// Running totals of wheels and joints at both ends, and the angles of the joints at the start [rad].
    Totals { wheels: [&'a [f64]; 2], steering: [&'a [f64]; 2], angles: &'a [f64] },
    /// Rotations of the wheels, and the angles of the joints at both ends [rad].
    Rotations { turned: &'a [f64], steering: [&'a [f64]; 2] },
    /// Rotations whose displacement [`WheelFit::solve`] has fitted.
    Fitted,
}

/// Input of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepInput<'a> {
    pub settings: &'a Settings,
    pub wheels: WheelInput<'a>,
    /// Duration [s].
    pub dt: f64,
    /// True if rotations are means of rates at both ends, whose errors the neighbouring steps share.
    pub from_rates: bool,
    /// Yaw increment of a gyroscope, less that by its bias [rad].
    pub gyro_turn: Option<f64>,
    /// Variance of that bias [rad²/s²].
    pub bias_variance: f64,
    /// Bound of the displacement and its variances.
    pub bound: f64,
}

/// Output of a step. Nothing but the angles changes where it fails.
#[derive(Debug)]
pub(crate) struct StepOutput<'a> {
    /// Steering angles at the end, of [`WheelInput::Totals`] [rad].
    pub angles: &'a mut [f64],
    /// Speed at which each contact slid [m/s]; may be empty.
    pub residual: &'a mut [f64],
    /// The state to be propagated; None: it is not.
    pub state: Option<&'a mut State>,
}
