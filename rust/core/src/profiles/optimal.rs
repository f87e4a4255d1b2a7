//! Profiles in the least time under limits of velocity, acceleration and jerk, from any motion to any other.
//!
//! The mathematics is that of Ruckig (L. Berscheid, T. Kröger, Jerk-limited Real-time Trajectory Generation with
//! Arbitrary Target States, RSS 2021) in the crate `rsruckig`; here it gets arguments that make sense.

use std::str::FromStr;

use super::Profile;
use super::ruckig::solve;
use crate::error::{Error, number, numbers};

/// Where an axis is and how it moves there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moving {
    /// Its value.
    pub value: f64,
    /// First derivative.
    pub velocity: f64,
    /// Second derivative; without a limit of jerk it takes any value at once.
    pub acceleration: f64,
}

impl Moving {
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
    pub minimum_velocity: f64,
    /// Largest acceleration, positive.
    pub acceleration: f64,
    /// Smallest acceleration, negative.
    pub minimum_acceleration: f64,
    /// Largest magnitude of the jerk, positive.
    pub jerk: f64,
}

impl Bounds {
    /// The same limits in both directions.
    pub fn symmetric(velocity: f64, acceleration: f64, jerk: f64) -> Self {
        Self { velocity, minimum_velocity: -velocity, acceleration, minimum_acceleration: -acceleration, jerk }
    }

    fn check(&self, end: &Moving) -> Result<(), Error> {
        let limits = [
            ("velocity", self.velocity, 1.0),
            ("minimum_velocity", self.minimum_velocity, -1.0),
            ("acceleration", self.acceleration, 1.0),
            ("minimum_acceleration", self.minimum_acceleration, -1.0),
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
        let (slowest, fastest) = (self.minimum_velocity, self.velocity);
        within("end_velocity", end.velocity, slowest, fastest)?;
        if self.jerk == f64::INFINITY {
            return Ok(());
        }
        let (weakest, strongest) = (self.minimum_acceleration, self.acceleration);
        within("end_acceleration", end.acceleration, weakest, strongest)?;
        // The velocity before the end is at best that from which the jerk builds up the acceleration.
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

/// How the axes of one profile keep time with each other.
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

impl FromStr for Synchronise {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        match name {
            "time" => Ok(Self::Time),
            "phase" => Ok(Self::Phase),
            "none" => Ok(Self::None),
            _ => {
                let rule = "be 'time', 'phase' or 'none'";
                Err(Error::value("synchronise", rule, format!("{name:?}")))
            }
        }
    }
}

/// The fastest course of every axis from `start` to `end` within `bounds`, or one that takes `duration` [s].
///
/// A start beyond the limits is first brought within them as fast as they allow.
pub fn time_optimal(
    start: &[Moving],
    end: &[Moving],
    bounds: &[Bounds],
    synchronise: Synchronise,
    duration: Option<f64>,
) -> Result<Profile, Error> {
    if start.is_empty() || start.len() != end.len() || start.len() != bounds.len() {
        let rule = format!("have one value for each of {} axes, and at least one", start.len());
        return Err(Error::value("end", rule, end.len().to_string()));
    }
    let names = ["start", "start_velocity", "start_acceleration"];
    check_finite(names, start)?;
    check_finite(["end", "end_velocity", "end_acceleration"], end)?;
    for (end, bounds) in end.iter().zip(bounds) {
        bounds.check(end)?;
    }
    if let Some(duration) = duration
        && !(duration.is_finite() && duration > 0.0)
    {
        let rule = "be finite and positive";
        return Err(Error::value("duration", rule, number(duration)));
    }
    let least = solve(start, end, bounds, synchronise, None)?;
    let Some(duration) = duration else {
        return Ok(least);
    };
    let close = |found: f64| (found - duration).abs() <= 1e-12 * duration;
    if close(least.duration()) {
        return Ok(least);
    }
    if duration < least.duration() {
        let rule = format!("be at least {} s", number(least.duration()));
        return Err(Error::value("duration", rule, number(duration)));
    }
    // Alone, an axis has no one to wait for: given a duration, all of them take it.
    let synchronise = if synchronise == Synchronise::Phase { Synchronise::Phase } else { Synchronise::Time };
    let found = solve(start, end, bounds, synchronise, Some(duration))?;
    if close(found.duration()) {
        return Ok(found);
    }
    // Between moving ends there may be gaps: too slow to go straight there, too fast to come back.
    let rule = format!(
        "be {} s or at least {} s: no course takes a time between",
        number(least.duration()),
        number(found.duration())
    );
    Err(Error::value("duration", rule, number(duration)))
}

fn check_finite(names: [&'static str; 3], states: &[Moving]) -> Result<(), Error> {
    for state in states {
        let values = [state.value, state.velocity, state.acceleration];
        for (name, value) in names.into_iter().zip(values) {
            crate::error::finite(name, &[value])?;
        }
    }
    Ok(())
}
