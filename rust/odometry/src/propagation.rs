//! Propagation of errors through a step, in every lane.

pub(crate) mod arc;
pub(crate) mod covariance;
pub(crate) mod fusion;
pub mod pose_gain;
