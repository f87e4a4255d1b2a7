//! Kernels over whole registers of rows, one file per quantity, the same for every level.

pub(crate) mod admissible;
pub(crate) mod choice;
pub mod cone;
pub mod fit;
pub(crate) mod forward;
pub mod inverse;
pub mod readings;
pub(crate) mod robust;
pub mod se2;
pub(crate) mod sensitivity;
pub mod steered;
pub mod usual;

#[cfg(test)]
mod tests;
