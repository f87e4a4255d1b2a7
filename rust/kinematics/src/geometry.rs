//! Twists and poses in the plane: SE(2) exponential and logarithm, and their sums over time.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use nalgebra::{Rotation2, Vector2, Vector3};

use six_wheel_numerics::error::{Error, finite, number, numbers};
use six_wheel_numerics::sizes::longest;

/// Velocity of the body frame, in body axes [m/s, m/s, rad/s].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twist {
    /// Forward [m/s].
    pub vx: f64,
    /// To the left [m/s].
    pub vy: f64,
    /// Counter-clockwise [rad/s].
    pub omega: f64,
}

/// `world_from_body`: position [m] and yaw [rad]. The yaw keeps its full turns.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// East or forward [m].
    pub x: f64,
    /// North or left [m].
    pub y: f64,
    /// Counter-clockwise [rad].
    pub yaw: f64,
}

impl From<[f64; 3]> for Twist {
    fn from([vx, vy, omega]: [f64; 3]) -> Self {
        Self { vx, vy, omega }
    }
}

impl From<Twist> for [f64; 3] {
    fn from(twist: Twist) -> Self {
        [twist.vx, twist.vy, twist.omega]
    }
}

impl From<Twist> for Vector3<f64> {
    fn from(twist: Twist) -> Self {
        Vector3::new(twist.vx, twist.vy, twist.omega)
    }
}

impl From<Vector3<f64>> for Twist {
    fn from(vector: Vector3<f64>) -> Self {
        Self::from([vector.x, vector.y, vector.z])
    }
}

impl From<[f64; 3]> for Pose {
    fn from([x, y, yaw]: [f64; 3]) -> Self {
        Self { x, y, yaw }
    }
}

impl From<Pose> for [f64; 3] {
    fn from(pose: Pose) -> Self {
        [pose.x, pose.y, pose.yaw]
    }
}

/// sin(x) / x. The quotient of two equally rounded numbers: only x = 0 itself needs a word.
#[inline]
pub fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { x.sin() / x }
}

/// Whole turns in two parts: so many times the first, of up to [`MANY`], have no rounding.
const TURN: [f64; 2] = {
    let high = f64::from_bits(TAU.to_bits() >> 21 << 21);
    [high, TAU - high]
};

/// Angles from which on turns are taken out bit by bit [rad].
const MANY: f64 = 1e6;

/// The angle brought into [-pi, pi] by whole turns; unchanged if it is there already.
pub fn wrap_angle(angle: f64) -> f64 {
    // Exact: what is left has no more digits than a turn.
    let rest = if angle.abs() < MANY {
        let turns = f64::from((angle / TAU) as i32);
        (angle - turns * TURN[0]) - turns * TURN[1]
    } else {
        angle % TAU
    };
    if rest > PI {
        rest - TAU
    } else if rest < -PI {
        rest + TAU
    } else {
        rest
    }
}

impl Twist {
    /// No motion.
    pub const ZERO: Self = Self { vx: 0.0, vy: 0.0, omega: 0.0 };

    /// Linear part [m/s].
    #[inline]
    pub fn linear(self) -> Vector2<f64> {
        Vector2::new(self.vx, self.vy)
    }

    /// Velocity of a point of the body [m/s].
    #[inline]
    pub fn at(self, x: f64, y: f64) -> Vector2<f64> {
        Vector2::new(self.vx - self.omega * y, self.vy + self.omega * x)
    }

    /// The same motion of the body, given as the velocity of this point instead of the origin's.
    #[must_use]
    #[inline]
    pub fn about(self, [x, y]: [f64; 2]) -> Self {
        let at_origin = self.at(-x, -y);
        Self { vx: at_origin.x, vy: at_origin.y, omega: self.omega }
    }

    /// `start_from_end`: where holding this twist for `dt` [s] takes the body frame.
    #[inline]
    pub fn exp(self, dt: f64) -> Pose {
        let yaw = self.omega * dt;
        // The chord leaves at half the turn. Nothing cancels as yaw → 0, unlike (1 − cos yaw)/yaw.
        let chord = Rotation2::new(yaw / 2.0) * self.linear() * (sinc(yaw / 2.0) * dt);
        Pose { x: chord.x, y: chord.y, yaw }
    }

    /// Instantaneous centre of rotation [m] in body axes.
    ///
    /// Driving straight it lies at infinity: the component across the motion is infinite, a component
    /// without motion across it is 0. At rest there is none: NaN.
    #[inline]
    pub fn icr(self) -> [f64; 2] {
        let quotient = |numerator: f64| match (self.omega == 0.0, numerator == 0.0) {
            (false, _) => numerator / self.omega,
            (true, true) => 0.0,
            (true, false) => f64::INFINITY.copysign(numerator),
        };
        if self == Self::ZERO {
            [f64::NAN; 2]
        } else {
            [quotient(-self.vy) + 0.0, quotient(self.vx) + 0.0] // + 0.0: no minus zero
        }
    }
}

