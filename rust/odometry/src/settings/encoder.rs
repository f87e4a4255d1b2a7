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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counters_go_the_shorter_way_round() {
        let counter = Encoder { modulus: Some(65536.0), ..Encoder::default() };
        assert_eq!(counter.difference(65530.0, 4.0), (10.0, true));
        assert_eq!(counter.difference(4.0, 65530.0), (-10.0, true));
        assert_eq!(counter.difference(-32760.0, 32760.0), (-16.0, true)); // a signed counter
        assert_eq!(counter.difference(100.0, 350.0), (250.0, false));
        assert_eq!(Encoder::default().difference(1.0, 1e6), (999_999.0, false));
    }

    #[test]
    fn an_absolute_encoder_knows_its_angle_at_once() {
        let encoder = Encoder { resolution: Some(4096.0), modulus: Some(4096.0), offset: -3.0, ..Encoder::default() };
        let angle = encoder.first_angle(3000.0);
        assert!((angle - (3000.0 / 4096.0 * TAU - 3.0)).abs() < 1e-12, "{angle}");
        let round = encoder.first_angle(100.0) - encoder.first_angle(4095.0);
        assert!((round - 101.0 / 4096.0 * TAU).abs() < 1e-12, "{round}");
    }
}
