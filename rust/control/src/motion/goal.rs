//! Goals: the steady motions that follow from commands by mode, projection and limits of speed.

use nalgebra::{Matrix3, Vector3};

use super::arc::Arc;
use super::envelope::{NamedLimit, fastest};
use super::limits::Limits;
use super::reason;
use six_wheel_kinematics::admissible::Keep;
use six_wheel_kinematics::geometry::{Pose, Twist};
use six_wheel_kinematics::rover::Rover;

/// Most rounds in which the arc of one period is scaled to the limits.
const ROUNDS: usize = 32;

/// Motions that a command is restricted to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Every motion that the rover can make.
    #[default]
    Free,
    /// Without turning.
    Crab,
    /// The front wheels steer, the others are held straight.
    FrontOnly,
    /// Turning on the spot.
    Spin,
}

impl Mode {
    /// The part of a twist that the mode allows.
    fn of(self, twist: Twist) -> Twist {
        match self {
            Self::Free | Self::FrontOnly => twist,
            Self::Crab => Twist { omega: 0.0, ..twist },
            Self::Spin => Twist { vx: 0.0, vy: 0.0, ..twist },
        }
    }
}

named_values! { Mode as "mode": "free" => Free, "crab" => Crab, "front_only" => FrontOnly, "spin" => Spin }

/// A motion to reach: a speed along a direction.
#[derive(Clone, Copy, Debug)]
pub struct Goal {
    /// Speed times direction.
    pub twist: Twist,
    /// Unit direction; arbitrary at rest.
    pub direction: Vector3<f64>,
    /// Speed along the direction, not negative [m/s].
    pub speed: f64,
    /// Share of the desired speed that the limits allow.
    pub share: f64,
    /// Reasons why it is not the desired motion.
    pub reasons: u32,
}

/// Length and direction of a twist; none of length zero.
pub fn polar(metric: &Matrix3<f64>, twist: Twist) -> Option<(f64, Vector3<f64>)> {
    let vector = Vector3::from(twist);
    let size = vector.amax();
    if size == 0.0 {
        return None;
    }
    let scaled = vector / size;
    let length = scaled.dot(&(metric * scaled)).sqrt();
    Some((size * length, scaled / length))
}

impl Goal {
    fn rest(reasons: u32) -> Self {
        Self { twist: Twist::ZERO, direction: Vector3::x(), speed: 0.0, share: 1.0, reasons }
    }

    /// The goal of a command; None if its squares overflow. With `period` [s], the goal is the arc that ends after that
    /// time where the desired twist, its axes held fixed, would.
    pub fn new(
        rover: &Rover,
        limits: &Limits,
        scratch: &mut Arc,
        [mode, held]: [Mode; 2],
        period: Option<f64>,
        desired: Twist,
    ) -> Option<Self> {
        let allowed = held.of(mode.of(desired));
        let projected = match rover.project(allowed, Keep::Curvature) {
            Ok(twist) => twist,
            Err(error) if error.kind == six_wheel_numerics::error::ErrorKind::Value => return None,
            Err(_) => Twist::ZERO,
        };
        let mut reasons = if projected == desired { 0 } else { reason::PROJECTED };
        if projected.vx != allowed.vx || projected.omega != allowed.omega {
            reasons |= reason::STEERING_LIMIT;
        }
        let mut highest = |direction: Vector3<f64>| -> NamedLimit {
            scratch.set(rover, direction, Vector3::zeros());
            fastest(limits, &scratch.bounds(0.0, 0.0))
        };
        let mut twist = projected;
        let Some((mut speed, mut direction)) = polar(&rover.metric, twist) else {
            return Some(Self::rest(reasons));
        };
        let (whole, limit) = (speed, highest(direction));
        if limit.value < speed {
            twist = Twist::from(direction * limit.value);
            speed = limit.value;
            reasons |= limit.reason;
        }
        // The arc of one period, scaled until it is inside the limits.
        let limited = twist;
        let mut share = 1.0;
        for _ in 0..ROUNDS {
            let Some(period) = period else { break };
            let arc = arc_of(scaled(limited, share), period);
            let (Some((length, along)), true) = (polar(&rover.metric, arc), rover.check(arc, None).is_ok()) else {
                break;
            };
            let limit = highest(along);
            if length <= limit.value * (1.0 + 1e-12) {
                (twist, speed, direction) = (arc, length, along);
                break;
            }
            reasons |= limit.reason;
            share *= limit.value / length;
        }
        Some(Self { twist, direction, speed, share: (speed / whole).min(1.0), reasons })
    }
}

fn scaled(twist: Twist, share: f64) -> Twist {
    Twist::from(Vector3::from(twist) * share)
}

/// The constant twist whose arc of one period ends where this twist, in axes that do not turn, would.
fn arc_of(twist: Twist, period: f64) -> Twist {
    let end = Pose { x: twist.vx * period, y: twist.vy * period, yaw: twist.omega * period };
    end.log(period)
}
