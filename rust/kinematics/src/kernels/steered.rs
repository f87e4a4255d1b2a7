//! One steered wheel: the angle it takes without a second thought, through a block.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use pulp::Simd;

use crate::rover_data::Mount;
use crate::steering::{SteeringRange, UNDECIDED};
use crate::wheels::{Direction, REST, Wheel};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::polynomials::angle;
use six_wheel_numerics::weave::{BLOCK, Column};

/// Comparisons that rounding may turn are not sure within this [rad].
pub(crate) const CLOSE: f64 = 1e-9;

/// Angles this near to an end of the reach need a second thought where the other end may be as near [rad].
pub(crate) const NEAR_AN_END: f64 = 1e-8;

/// Angles beyond an end by no more than this slide by less than half the tolerance of the check: they are at the end [rad].
pub(crate) const AT_AN_END: f64 = 5e-10;

/// Up to here a wheel with more than half a turn of range goes forwards without asking the others [rad].
pub(crate) const DECIDED: f64 = 84.0 * PI / 180.0;

/// A range that goes further to both sides surely holds the nearer way of any motion [rad].
const WIDE: f64 = FRAC_PI_2 + 1e-6;

/// Choices that a wheel has: it has only one way, the nearer one of two is surely meant, or it may have to ask the
/// others.
pub(crate) const ONLY: u8 = 0;
pub(crate) const NEARER: u8 = 1;
pub(crate) const EITHER: u8 = 2;

/// The angles that need no thought.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    /// Two half planes `across * y < along * x` of the pivot's velocity.
    upper: [f64; 2],
    lower: [f64; 2],
    /// True where both ends of the range are equally far.
    pub symmetric: bool,
    /// True if the range is a quarter turn to either side at most.
    pub folded: bool,
    /// [`ONLY`], [`NEARER`] or [`EITHER`].
    pub ways: u8,
}

impl Reach {
    /// Nothing if the wheel cannot point straight ahead.
    pub fn new(range: SteeringRange) -> Option<Self> {
        if !(range.lower < 0.0 && range.upper > 0.0) {
            return None;
        }
        let quarter = SteeringRange::default();
        let folded = range.lower >= quarter.lower && range.upper <= quarter.upper;
        let end = |angle: f64| {
            let angle = if folded { angle } else { angle.min(DECIDED) };
            let (sin, cos) = angle.sin_cos();
            [sin - NEAR_AN_END, cos + NEAR_AN_END]
        };
        Some(Self {
            upper: end(range.upper),
            lower: end(-range.lower),
            symmetric: range.lower == -range.upper,
            folded,
            ways: if range.lower > quarter.lower + NEAR_AN_END && range.upper < quarter.upper - NEAR_AN_END {
                ONLY
            } else if range.lower < -WIDE && range.upper > WIDE {
                EITHER
            } else {
                NEARER
            },
        })
    }

    /// True if the direction of `(x, y)`, turned by half where `x < 0`, is inside by more than the margin [m/s].
    #[inline(always)]
    fn holds<S: Simd>(&self, simd: S, [x, y]: [Lanes<S>; 2], margin: Lanes<S>) -> Mask<S> {
        let (along, rise) = (x.abs(), y.abs());
        let inside = |[ahead, across]: [f64; 2]| {
            let bound = Lanes::splat(simd, ahead) * along;
            Lanes::splat(simd, across).mul_add(rise, margin).below(bound)
        };
        if self.symmetric {
            return inside(self.upper);
        }
        let left = y.flip(x.sign());
        let zero = Lanes::splat(simd, 0.0);
        let beside = |mask: Mask<S>, end| mask | inside(end);
        beside(left.below(zero), self.upper) & beside(zero.below(left), self.lower)
    }
}

