//! One row at a time: the lanes of a register are the wheels.

pub(crate) mod forward;
