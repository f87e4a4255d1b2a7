//! The motion of a rollout: limits of a rover as half-spaces and quadratic forms, and steps within them.

mod direction_gaps;
#[allow(clippy::needless_range_loop)] // components of several motions side by side
pub(crate) mod drive;
#[allow(clippy::needless_range_loop)] // likewise
pub(crate) mod joints;
pub mod limits;
pub(crate) mod model;
pub(crate) mod steered_joint;
pub(crate) mod steering_setpoint;
