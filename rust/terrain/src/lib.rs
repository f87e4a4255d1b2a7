//! Rovers on ground: heights of a grid, suspensions, settled poses, bounds of them and stability.

pub mod bounds;
pub mod ground;
pub mod heights;
mod interval;
pub mod pyramid;
pub mod suspension;
pub mod terrain;

pub use suspension::{Chain, RockerBogie};
pub use terrain::Terrain;
