//! Constants of a chain, made once for all calls.

use super::two_link_chain::TwoLinkChain;
use crate::contact::rest_offset;
use crate::rates::constants::MotionConstants;
use six_wheel_terrain::suspension::Chain;

/// Constants of a chain for the motion on the ground and for traction.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// None for chains that are not planar: [`Chain::is_planar`].
    pub(crate) lanes: Option<LaneConstants>,
    /// [`rest_offset`] [m].
    pub offset: f64,
}

/// Constants of a chain whose rows go into lanes.
#[derive(Clone, Debug)]
pub(crate) struct LaneConstants {
    pub motion: MotionConstants,
    /// For one row of traction.
    pub two_link: Option<TwoLinkChain>,
}

impl Prepared {
    /// Of this chain.
    pub fn new(chain: &Chain) -> Self {
        let lanes = chain
            .is_planar()
            .then(|| LaneConstants { motion: MotionConstants::new(chain), two_link: TwoLinkChain::new(chain) });
        Self { lanes, offset: rest_offset(chain) }
    }
}
