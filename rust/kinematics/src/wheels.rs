//! The wheel equation: the rows by which one wheel, fixed or steered, with scrub and trail, constrains a twist.
//!
//! A wheel's contact lies at `pivot + trail (-e) + scrub n`, where `e` is its heading and `n` the left
//! normal of that. With the pivot's velocity `u`, the contact moves at
//!
//! ```text
//! c = u + (omega + steering_rate) (-scrub e - trail n)
//! rolling        e . c = radius * speed
//! no side slip   n . c = 0
//! ```
//!
//! (R. Siegwart, I. Nourbakhsh, D. Scaramuzza, Introduction to Autonomous Mobile Robots, 2nd ed., ch. 3.)

use nalgebra::Vector3;

use crate::geometry::{Direction, Twist};
use crate::steering::SteeringRange;
use six_wheel_numerics::error::{Error, HUGE, TINY, finite, number, positive};

/// Largest heading of a wheel [rad]: its sum with a steering angle is exact to 1e-13 rad.
const LARGEST_HEADING: f64 = 1e3;

/// Least sine of a roller angle: rollers along the axle transmit no motion of the rim.
const FLAT_ROLLERS: f64 = 1e-6;

/// A pivot is at rest if its velocity is at most this share of the sum of the magnitudes of its terms: rounding.
pub const REST: f64 = 4.0 * f64::EPSILON;

/// One wheel of a rover, as data.
#[derive(Clone, Debug, PartialEq)]
pub struct Wheel {
    /// Unique within its rover.
    pub name: String,
    /// Pivot, forward of the body's origin [m].
    pub x: f64,
    /// Pivot, left of the body's origin [m].
    pub y: f64,
    /// Hub to ground [m].
    pub radius: f64,
    /// Direction in which the wheel rolls at steering angle 0 [rad].
    pub heading: f64,
    /// Kind of the wheel: fixed, steered or castor.
    pub pivot: Pivot,
    /// Contact to the left of the steering axis [m].
    pub scrub: f64,
    /// Contact behind the steering axis [m].
    pub trail: f64,
    /// Angle of the rollers' axes to the axle [rad]: a quarter turn for an omni wheel, an eighth for a
    /// mecanum wheel; `None` without rollers.
    pub roller_angle: Option<f64>,
    /// True if a motor turns it; one that rolls along need not have an encoder.
    pub driven: bool,
}

/// Kind of a wheel by the cause of its direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pivot {
    /// It is mounted in its heading.
    Fixed,
    /// A steering joint within its range.
    Steered(SteeringRange),
    /// It swivels freely behind its pivot and constrains no motion.
    Castor,
}

/// The two rows of the wheel equation at one steering angle, each to be multiplied by `(vx, vy, omega)`.
#[derive(Clone, Copy, Debug)]
pub struct Rows {
    /// Its product with the twist is `radius * speed + scrub * steering_rate` [m/s].
    pub rolling: Vector3<f64>,
    /// Its product with the twist is `trail * steering_rate` [m/s].
    pub side_slip: Vector3<f64>,
}

impl Wheel {
    /// A fixed wheel that points forward.
    pub fn new(name: impl Into<String>, x: f64, y: f64, radius: f64) -> Self {
        let name = name.into();
        Self {
            name,
            x,
            y,
            radius,
            heading: 0.0,
            pivot: Pivot::Fixed,
            scrub: 0.0,
            trail: 0.0,
            roller_angle: None,
            driven: true,
        }
    }

    /// The same wheel on a steering axis.
    #[must_use]
    #[inline]
    pub fn steered(mut self, range: SteeringRange) -> Self {
        self.pivot = Pivot::Steered(range);
        self
    }

    /// The same wheel without a motor.
    #[must_use]
    pub fn passive(mut self) -> Self {
        self.driven = false;
        self
    }

    /// Steering range, if the wheel can steer.
    #[inline]
    pub fn steering(&self) -> Option<SteeringRange> {
        match self.pivot {
            Pivot::Steered(range) => Some(range),
            Pivot::Fixed | Pivot::Castor => None,
        }
    }

