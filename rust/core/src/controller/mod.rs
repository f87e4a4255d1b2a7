//! From a wanted twist to joint commands, one step at a time, within limits.

mod limits;

pub use limits::Limits;
