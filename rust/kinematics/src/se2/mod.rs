//! SE(2), the group of planar motions: maps between twists and poses, angles of any size, and compensated sums of
//! poses.

pub(crate) mod accumulate;
pub mod angles;
pub mod maps;
