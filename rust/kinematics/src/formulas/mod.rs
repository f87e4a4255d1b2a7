//! What is computed, one file a job: kernels over whole registers of rows, the same for every level.

pub(crate) mod admissible;
pub(crate) mod choice;
pub(crate) mod cone;
pub(crate) mod fit;
pub(crate) mod forward;
pub(crate) mod integrate;
pub(crate) mod inverse;
pub(crate) mod logs;
pub(crate) mod maps;
pub(crate) mod readings;
pub(crate) mod robust;
pub(crate) mod rollout_cost;
pub(crate) mod sensitivity;
pub(crate) mod steered;
pub(crate) mod tile;
pub(crate) mod usual;
