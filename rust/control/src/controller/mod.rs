//! From desired twists to joint commands, one step at a time, within limits.
//!
//! A [`Controller`] holds one motion the rover can make: a direction, which is a point of an [`Arc`], and a speed along
//! it. A step changes both, never a joint or a component of the twist on its own: every output has one centre of
//! rotation, and while only the speed changes the curvature stays. Both changes are bounded by constants, the
//! [`Envelope`] of a piece of the arc, inside which all limits hold; a better one is entered as soon as the motion is
//! inside of it.
//!
//! Between directions that no continuous turn of the wheels connects, and from rest, every joint turns on its own while
//! the rover stands.

mod align;
mod find_route;
mod halt;
mod joint_errors;
mod joints;
mod options;
mod plane_change;
mod route;
mod run;
mod step;
mod turn;

use nalgebra::{Matrix3, Vector3};

pub use self::options::{AlignmentPolicy, Options};
use self::route::Route;
pub use self::run::Steps;
use crate::motion::Motion;
use crate::motion::arc::Arc;
use crate::motion::envelope::{Envelope, SpeedBounds};
use crate::motion::following::Following;
pub use crate::motion::goal::Mode;
use crate::motion::goal::{self, Goal};
pub use crate::motion::limits::{self, Limits};
pub use crate::motion::reason;
use six_wheel_kinematics::admissible::Keep;
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::Rover;
use six_wheel_numerics::error::{Error, HUGE, TINY, bounded, finite, number};

/// Largest turn of a joint in one step [rad]: less than a quarter turn, so that the sense of rotation is unambiguous.
const LARGEST_TURN: f64 = 1.2;

/// Time for which goals have to be far from the targets of the joints before new targets are chosen [s]: a command that
/// changes at every step must not keep the rover at rest.
const PATIENCE: f64 = 0.1;

/// An accepted command.
#[derive(Clone, Copy, Debug)]
struct Command {
    goal: Goal,
    /// The twist and the mode of the call; the goal follows from them and the limits.
    twist: Twist,
    mode: Mode,
    /// Time of the command [s].
    stamp: f64,
}

/// Controller of one rover: its motion, its limits and the command that it approaches.
#[derive(Clone, Debug)]
pub struct Controller {
    /// The rover as it was given.
    given: Rover,
    /// The rover with the steering limit and in its mode: the model for which joints are solved.
    rover: Rover,
    /// The rover with a new, narrower steering limit, until all joints are inside: the model that goals are projected
    /// by.
    narrowed: Option<Rover>,
    /// Indices of the model's joints among all joints; the others stay at 0.
    joints: Vec<usize>,
    /// The limits as they were given, and with defaults filled in.
    limits: Limits,
    filled: Limits,
    speed_bounds: SpeedBounds,
    /// The bounds of new limits, until the motion fits them.
    pending: Option<SpeedBounds>,
    options: Options,
    /// True if start angles were given: the first measured ones do not replace them.
    placed: bool,
    scratch: Arc,
    /// Time of the last step [s].
    clock: Option<f64>,
    /// Length of the last step and of the one before [s].
    last_step: f64,
    step_before: f64,
    command: Option<Command>,
    /// Stamp of the newest accepted command [s].
    newest: Option<f64>,
    /// Reasons of rejected commands, to report in the next step.
    ignored: u32,
    stale: bool,
    halted: bool,
    following: Following,
    /// Arc of the present turn.
    arc: Arc,
    /// Angle on the arc [rad] and its rate [rad/s].
    turn: Motion,
    /// Speed along the direction [m/s] and its change [m/s²].
    speed: Motion,
    /// True if the steering angles are those of the direction.
    aligned: bool,
    route: Route,
    /// True if the next step has to find a route.
    rerouted: bool,
    envelope: Envelope,
    /// Angle of the arc at which the envelope was entered [rad].
    entry_angle: f64,
    /// True if the envelope is that of the present direction, kept.
    is_direction_envelope: bool,
    /// True if the plane of the turn was changed in this step, and its envelope chosen with it.
    plane_changed: bool,
    /// The highest speed for the whole rest of the turn [m/s].
    turn_speed: f64,
    /// Commanded steering angles [rad] and their rates [rad/s].
    steering: Vec<f64>,
    steering_rates: Vec<f64>,
    /// Target angles of an alignment at rest [rad], and their direction.
    targets: Vec<f64>,
    target: Vector3<f64>,
    /// Angles of the newest goal [rad].
    candidates: Vec<f64>,
    /// Time since a goal was near the direction of the joints or of their targets [s].
    off_goal_time: f64,
    /// True if the joints have arrived at their targets, and the body has not moved since.
    arrived: bool,
    /// Wheel speeds per speed along the direction [rad/m].
    ratios: Vec<f64>,
    /// Commanded wheel speeds [rad/s].
    speeds: Vec<f64>,
    twist: Twist,
    reasons: u32,
}

