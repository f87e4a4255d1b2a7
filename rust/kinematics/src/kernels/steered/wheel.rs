//! Steering angle and rim speed of a wheel that turns about its pivot: the wheel equation solved, in every lane.
//!
//! With the velocity `u` of the pivot, the heading `e` of the wheel and its left normal `n`:
//!
//! ```text
//! contact velocity   c = u + (omega + phi') (-scrub e - trail n),    u = v + omega x p
//! no side slip       n . c = 0   =>   phi = arg u - beta   or   arg u + beta + pi,    sin beta = trail (omega + phi') / |u|
//! rolling            r q = e . c = +-sqrt(|u|^2 - trail^2 (omega + phi')^2) - scrub (omega + phi')
//! ```
//!
//! Both solutions are brought into the range by whole turns, next to the present angle. The one inside the range is taken,
//! the nearer one if both are, the one forwards if both are equally near. Wheels whose solutions are about equally near are
//! a direction tie: see [`DirectionVotes`]. A lane is a row of a batch with one wheel's constants, or one wheel of one row.

use std::f64::consts::{PI, TAU};

use pulp::Simd;

use super::constants::MAX_NEAR_INCREMENT;
pub use super::constants::{SAFE_OVERSHOOT, SteeredConstants, SteeredWheel};
use super::direction_votes::{CommonDirection, DirectionTie};
use crate::geometry::Direction;
use crate::geometry::Twist;
use crate::kernels::safe_range::{MAX_SQUARABLE, MIN_SQUARABLE, SCALE};
use crate::rover_data::Mount;
use crate::steering::ANGLE_TOLERANCE;
use crate::wheels::{REST, Wheel};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::level::{Kernel, Level};
use six_wheel_numerics::simd::polynomials::{ROUND, angle, sin_cos};
use six_wheel_numerics::simd::vector::Vector;

/// A wheel whose two solutions differ by less than this is a direction tie, so that angles on either side of a quarter
/// turn do not split the rover [rad].
const TIE_DIFFERENCE: f64 = 10.0 * PI / 180.0;

/// Input of the wheel equation.
#[derive(Clone, Copy)]
pub struct WheelQuery<S: Simd> {
    /// Twist of the body; `vx` is no minus zero.
    pub twist: [Lanes<S>; 3],
    /// Twice the bound of the rounding error of pivot velocities; infinite where their squares may overflow or lose
    /// digits [m/s].
    pub rounding: Lanes<S>,
    /// Present steering angle [rad]; 0 if it is not given.
    pub previous: Option<Lanes<S>>,
    /// Rate of the steering angle [rad/s]; 0 if it is not given.
    pub rate: Option<Lanes<S>>,
}

/// The first of the two solutions: the one within a quarter turn of steering angle 0.
#[derive(Clone, Copy)]
pub struct FirstSolution<S: Simd> {
    /// Velocity of the pivot in the axes of steering angle 0 [m/s].
    velocity: [Lanes<S>; 2],
    /// Direction of the line along which the pivot moves, within a quarter turn of steering angle 0 [rad].
    pivot_heading: Lanes<S>,
    /// Steering angle [rad].
    pub angle: Lanes<S>,
    /// Speed of the contact along the rim [m/s].
    pub rim_speed: Lanes<S>,
    /// True where this solution is the wheel's motion.
    pub is_final: Mask<S>,
}

/// Motion of a wheel.
#[derive(Clone, Copy)]
pub struct WheelMotion<S: Simd> {
    /// Steering angle [rad].
    pub angle: Lanes<S>,
    /// Speed of the contact along the rim [m/s].
    pub rim_speed: Lanes<S>,
    /// Distance by which the range ends short of the angle [rad]; infinite where no angle stops the side slip.
    pub overshoot: Lanes<S>,
    /// True where both solutions are about equally near.
    pub tie: DirectionTie<S>,
}

