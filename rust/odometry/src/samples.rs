//! Samples of wheels and joints: one or all of a log, their increments, and those that were left out.

pub mod increments;
pub mod recording;
pub mod skipped_rows;
pub mod whole_logs;
