//! Numbers in registers, small matrices, threads and errors, on which every formula of six_wheel is built. Nothing here
//! depends on a rover.
//!
//! [`simd`] holds registers of every instruction set and their functions, [`columns`] and [`stream`] the transfer
//! between rows in memory and columns of registers, [`threads`] the division of a batch between threads.

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
