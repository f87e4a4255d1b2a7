//! The wheel equation: what one wheel, fixed or steered, with scrub and trail, asks of a twist.
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

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Vector2, Vector3};

use crate::error::{Error, number, positive};
use crate::geometry::Twist;

/// Overshoot of a steering angle that is rounding, not a request [rad].
const ANGLE_TOLERANCE: f64 = 1e-9;

/// Share of the summed speeds at a pivot below which their sum is nothing but rounding.
const REST: f64 = 4.0 * f64::EPSILON;

/// Angles a steered wheel can take, counted from its heading [rad].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteeringRange {
    /// Smallest angle [rad].
    pub lower: f64,
    /// Largest angle [rad].
    pub upper: f64,
}

impl Default for SteeringRange {
    /// A quarter turn to either side: enough to roll in every direction, backwards if need be.
    fn default() -> Self {
        Self {
            lower: -FRAC_PI_2,
            upper: FRAC_PI_2,
        }
    }
}

impl SteeringRange {
    /// From `-limit` to `limit`. Fails unless the limit is finite and positive.
    pub fn symmetric(limit: f64) -> Result<Self, Error> {
        positive("steering_limit", limit)?;
        Ok(Self {
            lower: -limit,
            upper: limit,
        })
    }

    /// Fails unless both ends are finite and in order.
    pub fn check(self) -> Result<(), Error> {
        if self.lower.is_finite() && self.upper.is_finite() && self.lower < self.upper {
            return Ok(());
        }
        let rule = "be finite, the lower angle below the upper";
        Err(Error::value("steering_limit", rule, self.to_string()))
    }

    /// Whether a wheel can roll in every direction, forwards or backwards.
    pub fn is_full(self) -> bool {
        self.upper - self.lower >= PI
    }
}

impl std::fmt::Display for SteeringRange {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "({}, {})", number(self.lower), number(self.upper))
    }
}

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
    /// Where it can steer; `None` for a fixed wheel.
    pub steering: Option<SteeringRange>,
    /// Contact to the left of the steering axis [m].
    pub scrub: f64,
    /// Contact behind the steering axis [m].
    pub trail: f64,
}

/// Sine and cosine of one angle.
#[derive(Clone, Copy, Debug)]
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

/// The two rows of the wheel equation at one steering angle, each to be multiplied by `(vx, vy, omega)`.
#[derive(Clone, Copy, Debug)]
pub struct Rows {
    /// Gives `radius * speed + scrub * steering_rate`.
    pub rolling: Vector3<f64>,
    /// Gives `trail * steering_rate`.
    pub side_slip: Vector3<f64>,
}

/// What a wheel has to do.
#[derive(Clone, Copy, Debug)]
pub struct WheelCommand {
    /// Steering angle [rad]; 0 for a fixed wheel.
    pub angle: f64,
    /// Speed of the contact along the rim [m/s].
    pub rim_speed: f64,
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
            steering: None,
            scrub: 0.0,
            trail: 0.0,
        }
    }

    /// The same wheel on a steering axis.
    #[must_use]
    pub fn steered(mut self, range: SteeringRange) -> Self {
        self.steering = Some(range);
        self
    }

    /// Fails unless every number makes sense.
    pub fn check(&self) -> Result<(), Error> {
        if self.name.is_empty() {
            return Err(Error::value("name", "not be empty", "''"));
        }
        positive("radius", self.radius)?;
        let lengths = [
            ("x", self.x),
            ("y", self.y),
            ("heading", self.heading),
            ("scrub", self.scrub),
            ("trail", self.trail),
        ];
        for (argument, value) in lengths {
            if !value.is_finite() {
                return Err(Error::value(argument, "be finite", number(value)));
            }
        }
        self.steering.map_or(Ok(()), SteeringRange::check)
    }

    /// Whether a steering angle is a fixed offset of the contact: neither scrub nor trail.
    pub fn is_centred(&self) -> bool {
        self.scrub == 0.0 && self.trail == 0.0
    }

    /// The wheel equation with the wheel rolling in `direction` (body axes).
    pub fn rows(&self, direction: Direction) -> Rows {
        let Direction { sin, cos } = direction;
        Rows {
            rolling: Vector3::new(cos, sin, self.x * sin - self.y * cos - self.scrub),
            side_slip: Vector3::new(-sin, cos, self.x * cos + self.y * sin - self.trail),
        }
    }

    /// The wheel equation solved for angle and rim speed of a steered wheel.
    ///
    /// Of the angles that do it inside the range, the nearest to `previous`, and of two equally near ones
    /// the one that rolls forwards. A pivot at rest holds `previous`. Where the range does not allow the
    /// motion the nearest end is returned: whether the motion is possible is for [`Self::side_slip`] to say.
    pub fn steer(
        &self,
        range: SteeringRange,
        heading: Direction,
        twist: Twist,
        steering_rate: f64,
        previous: f64,
    ) -> WheelCommand {
        let previous = previous.clamp(range.lower, range.upper);
        let turning = twist.omega + steering_rate;
        let Some(u) = self.pivot_velocity(heading, twist) else {
            return WheelCommand {
                angle: previous,
                rim_speed: -self.scrub * turning,
            };
        };
        // Work in the half plane where the pivot moves forwards: the small angles lose no digits.
        let sign = if u.x < 0.0 { -1.0 } else { 1.0 };
        let half = (sign * u.y).atan2(sign * u.x);
        let speed = u.x.hypot(u.y);
        // n . u = trail (omega + steering_rate) has two solutions, half a turn apart without trail.
        let across = self.trail * turning;
        let along = if across == 0.0 {
            speed
        } else {
            (speed - across).max(0.0).sqrt() * (speed + across).max(0.0).sqrt()
        };
        let lean = (sign * across).atan2(along);
        let candidates = [
            (half - lean, sign * along),
            (half + lean + PI, -sign * along),
        ];
        let [first, second] = candidates.map(|(angle, along)| {
            let angle = nearest_turn(angle, previous, range);
            let clipped = angle.clamp(range.lower, range.upper);
            let overshoot = ((angle - clipped).abs() - ANGLE_TOLERANCE).max(0.0);
            (
                overshoot,
                (clipped - previous).abs(),
                along < 0.0,
                clipped,
                along,
            )
        });
        let key = |c: &(f64, f64, bool, f64, f64)| (c.0, c.1, c.2);
        let (.., angle, along) = if key(&second) < key(&first) {
            second
        } else {
            first
        };
        WheelCommand {
            angle,
            rim_speed: along - self.scrub * turning,
        }
    }

    /// Speed at which the contact slides sideways at this angle [m/s].
    pub fn side_slip(&self, angle: f64, twist: Twist, steering_rate: f64) -> f64 {
        let rows = self.rows(Direction::from(self.heading + angle));
        rows.side_slip.dot(&Vector3::from(twist)) - self.trail * steering_rate
    }

    /// Velocity of the pivot in the axes of steering angle 0, or nothing where it rests.
    fn pivot_velocity(&self, heading: Direction, twist: Twist) -> Option<Vector2<f64>> {
        let Direction { sin, cos } = heading;
        let u = twist.at(self.x, self.y);
        let summed =
            twist.vx.abs() + twist.vy.abs() + twist.omega.abs() * (self.x.abs() + self.y.abs());
        (u.amax() > REST * summed)
            .then(|| Vector2::new(cos * u.x + sin * u.y, cos * u.y - sin * u.x))
    }
}

