//! Twists and poses in the plane: SE(2) exponential and logarithm, and their sums over time.

use std::ops::Range;

use nalgebra::{Vector2, Vector3};

pub use crate::se2::accumulate::{PoseAccumulator, Sum};
pub use crate::se2::angles::wrap_angle;
use crate::se2::maps::Map;
use six_wheel_numerics::error::{Error, SHORTEST, finite, number, numbers};
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

/// Sine and cosine of one angle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Direction {
    /// Sine.
    pub sin: f64,
    /// Cosine.
    pub cos: f64,
}

impl From<f64> for Direction {
    fn from(angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self { sin, cos }
    }
}

/// Placement of a grid in the plane: node `(row, column)` at `origin + R(yaw) [column dx, row dy]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridPlacement {
    spacing: [f64; 2],
    origin: [f64; 2],
    yaw: f64,
    turn: Direction,
}

getters! {
    GridPlacement:
    /// Distance between columns and between rows [m].
    spacing: [f64; 2];
    /// Position of node (0, 0) [m].
    origin: [f64; 2];
    /// Angle of the rows against the x axis of the world, counter-clockwise [rad].
    yaw: f64;
    /// Cosine and sine of [`Self::yaw`].
    turn: Direction;
}

impl GridPlacement {
    /// Fails unless all numbers are finite and the spacing positive.
    pub fn new(spacing: [f64; 2], origin: [f64; 2], yaw: f64) -> Result<Self, Error> {
        if !spacing.iter().all(|step| step.is_finite() && *step > 0.0) {
            return Err(Error::value("spacing", "be finite and positive", numbers(&spacing)));
        }
        finite("origin", &origin)?;
        finite("yaw", &[yaw])?;
        Ok(Self { spacing, origin, yaw, turn: Direction::from(yaw) })
    }

    /// A point of the world [m] in numbers of columns and rows from node (0, 0).
    #[inline]
    pub fn grid_from_world(&self, x: f64, y: f64) -> [f64; 2] {
        self.grid_from_offset(x - self.origin[0], y - self.origin[1])
    }

    /// A point in numbers of columns and rows, by its distances from node (0, 0) along x and y of the world [m].
    #[inline]
    pub fn grid_from_offset(&self, x: f64, y: f64) -> [f64; 2] {
        let [u, v] = self.grid_axes([x, y]);
        [u / self.spacing[0], v / self.spacing[1]]
    }

    /// A point of the world [m] in numbers of columns and rows of a grid whose last node is `(columns, rows)`; None off the
    /// grid and for NaN. A point beyond the rim by no more than the rounding of its coordinates is on the rim: a node at
    /// `origin + column spacing` is one of the grid.
    pub fn place_on_grid(&self, [x, y]: [f64; 2], last: [usize; 2]) -> Option<[f64; 2]> {
        let place = self.grid_from_world(x, y);
        if (0..2).all(|axis| (0.0..=last[axis] as f64).contains(&place[axis])) {
            return Some(place);
        }
        let rounding = 4.0 * f64::EPSILON * [x, y, self.origin[0], self.origin[1]].map(f64::abs).iter().sum::<f64>();
        let is_on_grid = (0..2).all(|axis| {
            let slack = rounding / self.spacing[axis];
            (-slack..=last[axis] as f64 + slack).contains(&place[axis])
        });
        is_on_grid.then(|| [place[0].clamp(0.0, last[0] as f64), place[1].clamp(0.0, last[1] as f64)])
    }

    /// The reverse of [`Self::grid_from_world`].
    #[inline]
    pub fn world_from_grid(&self, column: f64, row: f64) -> [f64; 2] {
        let [x, y] = self.world_axes([column * self.spacing[0], row * self.spacing[1]]);
        [self.origin[0] + x, self.origin[1] + y]
    }

    /// A vector of the world in the axes of the grid [m].
    #[inline]
    pub fn grid_axes(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let Direction { sin, cos } = self.turn;
        [cos * x + sin * y, cos * y - sin * x]
    }

    /// A vector in the axes of the grid in those of the world [m].
    #[inline]
    pub fn world_axes(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let Direction { sin, cos } = self.turn;
        [cos * u - sin * v, sin * u + cos * v]
    }
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

/// `sin(x) / x`: exact to rounding for every x but 0, where it is 1.
#[inline]
pub fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { x.sin() / x }
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
        Map::Exp.of(self.into(), [0.0; 3], dt).into()
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
        Map::Log.of(self.into(), [0.0; 3], dt).into()
    }

    /// `a_from_c = a_from_b * b_from_c`; yaws add up, turns included.
    #[must_use]
    #[inline]
    pub fn compose(self, next: Self) -> Self {
        Map::Compose.of(self.into(), next.into(), 1.0).into()
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

    /// The durations of some of the steps.
    #[inline]
    pub fn of(self, steps: Range<usize>) -> Self {
        match self {
            Self::Constant(dt) => Self::Constant(dt),
            Self::Each(dts) => Self::Each(&dts[steps]),
        }
    }

    /// Fails unless there are `count` finite durations, of which none is negative. Recordings have equal stamps, so 0
    /// is allowed: a step without motion.
    #[inline]
    pub fn check(&self, count: usize) -> Result<(), Error> {
        self.check_each(count, |dt| dt >= 0.0, "be finite and not negative")
    }

    /// Fails unless there are `count` finite, positive durations, to divide by.
    pub fn check_positive(&self, count: usize) -> Result<(), Error> {
        self.check_each(count, |dt| dt >= SHORTEST, "be finite and positive")
    }

    fn check_each(&self, count: usize, good: fn(f64) -> bool, rule: &str) -> Result<(), Error> {
        let wrong = |dt: f64| !(dt.is_finite() && good(dt));
        let rule = |dt: f64| if dt > 0.0 && dt < SHORTEST { format!("be at least {SHORTEST:e}") } else { rule.into() };
        match self {
            Self::Constant(dt) if wrong(*dt) => Err(Error::value("dt", rule(*dt), number(*dt))),
            Self::Constant(_) => Ok(()),
            Self::Each(dts) if dts.len() != count => Err(wrong_steps(count, dts.len())),
            Self::Each(dts) if longest(dts).is_some() => Ok(()),
            Self::Each(dts) => match dts.iter().position(|dt| wrong(*dt)) {
                Some(row) => Err(Error::value("dt", rule(dts[row]), number(dts[row])).at_row(row)),
                None => Ok(()),
            },
        }
    }
}

/// The failure of a number of durations that is neither 1 nor `count`.
pub(crate) fn wrong_steps(count: usize, length: usize) -> Error {
    Error::value("dt", format!("be one number or have {count} of them, one per step"), length)
}
