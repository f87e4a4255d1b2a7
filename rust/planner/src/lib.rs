//! A sampling planner's whole cycle: noise, wishes, rollouts within a rover's limits, costs, weights, new mean.
//!
//! From a rover and its limits follow a few numbers ([`facts`]); with them rollouts are driven ([`drive`]) and judged
//! ([`cost`]), a block at a time, by the same operations in the same order whatever the level, the number of
//! threads and the place in the batch ([`engine`]). All state of a planner is in
//! [`State`]. A cycle ([`mppi`]) begins in [`prepare`] and ends in [`conclude`].
//!
//! Source: G. Williams et al., Information-theoretic model predictive control, IEEE T-RO 34(6), 2018; E. Trevisan &
//! J. Alonso-Mora, Biased-MPPI, IEEE RA-L 9(6), 2024, for samples that are no noise.

mod conclude;
mod cost;
mod costmap;
mod cycle;
mod engine;
mod motion;
mod mppi;
mod numbers;
mod options;
mod prepare;
mod rollout;
mod rollout_cost;
mod smooth;

pub use cost::Weights;
pub use costmap::Costmap;
pub use cycle::{Outcome, Situation, State};
pub use motion::limits::Stuck;
pub use mppi::Mppi;
pub use options::{Options, Precision};
pub use rollout::{Present, rollout};
pub use rollout_cost::{Costs, rollout_cost};