    /// Fails unless every number is inside its range.
    pub fn check(&self) -> Result<(), Error> {
        if self.name.is_empty() {
            return Err(Error::value("name", "not be empty", "''"));
        }
        positive("radius", self.radius)?;
        if self.radius < TINY {
            return Err(Error::value("radius", format!("be at least {TINY:e}"), number(self.radius)));
        }
        for (argument, value) in fields!(self: radius, x, y, scrub, trail) {
            finite(argument, &[value])?;
            if value.abs() >= HUGE {
                return Err(Error::value(argument, format!("be smaller than {HUGE:e}"), number(value)));
            }
        }
        finite("heading", &[self.heading])?;
        if self.heading.abs() > LARGEST_HEADING {
            let rule = format!("be an angle, at most {LARGEST_HEADING} rad");
            return Err(Error::value("heading", rule, number(self.heading)));
        }
        if let Some(angle) = self.roller_angle {
            self.check_rollers(angle)?;
        }
        if self.pivot == Pivot::Castor && self.trail == 0.0 {
            let rule = "not be 0 for a castor: the contact has to follow the pivot";
            return Err(Error::value("trail", rule, number(self.trail)));
        }
        self.steering().map_or(Ok(()), SteeringRange::check)
    }

    fn check_rollers(&self, angle: f64) -> Result<(), Error> {
        if !angle.is_finite() || angle.sin().abs() < FLAT_ROLLERS {
            let rule = "be finite and no multiple of pi: rollers along the axle leave nothing to drive";
            return Err(Error::value("roller_angle", rule, number(angle)));
        }
        if self.pivot != Pivot::Fixed {
            let rule = "be left out for a wheel that turns about a pivot";
            return Err(Error::value("roller_angle", rule, number(angle)));
        }
        Ok(())
    }

    /// True if the contact is on the steering axis: neither scrub nor trail.
    #[inline]
    pub fn is_centred(&self) -> bool {
        self.scrub == 0.0 && self.trail == 0.0
    }

    /// The wheel equation with the wheel rolling in `direction` (body axes).
    ///
    /// Rollers move freely across their axes: the two rows combine to the one along these, `rolling + cot(roller angle)
    /// side_slip`.
    #[inline]
    pub fn rows(&self, direction: Direction) -> Rows {
        let Rows { rolling, side_slip } = self.bare_rows(direction);
        match self.passed_on() {
            None => Rows { rolling, side_slip },
            Some(share) => Rows { rolling: rolling + side_slip * share, side_slip: Vector3::zeros() },
        }
    }

    /// Distance along the wheel per metre across it by rollers, `cot(roller angle)`; `None` without rollers.
    #[inline]
    pub fn passed_on(&self) -> Option<f64> {
        self.roller_angle.map(|angle| angle.cos() / angle.sin())
    }

    /// The two rows of a steered wheel without scrub and trail, at any steering angle: the velocity of its pivot along
    /// x and y.
    pub fn pivot_rows(&self) -> [Vector3<f64>; 2] {
        [Vector3::new(1.0, 0.0, -self.y), Vector3::new(0.0, 1.0, self.x)]
    }

    /// The wheel equation without regard to rollers.
    pub(crate) fn bare_rows(&self, Direction { sin, cos }: Direction) -> Rows {
        Rows {
            rolling: Vector3::new(cos, sin, self.x * sin - self.y * cos - self.scrub),
            side_slip: Vector3::new(-sin, cos, self.x * cos + self.y * sin - self.trail),
        }
    }

    /// Speed at which the contact slides sideways at this angle [m/s].
    #[inline]
    pub fn side_slip(&self, angle: f64, twist: Twist, steering_rate: f64) -> f64 {
        let rows = self.rows(Direction::from(self.heading + angle));
        rows.side_slip.dot(&Vector3::from(twist)) - self.trail * steering_rate
    }
}
