//! Rovers on ground: settled poses of a chain on a grid of heights.
//!
//! [`rims`] (the least gap of wheels), [`scan`] (all wheels of chains at their states), [`pivots`] (Newton's step),
//! [`round`] and [`batch`] (rounds of Newton's method, a pose in every lane or one alone), [`newton`] (with a line
//! search, for poses at which these do not converge), [`continuation`] (from flat ground, where a line search does not
//! converge), [`stops`] (joints at their stops, wheels in the air), [`settle`] (the settled pose with its status),
//! [`stand`] (the settled pose as numbers), [`rows`] (the calls), [`derivatives`] (of the settled pose, by the pose in
//! the plane and by dimensions).

mod active_set;
mod batch;
mod continuation;
mod derivatives;
mod linear_system;
mod newton;
pub mod rims;
mod rows;
mod settle;
mod settler;
mod stand;
mod stops;

use batch::{pivots, poses, scan};

pub use derivatives::{DIMENSIONS, by_dimension, by_pose, shift_by_dimension};
pub use rows::settle;
pub(crate) use rows::settle_part;
pub use settler::{Settler, Status};
pub use stand::{CONTACT, NUMBERS};
pub use stand::{Contact, Stand, rim_point};
