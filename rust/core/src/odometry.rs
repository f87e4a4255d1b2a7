//! Dead reckoning that knows its error: where the wheels say the rover is, and how far that may be off.
//!
//! [`Odometry`] is one visible struct of state, stepped by one method. A step is exact: the displacement that fits
//! the turns of all wheels best, at the steering angles of its middle, is held as one arc ([`Twist::exp`]). Its
//! covariance comes from the analytic derivatives of that fit (`estimate::sensitivity`).

pub mod encoder;
pub mod health;
mod history;
pub mod noise;
mod spread;
mod step;
mod tolerant;
mod uncertainty;

use nalgebra::Matrix3;

pub use encoder::Encoder;
pub use health::Health;
pub use noise::Noise;

use crate::error::{Error, number, numbers};
use crate::estimate::Method;
use crate::geometry::{Pose, Twist, Walk, wrap_angle};
use crate::rover::{Inputs, Rover};
use history::History;
use step::{Motion, Rules, Workspace, shared_readings, step_jacobian};
use tolerant::Suspect;
pub use tolerant::{Recording, TrackRows};
use uncertainty::Uncertainty;

/// Displacements and variances over one step beyond which sums of squares might not be finite.
const HUGE: f64 = 1e60;

/// What the readings of the wheels are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Readings {
    /// Running totals.
    #[default]
    Angles,
    /// Rates at the stamps: a step takes the mean of its two ends.
    Speeds,
    /// What came since the sample before.
    Increments,
}

/// How odometry works; all of it may be left out.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Standard deviations of readings and slip.
    pub noise: Noise,
    /// What the readings of the wheels are.
    pub readings: Readings,
    /// One for all wheels or one per wheel; empty: they read radians.
    pub wheel_encoders: Vec<Encoder>,
    /// One for all steering joints or one per joint; empty: they read radians.
    pub steering_encoders: Vec<Encoder>,
    /// How the wheels are weighed.
    pub method: Method,
    /// Whether disagreement of the wheels beyond the noise counts as more noise.
    pub inflate: bool,
    /// Slip of a wheel that is flagged [m/s]; None: four standard deviations of what the noise explains.
    pub slip_threshold: Option<f64>,
    /// Time between samples beyond which a step is flagged [s].
    pub max_gap: Option<f64>,
    /// Rim speed beyond which a sample is refused [m/s].
    pub max_speed: Option<f64>,
    /// Steering rate beyond which a sample is refused [rad/s].
    pub max_steering_rate: Option<f64>,
    /// Time constant of the first-order filter of `velocity` [s]; 0: none.
    pub smoothing: f64,
    /// How late a pose from outside may come [s].
    pub lag: f64,
    /// Samples that are kept for that at most.
    pub history: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            noise: Noise::default(),
            readings: Readings::Angles,
            wheel_encoders: Vec::new(),
            steering_encoders: Vec::new(),
            method: Method::LeastSquares,
            inflate: false,
            slip_threshold: None,
            max_gap: None,
            max_speed: None,
            max_steering_rate: None,
            smoothing: 0.0,
            lag: 0.0,
            history: 1024,
        }
    }
}

impl Settings {
    fn check(&self, rover: &Rover) -> Result<(), Error> {
        self.noise.check()?;
        let encoders = [
            ("wheel_encoders", &self.wheel_encoders, rover.wheels().len()),
            (
                "steering_encoders",
                &self.steering_encoders,
                rover.steered().len(),
            ),
        ];
        for (argument, encoders, count) in encoders {
            if encoders.len() > 1 && encoders.len() != count {
                let rule = format!("be one encoder or {count}");
                return Err(Error::value(argument, rule, encoders.len().to_string()));
            }
            encoders.iter().try_for_each(Encoder::check)?;
        }
        let optional = [
            ("slip_threshold", self.slip_threshold),
            ("max_gap", self.max_gap),
            ("max_speed", self.max_speed),
            ("max_steering_rate", self.max_steering_rate),
        ];
        for (argument, value) in optional {
            if let Some(value) = value
                && !(value > 0.0)
            {
                return Err(Error::value(argument, "be positive", number(value)));
            }
        }
        for (argument, value) in [("smoothing", self.smoothing), ("lag", self.lag)] {
            if !(value.is_finite() && value >= 0.0) {
                let rule = "be finite and not negative";
                return Err(Error::value(argument, rule, number(value)));
            }
        }
        if self.method == Method::MiddleWheels && rover.steered().len() == rover.wheels().len() {
            let rule = "be another one for a rover without unsteered wheels";
            return Err(Error::value("method", rule, "'middle_wheels'"));
        }
        Ok(())
    }
}

