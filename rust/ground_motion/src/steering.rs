//! Angles of steered wheels on the ground, and without a map of it.

pub(crate) mod joint_angle;
pub(crate) mod search;
pub(crate) mod side_slip;
