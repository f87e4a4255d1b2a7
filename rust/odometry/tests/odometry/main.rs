//! Tests of odometry: laws, steps alone and in logs, motions between two instants.

mod arc;
mod covariance;
mod encoder;
mod laws;
mod levels;
#[allow(clippy::unwrap_used)]
mod preintegrated;
mod space;
mod steps;

use six_wheel_odometry::Sample;

/// Readings of wheels and steering joints alone.
fn sample<'a>(steering: &'a [f64], wheels: &'a [f64], stamp: f64) -> Sample<'a> {
    Sample { steering, wheels, stamp, yaw: None, yaw_rate: None }
}
