//! Registers of numbers on every level of instructions, and functions of them.

pub mod float;
pub mod lanes;
pub mod level;
pub mod polynomials;
pub mod vec3;
pub mod vector;
