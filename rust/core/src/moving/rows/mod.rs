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
mod run;
mod slip;
mod solve;
mod traction;

pub use footings::{Footings, Told};
pub use forward::{Movings, ReadingRows, forward_rows};
pub use inverse::{Commands, inverse_rows};
pub use slip::{Slips, slip_rows};
pub use traction::{Drives, Driving, Turns, traction_rows};

use self::instant::Instant;
use self::solve::Square;
use super::rest_offset;
use crate::suspension::Chain;
use crate::suspension::lanes::Plan;

/// What is known of a chain beforehand.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// None for chains that are not for lanes.
    plan: Option<Plan>,
    square: Option<Square>,
    instant: Option<Instant>,
    /// [`rest_offset`] [m].
    pub offset: f64,
}

impl Prepared {
    /// Of this chain.
    pub fn new(chain: &Chain) -> Self {
        let plan = Plan::new(chain);
        Self {
            square: plan.as_ref().and_then(Square::new),
            instant: plan.as_ref().and_then(|plan| Instant::new(chain, plan)),
            plan,
            offset: rest_offset(chain),
        }
    }
}
