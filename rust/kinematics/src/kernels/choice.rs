//! One steered wheel in general: both ways of making a motion, [`crate::steering::Choice`] in every lane.
//!
//! Scrub and trail, any range, the present angle and the rate of the steering are part of the formula. By the same
//! operations as the plain core, but for the functions of angles.

use std::f64::consts::{PI, TAU};

use pulp::Simd;

use super::steered::{CLOSE, Steered};
use crate::steering::{ANGLE_TOLERANCE, UNDECIDED};
use crate::wheels::Direction;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::polynomials::{ROUND, angle};

/// Share of the pivot's speed that has to be left along the wheel for the angle of a trail to be exact.
const LEFT: f64 = 0.75;

/// Angles beyond an end by no more than this surely count as inside [rad].
const INSIDE: f64 = ANGLE_TOLERANCE / 2.0;

/// Input of the choice of a steering angle, one wheel or row per lane.
#[derive(Clone, Copy)]
pub struct SteeringQuery<S: Simd> {
    pub twist: [Lanes<S>; 3],
    /// Present steering angle [rad].
    pub before: Lanes<S>,
    /// Rate of the steering angle [rad/s].
    pub rate: Lanes<S>,
}

/// Motion of the wheel that was chosen.
#[derive(Clone, Copy)]
pub struct Chosen<S: Simd> {
    /// [rad]
    pub angle: Lanes<S>,
    /// [m/s]
    pub rim_speed: Lanes<S>,
    pub backwards: Mask<S>,
    /// True if both ways are about equally near. The way backwards is shorter by `lead` [rad].
    pub undecided: Mask<S>,
    pub lead: Lanes<S>,
    /// True if the angle is within the range, so that nothing slides.
    pub inside: Mask<S>,
    pub sure: Mask<S>,
}

/// One way.
struct Side<S: Simd> {
    angle: Lanes<S>,
    overshoot: Lanes<S>,
    turn: Lanes<S>,
    /// True if rounding may have led to another turn.
    close: Mask<S>,
}

/// The wheels that have to go the same way, and whether that is backwards.
pub(crate) type Common<S> = Option<Mask<S>>;

impl Steered {
    /// The nearest way, or for undecided wheels the common one.
    #[inline(always)]
    pub fn choose<S: Simd>(&self, simd: S, asked: SteeringQuery<S>, common: Common<S>) -> Chosen<S> {
        let splat = |number| Lanes::splat(simd, number);
        let zero = splat(0.0);
        let [_, _, omega] = asked.twist;
        let [x, y] = self.velocity(simd, asked.twist);
        let x = x + zero; // no minus zero
        let before = asked.before.max(splat(self.range.lower)).min(splat(self.range.upper));
        let rests = self.rests(simd, asked.twist);
        let turning = omega + asked.rate;
        let square = x.mul_add(x, y * y);
        let speed = square.sqrt();
        let half = angle(simd, x.abs(), y.abs()).flip(y.sign()).flip(x.sign());
        let mut sure = zero.at_most(zero);
        let mut still = rests;
        let (mut along, mut near, mut far) = (speed, half, half + splat(PI));
        if self.trail != 0.0 {
            let across = splat(self.trail) * turning;
            let straight = across.abs().at_most(zero);
            along = (-across).mul_add(across, square).max(zero).sqrt();
            still = rests & straight; // steering drags the contact of a resting pivot
            sure = (splat(LEFT) * speed).below(along);
            let lean = angle(simd, along, across.abs()).flip(across.sign()).flip(x.sign());
            (near, far) = (half - lean, (half + lean) + splat(PI));
        }
        let ahead = zero.at_most(x);
        let forwards = self.side(simd, ahead.select(near, far), before);
        let backwards = self.side(simd, ahead.select(far, near), before);
        let lead = forwards.turn - backwards.turn;
        let both = forwards.overshoot.at_most(zero) & backwards.overshoot.at_most(zero);
        let undecided = both & lead.abs().below(splat(UNDECIDED)) & !rests;
        let further = backwards.overshoot - forwards.overshoot;
        let level = further.abs().at_most(zero);
        let mut back = further.below(zero) | (level & zero.below(lead));
        // Exactly as near is as sure as far from it.
        let doubt = |lead: Lanes<S>, bound: f64| zero.below(lead.abs()) & lead.abs().below(splat(bound));
        sure = sure & !(doubt(further, CLOSE) | (level & doubt(lead, CLOSE)));
        sure = sure & !(both & (lead.abs() - splat(UNDECIDED)).abs().below(splat(CLOSE)));
        if let Some(common) = common {
            back = (undecided & common) | (!undecided & back);
        }
        let close = (back & backwards.close) | (!back & forwards.close);
        sure = sure & !(close | (undecided & (forwards.close | backwards.close)));
        let angle = back.select(backwards.angle, forwards.angle);
        let overshoot = back.select(backwards.overshoot, forwards.overshoot);
        let rolled = rests.select(zero, along.flip(back.select(splat(-0.0), zero)));
        let (rim_speed, kept) = self.scrubbed(simd, rolled, turning);
        Chosen {
            angle: rests.select(before, angle),
            rim_speed,
            backwards: back,
            undecided,
            lead,
            inside: still | (!rests & overshoot.at_most(zero)),
            sure: rests | (sure & kept),
        }
    }

