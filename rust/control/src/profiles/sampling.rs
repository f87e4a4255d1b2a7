//! Transitions led by one part of the rover: the body's twist, or each module's own angle and speed.

use nalgebra::Vector3;

use super::chord::solved;
use super::constraints::pivot_direction_derivatives;
use super::limits::{AxisState, Bounds, Synchronise};
use super::optimal::time_optimal;
use super::{Profile, Shape, linear};
use six_wheel_kinematics::estimate::{Measured, Method, Unseen};
use six_wheel_kinematics::geometry::Direction;
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::kernels::steered::wheel::castor_rim_speed;
use six_wheel_kinematics::rover::{Inputs, MAX_WHEELS, Mount, Rover};
use six_wheel_kinematics::steering::ANGLE_TOLERANCE;
use six_wheel_numerics::error::{Error, finite, number};

/// Output of a transition: one value per steered wheel, speeds per wheel.
#[derive(Debug)]
pub struct Wheels<'a> {
    /// Steering angles [rad].
    pub steering: &'a mut [f64],
    /// Wheel speeds [rad/s].
    pub speeds: &'a mut [f64],
    /// Steering rates [rad/s].
    pub rates: &'a mut [f64],
    /// Steering accelerations [rad/s²].
    pub accelerations: &'a mut [f64],
}

impl Wheels<'_> {
    /// Angles and speeds by the wheel equation; of equivalent angles the one nearest to the present angle.
    pub fn roll(&mut self, rover: &Rover, twist: Twist) {
        let mut near = [0.0; MAX_WHEELS];
        let near = &mut near[..self.steering.len()];
        near.copy_from_slice(self.steering);
        let inputs = Inputs { previous: Some(near), previous_speeds: None, steering_rates: Some(self.rates) };
        rover.solve(twist, inputs, self.steering, self.speeds);
    }

    /// Speeds by the wheel equation at the present angles and rates, which have to be those of the twist.
    pub(crate) fn roll_at_angles(&mut self, rover: &Rover, twist: Twist) {
        let vector = Vector3::from(twist);
        let mut joint = 0;
        for (i, wheel) in rover.wheels().iter().enumerate() {
            let rim_speed = match rover.mounts[i] {
                Mount::Fixed(rows) => rows.rolling.dot(&vector),
                Mount::Castor(heading) => castor_rim_speed(wheel, heading, twist),
                Mount::Steered(..) => {
                    let direction = Direction::from(wheel.heading + self.steering[joint]);
                    let rolling = wheel.rows(direction).rolling.dot(&vector);
                    joint += 1;
                    rolling - wheel.scrub * self.rates[joint - 1]
                }
            };
            self.speeds[i] = rim_speed / wheel.radius;
        }
    }

    /// Steering angles and their derivatives by the first axes of a profile.
    pub fn follow(&mut self, profile: &Profile, time: f64) {
        for (j, angle) in self.steering.iter_mut().enumerate() {
            let [value, rate, acceleration, _] = profile.at(j, time);
            *angle = value;
            self.rates[j] = rate;
            self.accelerations[j] = acceleration;
        }
    }

    /// The least-squares twist of the wheels, and the largest speed at which one of them slides under it [m/s].
    pub fn scrub(&self, rover: &Rover) -> Result<(Twist, f64), Error> {
        let measured = Measured { steering: self.steering, speeds: self.speeds, steering_rates: Some(self.rates) };
        let (mut residual, mut weights) = ([0.0; MAX_WHEELS], [0.0; MAX_WHEELS]);
        let count = self.speeds.len();
        let residual = &mut residual[..count];
        let method = Method::LeastSquares;
        let fit = rover.fit(measured, method, Unseen::Zero, residual, &mut weights[..count])?;
        Ok((fit.twist, residual.iter().fold(0.0, |worst: f64, slip| worst.max(*slip))))
    }
}

