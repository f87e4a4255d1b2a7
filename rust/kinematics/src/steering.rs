//! Steering angle of a wheel: its range, and the choice between rolling forwards and backwards.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use six_wheel_numerics::error::{Error, positive, short};

/// Overshoot of a steering angle that is rounding, not a request [rad].
pub const ANGLE_TOLERANCE: f64 = 1e-9;

/// A wheel whose two ways differ by less than this is undecided: it goes with the other undecided wheels,
/// so that angles on either side of a quarter turn do not split the rover [rad].
pub(crate) const UNDECIDED: f64 = 10.0 * PI / 180.0;

/// Angles a steered wheel can take, counted from its heading [rad].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteeringRange {
    /// Smallest angle [rad].
    pub lower: f64,
    /// Largest angle [rad].
    pub upper: f64,
}

impl Default for SteeringRange {
    /// A quarter turn to either side: enough to roll in every direction, backwards if need be.
    fn default() -> Self {
        Self { lower: -FRAC_PI_2, upper: FRAC_PI_2 }
    }
}

impl SteeringRange {
    /// Without ends: a joint that turns on and on.
    pub const ENDLESS: Self = Self { lower: f64::NEG_INFINITY, upper: f64::INFINITY };

    /// Wherever a wheel may turn that nothing steers.
    pub(crate) const WHOLE_TURN: Self = Self { lower: -PI, upper: PI };

    /// From `-limit` to `limit`; infinity is endless. Fails unless the limit is positive.
    #[inline]
    pub fn symmetric(limit: f64) -> Result<Self, Error> {
        if limit != f64::INFINITY {
            positive("steering_limit", limit)?;
        }
        Ok(Self { lower: -limit, upper: limit })
    }

    /// Fails unless both ends are finite and in order, or there are none.
    pub fn check(self) -> Result<(), Error> {
        if self.lower.is_finite() && self.upper.is_finite() && self.lower < self.upper || self.is_endless() {
            return Ok(());
        }
        let rule = "be finite, the lower angle below the upper";
        Err(Error::value("steering_limit", rule, self.to_string()))
    }

    /// True if there are no ends.
    pub fn is_endless(self) -> bool {
        self == Self::ENDLESS
    }

    /// True if a wheel can roll in every direction, forwards or backwards.
    #[inline]
    pub fn is_full(self) -> bool {
        self.upper - self.lower >= PI
    }

    /// The angle, or the end of the range that is nearer.
    #[inline]
    pub fn clip(self, angle: f64) -> f64 {
        angle.clamp(self.lower, self.upper)
    }

    /// `angle` plus the whole turns that bring it nearest to `previous`, but into the range if any do.
    fn nearest_turn(self, angle: f64, previous: f64) -> f64 {
        let near = angle + TAU * ((previous - angle) / TAU).round_ties_even();
        let (above, below) = (near - self.upper, self.lower - near);
        let (turned, beyond, short) = if above > ANGLE_TOLERANCE {
            let turned = near - TAU * (above / TAU).ceil();
            (turned, self.lower - turned, above)
        } else if below > ANGLE_TOLERANCE {
            let turned = near + TAU * (below / TAU).ceil();
            (turned, turned - self.upper, below)
        } else {
            return near;
        };
        // A range narrower than a turn may hold neither: then the nearer end decides.
        if beyond <= ANGLE_TOLERANCE.max(short) { turned } else { near }
    }
}

impl std::fmt::Display for SteeringRange {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (low, high) = (self.lower, self.upper);
        if self.is_endless() {
            return write!(f, "endless");
        }
        write!(f, "{} to {} rad (", short(low), short(high))?;
        write!(f, "{:.1}° to {:.1}°)", low.to_degrees(), high.to_degrees())
    }
}

/// Command of one wheel.
#[derive(Clone, Copy, Debug)]
pub struct WheelCommand {
    /// Steering angle [rad]; 0 for a fixed wheel.
    pub angle: f64,
    /// Speed of the contact along the rim [m/s].
    pub rim_speed: f64,
}

/// Rolling direction of a wheel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    Forwards,
    Backwards,
}

/// One way of making the motion.
#[derive(Clone, Copy, Debug)]
struct Side {
    command: WheelCommand,
    /// Distance by which the range ends short of the angle [rad].
    overshoot: f64,
    /// Distance that the wheel has to turn [rad].
    turn: f64,
}

/// Both ways in which a steered wheel can make a motion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Choice {
    forwards: Side,
    backwards: Side,
}

impl Choice {
    /// The ways of a wheel whose pivot moves: angle and speed along the heading for each.
    #[inline]
    pub fn new(range: SteeringRange, previous: f64, [forwards, backwards]: [WheelCommand; 2]) -> Self {
        let side = |command: WheelCommand| {
            let angle = range.nearest_turn(command.angle, previous);
            let clipped = range.clip(angle);
            Side {
                command: WheelCommand { angle: clipped, ..command },
                overshoot: ((angle - clipped).abs() - ANGLE_TOLERANCE).max(0.0),
                turn: (clipped - previous).abs(),
            }
        };
        Self { forwards: side(forwards), backwards: side(backwards) }
    }

    /// The way of a wheel whose pivot rests: none but to stay.
    #[inline]
    pub fn stay(command: WheelCommand) -> Self {
        let side = Side { command, overshoot: 0.0, turn: 0.0 };
        Self { forwards: side, backwards: Side { overshoot: f64::INFINITY, ..side } }
    }

    /// The way inside the range, the nearer one if both are, forwards if both are equally near.
    #[inline]
    pub fn nearest(&self) -> Way {
        let key = |side: &Side| (side.overshoot, side.turn);
        if key(&self.backwards) < key(&self.forwards) { Way::Backwards } else { Way::Forwards }
    }

    /// Difference by which the way backwards is shorter [rad], if both are possible and about equally near.
    pub fn undecided(&self) -> Option<f64> {
        let lead = self.forwards.turn - self.backwards.turn;
        let both = self.forwards.overshoot == 0.0 && self.backwards.overshoot == 0.0;
        (both && lead.abs() < UNDECIDED).then_some(lead)
    }

    /// Angle and speed of one way.
    #[inline]
    pub fn command(&self, way: Way) -> WheelCommand {
        match way {
            Way::Forwards => self.forwards.command,
            Way::Backwards => self.backwards.command,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_turns_bring_an_angle_into_its_range() {
        let range = SteeringRange { lower: -1.0, upper: 8.0 };
        for (angle, previous, expected) in
            [(0.5, 0.0, 0.5), (0.5, 7.0, 0.5 + TAU), (-2.0, 0.0, -2.0 + TAU), (3.0, -40.0, 3.0), (0.5, 40.0, 0.5 + TAU)]
        {
            let got = range.nearest_turn(angle, previous);
            assert!((got - expected).abs() < 1e-12, "{angle} {previous}: {got}");
        }
    }
}
