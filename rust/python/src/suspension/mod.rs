//! `six_wheel.Suspension` and `six_wheel.RockerBogie`: suspensions as data, and what follows from joint angles alone.

mod base;
mod bounds;
mod chain;
mod presets;
mod rocker_bogie;
mod steer;

pub use base::Suspension;
pub use bounds::{PoseBounds, check_map_error};
pub use chain::Joints;
pub use rocker_bogie::{Link, RockerBogie};
pub use steer::SteeringCommand;