/// What was read at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'a> {
    /// Readings of the steering joints.
    pub steering: &'a [f64],
    /// Readings of the wheels. NaN where a passive wheel has no encoder.
    pub wheels: &'a [f64],
    /// When [s].
    pub stamp: f64,
    /// Absolute yaw from a sensor with a zero of its own [rad].
    pub yaw: Option<f64>,
    /// Yaw rate of a gyroscope [rad/s].
    pub yaw_rate: Option<f64>,
}

/// The sample from which the next one counts.
#[derive(Clone, Debug)]
struct Reference {
    /// Whether there is one.
    known: bool,
    stamp: f64,
    wheels: Vec<f64>,
    /// As read.
    steering: Vec<f64>,
    /// Whole turns kept [rad].
    angles: Vec<f64>,
    yaw_rate: Option<f64>,
}

/// What changes from sample to sample and is taken back when a late pose comes.
#[derive(Clone, Debug)]
struct State {
    walk: Walk,
    twist: Twist,
    velocity: Option<Twist>,
    uncertainty: Uncertainty,
}

impl State {
    fn copy_from(&mut self, other: &Self) {
        self.walk = other.walk;
        self.twist = other.twist;
        self.velocity = other.velocity;
        self.uncertainty.copy_from(&other.uncertainty);
    }

    fn pose(&self) -> Pose {
        Pose {
            x: self.walk.x.value(),
            y: self.walk.y.value(),
            yaw: self.walk.yaw.value(),
        }
    }

    /// Moves the pose by a correction.
    fn shift(&mut self, by: &nalgebra::Vector3<f64>) {
        self.walk.shift(by.x, by.y);
        self.walk.turn(by.z);
    }
}

/// Why a sample is refused.
struct Refusal {
    flag: Health,
    error: Error,
}

impl Refusal {
    fn new(flag: Health, error: Error) -> Self {
        Self { flag, error }
    }
}

/// Dead reckoning of one rover: its pose, its motion, and how far they may be off.
#[derive(Clone, Debug)]
pub struct Odometry {
    rover: Rover,
    settings: Settings,
    reference: Reference,
    state: State,
    residual: Vec<f64>,
    health: Health,
    work: Workspace,
    turned: Vec<f64>,
    angles: Vec<f64>,
    history: History,
    suspect: Suspect,
}

impl Odometry {
    /// At the origin, waiting for a first sample.
    pub fn new(rover: Rover, settings: Settings) -> Result<Self, Error> {
        settings.check(&rover)?;
        let from_rates = settings.readings == Readings::Speeds;
        let (wheels, joints) = (rover.wheels().len(), rover.steered().len());
        let state = State {
            walk: Walk::new([0.0; 3]),
            twist: Twist::ZERO,
            velocity: None,
            uncertainty: Uncertainty::new(shared_readings(&rover, from_rates)),
        };
        let reference = Reference {
            known: false,
            stamp: 0.0,
            wheels: vec![0.0; wheels],
            steering: vec![0.0; joints],
            angles: vec![0.0; joints],
            yaw_rate: None,
        };
        Ok(Self {
            history: History::new(&settings, &state, wheels, joints),
            suspect: Suspect::new(wheels, joints),
            reference,
            state,
            residual: vec![0.0; wheels],
            health: Health::GOOD,
            work: Workspace::new(&rover, from_rates),
            turned: vec![0.0; wheels],
            angles: vec![0.0; joints],
            rover,
            settings,
        })
    }

