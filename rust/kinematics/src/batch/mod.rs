//! Whole arrays at once: every row is checked before the first one is written.
//!
//! From an array to a register and back, for one batch:
//!
//! 1. A **call** (one file a kind, here) has rows of numbers as the caller keeps them (a [`Table`]), and [`Workers`]: a
//!    level and a number of threads. It cuts the rows into shares for the threads (`threads/workers.rs` in
//!    `six_wheel_numerics`), and those into blocks that stay in the caches.
//! 2. It takes the constants of the rover: the numbers that a formula needs of it.
//! 3. [`Level::run_any`] enters a function that is compiled once per set of instructions, with a token `S` that proves
//!    the processor has them. Everything below it is `#[inline(always)]`.
//! 4. A **kernel** ([`crate::kernels`], one file per quantity) splits 64 rows at a time into columns (`columns.rs`), one
//!    column per number of a row, so that a register holds the same number of 4 or 8 successive rows.
//! 5. It computes with `Lanes`, a register with the operators of a number (`simd/lanes.rs`), and functions of
//!    `simd/polynomials.rs`. There are no branches on a lane: a `Mask` selects, and a part of a formula that no lane of a
//!    register needs is left out where that changes no bit. So every level gives the same bits.
//! 6. The columns of the results are transposed to rows and stored, past the caches if the output is larger than these
//!    (`stream.rs`).
//! 7. Rows without all readings, with huge ones, or without a clear solution are solved each on its own, with their own
//!    equations (`kernels/fit_row.rs`).
//!
//! **One row** takes the same steps, but its lanes are the wheels, so nothing is transposed: the constants are loaded
//! from one array per number instead of being the same in every lane.

mod maps;
pub mod poses;
mod rows;
mod singly;
mod twists;

pub use crate::estimate::Readings;
pub use crate::kernels::fit::Fits;
pub use crate::table::{Durations, InputTables, Log, Source, Table};
pub use maps::{Map, differentiate, map};
pub use poses::integrate;
pub use rows::{forward, inverse};
pub use singly::{fill, fit, sensitivity};
pub use six_wheel_numerics::places::Places;
pub use six_wheel_numerics::simd::level::Level;
pub use six_wheel_numerics::threads::workers::Workers;
pub use twists::{admissible, project};

/// Rows at a time of arguments that have to be read, and of outputs that may be left half written: their numbers stay
/// in the second-level cache.
pub(crate) const BLOCK_ROWS: usize = 2048;
