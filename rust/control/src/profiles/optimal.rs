//! Profiles in the least time under limits of velocity, acceleration and jerk, from any motion to any other.
//!
//! The algorithm is Ruckig (L. Berscheid, T. Kröger, Jerk-limited Real-time Trajectory Generation with
//! Arbitrary Target States, RSS 2021) in the crate `rsruckig`; here its arguments are checked.

use super::Profile;
use super::limits::{AxisState, Bounds, Synchronise};
use super::ruckig::solve;
use six_wheel_numerics::error::{Error, finite, number, positive};

/// The time-optimal profile of every axis from `start` to `end` within `bounds`, or one that takes `duration` [s].
///
/// A start beyond the limits is first brought within them as fast as they allow.
pub fn time_optimal(
    start: &[AxisState],
    end: &[AxisState],
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
    // A given duration applies to every axis: that is synchronisation in time.
    let synchronise = if synchronise == Synchronise::Phase { Synchronise::Phase } else { Synchronise::Time };
    let found = solve(start, end, bounds, synchronise, Some(duration))?;
    if close(found.duration()) {
        return Ok(found);
    }
    // Between moving ends the possible durations may have gaps.
    let rule = format!(
        "be {} s or at least {} s: no course takes a time between",
        number(least.duration()),
        number(found.duration())
    );
    Err(Error::value("duration", rule, number(duration)))
}

fn check_finite(names: [&'static str; 3], states: &[AxisState]) -> Result<(), Error> {
    for state in states {
        let values = [state.value, state.velocity, state.acceleration];
        for (name, value) in names.into_iter().zip(values) {
            finite(name, &[value])?;
        }
    }
    Ok(())
}