    /// The rover.
    pub fn rover(&self) -> &Rover {
        &self.rover
    }

    /// How it works.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Where the rover is.
    pub fn pose(&self) -> Pose {
        self.state.pose()
    }

    /// Mean twist over the last step, in body axes.
    pub fn twist(&self) -> Twist {
        self.state.twist
    }

    /// The twist through a first-order filter with the time constant `smoothing`, which starts with the first step.
    pub fn velocity(&self) -> Twist {
        self.state.velocity.unwrap_or_default()
    }

    /// Covariance of the pose in world axes, x [m], y [m], yaw [rad]: symmetric, without negative variances.
    pub fn covariance(&self) -> [[f64; 3]; 3] {
        self.state.uncertainty.reported().into()
    }

    /// Covariance of the twist over the last step, in body axes.
    pub fn twist_covariance(&self) -> [[f64; 3]; 3] {
        let dt = self.history.last_duration();
        if dt == 0.0 {
            return [[0.0; 3]; 3];
        }
        (self.work.noise.total().matrix() / (dt * dt)).into()
    }

    /// Speed at which each wheel's contact slid over the last step [m/s].
    pub fn residual(&self) -> &[f64] {
        &self.residual
    }

    /// Say of each wheel over the last step, 0 to 1.
    pub fn weights(&self) -> &[f64] {
        &self.work.weights
    }

    /// What there is to say about the last sample.
    pub fn health(&self) -> Health {
        self.health
    }

    /// When the last sample was taken [s]; None before the first one.
    pub fn stamp(&self) -> Option<f64> {
        self.reference.known.then_some(self.reference.stamp)
    }

    /// Goes on from this pose; the readings count on from the last sample.
    pub fn set_pose(&mut self, pose: Pose, covariance: [[f64; 3]; 3]) -> Result<(), Error> {
        let covariance = check_covariance(covariance)?;
        if covariance.iter().any(|value| !value.is_finite()) {
            let rule = "be finite";
            return Err(Error::value(
                "covariance",
                rule,
                numbers(covariance.as_slice()),
            ));
        }
        crate::error::finite("pose", &<[f64; 3]>::from(pose))?;
        self.state.walk = Walk::new(pose.into());
        self.state.uncertainty.set(covariance);
        self.history.clear();
        Ok(())
    }

    /// Forgets every reading: the next sample is a first one. The pose stays.
    pub fn forget(&mut self) {
        self.reference.known = false;
        self.reference.yaw_rate = None;
        self.state.twist = Twist::ZERO;
        self.state.velocity = None;
        self.state.uncertainty.let_go();
        self.residual.fill(0.0);
        self.work.weights.fill(1.0);
        self.health = Health::GOOD;
        self.history.clear();
        self.suspect.clear();
    }

    /// Takes in a sample. On failure nothing has changed.
    pub fn update(&mut self, sample: Sample<'_>) -> Result<Health, Error> {
        self.take(sample).map_err(|refusal| refusal.error)
    }

