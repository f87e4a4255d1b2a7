//! Limits that a log of steps is held against.

use six_wheel_control::controller::{Controller, Limits};
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::Rover;

/// One step of a log.
#[derive(Clone, Debug)]
pub struct Shot {
    pub dt: f64,
    pub twist: Twist,
    pub steering: Vec<f64>,
    pub speeds: Vec<f64>,
}

/// Differences of rounded numbers: this many ulp of values near 1, or a share of the limit.
fn within(value: f64, limit: f64, noise: f64) -> bool {
    value <= limit * (1.0 + 1e-6) + noise
}

pub struct Checker<'a> {
    pub rover: &'a Rover,
    pub limits: Limits,
    /// Text that a failure prints.
    pub context: &'a dyn Fn() -> String,
}

impl Checker<'_> {
    fn demand(&self, name: &str, value: f64, limit: f64, noise: f64) {
        assert!(within(value, limit, noise), "{name}: {value} > {limit}\n{}", (self.context)());
    }

    /// One instant.
    pub fn state(&self, shot: &Shot) {
        let Shot { twist, steering, speeds, .. } = shot;
        let speed = twist.linear().norm();
        self.demand("speed", speed, self.limits.speed, 1e-12);
        self.demand("yaw rate", twist.omega.abs(), self.limits.yaw_rate, 1e-12);
        let lateral = speed * twist.omega.abs();
        self.demand("lateral", lateral, self.limits.lateral_acceleration, 1e-12);
        for speed in speeds {
            self.demand("wheel speed", speed.abs(), self.limits.wheel_speed, 1e-12);
        }
        for bank in &self.rover.banks {
            let row = bank.row;
            let slip = row.x * twist.vx + row.y * twist.vy + row.z * twist.omega;
            let slip = slip.abs();
            self.demand("bank", slip, 1e-9, 0.0);
        }
        for (angle, &i) in steering.iter().zip(self.rover.steered()) {
            let wheel = &self.rover.wheels()[i];
            self.demand("scrub", wheel.side_slip(*angle, *twist, 0.0).abs(), 1e-9, 0.0);
        }
    }

    /// From one to the next.
    pub fn change(&self, [first, second]: [&Shot; 2]) {
        let dt = second.dt;
        let step = |a: f64, b: f64| (b - a).abs() / dt;
        let linear = (second.twist.linear() - first.twist.linear()).norm() / dt;
        let limits = &self.limits;
        let turned = first.steering != second.steering;
        let pick = |up: f64, down: f64, grows: bool| match (turned, grows) {
            (true, _) => up.max(down),
            (_, true) => up,
            _ => down,
        };
        let grows = second.twist.linear().norm() > first.twist.linear().norm();
        let noise = 1e-14 / dt;
        self.demand("acceleration", linear, pick(limits.acceleration, limits.deceleration, grows), noise);
        let angular = step(first.twist.omega, second.twist.omega);
        let grows = second.twist.omega.abs() > first.twist.omega.abs();
        let limit = pick(limits.angular_acceleration, limits.angular_deceleration, grows);
        self.demand("angular acceleration", angular, limit, noise);
        for (a, b) in first.speeds.iter().zip(&second.speeds) {
            self.demand("wheel acceleration", step(*a, *b), limits.wheel_acceleration, 100.0 * noise);
        }
        for (a, b) in first.steering.iter().zip(&second.steering) {
            self.demand("steering rate", step(*a, *b), limits.steering_rate, noise);
        }
    }

    /// Over three: divided differences, which the mean value theorem bounds by the derivative.
    pub fn curve(&self, [first, second, third]: [&Shot; 3]) {
        let [early, late] = [second.dt, third.dt];
        let bend = |a: f64, b: f64, c: f64| ((c - b) / late - (b - a) / early) * 2.0 / (early + late);
        let noise = 1e-14 / (early.min(late) * early.min(late));
        let part = |of: fn(&Twist) -> f64| bend(of(&first.twist), of(&second.twist), of(&third.twist));
        let linear = part(|twist| twist.vx).hypot(part(|twist| twist.vy));
        self.demand("jerk", linear, self.limits.jerk, noise);
        self.demand("angular jerk", part(|twist| twist.omega).abs(), self.limits.angular_jerk, noise);
        for (k, angle) in third.steering.iter().enumerate() {
            let value = bend(first.steering[k], second.steering[k], *angle).abs();
            self.demand("steering acceleration", value, self.limits.steering_acceleration, noise);
        }
    }
}

pub fn shot(controller: &Controller, dt: f64) -> Shot {
    Shot {
        dt,
        twist: controller.twist(),
        steering: controller.steering().to_vec(),
        speeds: controller.speeds().to_vec(),
    }
}
