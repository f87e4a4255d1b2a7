//! Arithmetic of rollouts: quadratic forms, and noise.

pub(crate) mod noise;
#[allow(clippy::needless_range_loop)] // components of several motions side by side
pub(crate) mod norms;
pub(crate) mod squares;

/// Rollouts of a block: as many as fill two of the widest registers.
pub(crate) const BLOCK: usize = 32;