/// Fails if the angle of a steered wheel depends on its own rate.
pub(crate) fn check_trail(rover: &Rover) -> Result<(), Error> {
    let trailing = rover.steered().iter().map(|&i| &rover.wheels()[i]).find(|wheel| wheel.trail != 0.0);
    match trailing {
        None => Ok(()),
        Some(wheel) => {
            let rule =
                format!("have no steered wheel with trail: the angle of {:?} depends on its own rate", wheel.name);
            Err(Error::value("rover", rule, number(wheel.trail)))
        }
    }
}

/// A transition by a profile of the body's twist, from which the wheels follow.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyTransition {
    rover: Rover,
    profile: Profile,
    previous: Vec<f64>,
}

impl BodyTransition {
    /// A rover that moves by a profile of `vx`, `vy` and `omega`; `previous` are the steering angles before it.
    pub fn new(rover: &Rover, profile: Profile, previous: Option<&[f64]>) -> Result<Self, Error> {
        check_trail(rover)?;
        Inputs { previous, ..Inputs::default() }.check()?;
        let ends = [("start_twist", 0.0), ("end_twist", profile.duration())];
        for (argument, time) in ends {
            rover
                .check(twist_at(&profile, time)[0].into(), None)
                .map_err(|error| Error { argument: argument.into(), ..error })?;
        }
        let [previous, _] = solved(rover, twist_at(&profile, 0.0)[0].into(), previous);
        Ok(Self { rover: rover.clone(), profile, previous })
    }

    /// Time-optimal within limits of the acceleration and jerk `[.., ..]` of vx and vy each, and of omega.
    pub fn within(
        rover: &Rover,
        [start, end]: [Twist; 2],
        [linear, angular]: [[f64; 2]; 2],
        synchronise: Synchronise,
        previous: Option<&[f64]>,
    ) -> Result<Self, Error> {
        let (start, end) = (<[f64; 3]>::from(start), <[f64; 3]>::from(end));
        let limits = [linear, linear, angular];
        let bounds = |axis: usize| {
            let [first, second] = limits[axis];
            // The limit of an axis that does not change has no effect, so an infinite one is replaced.
            let first = if start[axis] == end[axis] { first.min(1.0) } else { first };
            Bounds::symmetric(first, second, f64::INFINITY)
        };
        let (from, to) = (AxisState::resting(&start), AxisState::resting(&end));
        let profile = time_optimal(&from, &to, &[0, 1, 2].map(bounds), synchronise, None)?;
        Self::new(rover, profile, previous)
    }

    /// Duration [s].
    pub fn duration(&self) -> f64 {
        self.profile.duration()
    }

    /// The rover it is for.
    pub fn rover(&self) -> &Rover {
        &self.rover
    }

    /// Twist and wheels at a time [s]; steering angles are clipped to their ranges.
    pub fn at(&self, time: f64, wheels: &mut Wheels<'_>) -> Twist {
        let moving = twist_at(&self.profile, time);
        for (j, &i) in self.rover.steered().iter().enumerate() {
            let [rate, acceleration] = pivot_direction_derivatives(&self.rover, i, moving);
            wheels.rates[j] = rate;
            wheels.accelerations[j] = acceleration;
        }
        wheels.steering.copy_from_slice(&self.previous);
        let twist = moving[0].into();
        wheels.roll(&self.rover, twist);
        twist
    }
}

/// A twist and its first two derivatives.
fn twist_at(profile: &Profile, time: f64) -> [Vector3<f64>; 3] {
    let axes = [0, 1, 2].map(|axis| profile.at(axis, time));
    [0, 1, 2].map(|order| Vector3::new(axes[0][order], axes[1][order], axes[2][order]))
}

/// Limits of a transition of modules; infinite where there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModuleLimits {
    /// Largest rate of every steering joint [rad/s].
    pub steering_rate: f64,
    /// Largest acceleration of every steering joint [rad/s²].
    pub steering_acceleration: f64,
    /// Largest jerk of every steering joint [rad/s³].
    pub steering_jerk: f64,
    /// Largest acceleration of every wheel [rad/s²].
    pub wheel_acceleration: f64,
    /// Largest jerk of every wheel [rad/s³].
    pub wheel_jerk: f64,
}

