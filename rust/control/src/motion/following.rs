//! The record of joints that do not follow their commands.

/// The steering joints as they were measured.
#[derive(Clone, Debug)]
pub struct Following {
    /// Measured angle minus last command [rad], if the last step was given measured angles.
    pub errors: Vec<f64>,
    pub measured: bool,
    /// Time for which a joint has been farther from its command than it may be [s]; none if it is not.
    pub beyond: Vec<Option<f64>>,
    /// Measured angle of a joint that is stuck [rad].
    pub holds: Vec<Option<f64>>,
    /// The joint that was found to be stuck.
    pub stuck: Option<usize>,
}

impl Following {
    /// Nothing is measured yet.
    pub fn new(joints: usize) -> Self {
        Self {
            errors: vec![0.0; joints],
            measured: false,
            beyond: vec![None; joints],
            holds: vec![None; joints],
            stuck: None,
        }
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.measured = false;
        self.beyond.fill(None);
        self.holds.fill(None);
        self.stuck = None;
    }
}
