//! Numbers of every kind, and rovers, made of the bytes that a target is given.

use six_wheel_kinematics::rover::Rover;
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_kinematics::wheels::{Pivot, Wheel};

/// Bytes read one after the other; zeros when they are used up.
pub struct Bytes<'a>(pub &'a [u8]);

impl Bytes<'_> {
    /// The next byte.
    pub fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.0.split_first() else {
            return 0;
        };
        self.0 = rest;
        *first
    }

    /// True if there are any left.
    pub fn any(&self) -> bool {
        !self.0.is_empty()
    }

    /// An ordinary number for most first bytes; any of all doubles for the others.
    pub fn number(&mut self) -> f64 {
        match self.byte() {
            0..=15 => {
                let mut bits = [0; 8];
                bits.iter_mut().for_each(|byte| *byte = self.byte());
                f64::from_le_bytes(bits)
            }
            scale => {
                let mantissa = f64::from(i16::from_le_bytes([self.byte(), self.byte()])) / 4096.0;
                mantissa * f64::powi(2.0, i32::from(scale % 16) - 8)
            }
        }
    }

    /// So many numbers.
    pub fn numbers(&mut self, count: usize) -> Vec<f64> {
        (0..count).map(|_| self.number()).collect()
    }

    /// A rover, if the bytes make one.
    pub fn rover(&mut self) -> Option<Rover> {
        let count = usize::from(self.byte() % 8) + 1;
        let wheels = (0..count).map(|k| {
            let kind = self.byte();
            let range = SteeringRange { lower: -self.number().abs(), upper: self.number().abs() };
            Wheel {
                pivot: match kind % 4 {
                    0 => Pivot::Steered(SteeringRange::default()),
                    1 => Pivot::Steered(range),
                    2 => Pivot::Castor,
                    _ => Pivot::Fixed,
                },
                heading: if kind & 16 == 0 { 0.0 } else { self.number() },
                scrub: if kind & 32 == 0 { 0.0 } else { self.number() },
                trail: if kind & 64 == 0 { 0.0 } else { self.number() },
                driven: kind & 8 == 0,
                ..Wheel::new(format!("w{k}"), self.number(), self.number(), self.number().abs())
            }
        });
        Rover::new(wheels.collect()).ok()
    }
}