impl Pose {
    /// The twist that reaches this pose in `dt` [s] along one arc, turning the short way round.
    #[inline]
    pub fn log(self, dt: f64) -> Twist {
        let yaw = wrap_angle(self.yaw);
        let chord = Vector2::new(self.x, self.y);
        let linear = Rotation2::new(-yaw / 2.0) * chord / (sinc(yaw / 2.0) * dt);
        Twist { vx: linear.x, vy: linear.y, omega: yaw / dt }
    }

    /// `a_from_c = a_from_b * b_from_c`; yaws add up, turns included.
    #[must_use]
    #[inline]
    pub fn compose(self, next: Self) -> Self {
        let shift = Rotation2::new(self.yaw) * Vector2::new(next.x, next.y);
        Self { x: self.x + shift.x, y: self.y + shift.y, yaw: self.yaw + next.yaw }
    }

    /// `self_from_next`: the pose of `next` seen from this one.
    #[must_use]
    #[inline]
    pub fn between(self, next: Self) -> Self {
        let shift = Rotation2::new(-self.yaw) * Vector2::new(next.x - self.x, next.y - self.y);
        Self { x: shift.x, y: shift.y, yaw: next.yaw - self.yaw }
    }
}

/// Durations of the steps of a log [s].
#[derive(Clone, Copy, Debug)]
pub enum Steps<'a> {
    /// Every step takes the same time.
    Constant(f64),
    /// One duration per step.
    Each(&'a [f64]),
}

impl<'a> Steps<'a> {
    /// Duration of step `k`.
    #[inline]
    pub fn get(&self, k: usize) -> f64 {
        match self {
            Self::Constant(dt) => *dt,
            Self::Each(dts) => dts[k],
        }
    }

    /// Those of some of the steps.
    #[inline]
    pub fn of(self, steps: Range<usize>) -> Self {
        match self {
            Self::Constant(dt) => Self::Constant(dt),
            Self::Each(dts) => Self::Each(&dts[steps]),
        }
    }

    /// Fails unless there are `count` finite durations, of which none is negative: recordings hold the same stamp
    /// twice, and in no time nothing moves.
    #[inline]
    pub fn check(&self, count: usize) -> Result<(), Error> {
        self.check_each(count, |dt| dt >= 0.0, "be finite and not negative")
    }

    /// Fails unless there are `count` finite, positive durations, to divide by.
    pub fn check_positive(&self, count: usize) -> Result<(), Error> {
        self.check_each(count, |dt| dt > 0.0, "be finite and positive")
    }

    fn check_each(&self, count: usize, good: fn(f64) -> bool, rule: &str) -> Result<(), Error> {
        let wrong = |dt: f64| !(dt.is_finite() && good(dt));
        match self {
            Self::Constant(dt) if wrong(*dt) => Err(Error::value("dt", rule, number(*dt))),
            Self::Constant(_) => Ok(()),
            Self::Each(dts) if dts.len() != count => Err(Error::value(
                "dt",
                format!("be one number or have {count} of them, one per step"),
                format!("{}", dts.len()),
            )),
            Self::Each(dts) if longest(dts).is_some() => Ok(()),
            Self::Each(dts) => match dts.iter().position(|dt| wrong(*dt)) {
                Some(row) => Err(Error::value("dt", rule, number(dts[row])).at_row(row)),
                None => Ok(()),
            },
        }
    }
}

/// A sum that carries its own rounding error along (Kahan's sum in Knuth's form, without a branch).
#[derive(Clone, Copy, Debug)]
pub struct Sum {
    /// Leading part.
    pub sum: f64,
    /// Rounding error of the leading part.
    pub lost: f64,
}

impl Sum {
    /// A sum of one term.
    #[inline]
    pub fn new(start: f64) -> Self {
        Self { sum: start, lost: 0.0 }
    }

    /// Adds a term.
    #[inline(always)]
    pub fn add(&mut self, term: f64) {
        let total = self.sum + term;
        let added = total - self.sum;
        self.lost += (self.sum - (total - added)) + (term - added);
        self.sum = total;
    }

    /// The sum, rounded once.
    #[inline(always)]
    pub fn value(self) -> f64 {
        self.sum + self.lost
    }
}

/// Difference of a whole turn and [`TAU`]: `2 pi - TAU` [rad].
pub(crate) const TAU_REST: f64 = 2.449_293_598_294_706_4e-16;

/// A pose on its way along a log.
#[derive(Clone, Copy, Debug)]
pub struct Walk {
    /// East or forward [m].
    pub x: Sum,
    /// North or left [m].
    pub y: Sum,
    /// With all its turns, as it is written.
    pub yaw: Sum,
    /// Without them, as it is used: it keeps its digits however often the rover turns.
    pub heading: Sum,
}

