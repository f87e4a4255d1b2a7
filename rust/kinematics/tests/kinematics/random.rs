//! Random rovers and twists.

use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::Rover;
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_kinematics::wheels::{Pivot, Wheel};
use six_wheel_numerics::error::Error;

/// Numbers between 0 and 1, the same every time.
pub struct Numbers(pub u64);

impl Numbers {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    pub fn chance(&mut self, share: f64) -> bool {
        self.next() < share
    }

    /// Any wheels: fixed and steered, in ranges of any width, symmetric or not, some with scrub or trail.
    pub fn rover(&mut self) -> Result<Rover, Error> {
        let count = 2 + (self.next() * 5.0) as usize;
        let symmetric = self.chance(0.5);
        let limit = self.between(0.1, 1.7);
        let mut wheels = Vec::new();
        for i in 0..count {
            let (x, y) = (self.between(-1.0, 1.0), self.between(-1.0, 1.0));
            let mut wheel = Wheel::new(format!("w{i}"), x, y, self.between(0.05, 0.2));
            if symmetric && i % 2 == 1 {
                let other: &Wheel = &wheels[i - 1];
                (wheel.x, wheel.y) = (other.x, -other.y);
            }
            if self.chance(0.7) {
                let range = if self.chance(0.6) {
                    SteeringRange::symmetric(limit)?
                } else {
                    let lower = self.between(-1.5, 0.5);
                    SteeringRange { lower, upper: lower + self.between(0.1, 2.5) }
                };
                wheel = wheel.steered(range);
                if self.chance(0.2) {
                    wheel.heading = self.between(-3.0, 3.0);
                }
                if self.chance(0.1) {
                    wheel.scrub = self.between(-0.1, 0.1);
                }
                if self.chance(0.05) {
                    wheel.trail = self.between(-0.1, 0.1);
                }
            } else if self.chance(0.1) {
                wheel.heading = self.between(-1.0, 1.0);
            } else if self.chance(0.2) {
                wheel.trail = self.between(-0.1, 0.1);
                wheel.pivot = Pivot::Castor;
            }
            wheels.push(wheel);
        }
        Rover::new(wheels)
    }

    /// Of any size, sometimes with zeros.
    pub fn twist(&mut self) -> Twist {
        let size = 10_f64.powf(self.between(-3.0, 3.0));
        let mut part = || {
            if self.chance(0.1) { 0.0 } else { self.between(-size, size) }
        };
        let (vx, vy, omega) = (part(), part(), part());
        Twist { vx, vy, omega }
    }
}
