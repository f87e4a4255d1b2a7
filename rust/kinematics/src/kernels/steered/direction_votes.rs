//! Direction ties: wheels whose two solutions are about equally near roll the same way.
//!
//! They keep their own solutions if these have the same direction and the sum of their present speeds is 0. Otherwise
//! the sign of that sum is their direction, or where it is 0 the direction with the smaller sum of steering increments.

use pulp::Simd;

use crate::steering::ANGLE_TOLERANCE;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};

/// Lanes in which wheels of a tie have a common direction, and lanes in which that is backwards.
pub type CommonDirection<S> = Option<[Mask<S>; 2]>;

/// Two solutions of a wheel that are about equally near.
#[derive(Clone, Copy)]
pub struct DirectionTie<S: Simd> {
    /// True where both solutions are inside the range and about equally near.
    pub is_tie: Mask<S>,
    /// True where the wheel's own solution is backwards.
    pub is_backwards: Mask<S>,
    /// Difference of the steering increments, forwards less backwards [rad].
    pub lead: Lanes<S>,
}

/// Sums over the wheels of a direction tie.
#[derive(Clone, Copy)]
pub struct DirectionVotes<S: Simd> {
    /// Number of wheels whose own solution is forwards.
    pub forwards: Lanes<S>,
    /// Number of wheels whose own solution is backwards.
    pub backwards: Lanes<S>,
    /// Sum of the differences of the steering increments, forwards less backwards [rad].
    pub lead: Lanes<S>,
    /// Sum of the present speeds [rad/s].
    pub speed: Lanes<S>,
}

#[inline_always]
impl<S: Simd> DirectionVotes<S> {
    /// No wheels.
    pub fn none(simd: S) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        Self { forwards: zero, backwards: zero, lead: zero, speed: zero }
    }

    /// The votes with one more wheel and its present speed [rad/s].
    #[must_use]
    pub fn with(self, tie: &DirectionTie<S>, speed: Lanes<S>) -> Self {
        let simd = speed.simd();
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let counted = |mask: Mask<S>, number: Lanes<S>| mask.select(number, zero);
        Self {
            forwards: self.forwards + counted(tie.is_tie & !tie.is_backwards, one),
            backwards: self.backwards + counted(tie.is_tie & tie.is_backwards, one),
            lead: self.lead + counted(tie.is_tie, tie.lead),
            speed: self.speed + counted(tie.is_tie, speed),
        }
    }

    /// Lanes with a common direction, and lanes in which it is backwards.
    pub fn common_direction(&self, simd: S) -> [Mask<S>; 2] {
        let zero = Lanes::splat(simd, 0.0);
        let is_rolling = zero.lt(self.speed.abs());
        let differ = zero.lt(self.forwards * self.backwards);
        let is_shorter = Lanes::splat(simd, ANGLE_TOLERANCE).lt(self.lead);
        let to_back = (is_rolling & self.speed.lt(zero)) | (!is_rolling & is_shorter);
        [is_rolling | differ, to_back]
    }
}
