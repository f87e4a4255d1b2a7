//! Conversion of encoder counts to radians.

use std::f64::consts::TAU;

use six_wheel_numerics::error::{Error, finite, number, positive};

/// An encoder: its resolution, gear, range of its counter and offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encoder {
    /// Counts per turn of its shaft; None if it reads radians.
    pub resolution: Option<f64>,
    /// Turns of that shaft per turn of the joint; negative if it turns in the opposite direction.
    pub gear: f64,
    /// Counts after which the counter starts over, 65536 for 16 bits; None if it never does.
    pub modulus: Option<f64>,
    /// Angle of the joint where the counter is zero [rad]; used for steering joints only.
    pub offset: f64,
}

impl Default for Encoder {
    fn default() -> Self {
        Self { resolution: None, gear: 1.0, modulus: None, offset: 0.0 }
    }
}

impl Encoder {
    /// Fails unless every number is finite and in its range.
    pub fn check(&self) -> Result<(), Error> {
        for (argument, value) in [("ticks_per_turn", self.resolution), ("wraps_at", self.modulus)] {
            value.map_or(Ok(()), |value| positive(argument, value))?;
        }
        if !(self.gear.is_finite() && self.gear != 0.0) {
            return Err(Error::value("gear_ratio", "be finite and not 0", number(self.gear)));
        }
        if !self.angle_per_count().is_finite() {
            let rule = "be large enough, with gear_ratio, for a finite angle per tick";
            return Err(Error::value("ticks_per_turn", rule, number(self.resolution.unwrap_or(TAU))));
        }
        finite("offset", &[self.offset])
    }

    /// Angle of the joint per count [rad].
    #[inline]
    pub fn angle_per_count(&self) -> f64 {
        self.resolution.map_or(1.0, |resolution| TAU / resolution) / self.gear
    }

    /// Counts between two readings, at most half the modulus in magnitude; true if the counter started over between
    /// them.
    pub fn difference(&self, before: f64, after: f64) -> (f64, bool) {
        let difference = after - before;
        match self.modulus {
            None => (difference, false),
            Some(modulus) => {
                let turns = (difference / modulus).round();
                (turns.mul_add(-modulus, difference), turns != 0.0)
            }
        }
    }

    /// Angle of a steering joint at its first reading [rad]. A counter with a modulus gives it in half a range to
    /// either side of 0.
    pub fn first_angle(&self, counts: f64) -> f64 {
        let angle = counts * self.angle_per_count() + self.offset;
        match self.modulus {
            None => angle,
            Some(modulus) => {
                let round = (modulus * self.angle_per_count()).abs();
                angle - round * (angle / round).round()
            }
        }
    }
}
