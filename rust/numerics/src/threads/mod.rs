//! Work shared between threads.

mod crew;
pub mod workers;