/// One of the two solutions, brought into the range.
#[derive(Clone, Copy)]
struct Candidate<S: Simd> {
    angle: Lanes<S>,
    /// Distance by which the range ends short of the angle [rad].
    overshoot: Lanes<S>,
    /// Overshoot beyond [`ANGLE_TOLERANCE`] [rad].
    excess: Lanes<S>,
    /// Distance from the present steering angle [rad].
    increment: Lanes<S>,
}

#[inline_always]
impl<S: Simd> SteeredWheel<S> {
    /// Velocity of the pivot in body axes [m/s].
    fn body_velocity(&self, [vx, vy, omega]: [Lanes<S>; 3]) -> [Lanes<S>; 2] {
        [vx - omega * self.pivot[1], vy + omega * self.pivot[0]]
    }

    /// Velocity of the pivot in the axes of steering angle 0 [m/s].
    pub fn velocity(&self, twist: [Lanes<S>; 3]) -> [Lanes<S>; 2] {
        let [x, y] = self.body_velocity(twist);
        if !self.features.is_turned {
            return [x, y];
        }
        let [sin, cos] = self.heading;
        [cos * x + sin * y, cos * y - sin * x]
    }

    /// True where the pivot's velocity is within the rounding error of the terms of its sum.
    pub fn is_at_rest(&self, twist: [Lanes<S>; 3]) -> Mask<S> {
        let [x, y] = self.body_velocity(twist);
        let [vx, vy, omega] = twist.map(Lanes::abs);
        let terms = vx + vy + omega * (self.pivot[0].abs() + self.pivot[1].abs());
        x.abs().max(y.abs()).le(Lanes::splat(vx.simd(), REST) * terms)
    }

    /// The first solution. It is final where the pivot moves and the second one is outside the range or farther away.
    pub fn first_solution(&self, simd: S, query: &WheelQuery<S>) -> FirstSolution<S> {
        let [x, y] = self.velocity(query.twist);
        let (along, across) = (x.abs(), y.abs());
        let zero = Lanes::splat(simd, 0.0);
        let pivot_heading = angle(simd, along, across).xor_sign(y.sign_bit()).xor_sign(x.sign_bit()) + zero;
        let mut angle = pivot_heading;
        let mut is_final = query.rounding.lt(along.max(across));
        let is_within = |[lower, upper]: [Lanes<S>; 2]| lower.le(pivot_heading) & pivot_heading.le(upper);
        if let Some(previous) = query.previous {
            angle = self.clip(angle);
            let is_near = (pivot_heading - angle).abs().le(Lanes::splat(simd, SAFE_OVERSHOOT))
                & (angle - self.clip(previous)).abs().le(Lanes::splat(simd, MAX_NEAR_INCREMENT));
            is_final = is_final & (is_within(self.single_range) | is_near);
        } else {
            is_final = is_final & is_within(self.near_range);
            if self.features.is_narrow {
                angle = self.clip(angle);
            }
        }
        let mut rim_speed = x.mul_add(x, y * y).sqrt().xor_sign(x.sign_bit());
        if self.features.has_scrub {
            rim_speed = rim_speed - self.scrub * self.turn_rate(query);
        }
        if self.features.has_trail {
            is_final = is_final & self.trail.abs().le(zero);
        }
        FirstSolution { velocity: [x, y], pivot_heading, angle, rim_speed, is_final }
    }

