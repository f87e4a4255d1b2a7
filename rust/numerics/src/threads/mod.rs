//! Work shared between threads.

mod pool;
pub mod workers;
