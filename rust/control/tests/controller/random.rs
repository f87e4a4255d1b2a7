//! Random rovers, limits and commands.

use std::f64::consts::FRAC_PI_2;

use six_wheel_control::controller::Limits;
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::layouts::{Drive, SkidCentres};
use six_wheel_kinematics::rover::Rover;
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_kinematics::wheels::Wheel;
use six_wheel_numerics::error::Error;

/// Numbers that look random (Steele, Lea & Flood's SplitMix64).
pub struct Random(pub u64);

impl Random {
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    pub fn chance(&mut self, share: f64) -> bool {
        self.unit() < share
    }

    pub fn pick(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }
}

pub fn rover(random: &mut Random) -> Result<Rover, Error> {
    let radius = random.within(0.05, 0.3);
    let range =
        if random.chance(0.3) { SteeringRange::default() } else { SteeringRange::symmetric(random.within(0.3, 2.5))? };
    let lengths = [(); 4].map(|()| random.within(0.1, 1.0));
    let [a, b, ..] = lengths;
    match random.pick(7) {
        0..=2 => Rover::six_wheel(lengths, radius, range),
        3 => Rover::swerve(&[[a, b], [a, -b], [-a, b], [-a, -b]], None, radius, range),
        4 => Rover::ackermann(a + 0.2, b, radius, SteeringRange::symmetric(0.7)?, Drive::Rear),
        5 if random.chance(0.5) => Rover::mecanum(a, b, radius, FRAC_PI_2 / 2.0),
        5 => Rover::differential(b, [radius; 2], 1, 0.0, SkidCentres::default()),
        _ => {
            let wheel = |name, x, y| Wheel::new(name, x, y, radius);
            let scrub = random.within(-0.1, 0.1);
            let offset = |wheel: Wheel| Wheel { scrub, ..wheel.steered(range) };
            Rover::new(vec![
                offset(wheel("front", a, 0.1)),
                offset(wheel("rear", -a, 0.0)),
                wheel("left", 0.0, b),
                wheel("right", 0.0, -b),
            ])
        }
    }
}

pub fn limits(random: &mut Random) -> Result<Limits, Error> {
    let mut given = [None; Limits::NAMES.len()];
    for (name, value) in Limits::NAMES.iter().zip(&mut given) {
        if !["steering_limit", "halt_deceleration"].contains(name) && random.chance(0.6) {
            // From tame to rough, on a scale of ratios.
            *value = Some(random.within(-1.5, 1.5).exp2() * if name.contains("wheel") { 10.0 } else { 1.0 });
        }
    }
    Limits::new(given)
}

pub fn twist(random: &mut Random, before: Twist) -> Twist {
    let [vx, vy, omega] = [(); 3].map(|()| random.within(-1.5, 1.5));
    match random.pick(8) {
        0 => Twist { vx, vy: 0.0, omega: 0.0 },
        1 => Twist { vx: 0.0, vy: 0.0, omega },
        2 => Twist::ZERO,
        3 => Twist { vx: -before.vx, vy: -before.vy, omega: -before.omega },
        4 => Twist { vx: before.vx * 1.01, vy: before.vy, omega: before.omega + 0.01 },
        5 => Twist { vx, vy, omega },
        _ => Twist { vx, vy: 0.0, omega },
    }
}