    /// The motion of the wheel by both solutions; in a direction tie in the common direction, if there is one.
    pub fn solve(
        &self,
        simd: S,
        query: &WheelQuery<S>,
        first: &FirstSolution<S>,
        common: CommonDirection<S>,
    ) -> WheelMotion<S> {
        let splat = |number| Lanes::splat(simd, number);
        let (zero, endless) = (splat(0.0), splat(f64::INFINITY));
        let held = self.clip(query.previous.unwrap_or(zero));
        let is_at_rest = self.is_at_rest(query.twist);
        let Rolling { speed, turn_rate, trail_angle, is_solvable, is_forwards, unscale } =
            self.rolling(simd, query, first.velocity);
        let second = (first.pivot_heading + trail_angle) + splat(PI);
        let first = first.pivot_heading - trail_angle;
        let forwards = self.candidate(simd, is_forwards.select(first, second), held);
        let backwards = self.candidate(simd, is_forwards.select(second, first), held);

        let lead = forwards.increment - backwards.increment;
        let further = backwards.excess - forwards.excess;
        let is_as_far = further.abs().le(zero);
        let mut is_backwards = further.lt(zero) | (is_as_far & splat(ANGLE_TOLERANCE).lt(lead));
        let are_inside = forwards.excess.le(zero) & backwards.excess.le(zero);
        let is_tie = are_inside & lead.abs().lt(splat(TIE_DIFFERENCE)) & !is_at_rest;
        let tie = DirectionTie { is_tie, is_backwards, lead };
        if let Some([is_common, to_back]) = common {
            let is_common = is_tie & is_common;
            is_backwards = (is_common & to_back) | (!is_common & is_backwards);
        }

        let angle = is_backwards.select(backwards.angle, forwards.angle);
        let overshoot = is_backwards.select(backwards.overshoot, forwards.overshoot);
        let rolled = is_at_rest.select(zero, speed.xor_sign(is_backwards.select(splat(-0.0), zero)));
        WheelMotion {
            angle: is_at_rest.select(held, angle),
            rim_speed: self.without_scrub(rolled, turn_rate) * unscale,
            overshoot: is_solvable.select(is_at_rest.select(zero, overshoot), endless),
            tie,
        }
    }

    /// Rim speed of a castor that trails behind its moving pivot [m/s]. It does not depend on the heading.
    pub fn castor_rim_speed(&self, simd: S, twist: [Lanes<S>; 3]) -> Lanes<S> {
        let zero = Lanes::splat(simd, 0.0);
        let query = WheelQuery { twist, rounding: zero, previous: None, rate: None };
        let Rolling { speed, turn_rate, unscale, .. } = self.rolling(simd, &query, self.velocity(twist));
        let rolled = self.is_at_rest(twist).select(zero, speed.xor_sign(self.trail.sign_bit()));
        self.without_scrub(rolled, turn_rate) * unscale
    }

    /// Speed at which the contact slides sideways at a steering angle, `n . c` [m/s].
    pub fn side_slip(&self, simd: S, query: &WheelQuery<S>, first: &FirstSolution<S>, angle: Lanes<S>) -> Lanes<S> {
        let [x, y] = first.velocity;
        let (sin, cos) = sin_cos(simd, angle);
        let slip = cos * y - sin * x;
        if self.features.has_trail { slip - self.trail * self.turn_rate(query) } else { slip }
    }

    /// The terms that both solutions have in common, scaled so that squares neither overflow nor lose digits.
    fn rolling(&self, simd: S, query: &WheelQuery<S>, [x, y]: [Lanes<S>; 2]) -> Rolling<S> {
        let splat = |number| Lanes::splat(simd, number);
        let (zero, one) = (splat(0.0), splat(1.0));
        let size = x.abs().max(y.abs());
        let (is_small, is_large) = (size.lt(splat(MIN_SQUARABLE)), splat(MAX_SQUARABLE).lt(size));
        let scale = is_small.select(splat(SCALE[0]), is_large.select(splat(SCALE[1]), one));
        let unscale = is_small.select(splat(SCALE[1]), is_large.select(splat(SCALE[0]), one));

        let (x, y, turn_rate) = (x * scale + zero, y * scale, self.turn_rate(query) * scale);
        let square = x.mul_add(x, y * y);
        let mut rolling = Rolling {
            speed: square.sqrt(),
            turn_rate,
            trail_angle: zero,
            is_solvable: Mask::splat(simd, true),
            is_forwards: zero.le(x),
            unscale,
        };
        if self.features.has_trail {
            let side = self.trail * turn_rate;
            let along = (-side).mul_add(side, square);
            rolling.speed = along.max(zero).sqrt();
            rolling.trail_angle =
                angle(simd, rolling.speed, side.abs()).xor_sign(side.sign_bit()).xor_sign(x.sign_bit());
            rolling.is_solvable = zero.le(along) & (zero.lt(square) | side.abs().le(zero));
        }
        rolling
    }

