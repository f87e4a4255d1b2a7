//! Range of the steering angle of a wheel.

use std::f64::consts::{FRAC_PI_2, PI};

use six_wheel_numerics::error::{Error, positive, short};

/// Overshoot of a steering range up to which an angle counts as inside: rounding [rad].
pub const ANGLE_TOLERANCE: f64 = 1e-9;

/// Play and noise of a measured steering angle beyond its range [rad]; an angle farther off is an error of wiring or units.
pub const MEASURED_SLACK: f64 = 0.05;

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
    /// Without ends: a joint that turns any number of times.
    pub const ENDLESS: Self = Self { lower: f64::NEG_INFINITY, upper: f64::INFINITY };

    /// Range of a wheel without a steering joint, such as a castor.
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
        Err(Error::value("steering_limit", "be finite, the lower angle below the upper", self))
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

    /// True if the angle is inside the range, or beyond it by [`MEASURED_SLACK`] at most.
    pub fn is_near(self, angle: f64) -> bool {
        let inside = self.clip(angle);
        (inside - MEASURED_SLACK..=inside + MEASURED_SLACK).contains(&angle)
    }

    /// The angle, or the end of the range that is nearer.
    #[inline]
    pub fn clip(self, angle: f64) -> f64 {
        angle.clamp(self.lower, self.upper)
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
