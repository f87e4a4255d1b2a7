//! The calls: they share the rows out, check them before the first one is written, and choose the kernel.

pub(crate) mod maps;
pub(crate) mod poses;
pub(crate) mod rows;
pub(crate) mod single;
pub(crate) mod singly;
pub(crate) mod twists;

/// Rows that are read, or checked and written, at a time where that is not done for all rows at once: their
/// numbers stay in the second-level cache.
const BLOCK_ROWS: usize = 2048;
