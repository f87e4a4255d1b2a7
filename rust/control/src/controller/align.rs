//! Alignment at rest: every joint turns to its angle for a direction, within its own limits.

use super::joints::SolveTarget;
use super::route::Route;
use super::{Controller, PATIENCE};
use crate::motion::goal::Goal;
use crate::motion::reason;
use crate::motion::{LimitedBy, Motion};
use six_wheel_kinematics::geometry::Twist;

/// Largest turn of a joint that is made in motion where it could be made at rest [rad]. Goals are near each other if
/// the angles of their joints differ by less.
pub(super) const NEAR: f64 = 0.3;

/// The same bound for joints that have just arrived [rad]: the goal has moved meanwhile.
pub(super) const STILL_NEAR: f64 = 0.6;

/// Share of a time that is rounding.
const ROUNDING: f64 = 1e-9;

impl Controller {
    /// Chooses the target angles of an alignment.
    ///
    /// Moving joints keep their targets while goals are near them, unless others are reached sooner: so the time to
    /// arrival falls, however often the command changes.
    pub(super) fn align_to(&mut self, goal: &Goal, dt: f64) -> Route {
        self.solve(Twist::from(goal.direction), SolveTarget::Candidates);
        let sooner = self.time_to(&self.candidates);
        let held = if self.aligned { &self.steering } else { &self.targets };
        let apart = held.iter().zip(&self.candidates).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        self.off_goal_time = if apart <= NEAR { 0.0 } else { self.off_goal_time + dt };
        if self.aligned {
            if sooner > 0.0 && self.off_goal_time > 0.0 && self.off_goal_time < PATIENCE {
                return Route::Wait;
            }
        } else if self.route == Route::Align {
            let kept = self.time_to(&self.targets);
            if (self.off_goal_time < PATIENCE || kept <= self.off_goal_time)
                && kept > 0.0
                && sooner >= kept * (1.0 - ROUNDING)
            {
                return Route::Align;
            }
        }
        self.aligned = false;
        self.turn.rate = 0.0;
        self.off_goal_time = 0.0;
        self.target = goal.direction;
        std::mem::swap(&mut self.targets, &mut self.candidates);
        Route::Align
    }

    /// Time after which all joints can be at these angles [s].
    fn time_to(&self, angles: &[f64]) -> f64 {
        let limits = &self.speed_bounds.limits;
        let joints = self.steering.iter().zip(&self.steering_rates).zip(angles);
        let times = joints.map(|((&value, &rate), &angle)| {
            Motion { value, rate }.time_to(angle, [limits.steering_rate; 2], limits.steering_acceleration)
        });
        times.fold(0.0, f64::max)
    }

    /// One step of every joint towards its target, the body at rest. Returns true if the body may start to move, and
    /// the reasons.
    pub(super) fn align(&mut self, goal: Option<&Goal>, dt: f64) -> (bool, u32) {
        let limits = &self.speed_bounds.limits;
        let (rates, change) = ([limits.steering_rate; 2], limits.steering_acceleration);
        let at_once = limits.steering_rate.is_infinite() && change.is_infinite();
        let onwards = self.route == Route::Align;
        let (mut there, mut moved, mut reasons) = (true, false, 0);
        for (k, angle) in self.steering.iter_mut().enumerate() {
            let motion = Motion { value: *angle, rate: self.steering_rates[k] };
            let target = match self.joints.iter().position(|&joint| joint == k) {
                _ if onwards => self.targets[k],
                Some(place) => {
                    let wheel = &self.rover.wheels()[self.rover.steered()[place]];
                    let range = wheel.steering().unwrap_or_default();
                    range.clip(self.following.holds[k].unwrap_or(motion.stop(change)))
                }
                // A joint that the mode keeps straight.
                None => 0.0,
            };
            let (motion, held) = motion.step_towards(target, rates, change, dt);
            moved |= motion.value != *angle;
            there &= held == LimitedBy::Nothing;
            reasons |= held.reason(reason::STEERING_RATE, reason::STEERING_ACCELERATION);
            *angle = motion.value;
            self.steering_rates[k] = motion.rate;
        }
        self.twist = Twist::ZERO;
        let Some(goal) = goal.filter(|_| onwards) else {
            return (false, reasons);
        };
        let mut go = false;
        if there {
            self.set_direction(self.target);
            self.rest_turn();
            self.off_goal_time = 0.0;
            self.arrived = true;
            self.route = Route::Along { sign: 1.0 };
            // The route to a goal that has moved meanwhile is found in the next step.
            self.rerouted |= self.target != goal.direction;
            go = self.target == goal.direction && (at_once || !moved);
        }
        (go, if go { 0 } else { reasons | reason::ALIGNING })
    }
}
