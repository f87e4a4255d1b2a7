//! Rovers on ground: where a chain settles on a grid of heights.
//!
//! [`rims`] (the least gap of wheels), [`batch`] (a pose in every lane), [`touch`] (all wheels of one chain), [`newton`] (closing
//! the gaps), [`growth`] (where that finds nothing), [`stops`] (joints at their stops, wheels in the air), [`settle`] (the answer,
//! with its status), [`stand`] (the answer as numbers), [`rows`] (many poses), [`derivatives`] (of the answer, by the pose
//! and by dimensions).

mod batch;
mod derivatives;
mod growth;
mod newton;
mod rims;
mod rows;
mod settle;
mod settler;
mod stand;
mod stops;
mod touch;

pub use derivatives::{DIMENSIONS, by_dimension, by_pose, shift_by_dimension};
pub use rims::contact::{Minimum, RimContact};
pub use rows::settle;
pub(crate) use rows::{settle_part, worth_lanes};
pub use settler::{Settled, Settler, Status};
pub use stand::{CONTACT, NUMBERS};
pub use stand::{Contact, Stand, rim_point};
pub use touch::{WheelContact, WheelContacts, gap_slopes};
