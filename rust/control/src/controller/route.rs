//! How to get from the motion there is to the one asked for.

use nalgebra::Vector3;

use super::goal::Goal;
use super::motion::Motion;
use super::reason;
use super::way::Route;
use super::{Controller, Into};
use six_wheel_kinematics::geometry::Twist;

/// Sine of the angle between directions that are one.
const SAME: f64 = 1e-12;

/// Cosine of the turn past which it is better to stop and go backwards than to turn round in motion: 150 degrees.
const REVERSE: f64 = -0.866;

/// Overshoot of a steering angle that is rounding [rad].
const ANGLE_TOLERANCE: f64 = 1e-9;

impl Controller {
    /// Whether the body stands.
    pub(super) fn at_rest(&self) -> bool {
        self.speed == Motion::default()
    }

    /// The way to a goal.
    pub(super) fn find_route(&mut self, goal: Option<&Goal>) -> Route {
        let Some(goal) = goal.filter(|goal| goal.speed > 0.0) else {
            return Route::Stay;
        };
        if !self.aligned {
            return self.align_to(goal);
        }
        if self.envelope.turn[1].value.is_infinite() {
            self.turn.rate = 0.0; // it may jump
        }
        let (angle, off) = self.arc.angle_to(self.metric(), self.turn.value, goal.direction);
        let here = off <= SAME && angle.sin().abs() <= SAME;
        if here && self.turn.rate == 0.0 {
            let sign = angle.cos().signum();
            return Route::Along { sign };
        }
        if self.at_rest() {
            return self.align_to(goal);
        }
        let steered = self.rover.steered().iter();
        if steered.map(|&i| &self.rover.wheels()[i]).any(|w| w.trail != 0.0) {
            return Route::Blocked(reason::ALIGNING);
        }
        if off > SAME && self.turn.rate != 0.0 {
            return Route::Wait;
        }
        let cosine = self.direction().dot(&(self.rover.metric * goal.direction));
        let signs = if cosine < REVERSE { [-1.0, 1.0] } else { [1.0, -1.0] };
        for sign in signs {
            let end = self.turn_to(goal.direction * sign);
            if self.reaches(end) {
                return Route::Turn { end, sign };
            }
        }
        Route::Blocked(reason::SPIN_ISLAND)
    }

    /// The angle of a direction on the arc, which is laid through it if it is not there yet.
    fn turn_to(&mut self, direction: Vector3<f64>) -> f64 {
        let (angle, off) = self.arc.angle_to(self.metric(), self.turn.value, direction);
        if off <= SAME {
            return self.turn.value + angle;
        }
        let from = self.direction();
        let image = self.rover.metric * direction;
        let along = from.dot(&image);
        let across = direction - from * along;
        let length = across.dot(&(self.rover.metric * across)).sqrt();
        self.arc.set(&self.rover, from, across / length);
        self.turn = Motion::at(0.0);
        self.envelope.turning = false;
        length.atan2(along)
    }

    /// Whether every wheel can turn along to that angle, all the way.
    fn reaches(&self, end: f64) -> bool {
        let turns = self.arc.turns(&self.rover, self.turn.value, end);
        let mut wheels = self.joints.iter().zip(self.rover.steered());
        turns.zip(&mut wheels).all(|(turn, (&joint, &i))| {
            let range = self.rover.wheels()[i].steering().unwrap_or_default();
            let angle = self.steering[joint] + turn;
            (angle - range.clip(angle)).abs() <= ANGLE_TOLERANCE
        })
    }

    /// The angles to go to at rest.
    fn align_to(&mut self, goal: &Goal) -> Route {
        self.aligned = false;
        self.turn.rate = 0.0;
        self.solve(Twist::from(goal.direction), Into::Targets);
        Route::Align
    }

    /// Lays the arc through this direction, which is where the motion is, but for rounding.
    pub(super) fn settle(&mut self, direction: Vector3<f64>) {
        self.arc.set(&self.rover, direction, Vector3::zeros());
        self.turn = Motion::at(0.0);
        self.aligned = true;
        self.settled = false;
        self.envelope.turning = false;
        self.solve(Twist::from(direction), Into::Steering);
    }
}