/// `angle` plus the whole turns that bring it nearest to `previous`, but into the range if any do.
fn nearest_turn(angle: f64, previous: f64, range: SteeringRange) -> f64 {
    let near = angle + TAU * ((previous - angle) / TAU).round_ties_even();
    let above = near - range.upper;
    let below = range.lower - near;
    if above > ANGLE_TOLERANCE {
        let turned = near - TAU * (above / TAU).ceil();
        // A range narrower than a turn may hold neither: then the nearer end decides.
        if range.lower - turned <= ANGLE_TOLERANCE.max(above) {
            turned
        } else {
            near
        }
    } else if below > ANGLE_TOLERANCE {
        let turned = near + TAU * (below / TAU).ceil();
        if turned - range.upper <= ANGLE_TOLERANCE.max(below) {
            turned
        } else {
            near
        }
    } else {
        near
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RANGE: SteeringRange = SteeringRange {
        lower: -1.0,
        upper: 8.0,
    };

    #[test]
    fn whole_turns_bring_an_angle_into_its_range() {
        for (angle, previous, expected) in [
            (0.5, 0.0, 0.5),
            (0.5, 7.0, 0.5 + TAU),
            (-2.0, 0.0, -2.0 + TAU),
            (3.0, -40.0, 3.0),
            (0.5, 40.0, 0.5 + TAU),
        ] {
            let got = nearest_turn(angle, previous, RANGE);
            assert!((got - expected).abs() < 1e-12, "{angle} {previous}: {got}");
        }
    }

    #[test]
    fn a_pivot_rests_up_to_rounding_and_no_further() {
        let wheel = Wheel::new("w", 0.3, 0.4, 0.1).steered(SteeringRange::default());
        let forward = Direction::from(0.0);
        let about = |shift: f64| Twist {
            vx: 0.4,
            vy: -0.3 + shift,
            omega: 1.0,
        };
        let summed = 0.4 + 0.3 + 0.7;
        for (shift, rests) in [
            (0.0, true),
            (2.0 * f64::EPSILON * summed, true),
            (1e-14, false),
        ] {
            assert_eq!(
                wheel.pivot_velocity(forward, about(shift)).is_none(),
                rests,
                "{shift}"
            );
        }
    }

    #[test]
    fn an_angle_past_the_range_by_rounding_is_clipped() {
        let range = SteeringRange {
            lower: -0.5,
            upper: 0.5,
        };
        let wheel = Wheel::new("w", 0.0, 0.0, 0.1).steered(range);
        let forward = Direction::from(0.0);
        for (angle, expected) in [(0.5 + 1e-10, 0.5), (0.5 - 1e-10, 0.5 - 1e-10), (-0.7, -0.5)] {
            let (vy, vx) = f64::sin_cos(angle);
            let twist = Twist { vx, vy, omega: 0.0 };
            let command = wheel.steer(range, forward, twist, 0.0, 0.0);
            assert!(
                (command.angle - expected).abs() < 1e-15,
                "{angle}: {command:?}"
            );
        }
    }
}
