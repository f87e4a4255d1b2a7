//! The blocks in which the calls of a batch take their rows.

/// Rows that are read, or checked and written, at a time where that is not done for all rows at once: their
/// numbers stay in the second-level cache.
pub(crate) const BLOCK_ROWS: usize = 2048;
