//! Following errors of the steering joints over time.

/// Measurements of the steering joints against their commands.
#[derive(Clone, Debug, Default)]
pub struct Following {
    /// Measured angle less last command [rad]; valid if `measured`.
    pub errors: Vec<f64>,
    /// True if the last step was given measured angles.
    pub measured: bool,
    /// Time for which the error of a joint has exceeded its bound [s]; None if it does not.
    pub beyond: Vec<Option<f64>>,
    /// Measured angle of a joint that is stuck [rad].
    pub holds: Vec<Option<f64>>,
    /// The joint that was found to be stuck.
    pub stuck: Option<usize>,
}

impl Following {
    /// Nothing is measured yet.
    pub fn new(joints: usize) -> Self {
        Self { errors: vec![0.0; joints], beyond: vec![None; joints], holds: vec![None; joints], ..Self::default() }
    }

    /// Clears all measurements.
    pub fn clear(&mut self) {
        self.measured = false;
        self.beyond.fill(None);
        self.holds.fill(None);
        self.stuck = None;
    }
}