    fn take(&mut self, sample: Sample<'_>) -> Result<Health, Refusal> {
        self.check_numbers(&sample)
            .map_err(|error| Refusal::new(Health::NOT_FINITE, error))?;
        if !self.reference.known {
            self.refer_to(&sample);
            self.health = Health::FIRST;
            if let Some(yaw) = sample.yaw {
                self.meet_yaw(yaw);
            }
            return Ok(Health::FIRST);
        }
        let dt = sample.stamp - self.reference.stamp;
        if !(dt > 0.0) {
            let flag = if dt == 0.0 {
                Health::DUPLICATE
            } else {
                Health::BACKWARDS
            };
            let rule = format!(
                "be later than the last one, {}",
                number(self.reference.stamp)
            );
            let error = Error::value("stamp", rule, number(sample.stamp));
            return Err(Refusal::new(flag, error));
        }
        let wrapped = self.difference(&sample, dt);
        self.check_jump(dt)
            .map_err(|error| Refusal::new(Health::JUMP, error))?;
        let gyro_turn = sample
            .yaw_rate
            .map(|rate| f64::midpoint(self.reference.yaw_rate.unwrap_or(rate), rate) * dt);
        let motion = Motion {
            steering: [&self.reference.angles, &self.angles],
            turned: &self.turned,
            from_rates: self.settings.readings == Readings::Speeds,
            dt,
            gyro_turn,
        };
        let rules = self.settings.rules();
        advance(
            &self.rover,
            &rules,
            motion,
            &mut self.work,
            &mut self.state,
            self.settings.smoothing,
        )
        .map_err(|error| Refusal::new(Health::UNDETERMINED, error))?;
        for (residual, slid) in self.residual.iter_mut().zip(&self.work.slid) {
            *residual = slid / dt;
        }
        let is_gap = self.settings.max_gap.is_some_and(|gap| dt > gap);
        self.health = Health::GAP.when(is_gap)
            | Health::WRAPPED.when(wrapped)
            | Health::SLIP.when(self.work.slips);
        self.reference.known = true;
        self.reference.stamp = sample.stamp;
        self.reference.yaw_rate = sample.yaw_rate;
        self.reference.wheels.copy_from_slice(sample.wheels);
        self.reference.steering.copy_from_slice(sample.steering);
        self.reference.angles.copy_from_slice(&self.angles);
        if let Some(yaw) = sample.yaw {
            self.meet_yaw(yaw);
        }
        self.suspect.clear();
        self.history.push(
            sample,
            dt,
            &self.angles,
            &self.turned,
            gyro_turn,
            &self.state,
        );
        Ok(self.health)
    }

    fn check_numbers(&self, sample: &Sample<'_>) -> Result<(), Error> {
        crate::error::finite("steering", sample.steering)?;
        for (wheel, reading) in self.rover.wheels().iter().zip(sample.wheels) {
            if !(reading.is_finite() || reading.is_nan() && !wheel.driven) {
                return Err(Error::value("wheels", "be finite", numbers(sample.wheels)));
            }
        }
        let others = [
            ("stamp", Some(sample.stamp)),
            ("yaw", sample.yaw),
            ("yaw_rate", sample.yaw_rate),
        ];
        for (argument, value) in others {
            if let Some(value) = value
                && !value.is_finite()
            {
                return Err(Error::value(argument, "be finite", number(value)));
            }
        }
        Ok(())
    }

    /// Takes the sample as the one from which the next one counts.
    fn refer_to(&mut self, sample: &Sample<'_>) {
        for (joint, (angle, reading)) in self
            .reference
            .angles
            .iter_mut()
            .zip(sample.steering)
            .enumerate()
        {
            *angle = self.settings.steering_encoder(joint).first_angle(*reading);
        }
        self.reference.known = true;
        self.reference.stamp = sample.stamp;
        self.reference.wheels.copy_from_slice(sample.wheels);
        self.reference.steering.copy_from_slice(sample.steering);
        self.reference.yaw_rate = sample.yaw_rate;
    }

    /// What wheels and joints turned since the reference. Whether a counter started over.
    fn difference(&mut self, sample: &Sample<'_>, dt: f64) -> bool {
        let mut wrapped = false;
        let pairs = self.reference.wheels.iter().zip(sample.wheels);
        for (i, ((before, after), turned)) in pairs.zip(&mut self.turned).enumerate() {
            let encoder = self.settings.wheel_encoder(i);
            let counts = match self.settings.readings {
                Readings::Angles => {
                    let (counts, over) = encoder.difference(*before, *after);
                    wrapped |= over;
                    counts
                }
                Readings::Speeds => f64::midpoint(*before, *after) * dt,
                Readings::Increments => *after + self.suspect.owed(i),
            };
            *turned = counts * encoder.angle_per_count();
        }
        let pairs = self.reference.steering.iter().zip(sample.steering);
        for (joint, ((before, after), angle)) in pairs.zip(&mut self.angles).enumerate() {
            let encoder = self.settings.steering_encoder(joint);
            let (counts, over) = encoder.difference(*before, *after);
            wrapped |= over;
            *angle = self.reference.angles[joint] + counts * encoder.angle_per_count();
        }
        wrapped
    }

