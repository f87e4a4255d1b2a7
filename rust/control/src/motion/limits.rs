//! Limits of the motion: of the body, of the wheels, of the steering.

use six_wheel_kinematics::rover::Rover;
use six_wheel_numerics::error::{Error, HUGE, TINY, number};

/// Number of limits.
pub const COUNT: usize = 15;

/// Default of the acceleration [m/s²]: that of wheels with a friction coefficient of 1 on level ground.
const USUAL_ACCELERATION: f64 = 9.81;

/// Default of the steering rate [rad/s]: 1.2 rad, less than a quarter turn, in a step of 0.1 s.
const USUAL_STEERING_RATE: f64 = 12.0;

/// Declares the limits, their names, and conversions from and to an array of values.
macro_rules! limits {
    ($($(#[$doc:meta])* $name:ident;)*) => {
        /// Limits of a motion; infinite where there is none.
        ///
        /// Linear ones concern the velocity of the body's origin, angular ones the yaw rate. Speeding up and slowing
        /// down count along the motion, so that both are the same forwards and backwards.
        ///
        /// An infinite limit that is not in `given` is left out: [`Self::on`] fills in its default.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Limits {
            $($(#[$doc])* pub $name: f64,)*
            /// Bit k: limit k of [`Self::NAMES`] was given, be it as infinite.
            pub given: u32,
        }

        impl Limits {
            /// Names, in the order of [`Self::values`].
            pub const NAMES: [&'static str; COUNT] = [$(stringify!($name)),*];

            /// No limit, and no default.
            pub const NONE: Self = Self { $($name: f64::INFINITY,)* given: (1 << COUNT) - 1 };

            /// All limits, in the order of [`Self::NAMES`].
            pub fn values(&self) -> [f64; COUNT] {
                [$(self.$name),*]
            }

            fn of_values([$($name),*]: [f64; COUNT], given: u32) -> Self {
                Self { $($name,)* given }
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
    /// Change of the speed of a wheel over the ground during a halt [m/s²]; at least `deceleration`.
    halt_deceleration;
}

impl Default for Limits {
    /// Every limit left out.
    fn default() -> Self {
        Self { given: 0, ..Self::NONE }
    }
}

impl Limits {
    /// Limits from values in the order of [`Self::NAMES`]. Fails unless every one is positive; 1e60 and more is no limit.
    ///
    /// Limits left out read as infinity, but those of slowing down as those of speeding up.
    pub fn new(values: [Option<f64>; COUNT]) -> Result<Self, Error> {
        for (&name, value) in Self::NAMES.iter().zip(values) {
            let Some(value) = value else { continue };
            if value >= TINY {
                continue;
            }
            let still = name.ends_with("deceleration") && value == 0.0;
            let top = [("speed", values[0]), ("yaw_rate", values[1])];
            let moving = top.iter().find_map(|(top, v)| Some((top, (*v)?)));
            let rule = match moving.filter(|_| still) {
                Some((top, value)) => {
                    let value = number(value);
                    format!("be positive: with {top}={value} the rover would never stop again")
                }
                None if value > 0.0 => format!("be at least {TINY:e}"),
                None => "be positive (math.inf for no limit)".into(),
            };
            return Err(Error::value(name, rule, number(value)));
        }
        let bits = values.iter().enumerate().filter(|(_, value)| value.is_some());
        let given = bits.fold(0, |bits, (k, _)| bits | 1 << k);
        let values = values.map(|value| value.filter(|value| *value < HUGE).unwrap_or(f64::INFINITY));
        let mut limits = Self::of_values(values, given);
        if !limits.has("deceleration") {
            limits.deceleration = limits.acceleration;
        }
        if !limits.has("angular_deceleration") {
            limits.angular_deceleration = limits.angular_acceleration;
        }
        let slows = limits.has("deceleration") || limits.has("acceleration");
        if slows && limits.has("halt_deceleration") && limits.halt_deceleration < limits.deceleration {
            let rule = format!("be at least deceleration={}", number(limits.deceleration));
            return Err(Error::value("halt_deceleration", rule, number(limits.halt_deceleration)));
        }
        Ok(limits)
    }

    /// True if the limit of this name was given.
    pub fn has(&self, name: &str) -> bool {
        Self::NAMES.iter().position(|known| *known == name).is_some_and(|k| self.given & 1 << k != 0)
    }

    /// The limits that were given, by name.
    pub fn pairs(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let limits = *self;
        let named = Self::NAMES.into_iter().zip(self.values());
        named.filter(move |(name, _)| limits.has(name))
    }

    /// The limits with a default for each that was left out and has one:
    ///
    /// - `acceleration`: 9.81 m/s², the friction of 1; `deceleration`: as `acceleration`;
    /// - `angular_acceleration`, `angular_deceleration`, `angular_jerk`: the linear one over the distance of the farthest
    ///   wheel from the origin, so that no wheel's speed over the ground changes faster in a spin than straight on; but
    ///   `angular_deceleration` as a given `angular_acceleration`;
    /// - `steering_rate`: 12 rad/s; `halt_deceleration`: as `deceleration`.
    #[must_use]
    pub fn on(&self, rover: &Rover) -> Self {
        let reach = rover.wheels().iter().map(|wheel| wheel.x.hypot(wheel.y)).fold(0.0, f64::max);
        let left_out = |name, value: f64| value.is_infinite() && !self.has(name);
        let mut filled = self.slowing();
        let fill = |value: &mut f64, name, usual: f64| {
            if left_out(name, *value) && usual > 0.0 {
                *value = usual;
            }
        };
        fill(&mut filled.angular_acceleration, "angular_acceleration", filled.acceleration / reach);
        let slower = if left_out("angular_acceleration", self.angular_acceleration) {
            filled.deceleration / reach
        } else {
            filled.angular_acceleration
        };
        fill(&mut filled.angular_deceleration, "angular_deceleration", slower);
        fill(&mut filled.angular_jerk, "angular_jerk", filled.jerk / reach);
        fill(&mut filled.steering_rate, "steering_rate", USUAL_STEERING_RATE);
        filled.given |= (1 << COUNT) - 1;
        filled
    }

    /// The limits with the defaults of the linear ones, which are the same for every rover.
    fn slowing(&self) -> Self {
        let mut filled = *self;
        if !self.has("acceleration") && self.acceleration.is_infinite() {
            filled.acceleration = USUAL_ACCELERATION;
        }
        if !self.has("deceleration") && self.deceleration.is_infinite() {
            filled.deceleration = filled.acceleration;
            if !self.has("acceleration") {
                // A slower halt that was given is a slower deceleration too.
                filled.deceleration = filled.deceleration.min(self.halt_deceleration);
            }
        }
        if !self.has("halt_deceleration") && self.halt_deceleration.is_infinite() {
            filled.halt_deceleration = filled.deceleration;
        }
        filled
    }

    /// Way [m] of a stop straight ahead from a steady speed [m/s], at the deceleration and jerk allowed.
    pub fn stopping_distance(&self, speed: f64) -> f64 {
        stop(speed.abs(), 0.0, self.slowing().deceleration, self.jerk)
    }

    /// Way [m] of a halt straight ahead from a steady speed [m/s].
    pub fn halting_distance(&self, speed: f64) -> f64 {
        stop(speed.abs(), 0.0, self.slowing().halt_deceleration, f64::INFINITY)
    }
}

/// Time of the quickest change of a quantity by `distance` from rest to rest, its rate at most `rate` and changing by
/// `acceleration` at most [s].
pub fn rest_to_rest(distance: f64, rate: f64, acceleration: f64) -> f64 {
    if distance * acceleration > rate * rate {
        distance / rate + rate / acceleration
    } else {
        2.0 * (distance / acceleration).sqrt()
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
    let after = peak * rest_to_rest(peak, deceleration, jerk) / 2.0;
    if rate > 0.0 {
        way + after
    } else {
        // From `peak` to `speed` the way covered already is this much.
        let before = peak * turn - jerk * turn.powi(3) / 6.0;
        (after - before).max(0.0)
    }
}