getters! {
    Controller:
    /// Steering angles to command now [rad].
    steering: &[f64];
    /// Their rates [rad/s].
    steering_rates: &[f64];
    /// Wheel speeds to command now [rad/s].
    speeds: &[f64];
    /// The motion they make.
    twist: Twist;
    /// Reasons why it is not the desired motion: bits of [`reason`].
    reasons: u32;
    /// The limits as they were given.
    limits: &Limits;
    /// The options it was made with.
    options: &Options;
}

impl Controller {
    /// A controller at rest, the joints at `steering` [rad], or at the first measured angles, or at 0.
    ///
    /// Fails if an option or limit is invalid, by itself or for this rover.
    pub fn new(rover: &Rover, limits: Limits, options: Options, steering: Option<&[f64]>) -> Result<Self, Error> {
        options.check()?;
        if rover.size < TINY {
            let rule = format!("have its wheels in one place, or {TINY:e} m apart at least");
            return Err(Error::value("rover", rule, number(rover.size)));
        }
        let (model, joints) = options.model(rover, &limits)?;
        let count = rover.steered().len();
        let along = Vector3::x() / model.metric[(0, 0)].sqrt();
        let arc = Arc::new(&model, along);
        let filled = limits.on(rover);
        let speed_bounds = speed_bounds(&model, filled, &options);
        let envelope = Envelope::of_direction(&speed_bounds, &arc, 0.0);
        let mut controller = Self {
            given: rover.clone(),
            narrowed: None,
            joints,
            limits,
            filled,
            speed_bounds,
            pending: None,
            options,
            placed: false,
            scratch: arc.clone(),
            clock: None,
            last_step: 0.0,
            step_before: 0.0,
            command: None,
            newest: None,
            ignored: 0,
            stale: false,
            halted: false,
            following: Following::new(count),
            arc,
            turn: Motion::default(),
            speed: Motion::default(),
            aligned: false,
            route: Route::Stay,
            rerouted: true,
            envelope,
            entry_angle: 0.0,
            is_direction_envelope: false,
            plane_changed: false,
            turn_speed: f64::INFINITY,
            steering: vec![0.0; count],
            steering_rates: vec![0.0; count],
            targets: vec![0.0; count],
            target: along,
            candidates: vec![0.0; count],
            off_goal_time: PATIENCE,
            arrived: false,
            ratios: vec![0.0; rover.wheels().len()],
            speeds: vec![0.0; rover.wheels().len()],
            twist: Twist::ZERO,
            reasons: 0,
            rover: model,
        };
        controller.reset(steering)?;
        if steering.is_none() {
            controller.set_angles_in_range();
        }
        Ok(controller)
    }

    /// The controller in motion: at a steady speed with the possible twist nearest to this one, the joints at its
    /// angles. A speed beyond the limits slows down into them.
    ///
    /// Fails if the twist is not finite.
    pub fn in_motion(mut self, twist: Twist) -> Result<Self, Error> {
        bounded("twist", &<[f64; 3]>::from(twist))?;
        let possible = self.rover.project(twist, Keep::Nearest)?;
        if let Some((speed, direction)) = goal::polar(&self.rover.metric, possible) {
            self.set_direction(direction);
            self.speed = Motion::at(speed);
            self.twist = possible;
            // Entered even if the speed is outside: then it slows down until it is inside.
            self.envelope = Envelope::of_direction(&self.speed_bounds, &self.arc, 0.0);
            self.is_direction_envelope = true;
            self.placed = true;
            self.set_speeds();
        }
        Ok(self)
    }

    /// Clears command, clock, halt and fault. The body rests; the joints stay where they were last commanded, or start
    /// at the angles of the next step's measurement, or of `steering` [rad].
    ///
    /// Fails, without effect, unless there is an angle near the rover's own range for every joint.
    pub fn reset(&mut self, steering: Option<&[f64]>) -> Result<(), Error> {
        if let Some(steering) = steering {
            self.given.check_measured("steering", steering)?;
            self.start_at(steering);
        }
        self.placed = steering.is_some();
        self.clock = None;
        self.command = None;
        self.newest = None;
        self.ignored = 0;
        self.stale = false;
        self.halted = false;
        self.following.clear();
        self.turn = Motion::default();
        self.speed = Motion::default();
        self.aligned = false;
        self.envelope.turning = false;
        self.is_direction_envelope = false;
        self.route = Route::Stay;
        self.rerouted = true;
        (self.off_goal_time, self.arrived) = (PATIENCE, false);
        self.steering_rates.fill(0.0);
        self.targets.copy_from_slice(&self.steering);
        self.speeds.fill(0.0);
        self.twist = Twist::ZERO;
        self.reasons = 0;
        self.last_step = 0.0;
        self.step_before = 0.0;
        Ok(())
    }