    /// Fails if the rover would have moved faster than it can.
    fn check_jump(&self, dt: f64) -> Result<(), Error> {
        if let Some(limit) = self.settings.max_speed {
            for (i, wheel) in self.rover.wheels().iter().enumerate() {
                let owed = self.suspect.owed(i) * self.settings.wheel_encoder(i).angle_per_count();
                let speed = wheel.radius * (self.turned[i] - owed) / dt;
                if speed.abs() > limit {
                    let rule = format!("keep {} at a rim speed of {limit} m/s at most", wheel.name);
                    return Err(Error::value("wheels", rule, number(speed)));
                }
            }
        }
        if let Some(limit) = self.settings.max_steering_rate {
            let joints = self.angles.iter().zip(&self.reference.angles);
            for ((after, before), &wheel) in joints.zip(self.rover.steered()) {
                let rate = (after - before) / dt;
                if rate.abs() > limit {
                    let name = &self.rover.wheels()[wheel].name;
                    let rule = format!("keep {name} at a steering rate of {limit} rad/s at most");
                    return Err(Error::value("steering", rule, number(rate)));
                }
            }
        }
        Ok(())
    }

    fn meet_yaw(&mut self, yaw: f64) {
        meet_yaw(&mut self.state, yaw, self.settings.noise.yaw);
    }

    /// Open loop: the rover is taken to have held a commanded twist since the last stamp. The next sample is a
    /// first one.
    pub fn command(&mut self, twist: Twist, stamp: f64) -> Result<Health, Error> {
        crate::error::finite("twist", &<[f64; 3]>::from(twist))?;
        if !stamp.is_finite() {
            return Err(Error::value("stamp", "be finite", number(stamp)));
        }
        let Some(before) = self.stamp().or(self.history.commanded) else {
            self.history.commanded = Some(stamp);
            return Ok(Health::FIRST);
        };
        let dt = stamp - before;
        if !(dt > 0.0) {
            let rule = format!("be later than the last one, {}", number(before));
            return Err(Error::value("stamp", rule, number(stamp)));
        }
        let joints = self.rover.steered().len();
        let (mut steering, mut speeds) = (vec![0.0; joints], vec![0.0; self.rover.wheels().len()]);
        let inputs = Inputs {
            previous: Some(&self.reference.angles),
            ..Inputs::default()
        };
        self.rover
            .inverse(twist, inputs, &mut steering, &mut speeds)?;
        for speed in &mut speeds {
            *speed *= dt;
        }
        let motion = Motion {
            steering: [&steering, &steering],
            turned: &speeds,
            from_rates: false,
            dt,
            gyro_turn: None,
        };
        let rules = self.settings.rules();
        advance(
            &self.rover,
            &rules,
            motion,
            &mut self.work,
            &mut self.state,
            self.settings.smoothing,
        )?;
        self.state.uncertainty.let_go();
        self.residual.fill(0.0);
        self.reference.known = false;
        self.reference.angles.copy_from_slice(&steering);
        self.reference.yaw_rate = None;
        self.suspect.clear();
        self.history.clear();
        self.history.commanded = Some(stamp);
        self.health = Health::GAP.when(self.settings.max_gap.is_some_and(|gap| dt > gap));
        Ok(self.health)
    }
}

impl Settings {
    fn rules(&self) -> Rules {
        Rules {
            noise: self.noise,
            method: self.method,
            inflate: self.inflate,
            slip_threshold: self.slip_threshold,
        }
    }

    fn wheel_encoder(&self, wheel: usize) -> Encoder {
        pick(&self.wheel_encoders, wheel)
    }

    fn steering_encoder(&self, joint: usize) -> Encoder {
        pick(&self.steering_encoders, joint)
    }
}

