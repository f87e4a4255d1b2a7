//! The place where shapes, dtypes and memory order meet: Python objects in, slices of `f64` out, and back.

mod array;
mod broadcast;
mod compute;
mod errors;
mod input;
pub mod memory;
mod numpy_module;
mod out;
mod output;
mod pool;
mod scalars;
mod strided;

pub use array::{items, name, number, read_array, singles};
pub use broadcast::{Broadcast, Named, given, joined, joint, named, rows_over, together};
pub use compute::{batches_at_work, compute, compute_rows, forget_other_threads};
pub use errors::{
    OrRaise, choice, is_interrupted, is_of_another_kind, one_row, one_twist, one_twist_first, raise, refuse,
    refuse_shape, refuse_type, shape_text, short_repr,
};
pub use input::{Blocks, Rows, numbers, read_point};
pub use numpy_module::{AnyArray, Array, is_ready, ready};
pub use out::{Out, Results, out_tuple};
pub use output::{Output, OutputOptions, Precision, scalar_or_array};
pub use scalars::Scalars;
