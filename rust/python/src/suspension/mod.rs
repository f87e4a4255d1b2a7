//! `six_wheel.Suspension` and `six_wheel.RockerBogie`: suspensions as data, and what follows from joint angles alone.

mod base;
mod bounds;
mod chain;
mod presets;
mod rocker_bogie;
mod steer;

pub use base::Suspension;
pub use bounds::{Plate, PoseBounds, check_map_error, read_belly};
pub use chain::rocker_and_bogies;
pub use rocker_bogie::{Link, RockerBogie};
pub use steer::SteeringCommand;
