//! The constants of a chain for rows of motions.

use super::least_squares::Square;
use super::two_link_chain::Instant;
use crate::contact::rest_offset;
use six_wheel_terrain::suspension::Chain;
use six_wheel_terrain::suspension::lanes::ChainConstants;

/// The constants of a chain.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// None for chains that are not for lanes.
    pub(crate) plan: Option<ChainConstants>,
    pub(crate) square: Option<Square>,
    pub(crate) instant: Option<Instant>,
    /// [`rest_offset`] [m].
    pub offset: f64,
}

impl Prepared {
    /// Of this chain.
    pub fn new(chain: &Chain) -> Self {
        let plan = ChainConstants::new(chain);
        Self {
            square: plan.as_ref().and_then(Square::new),
            instant: plan.as_ref().and_then(|plan| Instant::new(chain, plan)),
            plan,
            offset: rest_offset(chain),
        }
    }
}