/// A steered wheel.
#[derive(Clone, Copy, Debug)]
pub struct Steered {
    /// Pivot, forward [m].
    pub x: f64,
    /// Pivot, to the left [m].
    pub y: f64,
    /// `None` where it is straight ahead.
    pub heading: Option<Direction>,
    /// Range of the steering angle [rad].
    pub range: SteeringRange,
    /// Of the lower and the upper end of the range; NaN where it is endless.
    pub ends: [Direction; 2],
    /// Contact to the left of the steering axis, and behind it [m].
    pub scrub: f64,
    /// Contact behind the steering axis [m].
    pub trail: f64,
    /// Of a wheel without scrub and trail that can point straight ahead.
    pub reach: Option<Reach>,
}

impl Steered {
    /// Nothing for a fixed wheel.
    pub fn new(wheel: &Wheel, mount: Mount) -> Option<Self> {
        let (range, heading) = match mount {
            Mount::Steered(range, heading) => (range, heading),
            Mount::Castor(heading) => (SteeringRange::WHOLE_TURN, heading),
            Mount::Fixed(_) => return None,
        };
        Some(Self {
            x: wheel.x,
            y: wheel.y,
            heading: (wheel.heading != 0.0).then_some(heading),
            range,
            ends: [range.lower, range.upper].map(Direction::from),
            scrub: wheel.scrub,
            trail: wheel.trail,
            reach: Reach::new(range).filter(|_| wheel.is_centred()),
        })
    }

    /// Velocity of the pivot in the axes of the heading, by the same operations as the plain core.
    #[inline(always)]
    pub fn velocity<S: Simd>(&self, simd: S, [vx, vy, omega]: [Lanes<S>; 3]) -> [Lanes<S>; 2] {
        let ux = vx - omega * Lanes::splat(simd, self.y);
        let uy = vy + omega * Lanes::splat(simd, self.x);
        let Some(Direction { sin, cos }) = self.heading else {
            return [ux, uy];
        };
        let (sin, cos) = (Lanes::splat(simd, sin), Lanes::splat(simd, cos));
        [cos * ux + sin * uy, cos * uy - sin * ux]
    }

    /// Lanes in which the pivot rests, by the same operations as the plain core.
    #[inline(always)]
    pub fn rests<S: Simd>(&self, simd: S, twist: [Lanes<S>; 3]) -> Mask<S> {
        let ahead = Self { heading: None, ..*self };
        let [ux, uy] = ahead.velocity(simd, twist);
        let arm = Lanes::splat(simd, self.x.abs() + self.y.abs());
        let [vx, vy, omega] = absolute(twist);
        let summed = vx + vy + omega * arm;
        let rounding = Lanes::splat(simd, REST) * summed;
        ux.abs().max(uy.abs()).at_most(rounding)
    }
}

#[inline(always)]
pub(crate) fn absolute<S: Simd>([vx, vy, omega]: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
    [vx.abs(), vy.abs(), omega.abs()]
}

/// A register of twists.
#[inline(always)]
pub(crate) fn load<S: Simd>(simd: S, columns: &[Column; 3], k: usize) -> [Lanes<S>; 3] {
    [columns[0].load(simd, k), columns[1].load(simd, k), columns[2].load(simd, k)]
}

/// One steered wheel through a block.
pub(crate) struct Steer<'a, S: Simd> {
    pub twists: &'a [Column; 3],
    pub margins: &'a [S::f64s],
    pub per_radius: Lanes<S>,
    pub angles: &'a mut [S::f64s],
    pub speeds: &'a mut [S::f64s],
    /// Numbers of undecided wheels for either way, and the total by which the way backwards is shorter [rad].
    pub votes: &'a mut [Column; 3],
}

/// Excess of the nearer way at this angle over the other one, `2 abs(angle) - pi` [rad]: at most 0.
#[inline(always)]
fn half_turn_margin<S: Simd>(simd: S, angle: Lanes<S>) -> Lanes<S> {
    let size = angle.abs();
    size + size - Lanes::splat(simd, PI)
}

