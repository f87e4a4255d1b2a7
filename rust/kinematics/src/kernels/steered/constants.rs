//! Constants of wheels that turn about their pivots: as numbers, and in every lane.

use std::f64::consts::PI;

use pulp::Simd;

use crate::geometry::Direction;
use crate::rover_data::Mount;
use crate::steering::SteeringRange;
use crate::wheels::Wheel;
use six_wheel_numerics::simd::lanes::Lanes;

/// Steering increment up to which the first solution is nearer than the other one by more than that of a direction tie [rad].
pub const MAX_NEAR_INCREMENT: f64 = 84.0 * PI / 180.0;

/// A range narrower than half a turn by more than this holds at most one solution [rad].
const HALF_TURN_MARGIN: f64 = 1e-6;

/// Overshoot of an end of the range up to which the contact slides by at most half of the tolerance of side slip [rad].
pub const SAFE_OVERSHOOT: f64 = 5e-10;

/// Constants of a wheel that turns about its pivot.
#[derive(Clone, Copy, Debug)]
pub struct SteeredConstants {
    /// Pivot, forward [m].
    pub x: f64,
    /// Pivot, to the left [m].
    pub y: f64,
    /// Direction at steering angle 0.
    pub heading: Direction,
    /// Range of the steering angle [rad].
    pub range: SteeringRange,
    /// Directions of the lower and the upper end of the range; NaN where it is endless.
    pub ends: [Direction; 2],
    /// Contact to the left of the steering axis [m].
    pub scrub: f64,
    /// Contact behind the steering axis [m].
    pub trail: f64,
    /// True if the heading is not straight ahead.
    pub is_turned: bool,
    /// True if the range holds at most one solution.
    pub is_narrow: bool,
}

impl SteeredConstants {
    /// None for a fixed wheel.
    pub fn new(wheel: &Wheel, mount: Mount) -> Option<Self> {
        let (range, heading) = match mount {
            Mount::Steered(range, heading) => (range, heading),
            Mount::Castor(heading) => (SteeringRange::WHOLE_TURN, heading),
            Mount::Fixed(_) => return None,
        };
        Some(Self {
            x: wheel.x,
            y: wheel.y,
            heading,
            range,
            ends: [range.lower, range.upper].map(Direction::from),
            scrub: wheel.scrub,
            trail: wheel.trail,
            is_turned: wheel.heading != 0.0,
            is_narrow: range.upper - range.lower < PI - HALF_TURN_MARGIN,
        })
    }

    /// Interval of angles whose second solution is outside the range, whatever the present angle is [rad].
    pub fn single_range(&self) -> [f64; 2] {
        let SteeringRange { lower, upper } = self.range;
        if self.is_narrow {
            return [lower - SAFE_OVERSHOOT, upper + SAFE_OVERSHOOT];
        }
        [lower.max(upper - PI + HALF_TURN_MARGIN), upper.min(lower + PI - HALF_TURN_MARGIN)]
    }

    /// Interval of angles whose second solution is outside the range, or farther from the present angle 0 and in no tie
    /// [rad].
    pub fn near_range(&self) -> [f64; 2] {
        let SteeringRange { lower, upper } = self.range;
        let held = self.range.clip(0.0);
        let near = [lower.max(held - MAX_NEAR_INCREMENT), upper.min(held + MAX_NEAR_INCREMENT)];
        let single = self.single_range();
        if single[1] - single[0] > near[1] - near[0] { single } else { near }
    }

    /// The constants of this wheel in every lane.
    #[inline(always)]
    pub fn broadcast<S: Simd>(&self, simd: S) -> SteeredWheel<S> {
        let splat = |number| Lanes::splat(simd, number);
        SteeredWheel {
            pivot: [splat(self.x), splat(self.y)],
            heading: [splat(self.heading.sin), splat(self.heading.cos)],
            range: [splat(self.range.lower), splat(self.range.upper)],
            single_range: self.single_range().map(splat),
            near_range: self.near_range().map(splat),
            scrub: splat(self.scrub),
            trail: splat(self.trail),
            features: Features {
                is_turned: self.is_turned,
                is_narrow: self.is_narrow,
                has_scrub: self.scrub != 0.0,
                has_trail: self.trail != 0.0,
            },
        }
    }
}

/// Terms of the wheel equation that some lane needs; the results of other lanes are the same bits with and without
/// them.
#[derive(Clone, Copy, Debug, Default)]
pub struct Features {
    /// True if a heading is not straight ahead.
    pub is_turned: bool,
    /// True if a range holds at most one solution.
    pub is_narrow: bool,
    /// True if a contact is beside its steering axis.
    pub has_scrub: bool,
    /// True if a contact is behind its steering axis.
    pub has_trail: bool,
}

/// Constants of a wheel that turns about its pivot, in every lane: of one wheel, or of as many as there are lanes.
#[derive(Clone, Copy)]
pub struct SteeredWheel<S: Simd> {
    /// Pivot, forward and to the left of the body's origin [m].
    pub pivot: [Lanes<S>; 2],
    /// Sine and cosine of the direction at steering angle 0.
    pub heading: [Lanes<S>; 2],
    /// Ends of the range [rad].
    pub range: [Lanes<S>; 2],
    /// See [`SteeredConstants::single_range`].
    pub single_range: [Lanes<S>; 2],
    /// See [`SteeredConstants::near_range`].
    pub near_range: [Lanes<S>; 2],
    /// Contact to the left of the steering axis [m].
    pub scrub: Lanes<S>,
    /// Contact behind the steering axis [m].
    pub trail: Lanes<S>,
    /// Terms that some lane needs.
    pub features: Features,
}
