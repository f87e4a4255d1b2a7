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

/// Constants of a planar chain, for kernels with a row in every lane.
#[derive(Clone, Debug)]
pub(crate) struct LaneConstants {
    pub motion: MotionConstants,
    /// Constants of the kernel for one row of traction; None for chains that it does not fit.
    pub two_link: Option<TwoLinkChain>,
}

impl Prepared {
    /// Constants of this chain.
    pub fn new(chain: &Chain) -> Self {
        let lanes = chain
            .is_planar()
            .then(|| LaneConstants { motion: MotionConstants::new(chain), two_link: TwoLinkChain::new(chain) });
        Self { lanes, offset: rest_offset(chain) }
    }
}
