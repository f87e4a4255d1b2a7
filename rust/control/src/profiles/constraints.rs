//! Constraints of the pace along a chord: one for every limit of a joint, a wheel or the body.

use nalgebra::{Complex, Vector2, Vector3};

use super::chord::{Chord, Joint, is_driven};
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::{Mount, Rover};
use six_wheel_numerics::error::{Error, HUGE, TINY, number};

/// Limits whose cubes neither overflow nor underflow.
const SIZES: std::ops::RangeInclusive<f64> = TINY..=HUGE;

/// Limits of a transition; infinite where there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IcrLimits {
    /// Largest rate of every steering joint [rad/s].
    pub steering_rate: f64,
    /// Largest acceleration of every steering joint [rad/s²].
    pub steering_acceleration: f64,
    /// Largest jerk of every steering joint [rad/s³].
    pub steering_jerk: f64,
    /// Largest speed of every driven wheel [rad/s].
    pub wheel_speed: f64,
    /// Largest acceleration of every driven wheel [rad/s²].
    pub wheel_acceleration: f64,
    /// Largest length of the derivative of (vx, vy) in body axes [m/s²].
    pub acceleration: f64,
    /// Largest magnitude of the derivative of the yaw rate [rad/s²].
    pub angular_acceleration: f64,
}

array_of_fields! {
    IcrLimits:
    steering_rate, steering_acceleration, steering_jerk, wheel_speed, wheel_acceleration, acceleration,
    angular_acceleration
}

impl Default for IcrLimits {
    fn default() -> Self {
        Self::of([f64::INFINITY; Self::NAMES.len()])
    }
}

impl IcrLimits {
    /// Fails unless every limit is positive, and that of the steering rate finite.
    pub fn check(&self) -> Result<(), Error> {
        for (argument, limit) in Self::NAMES.into_iter().zip(self.values()) {
            if limit.is_nan() || limit <= 0.0 {
                return Err(Error::value(argument, "be positive", number(limit)));
            }
            if limit != f64::INFINITY && !SIZES.contains(&limit) {
                let rule = format!("be between {:?} and {:?}", SIZES.start(), SIZES.end());
                return Err(Error::value(argument, rule, number(limit)));
            }
        }
        if self.steering_rate.is_finite() {
            return Ok(());
        }
        let rule = "be finite";
        Err(Error::value("steering_rate", rule, number(self.steering_rate)))
    }

    /// Largest acceleration of a steering joint [rad/s²]. With a limit of the jerk alone, that of a ramp to the
    /// largest rate; with a scrub radius, at most that for half of the wheel's acceleration.
    pub fn acceleration_of(&self, scrub: f64, radius: f64) -> f64 {
        let by_jerk = (self.steering_rate * self.steering_jerk).sqrt();
        let own = self.steering_acceleration.min(by_jerk);
        if scrub == 0.0 { own } else { own.min(self.wheel_acceleration * radius / scrub.abs() / 2.0) }
    }
}

/// One constraint along a chord, by the least time per share of the chord that it allows [s].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Constraint {
    /// The same time per share everywhere [s].
    Even(f64),
    /// A joint turns at most at this rate [rad/s].
    Angle(Joint, f64),
    /// The speed of a joint's pivot changes at most at this rate [m/s²].
    Speed(Joint, f64),
    /// A wheel whose contact lies beside its pivot rolls as it steers: joint, scrub radius [m], the wheel's largest
    /// rim speed [m/s], and the yaw rate's part in it at both ends [m/s].
    Rolling(Joint, f64, f64, [f64; 2]),
}

impl Constraint {
    /// Least time per share of the chord [s], the inverse of the largest derivative of the share by time.
    pub fn slowness(&self, s: f64) -> f64 {
        match *self {
            Self::Even(pace) => pace,
            Self::Angle(joint, rate) => joint.angle_derivatives(s)[0].abs() / rate,
            Self::Speed(joint, rate) => joint.speed(s)[1].abs() / rate,
            Self::Rolling(joint, scrub, fastest, [a, b]) => {
                let used = joint.speed(s)[0] + (a + s * (b - a)).abs();
                (scrub * joint.angle_derivatives(s)[0]).abs() / (fastest - used).max(0.0)
            }
        }
    }

    /// Derivative of [`Self::slowness`] by the share of the chord [s].
    pub fn slope(&self, s: f64) -> f64 {
        match *self {
            Self::Angle(joint, rate) => {
                let [first, second, _] = joint.angle_derivatives(s);
                second * first.signum() / rate
            }
            Self::Speed(joint, rate) => {
                let [_, first, second] = joint.speed(s);
                second * first.signum() / rate
            }
            Self::Even(_) | Self::Rolling(..) => 0.0,
        }
    }

