//! Kernels over whole registers of rows, one file per quantity, the same for every level.

pub(crate) mod admissible;
pub mod cone;
pub mod direction_votes;
pub mod fit;
pub(crate) mod forward;
pub mod inverse;
pub(crate) mod projection;
pub mod readings;
pub(crate) mod robust;
pub mod safe_range;
pub mod se2;
pub(crate) mod sensitivity;
pub mod steered_constants;
pub mod steered_wheel;

#[cfg(test)]
mod tests;
