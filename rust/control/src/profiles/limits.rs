//! States and limits of one axis, and the synchronisation of several.

use six_wheel_numerics::error::{Error, number, numbers};

/// Value of an axis and its first two derivatives with respect to time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisState {
    /// Value.
    pub value: f64,
    /// First derivative.
    pub velocity: f64,
    /// Second derivative; it may jump where the jerk is not limited.
    pub acceleration: f64,
}

impl AxisState {
    /// Axes at rest.
    pub fn resting(values: &[f64]) -> Vec<Self> {
        let at_rest = |&value: &f64| Self { value, ..Self::default() };
        values.iter().map(at_rest).collect()
    }
}

/// Limits of one axis; infinite where there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Largest velocity, positive.
    pub velocity: f64,
    /// Smallest velocity, negative.
    pub min_velocity: f64,
    /// Largest acceleration, positive.
    pub acceleration: f64,
    /// Smallest acceleration, negative.
    pub min_acceleration: f64,
    /// Largest magnitude of the jerk, positive.
    pub jerk: f64,
}

impl Bounds {
    /// The same limits in both directions.
    pub fn symmetric(velocity: f64, acceleration: f64, jerk: f64) -> Self {
        Self { velocity, min_velocity: -velocity, acceleration, min_acceleration: -acceleration, jerk }
    }

    pub(super) fn check(&self, end: &AxisState) -> Result<(), Error> {
        let limits = [
            ("velocity", self.velocity, 1.0),
            ("min_velocity", self.min_velocity, -1.0),
            ("acceleration", self.acceleration, 1.0),
            ("min_acceleration", self.min_acceleration, -1.0),
            ("jerk", self.jerk, 1.0),
        ];
        for (argument, limit, sign) in limits {
            if limit.is_nan() || limit * sign <= 0.0 {
                let rule = if sign > 0.0 { "be positive" } else { "be negative" };
                return Err(Error::value(argument, rule, number(limit)));
            }
        }
        if self.velocity == f64::INFINITY && self.acceleration == f64::INFINITY && self.jerk == f64::INFINITY {
            let rule = "be finite where acceleration and jerk are not: something has to take time";
            return Err(Error::value("velocity", rule, "inf"));
        }
        let within = |argument, value: f64, lower: f64, upper: f64| {
            if value >= lower && value <= upper {
                return Ok(());
            }
            let rule = format!("lie within {}", numbers(&[lower, upper]));
            Err(Error::value(argument, rule, number(value)))
        };
        let (slowest, fastest) = (self.min_velocity, self.velocity);
        within("end_velocity", end.velocity, slowest, fastest)?;
        if self.jerk == f64::INFINITY {
            return Ok(());
        }
        let (weakest, strongest) = (self.min_acceleration, self.acceleration);
        within("end_acceleration", end.acceleration, weakest, strongest)?;
        // The end's acceleration is built up at the jerk limit from at best this velocity.
        let before = end.velocity - end.acceleration * end.acceleration.abs() / (2.0 * self.jerk);
        if before >= slowest && before <= fastest {
            return Ok(());
        }
        let rule = format!(
            "leave the velocity within {} just before, where the jerk builds it up from {}",
            numbers(&[slowest, fastest]),
            number(before)
        );
        Err(Error::value("end_acceleration", rule, number(end.acceleration)))
    }
}

/// Synchronisation of the axes of one profile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Synchronise {
    /// They arrive together.
    #[default]
    Time,
    /// They stay in proportion to each other where their start and end allow it, else they arrive together.
    Phase,
    /// Each takes its own least time.
    None,
}

named_values! { Synchronise as "synchronise": "time" => Time, "phase" => Phase, "none" => None }
