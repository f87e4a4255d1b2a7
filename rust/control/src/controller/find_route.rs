//! The choice of a route from the present motion to a goal.

use nalgebra::Vector3;

use super::align::{NEAR, STILL_NEAR};
use super::joints::SolveTarget;
use super::route::Route;
use super::{Controller, PATIENCE};
use crate::motion::Motion;
use crate::motion::goal::Goal;
use crate::motion::reason;
use six_wheel_kinematics::geometry::Twist;

/// Sine of the angle between two directions below which they count as equal.
pub(super) const SAME: f64 = 1e-12;

/// Cosine of the turn beyond which driving backwards is tried before a turn in motion: 150 degrees.
const REVERSE: f64 = -0.866;

/// Overshoot of a steering angle that is rounding [rad].
pub(super) const ANGLE_TOLERANCE: f64 = 1e-9;

/// Time for which goals have to differ from the direction of wheels with trail before the rover stops and turns them
/// [s].
const TRAIL_PATIENCE: f64 = 0.5;

impl Controller {
    /// True if the body is at rest.
    pub(super) fn at_rest(&self) -> bool {
        self.speed == Motion::default()
    }

    /// The route to a goal.
    pub(super) fn find_route(&mut self, goal: Option<&Goal>, dt: f64) -> Route {
        let Some(goal) = goal.filter(|goal| goal.speed > 0.0) else {
            (self.off_goal_time, self.arrived) = (PATIENCE, false);
            return Route::Stay;
        };
        if !self.aligned {
            return self.align_to(goal, dt);
        }
        if self.envelope.turn[1].value.is_infinite() {
            self.turn.rate = 0.0; // without a limit of its change the rate may jump
        }
        if self.pending.is_some() && self.turn.rate != 0.0 {
            return Route::Wait;
        }
        let (angle, off) = self.arc.angle_to(self.metric(), self.turn.value, goal.direction);
        let here = off <= SAME && angle.sin().abs() <= SAME;
        if here && self.turn.rate == 0.0 {
            return Route::Along { sign: angle.cos().signum() };
        }
        let rests = self.at_rest();
        self.arrived &= rests;
        if rests && self.joints.is_empty() {
            return self.align_to(goal, dt);
        }
        let mut steered = self.rover.steered().iter().map(|&i| &self.rover.wheels()[i]);
        if steered.any(|wheel| wheel.trail != 0.0) {
            return self.near_or_stop(goal, angle.cos().signum(), dt);
        }
        if off > SAME && self.turn.rate != 0.0 {
            return self.change_plane(goal, dt);
        }
        for sign in self.signs(goal) {
            let end = self.turn_to(goal.direction * sign);
            if self.reaches(end) && (!rests || self.is_near(end)) {
                return Route::Turn { end, sign, exact: true };
            }
        }
        if rests {
            return self.align_to(goal, dt);
        }
        self.off_goal_time = PATIENCE;
        Route::Blocked(reason::SPIN_ISLAND)
    }

    /// Signs of forwards and backwards along the goal's direction, in the order in which they are tried.
    pub(super) fn signs(&self, goal: &Goal) -> [f64; 2] {
        let cosine = self.direction().dot(&(self.metric() * goal.direction));
        if cosine < REVERSE { [-1.0, 1.0] } else { [1.0, -1.0] }
    }

    /// The route of a rover with trail, whose wheels change their direction at rest only: the direction is kept while
    /// goals are near it at least once in [`TRAIL_PATIENCE`].
    fn near_or_stop(&mut self, goal: &Goal, sign: f64, dt: f64) -> Route {
        let rests = self.at_rest();
        self.solve(Twist::from(goal.direction), SolveTarget::Candidates);
        let apart = self.steering.iter().zip(&self.candidates).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        self.off_goal_time = if apart <= self.options.align_tolerance { 0.0 } else { self.off_goal_time + dt };
        if apart <= NEAR && self.off_goal_time < TRAIL_PATIENCE {
            self.rerouted = true;
            return Route::Near { sign };
        }
        self.off_goal_time = PATIENCE;
        if rests { self.align_to(goal, dt) } else { Route::Blocked(reason::ALIGNING) }
    }

    /// The angle of a direction on the arc [rad]; the arc is replaced by one through the direction if it is not on it.
    fn turn_to(&mut self, direction: Vector3<f64>) -> f64 {
        let (angle, off) = self.arc.angle_to(self.metric(), self.turn.value, direction);
        if off <= SAME {
            return self.turn.value + angle;
        }
        let from = self.direction();
        let along = from.dot(&(self.metric() * direction));
        let (across, length) = self.part_across(from, direction);
        self.arc.set(&self.rover, from, across);
        self.turn = Motion::at(0.0);
        self.envelope.turning = false;
        length.atan2(along)
    }

    /// The part of a vector orthogonal to a direction: its own direction, and its length.
    ///
    /// Gram-Schmidt twice: after one pass a short part still has a component along the direction, by rounding.
    pub(super) fn part_across(&self, from: Vector3<f64>, vector: Vector3<f64>) -> (Vector3<f64>, f64) {
        let metric = self.metric();
        let part = |vector: Vector3<f64>| {
            let across = vector - from * from.dot(&(metric * vector));
            let length = across.dot(&(metric * across)).sqrt();
            (if length > 0.0 { across / length } else { across }, length)
        };
        let (across, length) = part(vector);
        (part(across).0, length)
    }

    /// True if every steering joint stays in its range for a turn to the angle `end` of the arc.
    pub(super) fn reaches(&self, end: f64) -> bool {
        let rover = self.narrowed.as_ref().unwrap_or(&self.rover);
        let turns = self.arc.turns(&self.rover, self.turn.value, end);
        let mut wheels = self.joints.iter().zip(rover.steered());
        turns.zip(&mut wheels).all(|(turn, (&joint, &i))| {
            let range = rover.wheels()[i].steering().unwrap_or_default();
            let angle = self.steering[joint] + turn;
            (angle - range.clip(angle)).abs() <= ANGLE_TOLERANCE
        })
    }

    /// True if joints have to turn to the angle `end` of the arc, and by so little that they turn in motion.
    fn is_near(&self, end: f64) -> bool {
        let turns = self.arc.turns(&self.rover, self.turn.value, end);
        let most = turns.fold(0.0, |most: f64, turn| most.max(turn.abs()));
        let limits = &self.speed_bounds.limits;
        let at_once = limits.steering_rate.is_infinite() && limits.steering_acceleration.is_infinite();
        !at_once && 0.0 < most && most <= if self.arrived { STILL_NEAR } else { NEAR }
    }

    /// Makes this direction, which is the present one up to rounding, the start of the arc.
    pub(super) fn set_direction(&mut self, direction: Vector3<f64>) {
        self.arc.set(&self.rover, direction, Vector3::zeros());
        self.turn = Motion::at(0.0);
        self.aligned = true;
        self.is_direction_envelope = false;
        self.envelope.turning = false;
        self.solve(Twist::from(direction), SolveTarget::Steering);
    }
}
