//! Propagation of errors through a step, in every lane.

pub mod arc;
pub mod covariance;
pub(crate) mod fusion;
pub mod pose_gain;
