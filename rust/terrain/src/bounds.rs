//! Bounds of the settled pose of a rocker-bogie, without settling it: from the lowest and highest ground under each
//! wheel.
//!
//! After ACE (K. Otsu, G. Matheron, S. Ghosh, O. Toupet, M. Ono, Fast approximate clearance evaluation for rovers with
//! articulated suspension systems, Journal of Field Robotics 37(5), 2020, arXiv 1808.00031), with the closed form of
//! `side` in place of the published one. The height of a wheel's centre is between the lowest and the highest ground
//! under its box, plus `r cos(g)`: the ground below its lowest point and the contact are in that box. From the
//! intervals of six heights follow those of the inclination `g`, by contraction of `tan(g) = (E_left - E_right) / (2
//! y)`, of both rockers and bogies, and of all other quantities.
//!
//! The boxes hold the wheels while the angles are inside [`TiltLimits`]. Where the bounds exceed these, where a corner
//! of the heights has no solution or is not proved to be extreme, the result is a [`BoundStatus`] and no interval.

mod belly;
mod boxes;
mod feasible;
mod kernel;
mod margins;
mod plan;
mod side;
mod stability;
mod stand;

pub use crate::pyramid::Pyramid;
pub use belly::Belly;
pub use boxes::TiltLimits;
pub use feasible::{Allowed, Judge, Reason, Verdict};
pub use kernel::{Ground, Margins, bounds};
pub use margins::{MarginSlopes, margins_by_dimension, margins_by_pose};
pub use plan::{BoundStatus, BoundsConstants, QUANTITIES};
pub use stability::{joint_margins, loads, tilt, tip_over_angle, wheel_drop};