    /// Rim speed from the speed of the contact's path: `rolled - scrub (omega + phi')` [m/s].
    fn without_scrub(&self, rolled: Lanes<S>, turn_rate: Lanes<S>) -> Lanes<S> {
        if self.features.has_scrub { rolled - self.scrub * turn_rate } else { rolled }
    }

    /// The angle plus whole turns: inside the range if some number of turns brings it there, and nearest to the present
    /// angle.
    fn candidate(&self, simd: S, angle: Lanes<S>, held: Lanes<S>) -> Candidate<S> {
        let splat = |number| Lanes::splat(simd, number);
        let [lower, upper] = self.range;
        let (tolerance, turn, round) = (splat(ANGLE_TOLERANCE), splat(TAU), splat(ROUND));
        let turns = (((held - angle) / turn) + round) - round;
        let near = angle + turn * turns;
        let (above, below) = (near - upper, lower - near);
        let is_above = tolerance.lt(above);
        let is_outside = is_above | tolerance.lt(below);
        let turned = is_above.select(near - turn, near + turn);
        // If the range holds neither, the one with the smaller overshoot.
        let beyond = is_above.select(lower - turned, turned - upper);
        let short = is_above.select(above, below);
        let angle = (is_outside & beyond.le(tolerance.max(short))).select(turned, near);
        let clipped = self.clip(angle);
        let overshoot = (angle - clipped).abs();
        Candidate {
            angle: clipped,
            overshoot,
            excess: (overshoot - tolerance).max(splat(0.0)),
            increment: (clipped - held).abs(),
        }
    }

    /// The angle, or the end of the range that is nearer.
    fn clip(&self, angle: Lanes<S>) -> Lanes<S> {
        angle.max(self.range[0]).min(self.range[1])
    }

    /// Rate at which the wheel turns about its pivot, `omega + phi'` [rad/s].
    fn turn_rate(&self, query: &WheelQuery<S>) -> Lanes<S> {
        match query.rate {
            Some(rate) => query.twist[2] + rate,
            None => query.twist[2],
        }
    }
}

/// Terms of both solutions, scaled by a power of two.
struct Rolling<S: Simd> {
    /// `sqrt(|u|^2 - trail^2 (omega + phi')^2)`, scaled.
    speed: Lanes<S>,
    /// Rate at which the wheel turns about its pivot, `omega + phi'`, scaled.
    turn_rate: Lanes<S>,
    /// Angle between the wheel and its pivot's velocity, beta [rad].
    trail_angle: Lanes<S>,
    /// True if `|u| >= |trail (omega + phi')|`, so that an angle without side slip exists.
    is_solvable: Mask<S>,
    /// True where the first solution rolls forwards.
    is_forwards: Mask<S>,
    /// One over the scale.
    unscale: Lanes<S>,
}

/// Rim speed of a castor that trails behind its moving pivot [m/s].
pub fn castor_rim_speed(wheel: &Wheel, heading: Direction, twist: Twist) -> f64 {
    let castor = SteeredConstants::new(wheel, Mount::Castor(heading));
    castor.map_or(0.0, |castor| Level::Scalar.run_any(OneCastor { castor, twist: twist.into() }))
}

struct OneCastor {
    castor: SteeredConstants,
    twist: [f64; 3],
}

impl Kernel for OneCastor {
    type Output = f64;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> f64 {
        let twist = self.twist.map(|part| Lanes::splat(simd, part));
        self.castor.broadcast(simd).castor_rim_speed(simd, twist).last(simd)
    }
}
