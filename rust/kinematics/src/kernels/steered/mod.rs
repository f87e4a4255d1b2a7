//! Wheels that turn about their pivots: constants, the wheel equation solved, and ties of directions.

pub mod constants;
pub mod direction_votes;
pub mod wheel;
