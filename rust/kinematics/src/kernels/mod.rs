//! Kernels over whole registers of rows, one file per quantity, the same for every level.

pub mod fit;
pub(crate) mod fit_row;
pub(crate) mod forward;
pub(crate) mod forward_row;
pub mod normal_equations;
pub(crate) mod readings;
pub(crate) mod robust;
pub mod safe_range;
pub(crate) mod sensitivity;
pub mod steered;
pub mod wheel_lanes;
pub(crate) mod wheel_rows;
