//! Rows in lanes: loads, stores, angles, and settled poses.

pub(crate) mod columns;
pub(crate) mod pose_lanes;
pub(crate) mod settled_poses;
