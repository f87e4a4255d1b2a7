//! Goals: the steady motions that commands become by mode, projection and limits of speed.

use nalgebra::{Matrix3, Vector3};

use super::arc::Arc;
use super::envelope::{Cap, fastest};
use super::limits::Limits;
use super::reason;
use six_wheel_kinematics::admissible::Keep;
use six_wheel_kinematics::geometry::{Pose, Twist};
use six_wheel_kinematics::rover::Rover;

/// Rounds after which a command of finite steps has settled under the limits.
const ROUNDS: usize = 32;

/// The motions that commands mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Every one the rover can make.
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
    /// The part of a twist that it leaves.
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
    /// Their product.
    pub twist: Twist,
    /// Of unit length; any at rest.
    pub direction: Vector3<f64>,
    /// Not negative.
    pub speed: f64,
    /// Share of the speed asked for that the limits leave.
    pub share: f64,
    /// Reasons why it is not the motion asked for.
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

    /// The goal of a command, or none if it is too large to be meant. `period` is the time [s] over which the
    /// motion asked for is to be made, in one arc.
    pub fn new(
        rover: &Rover,
        limits: &Limits,
        scratch: &mut Arc,
        [mode, held]: [Mode; 2],
        period: Option<f64>,
        wanted: Twist,
    ) -> Option<Self> {
        let meant = held.of(mode.of(wanted));
        let projected = match rover.project(meant, Keep::Curvature) {
            Ok(twist) => twist,
            Err(error) if error.kind == six_wheel_numerics::error::ErrorKind::Value => return None,
            Err(_) => Twist::ZERO,
        };
        let mut reasons = if projected == wanted { 0 } else { reason::PROJECTED };
        if projected.vx != meant.vx || projected.omega != meant.omega {
            reasons |= reason::STEERING_LIMIT;
        }
        let mut highest = |direction: Vector3<f64>| -> Cap {
            scratch.set(rover, direction, Vector3::zeros());
            fastest(limits, &scratch.bounds(0.0, 0.0))
        };
        let mut twist = projected;
        let Some((mut speed, mut direction)) = polar(&rover.metric, twist) else {
            return Some(Self::rest(reasons));
        };
        let (whole, cap) = (speed, highest(direction));
        if cap.value < speed {
            twist = Twist::from(direction * cap.value);
            speed = cap.value;
            reasons |= cap.reason;
        }
        // The arc of one period, slowed down until it is inside the limits itself.
        let asked = twist;
        let mut share = 1.0;
        for _ in 0..ROUNDS {
            let Some(period) = period else { break };
            let arc = arc_of(scaled(asked, share), period);
            let (Some((length, along)), true) = (polar(&rover.metric, arc), rover.check(arc, None).is_ok()) else {
                break;
            };
            let cap = highest(along);
            if length <= cap.value * (1.0 + 1e-12) {
                (twist, speed, direction) = (arc, length, along);
                break;
            }
            reasons |= cap.reason;
            share *= cap.value / length;
        }
        Some(Self { twist, direction, speed, share: (speed / whole).min(1.0), reasons })
    }
}

fn scaled(twist: Twist, share: f64) -> Twist {
    Twist::from(Vector3::from(twist) * share)
}

/// The twist that leads in one arc where this one would lead if its axes did not turn along.
fn arc_of(twist: Twist, period: f64) -> Twist {
    let end = Pose { x: twist.vx * period, y: twist.vy * period, yaw: twist.omega * period };
    end.log(period)
}
