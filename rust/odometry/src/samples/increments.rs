//! Rotations of wheels and angles of steering joints between two samples, and their limits.

use crate::samples::skipped_rows::SkippedRows;
use crate::settings::{Readings, Settings};
use six_wheel_numerics::error::{Error, number};

/// Readings of wheels and steering joints, as their encoders count.
#[derive(Clone, Copy, Debug)]
pub struct Counts<'a> {
    /// Of the wheels.
    pub wheels: &'a [f64],
    /// Of the steering joints.
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

/// Fails if a wheel of this name and radius, after this rotation, rolled faster than the rover can.
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

/// Fails if a joint of this name, with these angles before and after, steered faster than the rover can.
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
