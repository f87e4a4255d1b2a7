//! Registers of numbers on every level of instructions, and functions of them.

pub mod lanes;
pub mod level;
pub mod polynomials;
pub mod vector;