    /// Integral of [`Self::slowness`] from the start of the chord to share `s`, on a part where its terms keep their
    /// signs [s].
    pub fn time(&self, s: f64) -> f64 {
        match *self {
            Self::Even(pace) => pace * s,
            Self::Angle(joint, rate) => joint.swept(s).abs() / rate,
            Self::Speed(joint, rate) => {
                let [speed, slope, _] = joint.speed(s);
                speed * slope.signum() / rate
            }
            Self::Rolling(..) => f64::NAN,
        }
    }

    /// The inverse of [`Self::time`], on the same side of the point of least pivot speed as `near`.
    pub fn place(&self, time: f64, near: f64) -> f64 {
        match *self {
            Self::Even(pace) => time / pace,
            Self::Angle(joint, rate) => joint.place_of(rate * time * joint.angle_derivatives(near)[0].signum()),
            Self::Speed(joint, rate) => joint.at_speed((rate * time).abs(), near >= joint.slowest()),
            Self::Rolling(..) => near,
        }
    }
}

/// All constraints of a chord.
pub(crate) fn constraints(rover: &Rover, chord: &Chord, limits: &IcrLimits) -> Vec<Constraint> {
    let change = chord.change();
    let mut constraints = Vec::new();
    let mut even = (Vector2::new(change.x, change.y).norm() / limits.acceleration)
        .max(change.z.abs() / limits.angular_acceleration);
    let mut joints = chord.joints.iter();
    for (i, wheel) in rover.wheels().iter().enumerate() {
        let rim = limits.wheel_acceleration * wheel.radius;
        match rover.mounts[i] {
            Mount::Fixed(rows) if is_driven(rover, i) => {
                even = even.max(rows.rolling.dot(&change).abs() / rim);
            }
            Mount::Steered(..) => {
                let Some(&joint) = joints.next() else {
                    continue;
                };
                let turns = joint.angle_derivatives(0.5)[0] != 0.0;
                if turns {
                    constraints.push(Constraint::Angle(joint, limits.steering_rate));
                }
                if !is_driven(rover, i) {
                    continue;
                }
                // With a scrub radius, half of the wheel's acceleration is for its rolling by the steering rate.
                let offset = wheel.scrub.abs() * change.z.abs();
                let rest = if wheel.scrub == 0.0 { rim } else { rim / 2.0 };
                if turns && rest.is_finite() && offset == 0.0 {
                    constraints.push(Constraint::Speed(joint, rest));
                } else {
                    let fastest = joint.speed(0.0)[1].abs().max(joint.speed(1.0)[1].abs());
                    even = even.max((fastest + offset) / rest);
                }
                if wheel.scrub != 0.0 && turns && limits.wheel_speed.is_finite() {
                    let ends = [chord.start.z, chord.end.z].map(|omega| wheel.scrub * omega);
                    let rim_speed = limits.wheel_speed * wheel.radius;
                    constraints.push(Constraint::Rolling(joint, wheel.scrub, rim_speed, ends));
                }
            }
            Mount::Fixed(_) | Mount::Castor(_) => {}
        }
    }
    constraints.push(Constraint::Even(even));
    constraints
}

/// Rate, acceleration and jerk of the direction of a vector, from the vector and its derivatives.
pub(crate) fn direction_derivatives(u: [Complex<f64>; 4]) -> [f64; 3] {
    let [w, second, third] = [u[1] / u[0], u[2] / u[0], u[3] / u[0]];
    let bend = second - w * w;
    [w.im, bend.im, (third - second * w * 3.0 + w * w * w * 2.0).im]
}

/// Rate and acceleration of the direction in which a pivot moves.
pub(crate) fn pivot_direction_derivatives(rover: &Rover, i: usize, twist: [Vector3<f64>; 3]) -> [f64; 2] {
    let wheel = &rover.wheels()[i];
    let velocity = |twist: Vector3<f64>| {
        let u = Twist::from(twist).at(wheel.x, wheel.y);
        Complex::new(u.x, u.y)
    };
    let [u, first, second] = twist.map(velocity);
    if u.norm() == 0.0 {
        return [0.0; 2];
    }
    let [rate, acceleration, _] = direction_derivatives([u, first, second, Complex::default()]);
    [rate, acceleration]
}