    /// Lanes in which some angle of the range surely leaves nothing to slide: the slip at its two ends has different
    /// signs, or is next to nothing at one of them.
    #[inline(always)]
    pub fn reaches<S: Simd>(&self, simd: S, twist: [Lanes<S>; 3], rate: Lanes<S>) -> Mask<S> {
        let splat = |number| Lanes::splat(simd, number);
        let [x, y] = self.velocity(simd, twist);
        let square = x.mul_add(x, y * y);
        let across = splat(self.trail) * (twist[2] + rate);
        let along = (-across).mul_add(across, square);
        let none = along * splat(INSIDE * INSIDE);
        let [lower, upper] = self.ends;
        let slip = |end: Direction| (y * splat(end.cos) - x * splat(end.sin)) - across;
        let (first, last) = (slip(lower), slip(upper));
        let held = (first * last).below(splat(0.0)) | (first * first).at_most(none) | (last * last).at_most(none);
        held & (splat(LEFT * LEFT) * square).at_most(along) & !self.rests(simd, twist)
    }

    /// Rim speed of a castor that has swung in behind its pivot [m/s], and the lanes in which it is sure.
    #[inline(always)]
    pub fn follow<S: Simd>(&self, simd: S, twist: [Lanes<S>; 3]) -> (Lanes<S>, Mask<S>) {
        let splat = |number| Lanes::splat(simd, number);
        let zero = splat(0.0);
        let [x, y] = self.velocity(simd, twist);
        let square = x.mul_add(x, y * y);
        let speed = square.sqrt();
        let across = splat(self.trail) * twist[2];
        let along = (-across).mul_add(across, square).max(zero).sqrt();
        let along = if self.trail < 0.0 { -along } else { along };
        let rests = self.rests(simd, twist);
        let rolled = rests.select(zero, along);
        let (rim_speed, kept) = self.scrubbed(simd, rolled, twist[2]);
        let sure = rests | (kept & (splat(LEFT) * speed).below(along.abs()));
        (rim_speed, sure)
    }

    /// Rim speed that is left after the share of scrub [m/s], and the lanes in which it keeps its digits.
    #[inline(always)]
    fn scrubbed<S: Simd>(&self, simd: S, rolled: Lanes<S>, turning: Lanes<S>) -> (Lanes<S>, Mask<S>) {
        let zero = Lanes::splat(simd, 0.0);
        if self.scrub == 0.0 {
            return (rolled, zero.at_most(zero));
        }
        let left = rolled - Lanes::splat(simd, self.scrub) * turning;
        let kept = rolled.abs().at_most(left.abs() + left.abs());
        (left, kept)
    }

    /// `SteeringRange::nearest_turn`, and what the range leaves of it.
    #[inline(always)]
    fn side<S: Simd>(&self, simd: S, angle: Lanes<S>, before: Lanes<S>) -> Side<S> {
        let splat = |number| Lanes::splat(simd, number);
        let (lower, upper) = (splat(self.range.lower), splat(self.range.upper));
        let (tolerance, turn) = (splat(ANGLE_TOLERANCE), splat(TAU));
        let (way, close) = (before - angle, splat(CLOSE));
        let turns = (way * splat(1.0 / TAU) + splat(ROUND)) - splat(ROUND);
        let near = angle + turn * turns;
        let mut doubt = ((before - near).abs() - splat(PI)).abs().below(close);
        let (above, below) = (near - upper, lower - near);
        let (is_above, is_below) = (tolerance.below(above), tolerance.below(below));
        let turned = is_above.select(near - turn, near + turn);
        let beyond = is_above.select(lower - turned, turned - upper);
        let short = is_above.select(above, below);
        let bound = tolerance.max(short);
        let out = is_above | is_below;
        doubt = doubt | (out & (beyond - bound).abs().below(close));
        doubt = doubt | ((above - tolerance).abs().below(splat(CLOSE / 4.0)));
        doubt = doubt | ((below - tolerance).abs().below(splat(CLOSE / 4.0)));
        let angle = (out & beyond.at_most(bound)).select(turned, near);
        let clipped = angle.max(lower).min(upper);
        Side {
            angle: clipped,
            overshoot: ((angle - clipped).abs() - tolerance).max(splat(0.0)),
            turn: (clipped - before).abs(),
            close: doubt,
        }
    }
}