/// The encoder of one joint: its own, the one for all, or one that reads radians.
fn pick(encoders: &[Encoder], index: usize) -> Encoder {
    let own = encoders.get(index).or_else(|| encoders.first());
    own.copied().unwrap_or_default()
}

/// One step of the state. On failure it has not changed.
fn advance(
    rover: &Rover,
    rules: &Rules,
    motion: Motion<'_>,
    work: &mut Workspace,
    state: &mut State,
    smoothing: f64,
) -> Result<(), Error> {
    let displacement = work.displacement(rover, motion, rules)?;
    let step = <[f64; 3]>::from(displacement);
    let twist = Twist::from(step.map(|part| part / motion.dt));
    let finite = step.iter().all(|part| part.abs() < HUGE)
        && work.noise.own.is_below(HUGE)
        && <[f64; 3]>::from(twist).iter().all(|part| part.is_finite());
    if !finite {
        let rule = "be small enough for a finite pose and covariance";
        return Err(Error::value("wheels", rule, numbers(motion.turned)));
    }
    let (sin, cos) = state.walk.heading.value().sin_cos();
    let jacobian = step_jacobian(displacement, [sin, cos]);
    state.uncertainty.propagate(&jacobian, &work.noise);
    state.walk.shift(jacobian.shift[0], jacobian.shift[1]);
    state.walk.turn(displacement.omega);
    state.twist = twist;
    state.velocity = Some(match state.velocity.filter(|_| smoothing > 0.0) {
        None => twist,
        Some(before) => {
            let share = -(-motion.dt / smoothing).exp_m1();
            Twist {
                vx: before.vx + share * (twist.vx - before.vx),
                vy: before.vy + share * (twist.vy - before.vy),
                omega: before.omega + share * (twist.omega - before.omega),
            }
        }
    });
    Ok(())
}

/// Takes in an absolute yaw; the first one tells where the sensor's zero is.
fn meet_yaw(state: &mut State, yaw: f64, deviation: f64) {
    let (predicted, variance) = (state.walk.yaw.value(), deviation * deviation);
    match state.uncertainty.yaw_offset {
        None => state.uncertainty.set_yaw_offset(yaw - predicted, variance),
        Some(offset) => {
            let gain = state.uncertainty.correct_yaw(offset, variance);
            state.shift(&(gain * wrap_angle(yaw - predicted - offset.value)));
        }
    }
}

/// A covariance that is symmetric and has no negative variance; infinite ones say nothing of a direction.
fn check_covariance(covariance: [[f64; 3]; 3]) -> Result<Matrix3<f64>, Error> {
    let matrix = Matrix3::from(covariance);
    let refused = |rule| Err(Error::value("covariance", rule, numbers(matrix.as_slice())));
    let finite = matrix.map(|value| if value.is_finite() { value } else { 0.0 });
    let diagonal = matrix.diagonal();
    if matrix.iter().any(|value| value.is_nan())
        || matrix
            .iter()
            .enumerate()
            .any(|(k, value)| k % 4 != 0 && value.is_infinite())
        || diagonal.iter().any(|value| *value < 0.0)
    {
        return refused("hold variances on its diagonal and finite covariances beside it");
    }
    let scale = |i: usize, k: usize| (finite[(i, i)] * finite[(k, k)]).sqrt();
    for (i, k) in [(0, 1), (0, 2), (1, 2)] {
        let known = diagonal[i].is_finite() && diagonal[k].is_finite();
        if (finite[(i, k)] - finite[(k, i)]).abs() > 1e-9 * scale(i, k) {
            return refused("be symmetric");
        }
        if known && finite[(i, k)].abs() > scale(i, k) * (1.0 + 1e-9) {
            return refused("have no negative variance in any direction");
        }
    }
    let symmetric = (finite + finite.transpose()) / 2.0;
    if symmetric.symmetric_eigenvalues().min() < -1e-9 * symmetric.trace() {
        return refused("have no negative variance in any direction");
    }
    Ok((matrix + matrix.transpose()) / 2.0)
}
