//! The place where shapes, dtypes and memory order meet: Python objects in, slices of `f64` out, and back.

mod array;
mod blocks;
mod broadcast;
mod compute;
mod errors;
mod input;
pub mod memory;
mod numpy_module;
mod out;
mod output;
mod pool;
mod strided;

pub use array::{items, name, not_rectangular, number, pair, pair_or_one, read_array, singles};
pub use blocks::Blocks;
pub use broadcast::{Broadcast, joined, joint, rows_over, together};
pub use compute::{batches_at_work, compute, compute_rows, forget_other_threads};
pub use errors::{
    OrRaise, choice, is_interrupted, is_of_another_kind, one_row, one_twist, one_twist_first, raise, refuse,
    refuse_shape, refuse_type, shape_text, short_repr,
};
pub use input::{Name, Rows, numbers, read_point};
pub use numpy_module::{AnyArray, Array, is_ready, ready};
pub use out::{Out, Results};
pub use output::{Output, OutputOptions, Precision, scalar_or_array};
