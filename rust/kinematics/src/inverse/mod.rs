//! Inverse kinematics: constants of a rover, and the kernels of whole batches and of one row.

pub mod constants;
pub mod rows;
pub mod single;
