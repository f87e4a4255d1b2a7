//! The way from the motion there is to the one asked for.

use nalgebra::Vector3;

use super::align::{NEAR, STILL_NEAR};
use super::joints::Into;
use super::way::Route;
use super::{Controller, PATIENCE};
use crate::motion::Motion;
use crate::motion::goal::Goal;
use crate::motion::reason;
use six_wheel_kinematics::geometry::Twist;

/// Sine of the angle between directions that are one.
pub(super) const SAME: f64 = 1e-12;

/// Cosine of the turn past which it is better to stop and go backwards than to turn round in motion: 150 degrees.
const REVERSE: f64 = -0.866;

/// Overshoot of a steering angle that is rounding [rad].
pub(super) const ANGLE_TOLERANCE: f64 = 1e-9;

/// Time for which goals have to be off the direction of wheels with trail before those are turned [s]: that takes a stop.
const TRAIL_PATIENCE: f64 = 0.5;

impl Controller {
    /// True if the body stands.
    pub(super) fn at_rest(&self) -> bool {
        self.speed == Motion::default()
    }

    /// The way to a goal.
    pub(super) fn find_route(&mut self, goal: Option<&Goal>, dt: f64) -> Route {
        let Some(goal) = goal.filter(|goal| goal.speed > 0.0) else {
            (self.astray, self.arrived) = (PATIENCE, false);
            return Route::Stay;
        };
        if !self.aligned {
            return self.align_to(goal, dt);
        }
        if self.envelope.turn[1].value.is_infinite() {
            self.turn.rate = 0.0; // it may jump
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
            return self.swing(goal, dt);
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
        self.astray = PATIENCE;
        Route::Blocked(reason::SPIN_ISLAND)
    }

    /// Forwards or backwards along the goal: first the one that takes the shorter turn.
    pub(super) fn signs(&self, goal: &Goal) -> [f64; 2] {
        let cosine = self.direction().dot(&(self.metric() * goal.direction));
        if cosine < REVERSE { [-1.0, 1.0] } else { [1.0, -1.0] }
    }

    /// Wheels with trail change direction at rest only: as long as goals are next to the direction there is, now and then
    /// at least, it is kept.
    fn near_or_stop(&mut self, goal: &Goal, sign: f64, dt: f64) -> Route {
        let rests = self.at_rest();
        self.solve(Twist::from(goal.direction), Into::Candidates);
        let apart = self.steering.iter().zip(&self.candidates).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        self.astray = if apart <= self.options.align_tolerance { 0.0 } else { self.astray + dt };
        if apart <= NEAR && self.astray < TRAIL_PATIENCE {
            self.rerouted = true;
            return Route::Near { sign };
        }
        self.astray = PATIENCE;
        if rests { self.align_to(goal, dt) } else { Route::Blocked(reason::ALIGNING) }
    }

    /// The angle of a direction on the arc, which is laid through it if it is not there yet.
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

    /// The part of a vector at a right angle to a direction: its own direction, and its length.
    ///
    /// A short part is mostly the rounding of its vector, and that has a part along: so it is taken out twice.
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

    /// True if every wheel can turn along to that angle, all the way.
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

    /// True if joints have to turn for that angle, and only a little.
    fn is_near(&self, end: f64) -> bool {
        let turns = self.arc.turns(&self.rover, self.turn.value, end);
        let most = turns.fold(0.0, |most: f64, turn| most.max(turn.abs()));
        let limits = &self.speed_bounds.limits;
        let at_once = limits.steering_rate.is_infinite() && limits.steering_acceleration.is_infinite();
        !at_once && 0.0 < most && most <= if self.arrived { STILL_NEAR } else { NEAR }
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
