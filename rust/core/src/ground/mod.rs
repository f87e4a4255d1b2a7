//! Rovers on ground: where a chain settles on a grid of heights.
//!
//! Rooms: [`circle`] and [`rim`] (where one wheel meets the ground), [`circles`], [`search`] and [`rims`] (the same for
//! eight at once), [`plan`], [`look`] and [`batch`] (many poses at once), [`touch`] (all wheels of a chain), [`newton`] (closing the
//! gaps), [`growth`] (where that finds nothing), [`stops`] (joints at their stops, wheels in the air), [`settle`] (the answer, with its status), [`stand`]
//! (the answer as plain numbers, and batches), [`derivatives`] (of the answer, by the pose and by dimensions).

mod batch;
mod circle;
mod circles;
mod derivatives;
mod growth;
mod look;
mod newton;
mod plan;
mod rim;
mod rims;
mod search;
mod settle;
mod stand;
mod stops;
mod touch;

pub use derivatives::{DIMENSIONS, by_dimension, by_pose, gap_slopes, shift_by_dimension};
pub use rim::{Minimum, Rim};
pub use settle::{Settled, Settler, Status};
pub(crate) use stand::{CONTACT, NUMBERS, settle_part, worth_lanes};
pub use stand::{Contact, Stand, rim_point, settle};
pub use touch::{Touch, Touches};
