//! Motion on the ground for many rows, with a row in every lane but for slip.
//!
//! In lanes it is the same mathematics as one row of [`Contacts::forward`](super::Contacts::forward),
//! [`super::inverse`] and [`super::traction`], which stay what these are compared with. Where a lane is not as plain as most (it steers past
//! its range, rests, divides by almost nothing) that row goes the plain way.

mod columns;
mod forward;
mod inverse;
mod least_squares;
mod prepared;
mod run;
mod settled_poses;
mod slip;
mod steering;
mod suspension_rates;
mod traction;
mod two_link_chain;

pub use forward::{Movings, ReadingRows, forward_rows};
pub use inverse::{Commands, inverse_rows};
pub use prepared::Prepared;
pub use settled_poses::{SettledPoseInput, SettledPoses};
pub use slip::{Slips, slip_rows};
pub use traction::traction_rows;