impl Walk {
    /// Starts at a pose [m, m, rad].
    #[inline]
    pub fn new([x, y, yaw]: [f64; 3]) -> Self {
        let mut heading = Sum::new(yaw);
        unwind(&mut heading);
        Self { x: Sum::new(x), y: Sum::new(y), yaw: Sum::new(yaw), heading }
    }

    /// Adds a chord in world axes.
    #[inline(always)]
    pub fn shift(&mut self, x: f64, y: f64) {
        self.x.add(x);
        self.y.add(y);
    }

    /// Adds a turn.
    #[inline(always)]
    pub fn turn(&mut self, yaw: f64) {
        self.yaw.add(yaw);
        self.heading.add(yaw);
        if self.heading.sum.abs() > PI {
            unwind(&mut self.heading);
        }
    }

    /// Holds a twist for a while; the pose after it.
    #[inline]
    pub fn step(&mut self, twist: [f64; 3], dt: f64) -> [f64; 3] {
        let step = Twist::from(twist).exp(dt);
        let shift = Rotation2::new(self.heading.value()) * Vector2::new(step.x, step.y);
        self.shift(shift.x, shift.y);
        self.turn(step.yaw);
        [self.x.value(), self.y.value(), self.yaw.value()]
    }

    /// Goes on along a log that has been checked; the pose after every step.
    #[inline]
    pub fn follow(&mut self, twists: &[[f64; 3]], steps: Steps<'_>, poses: &mut [[f64; 3]]) {
        for (k, (twist, pose)) in twists.iter().zip(poses).enumerate() {
            *pose = self.step(*twist, steps.get(k));
        }
    }
}

/// Beyond this an angle has no digit behind the point, and of its turns none that counts [rad].
const NO_DIGITS: f64 = 1e15;

/// Takes whole turns out of an angle, exactly but for what a turn in two parts leaves.
fn unwind(angle: &mut Sum) {
    if angle.sum.abs() > NO_DIGITS {
        *angle = Sum::new(wrap_angle(angle.sum));
        return;
    }
    let turns = (angle.sum / TAU).round();
    let product = turns * TAU;
    angle.add(-product);
    angle.lost -= turns.mul_add(TAU, -product) + turns * TAU_REST;
}

/// Bound of the way and the turn of a log so far: while it is finite, every pose on the way is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bound(f64);

impl Bound {
    #[inline]
    pub fn new(start: [f64; 3]) -> Result<Self, Error> {
        finite("start", &start)?;
        Ok(Self(start.iter().map(|value| value.abs()).fold(0.0, f64::max)))
    }

    /// Goes on along the log; rows of errors count from here.
    #[inline]
    pub fn extend(&mut self, twists: &[[f64; 3]], steps: Steps<'_>) -> Result<(), Error> {
        for (k, twist) in twists.iter().enumerate() {
            finite("twists", twist).map_err(|error| error.at_row(k))?;
            self.0 += twist.iter().map(|value| value.abs()).fold(0.0, f64::max) * steps.get(k) * 2.0;
            if !self.0.is_finite() {
                let rule = "keep the pose finite over its step";
                return Err(Error::value("twists", rule, numbers(twist)).at_row(k));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_closed_circle_ends_where_it_began() -> Result<(), Error> {
        let count = 1_000_000;
        let twists = vec![[1.0, 0.0, TAU / (count as f64 * 1e-3)]; count];
        let mut poses = vec![[0.0; 3]; count];
        let (steps, start) = (Steps::Constant(1e-3), [0.0; 3]);
        Bound::new(start)?.extend(&twists, steps)?;
        Walk::new(start).follow(&twists, steps, &mut poses);
        let [x, y, yaw] = poses[count - 1];
        // 1 km of path; yaw carries the rounding of its own increments, 1e6 half ulps at worst.
        assert!(x.hypot(y) < 1e-8, "{x} {y}");
        assert!((yaw - TAU).abs() < 1e-12, "{yaw}");
        Ok(())
    }

    #[test]
    fn angles_wrap_into_half_a_turn_to_either_side() {
        assert_eq!(wrap_angle(PI), PI);
        assert_eq!(wrap_angle(-PI), -PI);
        assert_eq!(wrap_angle(0.5), 0.5);
        assert!((wrap_angle(7.0) - (7.0 - TAU)).abs() < 1e-15);
        assert!((wrap_angle(-1e6) + 1e6 - TAU * (1e6 / TAU).round()).abs() < 1e-9);
        // To the bit what the remainder is, at whole and half turns and their neighbours too.
        let bitwise = |angle: f64| match angle % TAU {
            rest if rest > PI => rest - TAU,
            rest if rest < -PI => rest + TAU,
            rest => rest,
        };
        for k in (0..400_000).step_by(7) {
            for angle in [0.1 * f64::from(k), f64::from(k) * PI] {
                for angle in [angle.next_down(), angle, angle.next_up(), -angle] {
                    assert_eq!(wrap_angle(angle), bitwise(angle), "{angle}");
                }
            }
        }
    }
}
