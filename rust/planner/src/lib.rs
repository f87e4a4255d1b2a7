//! A sampling planner's whole cycle: noise, controls, rollouts within a rover's limits, costs, weights, new mean.
//!
//! A rover and its limits are half-spaces and quadratic forms (`motion/limits`). With these, rollouts are simulated
//! (`motion/drive`) and their costs added up (`cost`), a block at a time, by the same operations in the same order at
//! every level, number of threads and position in the batch (`kernels`, `engine`). All state of a planner is in
//! [`State`]. A cycle (`mppi`) begins in `prepare` and ends in `update_mean`.
//!
//! Source: G. Williams et al., Information-theoretic model predictive control, IEEE T-RO 34(6), 2018; E. Trevisan &
//! J. Alonso-Mora, Biased-MPPI, IEEE RA-L 9(6), 2024, for the constant controls among the samples.

#[macro_use]
extern crate six_wheel_numerics;

mod cost;
mod costmap;
mod cycle;
mod engine;
mod kernels;
mod motion;
mod mppi;
mod numbers;
mod options;
mod prepare;
mod rollout;
mod rollout_cost;
mod smooth;
mod update_mean;

pub use cost::Weights;
pub use costmap::Costmap;
pub use cycle::{CycleInput, CycleOutput, State};
pub use motion::limits::ImmobileReason;
pub use mppi::Mppi;
pub use options::{Options, Precision};
pub use rollout::{Present, rollout};
pub use rollout_cost::{Costs, rollout_cost};
