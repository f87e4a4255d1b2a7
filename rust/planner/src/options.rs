//! Options of a planner.

use super::cost::Weights;
use six_wheel_numerics::error::{Error, finite, not_negative, positive};

/// Largest number of steps and of rollouts.
const MOST: usize = 1 << 24;

/// Precision of the rollouts' numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// `f32`.
    Single,
    /// `f64`.
    #[default]
    Double,
}

/// Options of a planner.
#[derive(Clone, Debug)]
pub struct Options {
    /// Steps of a rollout, and their duration [s].
    pub horizon: usize,
    /// See `horizon`.
    pub dt: f64,
    /// Rollouts of a cycle.
    pub samples: usize,
    /// Seed of the noise.
    pub seed: u64,
    /// Standard deviation of the controls' noise [m/s, m/s, rad/s]; half the limits where there are some, if not given.
    pub noise: Option<[f64; 3]>,
    /// Time in which the correlation of the noise falls to 1/e [s].
    pub correlation: f64,
    /// Temperature of the rollouts' weights `exp(-cost / temperature)`, in units of cost.
    pub temperature: f64,
    /// Weights of the costs.
    pub weights: Weights,
    /// True if the new mean is smoothed, by a quadratic over five steps.
    pub smoothing: bool,
    /// Dead time from a command to its effect [s].
    pub delay: f64,
    /// Precision of the rollouts.
    pub precision: Precision,
    /// Points of the body where the map is read [m].
    pub footprint: Vec<[f64; 2]>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            horizon: 56,
            dt: 0.05,
            samples: 2000,
            seed: 0,
            noise: None,
            correlation: 0.5,
            temperature: 1.0,
            weights: Weights::default(),
            smoothing: true,
            delay: 0.0,
            precision: Precision::Double,
            footprint: vec![[0.0; 2]],
        }
    }
}

impl Options {
    pub(crate) fn check(&self) -> Result<(), Error> {
        for (name, count) in [("horizon", self.horizon), ("samples", self.samples)] {
            if count == 0 || count > MOST {
                return Err(Error::value(name, format!("be 1 to {MOST}"), count.to_string()));
            }
        }
        if self.horizon.saturating_mul(self.samples) > MOST << 4 {
            let rule = format!("make {} rollout steps at most", MOST << 4);
            return Err(Error::value(
                "horizon * samples",
                rule,
                (self.horizon as u128 * self.samples as u128).to_string(),
            ));
        }
        positive("dt", self.dt)?;
        positive("temperature", self.temperature)?;
        not_negative("correlation", self.correlation)?;
        not_negative("delay", self.delay)?;
        for (name, weight) in Weights::NAMES.into_iter().zip(self.weights.values()) {
            not_negative(name, weight)?;
        }
        for deviation in self.noise.unwrap_or_default() {
            not_negative("sampling_std", deviation)?;
        }
        if self.footprint.is_empty() || self.footprint.len() > 64 {
            let got = self.footprint.len().to_string();
            return Err(Error::value("footprint", "hold 1 to 64 points", got));
        }
        finite("footprint", self.footprint.as_flattened())
    }

    /// Number of steps whose controls are already sent.
    pub(crate) fn fixed(&self) -> usize {
        // A command that takes effect within the first step can still be changed.
        ((self.delay / self.dt).round() as usize).min(self.horizon - 1)
    }
}