/// Angles of the steered wheels [rad] and speeds of all wheels [rad/s].
#[derive(Clone, Copy, Debug)]
pub struct Modules<'a> {
    /// One per steered wheel.
    pub steering: &'a [f64],
    /// One per wheel.
    pub speeds: &'a [f64],
}

impl Modules<'_> {
    fn joined(&self) -> Vec<f64> {
        [self.steering, self.speeds].concat()
    }
}

/// A transition by a profile of every steering angle and every wheel speed.
#[derive(Clone, Debug, PartialEq)]
pub struct ModuleTransition {
    rover: Rover,
    /// Steering angles, then wheel speeds.
    profile: Profile,
}

impl ModuleTransition {
    /// All modules by profiles of one shape.
    pub fn shaped(
        rover: &Rover,
        start: Modules<'_>,
        end: Modules<'_>,
        shape: Shape,
        duration: f64,
    ) -> Result<Self, Error> {
        check_modules(rover, start, end)?;
        Ok(Self { rover: rover.clone(), profile: shape.between(&start.joined(), &end.joined(), duration)? })
    }

    /// Time-optimal within the limits of the modules; wheels without a limit take the time of the steering.
    pub fn within(
        rover: &Rover,
        start: Modules<'_>,
        end: Modules<'_>,
        limits: &ModuleLimits,
        synchronise: Synchronise,
    ) -> Result<Self, Error> {
        check_modules(rover, start, end)?;
        let steering = Bounds::symmetric(limits.steering_rate, limits.steering_acceleration, limits.steering_jerk);
        let rolling = Bounds::symmetric(limits.wheel_acceleration, limits.wheel_jerk, f64::INFINITY);
        let bounds = |bounds: Bounds, count: usize| vec![bounds; count];
        let (joints, wheels) = (start.steering.len(), start.speeds.len());
        let fastest = |from: &[f64], to: &[f64], bounds: &[Bounds]| {
            time_optimal(&AxisState::resting(from), &AxisState::resting(to), bounds, synchronise, None)
        };
        let is_limited = |bounds: &Bounds| bounds.velocity.min(bounds.acceleration).is_finite();
        let profile = if is_limited(&rolling) {
            let bounds = [bounds(steering, joints), bounds(rolling, wheels)].concat();
            fastest(&start.joined(), &end.joined(), &bounds)?
        } else if joints == 0 {
            let rule = "be finite for a rover that does not steer";
            return Err(Error::value("wheel_acceleration", rule, number(rolling.velocity)));
        } else {
            let turning = fastest(start.steering, end.steering, &bounds(steering, joints))?;
            let duration = turning.duration().max(f64::MIN_POSITIVE);
            turning.concatenate_axes(linear(start.speeds, end.speeds, duration)?)
        };
        Ok(Self { rover: rover.clone(), profile })
    }

    /// Duration [s].
    pub fn duration(&self) -> f64 {
        self.profile.duration()
    }

    /// The rover it is for.
    pub fn rover(&self) -> &Rover {
        &self.rover
    }

    /// Writes angles, rates and speeds of the wheels at a time [s].
    pub fn at(&self, time: f64, wheels: &mut Wheels<'_>) {
        wheels.follow(&self.profile, time);
        let joints = wheels.steering.len();
        for (i, speed) in wheels.speeds.iter_mut().enumerate() {
            *speed = self.profile.at(joints + i, time)[0];
        }
    }
}

/// Fails unless every number is finite and every angle within its range.
fn check_modules(rover: &Rover, start: Modules<'_>, end: Modules<'_>) -> Result<(), Error> {
    for (argument, modules) in [("start", start), ("end", end)] {
        finite(argument, modules.steering)?;
        finite(argument, modules.speeds)?;
        for (&angle, &i) in modules.steering.iter().zip(rover.steered()) {
            let wheel = &rover.wheels()[i];
            let Some(range) = wheel.steering() else {
                continue;
            };
            if (range.clip(angle) - angle).abs() > ANGLE_TOLERANCE {
                let rule = format!("steer wheel {:?} within {range}", wheel.name);
                return Err(Error::value(argument, rule, number(angle)));
            }
        }
    }
    Ok(())
}
