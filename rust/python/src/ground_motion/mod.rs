//! Motion of a suspension on the ground it stands on: `inverse`, `forward`, `slip`, and `traction` without a map.

mod fastcall;
mod motion;
mod results;
mod settled_pose_input;
mod slip;
mod traction;

pub use fastcall::install;
pub use results::{GroundCommand, GroundMotion};
pub use slip::{BodySlip, WheelSlip, body_slip};
pub use traction::Traction;
