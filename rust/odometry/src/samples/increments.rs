//! Rotations of wheels and angles of steering joints between two samples, and their limits.

use crate::samples::skipped_rows::SkippedRows;
use crate::settings::{Readings, Settings};
use six_wheel_numerics::error::{Error, number};

/// Upper bound of the acceleration of a rim on the ground [m/s²]: twice that at a friction coefficient of 1.
const LARGEST_ACCELERATION: f64 = 20.0;
/// Distance up to which a restart of a counter cannot be distinguished from a rotation of the wheel [m].
const LEAST_JUMP: f64 = 0.05;
/// A step of more than this many times the last duration has lost readings.
const LOST: f64 = 5.0;

/// Durations and speed from which the largest plausible rotation of a wheel in a step follows.
#[derive(Clone, Copy, Debug)]
pub struct StepTiming {
    /// Duration of the step [s].
    pub dt: f64,
    /// Duration of the step before [s]; 0 if there was none.
    pub last_dt: f64,
    /// Upper bound of the rim speeds at the start of the step [m/s].
    pub speed: f64,
}

/// Readings of wheels and steering joints, in units of their encoders.
#[derive(Clone, Copy, Debug)]
pub struct Counts<'a> {
    /// Readings of the wheels.
    pub wheels: &'a [f64],
    /// Readings of the steering joints.
    pub steering: &'a [f64],
}

/// Writes the rotations of wheels over a step of this duration, and adds the increments of joints to their angles [rad].
/// Returns true if a counter started over.
pub fn add_increments(
    settings: &Settings,
    skipped: &SkippedRows,
    [before, after]: [Counts<'_>; 2],
    dt: f64,
    rotations: &mut [f64],
    angles: &mut [f64],
) -> bool {
    let mut wrapped = false;
    let pairs = before.wheels.iter().zip(after.wheels);
    for (wheel, ((before, after), rotation)) in pairs.zip(rotations).enumerate() {
        let encoder = settings.wheel_encoder(wheel);
        let counts = match settings.readings {
            Readings::Angles => {
                let (counts, over) = encoder.difference(*before, *after);
                wrapped |= over;
                counts
            }
            Readings::Speeds => f64::midpoint(*before, *after) * dt,
            Readings::Increments => *after + skipped.pending_increment(wheel),
        };
        *rotation = counts * encoder.angle_per_count();
    }
    let pairs = before.steering.iter().zip(after.steering);
    for (joint, ((before, after), angle)) in pairs.zip(angles).enumerate() {
        let encoder = settings.steering_encoder(joint);
        let (counts, over) = encoder.difference(*before, *after);
        wrapped |= over;
        *angle += counts * encoder.angle_per_count();
    }
    wrapped
}

/// True if the counter may have restarted at zero between these two readings: the second one is less than half as
/// large.
#[inline]
pub fn may_start_over(before: f64, after: f64) -> bool {
    2.0 * after.abs() < before.abs()
}

/// Finds the wheels whose counters restarted at zero, as after a reset of a microcontroller, and replaces their
/// rotations by the counts since then. Returns true if there is one.
///
/// The distance of such a reading from zero is at most `speed dt + a dt²`, with a the [`LARGEST_ACCELERATION`], and
/// that from the reading before is larger. After lost readings any motion is possible: there a restart is found only if
/// all wheels read exactly zero.
pub fn count_from_zero(
    settings: &Settings,
    [before, after]: [&[f64]; 2],
    radii: impl Iterator<Item = f64>,
    timing: StepTiming,
    rotations: &mut [f64],
) -> bool {
    if settings.readings != Readings::Angles {
        return false;
    }
    let StepTiming { dt, last_dt, speed } = timing;
    let possible = (speed * dt + LARGEST_ACCELERATION * dt * dt).max(LEAST_JUMP);
    let is_lost =
        last_dt > 0.0 && dt > LOST * last_dt && after.iter().all(|reading| *reading == 0.0 || reading.is_nan());
    let least = if is_lost { LEAST_JUMP } else { possible };
    let mut started = false;
    for (wheel, (((before, after), radius), rotation)) in before.iter().zip(after).zip(radii).zip(rotations).enumerate()
    {
        let encoder = settings.wheel_encoder(wheel);
        let per_count = encoder.angle_per_count();
        let [rolled, since] = [after - before, *after].map(|counts| (radius * per_count * counts).abs());
        if encoder.modulus.is_none() && may_start_over(*before, *after) && rolled > least && since <= possible {
            *rotation = after * per_count;
            started = true;
        }
    }
    started
}

/// Fails if a wheel (name, radius [m], rotation in the step [rad]) rolled faster than the settings allow.
pub fn check_rim_speed<'a>(
    settings: &Settings,
    skipped: &SkippedRows,
    dt: f64,
    wheels: impl Iterator<Item = (&'a str, f64, f64)>,
) -> Result<(), Error> {
    let Some(limit) = settings.max_speed else { return Ok(()) };
    for (wheel, (name, radius, rotation)) in wheels.enumerate() {
        let pending = skipped.pending_increment(wheel) * settings.wheel_encoder(wheel).angle_per_count();
        let speed = radius * (rotation - pending) / dt;
        if speed.abs() > limit {
            let rule = format!("keep {name} at a rim speed of {limit} m/s at most");
            return Err(Error::value("wheel_angles", rule, number(speed)));
        }
    }
    Ok(())
}

/// Fails if a joint (name, angles before and after the step [rad]) steered faster than the settings allow.
pub fn check_steering_rate<'a>(
    settings: &Settings,
    dt: f64,
    joints: impl Iterator<Item = (&'a str, f64, f64)>,
) -> Result<(), Error> {
    let Some(limit) = settings.max_steering_rate else { return Ok(()) };
    for (name, before, after) in joints {
        let rate = (after - before) / dt;
        if rate.abs() > limit {
            let rule = format!("keep {name} at a steering rate of {limit} rad/s at most");
            return Err(Error::value("steering", rule, number(rate)));
        }
    }
    Ok(())
}
