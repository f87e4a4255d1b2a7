//! Sums of poses along a log that keep their digits.

use std::f64::consts::{PI, TAU};

use six_wheel_numerics::error::{Error, finite, numbers};

use crate::se2::angles::wrap_angle;

/// A compensated sum: the sum and its accumulated rounding error (Kahan's sum in Knuth's form, without a branch).
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
const TAU_REST: f64 = 2.449_293_598_294_706_4e-16;

/// The pose along a log, as compensated sums.
#[derive(Clone, Copy, Debug)]
pub struct PoseAccumulator {
    /// East or forward [m].
    pub x: Sum,
    /// North or left [m].
    pub y: Sum,
    /// Yaw with all whole turns, for output [rad].
    pub yaw: Sum,
    /// Yaw without whole turns, for sines and cosines [rad]: it keeps its digits after any number of turns.
    pub heading: Sum,
}

impl PoseAccumulator {
    /// Starts at a pose [m, m, rad].
    #[inline]
    pub fn new([x, y, yaw]: [f64; 3]) -> Self {
        let mut heading = Sum::new(yaw);
        unwind(&mut heading);
        Self { x: Sum::new(x), y: Sum::new(y), yaw: Sum::new(yaw), heading }
    }

    /// Adds a displacement in world axes [m].
    #[inline(always)]
    pub fn shift(&mut self, x: f64, y: f64) {
        self.x.add(x);
        self.y.add(y);
    }

    /// Adds a yaw increment [rad].
    #[inline(always)]
    pub fn turn(&mut self, yaw: f64) {
        self.turn_by(yaw, yaw);
    }

    /// Adds a yaw increment to the yaw, and the same less whole turns to the heading [rad].
    #[inline(always)]
    pub(crate) fn turn_by(&mut self, yaw: f64, without_turns: f64) {
        self.yaw.add(yaw);
        self.heading.add(without_turns);
        if self.heading.sum.abs() > PI {
            unwind(&mut self.heading);
        }
    }
}

/// Angles above this have no digits after the decimal point, so that whole turns need not be exact [rad].
const NO_DIGITS: f64 = 1e15;

/// Subtracts whole turns from an angle [rad], exact up to the error of `2 pi` as the sum of two doubles.
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

/// Upper bound of the distance and the yaw of a log so far: while it is finite, every pose is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bound(f64);

impl Bound {
    /// Fails unless the start is finite.
    #[inline]
    pub fn new(start: [f64; 3]) -> Result<Self, Error> {
        finite("start", &start)?;
        Ok(Self(start.iter().map(|value| value.abs()).fold(0.0, f64::max)))
    }

    /// Fails unless holding a twist for `dt` [s] keeps the pose finite.
    #[inline]
    pub fn extend(&mut self, twist: &[f64; 3], dt: f64) -> Result<(), Error> {
        finite("twists", twist)?;
        self.0 += twist.iter().map(|value| value.abs()).fold(0.0, f64::max) * dt * 2.0;
        if self.0.is_finite() {
            return Ok(());
        }
        Err(Error::value("twists", "keep the pose finite over its step", numbers(twist)))
    }
}
