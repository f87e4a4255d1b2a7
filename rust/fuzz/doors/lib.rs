//! What is fuzzed: a function of any bytes for every door of the core.

pub mod bytes;
pub mod controller;
pub mod estimate;
pub mod odometry;
