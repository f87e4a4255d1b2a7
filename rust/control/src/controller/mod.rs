//! From a wanted twist to joint commands, one step at a time, within limits.
//!
//! A [`Controller`] holds one motion the rover can make: a direction, which is a point of an [`Arc`], and
//! a speed along it. A step moves both, never a joint or a component of the twist on its own: every output has
//! one centre of rotation, and while only the speed changes the curvature stays. What the two may do in a step
//! is a box of constants, the [`Envelope`] of the piece of arc ahead, inside which all limits
//! hold whatever happens; a better one is taken as soon as the motion fits into it.
//!
//! Between directions that no continuous turn of the wheels connects, and from rest, the joints go on their own
//! while the rover stands.

mod ahead;
mod align;
mod halt;
mod joints;
mod options;
mod route;
mod run;
mod step;
mod swing;
mod watch;
mod way;

use nalgebra::{Matrix3, Vector3};

pub use self::options::{Align, Options};
pub use self::run::Steps;
use self::way::Route;
use crate::motion::Motion;
use crate::motion::arc::Arc;
use crate::motion::envelope::{Envelope, SpeedBounds};
use crate::motion::following::Following;
pub use crate::motion::goal::Mode;
use crate::motion::goal::{self, Goal};
use crate::motion::limits;
pub use crate::motion::limits::Limits;
pub use crate::motion::reason;
use six_wheel_kinematics::admissible::Keep;
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::Rover;
use six_wheel_numerics::error::{Error, HUGE, TINY, bounded, finite, number};

/// Largest turn of a joint in one step [rad]: less than a quarter turn, so that a wheel does not go the other way round.
const LARGEST_TURN: f64 = 1.2;

/// Time for which goals have to be far from the direction that the joints go to before they are sent elsewhere [s], so
/// that a command which changes at every step does not keep the rover at rest.
const PATIENCE: f64 = 0.1;

/// A command that was taken.
#[derive(Clone, Copy, Debug)]
struct Command {
    goal: Goal,
    /// The twist and the mode of the call; the goal follows from them and the limits.
    twist: Twist,
    mode: Mode,
    stamp: f64,
}

/// A motion on its way to a command.
#[derive(Clone, Debug)]
pub struct Controller {
    /// The rover as it was given.
    given: Rover,
    /// The rover inside the steering limit and in its mode: how joints are solved for.
    rover: Rover,
    /// The rover inside a narrower steering limit, until all joints are there: what goals are projected by.
    narrowed: Option<Rover>,
    /// The rover's joints among all joints; the others are held at 0.
    joints: Vec<usize>,
    /// The limits as they were given, and with their defaults.
    limits: Limits,
    filled: Limits,
    speed_bounds: SpeedBounds,
    /// The bounds of new limits, until the motion is ready for them.
    pending: Option<SpeedBounds>,
    options: Options,
    /// The angles were given: the first measured ones do not replace them.
    placed: bool,
    scratch: Arc,

    clock: Option<f64>,
    /// Length of the last step and of the one before [s].
    last_step: f64,
    step_before: f64,
    command: Option<Command>,
    /// Stamp of the newest command taken.
    newest: Option<f64>,
    /// Reasons to report about commands that were not taken.
    ignored: u32,
    stale: bool,
    halted: bool,
    following: Following,

    arc: Arc,
    turn: Motion,
    speed: Motion,
    /// The steering angles are those of the direction.
    aligned: bool,
    route: Route,
    rerouted: bool,
    envelope: Envelope,
    /// Angle at which the envelope was entered.
    entered: f64,
    /// The envelope is that of the direction there is.
    settled: bool,
    /// The plane of the turn was changed in this step, and its envelope chosen with it.
    swung: bool,
    /// The highest speed for the whole turn ahead.
    ahead: f64,

    steering: Vec<f64>,
    steering_rates: Vec<f64>,
    /// Angles that the joints go to at rest, and the direction they are for.
    targets: Vec<f64>,
    target: Vector3<f64>,
    /// Angles of the newest goal.
    candidates: Vec<f64>,
    /// Time since a goal was near the direction that the joints have or go to [s].
    astray: f64,
    /// The joints have arrived there, and the body has not moved since.
    arrived: bool,
    /// Wheel speeds per unit of speed.
    ratios: Vec<f64>,
    speeds: Vec<f64>,
    twist: Twist,
    reasons: u32,
}

impl Controller {
    /// At rest, the joints at `steering`, or at the first measured angles, or at 0.
    ///
    /// Fails if an option or limit makes no sense, by itself or for this rover.
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
            entered: 0.0,
            settled: false,
            swung: false,
            ahead: f64::INFINITY,
            steering: vec![0.0; count],
            steering_rates: vec![0.0; count],
            targets: vec![0.0; count],
            target: along,
            candidates: vec![0.0; count],
            astray: PATIENCE,
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

    /// The same, but already in motion: on the way with the possible twist next to this one, at a steady speed, the
    /// joints where it needs them. A speed beyond the limits comes down as any other does.
    ///
    /// Fails if the twist is not finite.
    pub fn in_motion(mut self, twist: Twist) -> Result<Self, Error> {
        bounded("twist", &<[f64; 3]>::from(twist))?;
        let possible = self.rover.project(twist, Keep::Nearest)?;
        if let Some((speed, direction)) = goal::polar(&self.rover.metric, possible) {
            self.settle(direction);
            self.speed = Motion::at(speed);
            self.twist = possible;
            // Taken even if the speed does not fit into it: then it comes down until it does.
            self.envelope = Envelope::of_direction(&self.speed_bounds, &self.arc, 0.0);
            self.settled = true;
            self.placed = true;
            self.set_speeds();
        }
        Ok(self)
    }

    /// Forgets command, clock, halt and fault. The body rests; the joints stay where they were last commanded, or start
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
        self.settled = false;
        self.route = Route::Stay;
        self.rerouted = true;
        (self.astray, self.arrived) = (PATIENCE, false);
        self.steering_rates.fill(0.0);
        self.targets.copy_from_slice(&self.steering);
        self.speeds.fill(0.0);
        self.twist = Twist::ZERO;
        self.reasons = 0;
        self.last_step = 0.0;
        self.step_before = 0.0;
        Ok(())
    }

    /// Takes a command given at `stamp` [s]; returns whether it is taken.
    ///
    /// Not taken, and reported by the steps to come, are one that is not finite and one older than the last.
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

    /// Steering angles to command now [rad].
    pub fn steering(&self) -> &[f64] {
        &self.steering
    }

    /// Their rates [rad/s].
    pub fn steering_rates(&self) -> &[f64] {
        &self.steering_rates
    }

    /// Wheel speeds to command now [rad/s].
    pub fn speeds(&self) -> &[f64] {
        &self.speeds
    }

    /// The motion they make.
    pub fn twist(&self) -> Twist {
        self.twist
    }

    /// Reasons why it is not the motion asked for: bits of [`reason`].
    pub fn reasons(&self) -> u32 {
        self.reasons
    }

    /// Share of the speed asked for that the limits leave: 1 if none of them binds.
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

    /// The limits as they were given.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// The options it was made with.
    pub fn options(&self) -> &Options {
        &self.options
    }

    /// Way of the body's origin [m], at most, of a stop that begins with the next step, the present speed being held
    /// until then.
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
