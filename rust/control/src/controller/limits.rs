//! What the motion may not exceed: of the body, of the wheels, of the steering.

use six_wheel_numerics::error::{Error, HUGE, TINY, number};

/// Number of limits.
pub const COUNT: usize = 14;

/// Declares the limits, their names, and the way from and to a row of values.
macro_rules! limits {
    ($($(#[$doc:meta])* $name:ident;)*) => {
        /// Limits of a motion. Infinite where there is none.
        ///
        /// Linear ones concern the velocity of the body's origin, angular ones the yaw rate. Speeding up and slowing
        /// down count along the motion, so that both are the same forwards and backwards.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Limits {
            $($(#[$doc])* pub $name: f64,)*
        }

        impl Limits {
            /// Names, in the order of [`Self::values`].
            pub const NAMES: [&'static str; COUNT] = [$(stringify!($name)),*];

            /// All limits, in the order of [`Self::NAMES`].
            pub fn values(&self) -> [f64; COUNT] {
                [$(self.$name),*]
            }

            fn of_values([$($name),*]: [f64; COUNT]) -> Self {
                Self { $($name),* }
            }
        }
    };
}

limits! {
    /// Speed of the body's origin [m/s].
    speed;
    /// Yaw rate [rad/s].
    yaw_rate;
    /// Change of velocity while speeding up [m/s²].
    acceleration;
    /// Change of velocity while slowing down [m/s²].
    deceleration;
    /// Change of the acceleration [m/s³].
    jerk;
    /// Change of the yaw rate while speeding up [rad/s²].
    angular_acceleration;
    /// Change of the yaw rate while slowing down [rad/s²].
    angular_deceleration;
    /// Change of the angular acceleration [rad/s³].
    angular_jerk;
    /// Speed times yaw rate [m/s²].
    lateral_acceleration;
    /// Rotation rate of every wheel [rad/s].
    wheel_speed;
    /// Change of the rotation rate of every wheel [rad/s²].
    wheel_acceleration;
    /// Steering angle to either side [rad].
    steering_limit;
    /// Rate of every steering angle [rad/s].
    steering_rate;
    /// Change of the rate of every steering angle [rad/s²].
    steering_acceleration;
}

impl Default for Limits {
    /// No limit at all.
    fn default() -> Self {
        Self::of_values([f64::INFINITY; COUNT])
    }
}

impl Limits {
    /// Limits from values in the order of [`Self::NAMES`]; what is not given is unlimited, but slowing down
    /// is limited as speeding up is. Fails unless every one is positive; 1e60 and more is unlimited.
    pub fn new(given: [Option<f64>; COUNT]) -> Result<Self, Error> {
        for (&name, value) in Self::NAMES.iter().zip(given) {
            let Some(value) = value else { continue };
            if value >= TINY {
                continue;
            }
            let still = name.ends_with("deceleration") && value == 0.0;
            let top = [("speed", given[0]), ("yaw_rate", given[1])];
            let moving = top.iter().find_map(|(top, v)| Some((top, (*v)?)));
            let rule = match moving.filter(|_| still) {
                Some((top, value)) => {
                    let value = number(value);
                    format!("be positive: with {top}={value} the rover would never stop again")
                }
                None if value > 0.0 => format!("be at least {TINY:e}"),
                None => "be positive (leave it out for no limit)".into(),
            };
            return Err(Error::value(name, rule, number(value)));
        }
        let given = given.map(|value| value.map(|value| if value < HUGE { value } else { f64::INFINITY }));
        let mut values = given.map(|value| value.unwrap_or(f64::INFINITY));
        for (slower, faster) in [(3, 2), (6, 5)] {
            values[slower] = given[slower].unwrap_or(values[faster]);
        }
        Ok(Self::of_values(values))
    }

    /// Way [m] of a stop straight ahead from a steady speed [m/s], at the deceleration and jerk allowed.
    pub fn stopping_distance(&self, speed: f64) -> f64 {
        stop(speed.abs(), 0.0, self.deceleration, self.jerk)
    }
}

/// Way of the quickest stop from a speed that changes at `rate`, while that is limited to `deceleration` and
/// changes by `jerk` at most.
pub fn stop(speed: f64, rate: f64, deceleration: f64, jerk: f64) -> f64 {
    if speed == 0.0 || jerk.is_infinite() {
        return speed * speed / (2.0 * deceleration);
    }
    // Until the rate is zero, and from the peak of the speed there: the same as from an earlier start at
    // rate 0, for a rate that falls already.
    let turn = rate.abs() / jerk;
    let gained = turn * rate / 2.0;
    let peak = speed + gained.abs();
    let way = gained.abs().mul_add(2.0 / 3.0, speed) * turn;
    // The deceleration rises and falls symmetrically about half the speed.
    let time = if peak * jerk <= deceleration * deceleration {
        2.0 * (peak / jerk).sqrt()
    } else {
        peak / deceleration + deceleration / jerk
    };
    let after = peak * time / 2.0;
    if rate > 0.0 {
        way + after
    } else {
        // From `peak` to `speed` the way covered already is this much.
        let before = peak * turn - jerk * turn.powi(3) / 6.0;
        (after - before).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The quickest stop in small steps.
    fn simulated(speed: f64, rate: f64, deceleration: f64, jerk: f64) -> f64 {
        let (mut v, mut a, mut way) = (speed, rate, 0.0);
        let dt = 1e-5;
        while v > 0.0 {
            // Ease off once what is left is what easing off takes.
            let ease = a < 0.0 && v <= a * a / (2.0 * jerk);
            a = if ease { (a + jerk * dt).min(-1e-4) } else { (a - jerk * dt).max(-deceleration) };
            way += v * dt;
            v += a * dt;
        }
        way
    }

    #[test]
    fn the_way_of_a_stop_is_that_of_its_integral() {
        for (speed, rate, deceleration, jerk) in [
            (1.0, 0.0, 0.5, 2.0),
            (0.05, 0.0, 0.5, 2.0),
            (1.0, 0.4, 0.5, 2.0),
            (1.0, -0.4, 0.5, 2.0),
            (0.2, -0.5, 0.5, 2.0),
            (2.0, 1.0, 3.0, 0.7),
        ] {
            let (way, expected) = (stop(speed, rate, deceleration, jerk), simulated(speed, rate, deceleration, jerk));
            // The steps: about v dt and the tail of the easing.
            assert!((way - expected).abs() < 2e-3 * expected, "{way} {expected}");
        }
    }
}