    /// Accepts a command given at `stamp` [s]; returns false if it is rejected.
    ///
    /// Rejected, and reported by the following steps, are a command that is not finite and one older than the last.
    /// Fails, without effect, if the stamp is not finite.
    pub fn command(&mut self, twist: Twist, stamp: f64, mode: Option<Mode>) -> Result<bool, Error> {
        finite("stamp", &[stamp])?;
        let held = self.options.mode;
        let mode = mode.unwrap_or(held);
        if mode == Mode::FrontOnly && held != mode {
            let rule = "be that of the controller to be 'front_only'";
            return Err(Error::value("mode", rule, format!("{:?}", held.name())));
        }
        if self.newest.is_some_and(|newest| stamp < newest) {
            self.ignored |= reason::OUT_OF_ORDER;
            return Ok(false);
        }
        if self.halted {
            return Ok(false);
        }
        let Some(goal) = self.goal_of(twist, mode) else {
            self.ignored |= reason::NOT_FINITE;
            return Ok(false);
        };
        let same = |last: &Command| last.goal.direction == goal.direction && last.goal.speed == goal.speed;
        self.rerouted |= !self.command.as_ref().is_some_and(same);
        self.ignored &= !reason::NOT_FINITE;
        self.newest = Some(stamp);
        self.command = Some(Command { goal, twist, mode, stamp });
        Ok(true)
    }

    /// The goal of a command, or none if it is not finite.
    fn goal_of(&mut self, twist: Twist, mode: Mode) -> Option<Goal> {
        let finite = <[f64; 3]>::from(twist).iter().all(|value| value.abs() < HUGE);
        let period = self.options.period.filter(|_| self.options.discretise);
        let rover = self.narrowed.as_ref().unwrap_or(&self.rover);
        let modes = [mode, self.options.mode];
        finite.then(|| Goal::new(rover, &self.filled, &mut self.scratch, modes, period, twist)).flatten()
    }

    /// Share of the desired speed that the limits allow: 1 if none of them is active.
    pub fn speed_share(&self) -> f64 {
        self.command.map_or(1.0, |command| command.goal.share)
    }

    /// True if body and joints stand still.
    pub fn stopped(&self) -> bool {
        self.speed == Motion::default() && self.steering_rates.iter().all(|rate| *rate == 0.0)
    }

    /// Time of the last step [s].
    pub fn now(&self) -> Option<f64> {
        self.clock
    }

    /// Upper bound of the distance that the body's origin travels until rest [m], if a stop begins with the next step
    /// and the speed is constant until then.
    pub fn stopping_distance(&self) -> f64 {
        let sign = if self.speed.value < 0.0 { -1.0 } else { 1.0 };
        let (speed, rate) = (self.speed.value * sign, self.speed.rate * sign);
        if speed == 0.0 && rate == 0.0 {
            return 0.0;
        }
        let (slowing, change) = (self.envelope.rates[0].value, self.envelope.change.value);
        let way = limits::stop(speed, rate, slowing, change) + speed * self.last_step;
        self.envelope.way * way
    }

    /// The direction of the motion.
    fn direction(&self) -> Vector3<f64> {
        self.arc.at(self.turn.value)
    }

    fn metric(&self) -> &Matrix3<f64> {
        &self.rover.metric
    }

    /// Fails unless the time is later than that of the last step.
    fn check_time(&self, now: f64) -> Result<(), Error> {
        finite("stamp", &[now])?;
        match self.clock {
            Some(last) if now <= last => {
                let rule = format!("be later than the last step, at {}", number(last));
                Err(Error::value("stamp", rule, number(now)))
            }
            _ => Ok(()),
        }
    }
}

/// Limits less the share of steering: a wheel with scrub rolls while it is steered.
fn speed_bounds(rover: &Rover, mut limits: Limits, options: &Options) -> SpeedBounds {
    let lever = |&i: &usize| rover.wheels()[i].scrub.abs() / rover.wheels()[i].radius;
    let lever = rover.steered().iter().map(lever).fold(0.0, f64::max);
    let mut steering_share = [0.0; 2];
    if lever > 0.0 {
        let wheels = [limits.wheel_speed / 2.0, limits.wheel_acceleration / 4.0];
        let joints = [&mut limits.steering_rate, &mut limits.steering_acceleration];
        for ((joint, wheel), share) in joints.into_iter().zip(wheels).zip(&mut steering_share) {
            *joint = joint.min(wheel / lever);
            if wheel.is_finite() {
                *share = wheel.min(*joint * lever); // a lever of nearly nothing bounds no rate
            }
        }
    }
    SpeedBounds { limits, steering_share, fastest_turn: LARGEST_TURN / options.max_step }
}
