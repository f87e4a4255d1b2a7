//! A turn under way that goes over into another plane of directions.
//!
//! Vehicles that go in any direction have a sphere of directions, and a goal that moves leaves the plane of the turn. The
//! turn has a rate `r`; where its plane swings by the angle `δ` about the direction there is, its velocity changes by
//! `2 r sin(δ / 2) <= r δ` across. So `δ` is bounded by what joints and jerk allow of such a change in one step.

use nalgebra::Vector3;

use super::Controller;
use super::route::SAME;
use super::way::Route;
use crate::motion::Motion;
use crate::motion::envelope::over;
use crate::motion::goal::Goal;

/// Share of the change of a turn that is for its plane, in a step in which that swings; the rest is for its rate.
const SHARE: f64 = 0.5;

/// Sine of an angle between planes that is rounding.
const ROUNDING: f64 = 1e-9;

impl Controller {
    /// Swings the plane of the turn towards a goal that is not in it, as far as one step allows, and turns on to the
    /// direction in that plane which is next to the goal.
    pub(super) fn swing(&mut self, goal: &Goal, dt: f64) -> Route {
        let [sign, other] = self.signs(goal);
        let wanted = goal.direction * sign;
        let (from, ahead) = (self.direction(), self.arc.ahead(self.turn.value) * self.turn.rate.signum());
        if let Some(across) = self.swung(from, ahead, wanted, goal.speed, dt) {
            let before = (self.turn, self.envelope);
            self.arc.set(&self.rover, from, across);
            self.turn = Motion { value: 0.0, rate: before.0.rate.abs() };
            let (angle, off) = self.arc.angle_to(self.metric(), 0.0, wanted);
            let best = self.search(angle, goal.speed, dt, 1.0 - SHARE).best;
            if let Some((_, envelope)) = best.filter(|_| self.reaches(angle)) {
                self.enter(envelope);
                self.ahead = f64::INFINITY;
                self.swung = true;
                return Route::Turn { end: angle, sign, exact: off <= SAME };
            }
            self.arc.set(&self.rover, from, ahead);
            self.turn = Motion { value: 0.0, rate: before.0.rate.abs() };
            self.envelope.end = (before.1.end - before.0.value) * before.0.rate.signum();
            self.entered = (self.entered - before.0.value) * before.0.rate.signum();
        }
        for sign in [sign, other] {
            let (angle, off) = self.arc.angle_to(self.metric(), self.turn.value, goal.direction * sign);
            let end = self.turn.value + angle;
            if self.reaches(end) {
                return Route::Turn { end, sign, exact: off <= SAME };
            }
        }
        Route::Wait
    }

    /// The velocity of the turn per rate after the swing that one step allows, from `ahead` towards a direction; none if
    /// that lies behind.
    fn swung(
        &mut self,
        from: Vector3<f64>,
        ahead: Vector3<f64>,
        to: Vector3<f64>,
        speed: f64,
        dt: f64,
    ) -> Option<Vector3<f64>> {
        let (towards, _) = self.part_across(from, to);
        let cosine = ahead.dot(&(self.metric() * towards));
        let (across, sine) = self.part_across(ahead, towards);
        let (across, _) = self.part_across(from, across);
        if cosine <= 0.0 || sine <= ROUNDING {
            return None;
        }
        let angle = sine.atan2(cosine).min(self.largest_swing(from, [across, ahead], speed, dt));
        let (sin, cos) = angle.sin_cos();
        (angle > 0.0).then(|| ahead * cos + across * sin)
    }

    /// Largest angle by which the plane of the turn may swing from `ahead` towards `across` [rad].
    fn largest_swing(&mut self, from: Vector3<f64>, [across, ahead]: [Vector3<f64>; 2], speed: f64, dt: f64) -> f64 {
        let limits = self.speed_bounds.limits;
        let (rate, speed) = (self.turn.rate.abs(), speed.max(self.speed.value.abs()));
        // The change counts over the time between the middles of two steps; half of that has the rate's whole change.
        let time = SHARE / 2.0 * dt.min(self.step_before);
        let [across, ahead] = [across, ahead].map(|part| {
            self.scratch.set(&self.rover, from, part);
            let bounds = self.scratch.bounds(0.0, 0.0);
            let joints = self.scratch.steering_rates(&self.rover, 0.0);
            [joints.fold(0.0, |most: f64, rate| most.max(rate.abs())), bounds.linear.across, bounds.yaw.across]
        });
        // The shares of the envelope: half of the joints' acceleration, a sixth of jerk.
        let allowed = [limits.steering_acceleration / 2.0, limits.jerk / 6.0, limits.angular_jerk / 6.0];
        let per = [rate, rate * speed, rate * speed];
        let mut angle = f64::INFINITY;
        for (k, allowed) in allowed.into_iter().enumerate().filter(|(_, allowed)| allowed.is_finite()) {
            // Of the change `sin(angle) across + (1 - cos(angle)) ahead` each part may have half.
            let half = allowed * time / 2.0;
            angle = angle.min(over(half, per[k] * across[k])).min(over(2.0 * half, per[k] * ahead[k]).sqrt());
        }
        angle
    }
}