impl Steered {
    /// The other way of a wheel at this angle, and whether it is about as near and within the range, of which the end is not
    /// close to it.
    #[inline(always)]
    fn other<S: Simd>(&self, simd: S, angle: Lanes<S>) -> (Lanes<S>, [Mask<S>; 2]) {
        let splat = |number| Lanes::splat(simd, number);
        let half = angle + splat(PI);
        let other = splat(0.0).below(angle).select(half - splat(TAU), half);
        let (below, above) = (splat(self.range.lower) - other, other - splat(self.range.upper));
        let beyond = below.max(above);
        let near = splat(-UNDECIDED).below(half_turn_margin(simd, angle));
        let sure = !near | splat(2.0 * CLOSE).below(beyond.abs());
        (other, [near & beyond.below(splat(0.0)), sure])
    }

    /// Angle and speed of a wheel after those of all have been asked which way to go: where it could as soon go the other
    /// way, and that is theirs, it does.
    #[inline(always)]
    pub fn apply_common_direction<S: Simd>(
        &self,
        simd: S,
        [angle, speed]: [Lanes<S>; 2],
        asked: Mask<S>,
        backwards: Mask<S>,
    ) -> [Lanes<S>; 2] {
        let back = speed.below(Lanes::splat(simd, 0.0));
        let (other, [undecided, _]) = self.other(simd, angle);
        let turns = asked & undecided & ((back & !backwards) | (!back & backwards));
        [turns.select(other, angle), turns.select(-speed, speed)]
    }
}

impl<S: Simd> Steer<'_, S> {
    /// Lanes in which the wheel surely moves and is surely within its range. Constants of the wheel leave the loop.
    #[inline(always)]
    pub fn run<const TURNED: bool, const WAYS: u8>(self, simd: S, steered: &Steered, reach: &Reach) -> Mask<S> {
        let mut steered = *steered;
        if !TURNED {
            steered.heading = None;
        }
        let [lower, upper] = [steered.range.lower, steered.range.upper].map(|end| Lanes::splat(simd, end));
        let at_an_end = Lanes::splat(simd, AT_AN_END);
        let zero = Lanes::splat(simd, 0.0);
        let mut sure = zero.at_most(zero);
        for k in 0..BLOCK / S::F64_LANES {
            let [x, y] = steered.velocity(simd, load(simd, self.twists, k));
            let margin = Lanes::load(simd, self.margins, k);
            let (along, across) = (x.abs(), y.abs());
            let sign = x.sign();
            let mut angle = angle(simd, along, across).flip(y.sign()).flip(sign);
            if WAYS == ONLY {
                let inside = angle.max(lower).min(upper);
                let moves = margin.below(along.max(across));
                sure = sure & moves & (angle - inside).abs().at_most(at_an_end);
                angle = inside;
            } else if WAYS == EITHER {
                let near = half_turn_margin(simd, angle);
                let beyond = near + Lanes::splat(simd, UNDECIDED);
                let close = Lanes::splat(simd, CLOSE);
                sure = sure & margin.below(along.max(across));
                sure = sure & close.below(beyond.abs()) & close.below(near.abs());
                if zero.below(beyond).any() {
                    let (_, [undecided, clear]) = steered.other(simd, angle);
                    sure = sure & clear;
                    let one = Lanes::splat(simd, 1.0);
                    let back = x.below(zero);
                    for (votes, vote) in
                        self.votes.iter_mut().zip([back.select(zero, one), back.select(one, zero), near.flip(sign)])
                    {
                        votes.store(k, votes.load(simd, k) + undecided.select(vote, zero));
                    }
                }
            } else {
                sure = sure & reach.holds(simd, [x, y], margin);
            }
            angle.store(self.angles, k);
            let speed = x.mul_add(x, y * y).sqrt() * self.per_radius;
            speed.flip(sign).store(self.speeds, k);
        }
        sure
    }
}
