//! Change of the plane of a turn in motion.
//!
//! Rovers with three degrees of freedom have a sphere of directions, on which a moving goal leaves the great circle of
//! the turn. The turn has a rate `r`; where its plane rotates by the angle `δ` about the present direction, its
//! velocity on the sphere changes by `2 r sin(δ / 2) <= r δ` across. The limits of joints and jerk for this change in
//! one step bound `δ`.

use nalgebra::Vector3;

use super::Controller;
use super::find_route::SAME;
use super::route::Route;
use crate::motion::Motion;
use crate::motion::envelope::quotient;
use crate::motion::goal::Goal;

/// Share of the limit of a turn's acceleration that is for its plane, in a step that rotates it; the rest is for its
/// rate.
const SHARE: f64 = 0.5;

/// Sine of an angle between planes that is rounding.
const ROUNDING: f64 = 1e-9;

impl Controller {
    /// Rotates the plane of the turn towards a goal outside of it, as far as the limits allow in one step, and turns on
    /// to the direction in the plane that is nearest to the goal.
    pub(super) fn change_plane(&mut self, goal: &Goal, dt: f64) -> Route {
        let [sign, other] = self.signs(goal);
        let desired = goal.direction * sign;
        let (from, ahead) = (self.direction(), self.arc.ahead(self.turn.value) * self.turn.rate.signum());
        if let Some(across) = self.rotated_plane(from, ahead, desired, goal.speed, dt) {
            let before = (self.turn, self.envelope);
            self.arc.set(&self.rover, from, across);
            self.turn = Motion { value: 0.0, rate: before.0.rate.abs() };
            let (angle, off) = self.arc.angle_to(self.metric(), 0.0, desired);
            let best = self.search(angle, goal.speed, dt, 1.0 - SHARE).best;
            if let Some((_, envelope)) = best.filter(|_| self.reaches(angle)) {
                self.enter(envelope);
                self.turn_speed = f64::INFINITY;
                self.plane_changed = true;
                return Route::Turn { end: angle, sign, exact: off <= SAME };
            }
            self.arc.set(&self.rover, from, ahead);
            self.turn = Motion { value: 0.0, rate: before.0.rate.abs() };
            self.envelope.end = (before.1.end - before.0.value) * before.0.rate.signum();
            self.entry_angle = (self.entry_angle - before.0.value) * before.0.rate.signum();
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

    /// Unit velocity of the turn after the largest rotation of its plane in one step, from `ahead` towards the
    /// direction `to`; None if that lies behind or in the plane.
    fn rotated_plane(
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
        let angle = sine.atan2(cosine).min(self.largest_plane_angle(from, [across, ahead], speed, dt));
        let (sin, cos) = angle.sin_cos();
        (angle > 0.0).then(|| ahead * cos + across * sin)
    }

    /// Largest rotation of the plane of the turn in one step, from `ahead` towards `across` [rad].
    fn largest_plane_angle(
        &mut self,
        from: Vector3<f64>,
        [across, ahead]: [Vector3<f64>; 2],
        speed: f64,
        dt: f64,
    ) -> f64 {
        let limits = self.speed_bounds.limits;
        let (rate, speed) = (self.turn.rate.abs(), speed.max(self.speed.value.abs()));
        // The change takes the time between the middles of two steps. The rate may use its share in half of that.
        let time = SHARE / 2.0 * dt.min(self.step_before);
        let [across, ahead] = [across, ahead].map(|part| {
            self.scratch.set(&self.rover, from, part);
            let bounds = self.scratch.bounds(0.0, 0.0);
            let joints = self.scratch.steering_rates(&self.rover, 0.0);
            [joints.fold(0.0, |most: f64, rate| most.max(rate.abs())), bounds.linear.across, bounds.yaw.across]
        });
        // The same shares as in the envelope: half of the joints' acceleration, a sixth of the jerk.
        let allowed = [limits.steering_acceleration / 2.0, limits.jerk / 6.0, limits.angular_jerk / 6.0];
        let per = [rate, rate * speed, rate * speed];
        let mut angle = f64::INFINITY;
        for (k, allowed) in allowed.into_iter().enumerate().filter(|(_, allowed)| allowed.is_finite()) {
            // Half of the change each for the two terms of `sin(angle) across + (1 - cos(angle)) ahead`.
            let half = allowed * time / 2.0;
            angle = angle.min(quotient(half, per[k] * across[k])).min(quotient(2.0 * half, per[k] * ahead[k]).sqrt());
        }
        angle
    }
}
