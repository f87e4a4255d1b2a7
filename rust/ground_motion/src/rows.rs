//! Motion on the ground for many rows, with a row in every lane; one row of traction has its wheels in the lanes.

mod forward;
mod inverse;
mod prepared;
mod run;
mod slip;
mod traction;
mod two_link_chain;
mod wheel_command;

pub use forward::{BodyMotions, ReadingRows, forward_rows};
pub use inverse::{Commands, inverse_rows};
pub use prepared::Prepared;
pub use slip::{SlipInput, Slips, slip_rows};
pub use traction::traction_rows;
