//! The plane: maps between twists and poses, angles of any size, and sums of poses that keep their digits.

pub(crate) mod accumulate;
pub mod angles;
pub(crate) mod maps;
