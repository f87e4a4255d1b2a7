//! Motion on the ground for many rows, with a row in every lane but for slip.
//!
//! In lanes it is the same mathematics as one row of [`Contacts::forward`](super::Contacts::forward),
//! [`super::inverse`] and [`super::traction`], which stay what these are compared with. Where a lane is not as plain as most (it steers past
//! its range, rests, divides by almost nothing) that row goes the plain way.

mod aim;
mod columns;
mod follow;
mod footings;
mod forward;
mod instant;
mod inverse;
mod prepared;
mod run;
mod slip;
mod solve;
mod traction;

pub use footings::{SettledPoseInput, SettledPoses};
pub use forward::{Movings, ReadingRows, forward_rows};
pub use inverse::{Commands, inverse_rows};
pub use prepared::Prepared;
pub use slip::{Slips, slip_rows};
pub use traction::traction_rows;
