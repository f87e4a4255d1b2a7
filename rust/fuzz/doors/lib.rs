//! The fuzzed functions: one of any bytes for every entry of the core.

pub mod bytes;
pub mod controller;
pub mod estimate;
pub mod odometry;
