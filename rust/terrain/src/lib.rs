//! Rovers on ground: heights of a grid, suspensions, settled poses, bounds of them and stability.

#[macro_use]
extern crate six_wheel_numerics;

pub mod bounds;
pub mod ground;
pub mod heights;
mod interval;
pub mod pyramid;
pub mod suspension;
pub mod terrain;

pub use suspension::{Chain, RockerBogie};
pub use terrain::Terrain;
