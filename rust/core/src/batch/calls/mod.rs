//! The calls: they share the rows out, check them before the first one is written, and choose the kernel.

pub(crate) mod poses;
pub(crate) mod rows;
