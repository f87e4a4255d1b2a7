//! Numbers in registers, small matrices, threads and errors: what every formula of six_wheel is made of.
//!
//! It knows no rover. [`simd`] holds registers of every instruction set and their functions, [`columns`] and [`stream`] the
//! way between rows in memory and columns of registers, [`threads`] the share of work of every thread.

#[macro_use]
extern crate six_wheel_inlining;

pub mod columns;
pub mod error;
pub mod jacobi;
pub mod least_squares;
pub mod names;
pub mod places;
pub mod simd;
pub mod sizes;
pub mod stream;
pub mod threads;

pub use six_wheel_inlining::inline_always;
