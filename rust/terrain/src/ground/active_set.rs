//! The active set of joints and wheels, which determines the gaps to be closed, and the tolerance of a closed gap.

use crate::suspension::{MAX_FREE, State};

/// A gap is closed if it is at most the first number [m] plus the second times the height of the body: the rounding of
/// heights.
pub(crate) const CLOSED_GAP: [f64; 2] = [2e-12, 2e-15];

/// The active set: joints held at an angle, and wheels in the air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ActiveSet {
    /// Angles of the joints that are held.
    pub joints: [Option<f64>; MAX_FREE],
    /// Bits of the wheels in the air.
    pub hanging: u32,
}

impl ActiveSet {
    /// No joint held, no wheel in the air.
    pub const NONE: Self = Self { joints: [None; MAX_FREE], hanging: 0 };

    /// True if a wheel touches.
    #[inline]
    pub fn touches(&self, wheel: usize) -> bool {
        self.hanging >> wheel & 1 == 0
    }

    /// Indices of the numbers of a state, of `count`, that are not held, in their order.
    pub fn free_columns(&self, count: usize) -> impl Iterator<Item = usize> {
        let joints = self.joints;
        (0..count).filter(move |&k| k < 3 || joints[k - 3].is_none())
    }

    /// The state with the held joints at their angles.
    pub fn held(&self, mut state: State) -> State {
        for (angle, held) in state[3..].iter_mut().zip(self.joints) {
            *angle = held.unwrap_or(*angle);
        }
        state
    }
}
