//! Profiles in the least time under limits of velocity, acceleration and jerk, from any motion to any other.
//!
//! The mathematics is that of Ruckig (L. Berscheid, T. Kröger, Jerk-limited Real-time Trajectory Generation with
//! Arbitrary Target States, RSS 2021) in the crate `rsruckig`; here it gets arguments that make sense.

use super::Profile;
use super::limits::{Bounds, Moving, Synchronise};
use super::ruckig::solve;
use six_wheel_numerics::error::{Error, finite, number, positive};

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
    duration.map_or(Ok(()), |duration| positive("duration", duration))?;
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
            finite(name, &[value])?;
        }
    }
    Ok(())
}
