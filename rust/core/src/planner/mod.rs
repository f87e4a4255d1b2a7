//! A sampling planner's whole cycle: noise, wishes, rollouts within a rover's limits, costs, weights, new mean.
//!
//! From a rover and its limits follow a few numbers ([`facts`]); with them rollouts are driven ([`drive`]) and judged
//! ([`cost`]), a block of [`BLOCK`] at a time, by the same operations in the same order whatever the level, the number of
//! threads and the place in the batch ([`engine`]). All state of a planner is in [`State`].
//!
//! Source: G. Williams et al., Information-theoretic model predictive control, IEEE T-RO 34(6), 2018; E. Trevisan &
//! J. Alonso-Mora, Biased-MPPI, IEEE RA-L 9(6), 2024, for samples that are no noise.

mod cost;
mod costmap;
#[allow(clippy::needless_range_loop)] // components of several motions side by side
mod drive;
mod engine;
mod facts;
mod noise;
mod registers;
mod rollout;
mod setting;

use crate::batch::Workers;
use crate::controller::Limits;
use crate::error::{Error, finite, number};
use crate::geometry::Twist;
use crate::rover::{Inputs, MAX_WHEELS, Rover};

use cost::Path;
pub use cost::Weights;
pub use costmap::Costmap;
use engine::{Engine, Job, Machine, Settings};
use facts::Facts;
pub use facts::Stuck;
pub use rollout::{Present, rollout};

/// Rollouts of a block: as many as fill two of the widest registers.
pub(crate) const BLOCK: usize = 32;

/// More standard deviations than any noise has: its uniform numbers have 24 bits.
const FARTHEST: f64 = 6.0;

/// Sizes beyond which a planner would not fit anywhere.
const MOST: usize = 1 << 24;

/// The kind of number rollouts are computed in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// `f32`.
    Single,
    /// `f64`.
    #[default]
    Double,
}

/// How a planner works.
#[derive(Clone, Debug)]
pub struct Options {
    /// Steps of a rollout, and their duration [s].
    pub horizon: usize,
    /// See `horizon`.
    pub dt: f64,
    /// Rollouts of a cycle.
    pub samples: usize,
    /// Of the noise.
    pub seed: u64,
    /// Standard deviation of the wishes' noise [m/s, m/s, rad/s]; half the limits where there are some, if not given.
    pub noise: Option<[f64; 3]>,
    /// Time in which the noise forgets to a share of 1/e [s].
    pub correlation: f64,
    /// Of the weights, in the costs' own unit.
    pub temperature: f64,
    /// Of the costs.
    pub weights: Weights,
    /// Whether the new mean is smoothed, by a quadratic over five steps.
    pub smoothing: bool,
    /// Dead time: commands this far ahead are on their way already [s].
    pub delay: f64,
    /// What rollouts are computed in.
    pub precision: Precision,
    /// Points of the body where the map is read [m].
    pub footprint: Vec<[f64; 2]>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            horizon: 56,
            dt: 0.05,
            samples: 2000,
            seed: 0,
            noise: None,
            correlation: 0.5,
            temperature: 1.0,
            weights: Weights::default(),
            smoothing: true,
            delay: 0.0,
            precision: Precision::Double,
            footprint: vec![[0.0; 2]],
        }
    }
}

/// All that a planner remembers from one cycle to the next.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// What is wished at every step, in body axes [m/s, m/s, rad/s].
    pub controls: Vec<[f64; 3]>,
    /// Cycles so far.
    pub cycle: u32,
    /// Where the steering joints are meant to be [rad].
    pub steering: Vec<f64>,
    /// How far along its path the rover is [m].
    pub progress: f64,
}

/// What a cycle is told.
#[derive(Clone, Copy, Debug, Default)]
pub struct Situation<'a> {
    /// x, y, yaw [m, m, rad].
    pub pose: [f64; 3],
    /// In body axes [m/s, m/s, rad/s].
    pub twist: [f64; 3],
    /// Measured steering angles [rad].
    pub steering: Option<&'a [f64]>,
    /// What it costs to be somewhere.
    pub costmap: Option<&'a Costmap>,
    /// Corners of the path [m].
    pub path: Option<&'a [[f64; 2]]>,
    /// Where to go [m]; the end of the path if not given.
    pub goal: Option<[f64; 2]>,
    /// Whether the ways are kept, for an extra cost.
    pub record: bool,
}

/// What a cycle found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// The motion to command now [m/s, m/s, rad/s].
    pub twist: [f64; 3],
    /// Where its joints have to be after this step [rad], and how fast its wheels roll [rad/s].
    pub steering: Vec<f64>,
    /// See `steering`.
    pub speeds: Vec<f64>,
    /// Motions and poses that the mean leads to: one row a step, poses with the start first.
    pub twists: Vec<[f64; 3]>,
    /// See `twists`.
    pub poses: Vec<[f64; 3]>,
    /// Lowest cost of a rollout.
    pub cost: f64,
    /// How many rollouts count: one over the sum of the squared weights.
    pub effective: f64,
    /// Why the rover stays, if it has to.
    pub stuck: Option<Stuck>,
}

/// A sampling planner of one rover.
pub struct Mppi {
    rover: Rover,
    facts: Facts,
    options: Options,
    settings: Settings,
    noise: [f64; 3],
    state: State,
    engine: Box<dyn Engine>,
    path: Path,
    corners: Vec<[f64; 2]>,
    job: Job,
    situation: ([f64; 3], Vec<f64>),
    /// Cycles that were begun.
    rolls: u64,
    costs: Vec<f64>,
    mean: Vec<f64>,
    motions: Vec<f64>,
    places: Vec<f64>,
    outcome: Outcome,
}

fn positive(argument: &'static str, value: f64) -> Result<(), Error> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(Error::value(
        argument,
        "be finite and positive",
        number(value),
    ))
}

fn not_negative(argument: &'static str, value: f64) -> Result<(), Error> {
    if value.is_finite() && value >= 0.0 {
        return Ok(());
    }
    Err(Error::value(
        argument,
        "be finite and not negative",
        number(value),
    ))
}

impl Options {
    fn check(&self) -> Result<(), Error> {
        for (name, count) in [("horizon", self.horizon), ("samples", self.samples)] {
            if count == 0 || count > MOST {
                return Err(Error::value(
                    name,
                    format!("be 1 to {MOST}"),
                    count.to_string(),
                ));
            }
        }
        if self.horizon.saturating_mul(self.samples) > MOST << 4 {
            let rule = format!("make {} rollout steps at most", MOST << 4);
            return Err(Error::value(
                "horizon * samples",
                rule,
                (self.horizon as u128 * self.samples as u128).to_string(),
            ));
        }
        positive("dt", self.dt)?;
        positive("temperature", self.temperature)?;
        not_negative("correlation", self.correlation)?;
        not_negative("delay", self.delay)?;
        for (name, weight) in Weights::NAMES.into_iter().zip(self.weights.values()) {
            not_negative(name, weight)?;
        }
        for deviation in self.noise.unwrap_or_default() {
            not_negative("noise", deviation)?;
        }
        if self.footprint.is_empty() || self.footprint.len() > 64 {
            let got = self.footprint.len().to_string();
            return Err(Error::value("footprint", "hold 1 to 64 points", got));
        }
        finite("footprint", self.footprint.as_flattened())
    }

    fn fixed(&self) -> usize {
        // What is on its way for a part of a step only can still be changed.
        ((self.delay / self.dt).round() as usize).min(self.horizon - 1)
    }
}

impl Mppi {
    /// A planner at the beginning. Fails if an option makes no sense.
    pub fn new(rover: &Rover, limits: Limits, options: Options) -> Result<Self, Error> {
        options.check()?;
        let facts = Facts::new(rover, limits)?;
        let half = |limit: f64, usual: f64| {
            if limit.is_finite() {
                limit / 2.0
            } else {
                usual
            }
        };
        let speed = half(limits.speed, 0.4);
        let noise = options
            .noise
            .unwrap_or([speed, speed, half(limits.yaw_rate, 0.5)]);
        let (sin, cos) = facts.heading.sin_cos();
        // In the components' axes.
        let points = options
            .footprint
            .iter()
            .map(|[x, y]| [cos * x + sin * y, cos * y - sin * x])
            .collect();
        let settings = Settings {
            steps: options.horizon,
            dt: options.dt,
            weights: options.weights,
            points,
        };
        let samples = options.samples;
        let engine: Box<dyn Engine> = match (options.precision, facts.free) {
            (Precision::Double, 2) => Box::new(Machine::<f64, 2>::new(&facts, &settings, samples)),
            (Precision::Double, _) => Box::new(Machine::<f64, 3>::new(&facts, &settings, samples)),
            (Precision::Single, 2) => Box::new(Machine::<f32, 2>::new(&facts, &settings, samples)),
            (Precision::Single, _) => Box::new(Machine::<f32, 3>::new(&facts, &settings, samples)),
        };
        let count = options.horizon * facts.free;
        let mut planner = Self {
            rover: rover.clone(),
            state: State {
                controls: Vec::new(),
                cycle: 0,
                steering: Vec::new(),
                progress: 0.0,
            },
            facts,
            settings,
            noise,
            engine,
            path: Path::default(),
            corners: Vec::new(),
            job: Job::default(),
            situation: Default::default(),
            rolls: 0,
            costs: Vec::new(),
            mean: vec![0.0; count],
            motions: vec![0.0; count],
            places: vec![0.0; 2 * options.horizon],
            outcome: Outcome::default(),
            options,
        };
        planner.reset();
        Ok(planner)
    }

    /// Back to where it was when it was made.
    pub fn reset(&mut self) {
        self.state = State {
            controls: vec![[0.0; 3]; self.options.horizon],
            cycle: 0,
            steering: self
                .facts
                .joints
                .iter()
                .map(|joint| joint.straight())
                .collect(),
            progress: 0.0,
        };
        self.state.steering.resize(self.rover.steered().len(), 0.0);
    }

    /// What it remembers.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Goes on from there. Fails if it is not of this planner's size or a number is not finite.
    pub fn set_state(&mut self, state: State) -> Result<(), Error> {
        if state.controls.len() != self.options.horizon {
            let rule = format!("have {} rows", self.options.horizon);
            return Err(Error::value(
                "controls",
                rule,
                state.controls.len().to_string(),
            ));
        }
        if state.steering.len() != self.rover.steered().len() {
            let rule = format!("have {} angles", self.rover.steered().len());
            return Err(Error::value(
                "steering",
                rule,
                state.steering.len().to_string(),
            ));
        }
        finite("controls", state.controls.as_flattened())?;
        finite("steering", &state.steering)?;
        not_negative("progress", state.progress)?;
        self.state = state;
        Ok(())
    }

    /// How it works.
    pub fn options(&self) -> &Options {
        &self.options
    }

    /// What it stays within.
    pub fn limits(&self) -> &Limits {
        &self.facts.limits
    }

    /// What it plans for.
    pub fn rover(&self) -> &Rover {
        &self.rover
    }

    /// Standard deviation of the noise [m/s, m/s, rad/s].
    pub fn noise(&self) -> [f64; 3] {
        self.noise
    }

    /// How many cycles were begun: whoever weighs has to know that they are still those it rolled.
    pub fn rolls(&self) -> u64 {
        self.rolls
    }

    /// Costs of the rollouts of the last cycle.
    pub fn costs(&self) -> &[f64] {
        &self.costs[..self.options.samples.min(self.costs.len())]
    }

    /// Drives the rollouts of a cycle. What the planner remembers stays as it is until [`Self::weigh`].
    pub fn roll(&mut self, situation: Situation<'_>, workers: Workers) -> Result<(), Error> {
        finite("state.pose", &situation.pose)?;
        finite("state.twist", &situation.twist)?;
        finite("state.steering", situation.steering.unwrap_or_default())?;
        finite("path", situation.path.unwrap_or_default().as_flattened())?;
        finite("goal", &situation.goal.unwrap_or_default())?;
        if situation.path.is_some_and(|path| path.len() < 2) {
            let got = situation.path.unwrap_or_default().len().to_string();
            return Err(Error::value("path", "have two points or more", got));
        }
        if let Some(map) = situation.costmap {
            map.check_holds(situation.pose)?;
        }
        self.rolls += 1;
        let steering = situation.steering.unwrap_or(&self.state.steering);
        self.situation.0 = situation.pose;
        self.situation.1.clear();
        self.situation.1.extend_from_slice(steering);
        if self.facts.stuck.is_some() {
            return Ok(());
        }
        self.follow(situation.path, situation.pose);
        self.prepare(&situation);
        self.engine.roll(
            &self.job,
            situation.costmap,
            &self.path,
            &self.settings,
            workers,
        )?;
        self.engine.costs(&mut self.costs);
        Ok(())
    }

    /// Takes the path, if it is another one, and where the rover is along it.
    fn follow(&mut self, path: Option<&[[f64; 2]]>, pose: [f64; 3]) {
        let place = [pose[0], pose[1]];
        let Some(path) = path else {
            self.job.has_path = false;
            self.job.progress = 0.0;
            return;
        };
        let same = self.job.has_path && self.corners == path;
        if !same {
            self.corners.clear();
            self.corners.extend_from_slice(path);
            self.path.follow(path);
        }
        self.job.has_path = !self.path.is_empty();
        // Along the same path no further than a horizon's way, so that it may cross itself.
        let (from, to) = if same {
            let reach = self.fastest() * self.options.dt * self.options.horizon as f64;
            (self.state.progress - reach, self.state.progress + reach)
        } else {
            (0.0, f64::INFINITY)
        };
        self.job.progress = self.path.nearest(place, from, to);
    }

    /// Speed at which the origin moves at most [m/s].
    fn fastest(&self) -> f64 {
        let [vx, vy, _] = self.noise;
        let controls = self.state.controls.iter().map(|[x, y, _]| x.hypot(*y));
        let free = controls.fold(0.0, f64::max) + FARTHEST * vx.hypot(vy);
        self.facts.limits.speed.min(free).max(0.1)
    }

    /// The mean moved on by a step, and everything else rollouts start from.
    fn prepare(&mut self, situation: &Situation<'_>) {
        let (facts, options, job) = (&self.facts, &self.options, &mut self.job);
        let limits = &facts.limits;
        let free = facts.free;
        let shift = usize::from(self.state.cycle > 0);
        job.mean.clear();
        for t in 0..options.horizon {
            let from = (t + shift).min(options.horizon - 1);
            job.mean
                .extend_from_slice(&facts.motion(self.state.controls[from])[..free]);
        }
        job.cap.clear();
        job.sigma.clear();
        let [sx, sy, sw] = self.noise;
        for k in 0..free {
            let turns = k + 1 == free;
            job.cap
                .push(if turns { limits.yaw_rate } else { limits.speed });
            job.sigma.push(match (turns, free, k) {
                (true, ..) => sw,
                (_, 3, 1) => sy,
                (_, 3, _) => sx,
                _ => (facts.heading.cos() * sx).hypot(facts.heading.sin() * sy),
            });
        }
        job.memory = if options.correlation > 0.0 {
            (-options.dt / options.correlation).exp()
        } else {
            0.0
        };
        job.fixed = options.fixed();
        job.seed = options.seed;
        job.cycle = self.state.cycle;
        job.samples = options.samples;
        job.start = [situation.pose[0], situation.pose[1]];
        let end = self.corners.last().filter(|_| job.has_path).copied();
        job.goal = situation.goal.or(end);
        job.record = situation.record;
        // Stop; turn on the spot; ahead and back.
        job.constant.clear();
        job.constant.resize(free, 0.0);
        for k in [free - 1, 0] {
            for side in [1.0, -1.0] {
                let size = (2.0 * job.sigma[k]).min(job.cap[k]);
                job.constant
                    .extend((0..free).map(|j| if j == k { side * size } else { 0.0 }));
            }
        }
        let motion = facts.motion(situation.twist);
        setting::begin(facts, motion, &self.situation.1, &mut job.begin);
        job.begin.heading = situation.pose[2] + facts.heading;
        job.begin.effort = options.weights.effort * options.dt;
        job.begin.scrub = options.weights.scrub * options.dt;
        let fastest = fastest_turn(facts, job, &motion);
        job.begin.turns(fastest, options.dt);
    }

    /// Weighs the rollouts, with costs from elsewhere added, and moves on. Fails, and stays as it was, if one of those
    /// costs is not a number.
    pub fn weigh(&mut self, extra: Option<&[f64]>, workers: Workers) -> Result<&Outcome, Error> {
        let samples = self.options.samples;
        if let Some(extra) = extra {
            if extra.len() != samples {
                let rule = format!("return {samples} costs, one per rollout");
                return Err(Error::value("extra_cost", rule, extra.len().to_string()));
            }
            if let Some(worst) = extra
                .iter()
                .position(|cost| cost.is_nan() || *cost == f64::NEG_INFINITY)
            {
                let rule = "return numbers";
                return Err(Error::value("extra_cost", rule, number(extra[worst])).at_row(worst));
            }
        }
        if let Some(stuck) = self.facts.stuck {
            self.stay(stuck);
            return Ok(&self.outcome);
        }
        for (cost, extra) in self.costs.iter_mut().zip(extra.unwrap_or_default()) {
            *cost += extra;
        }
        self.costs.truncate(samples);
        let least = self.costs.iter().copied().fold(f64::INFINITY, f64::min);
        if least == f64::INFINITY {
            let rule = "leave one rollout possible";
            return Err(Error::value(
                "extra_cost",
                rule,
                "infinity for all".to_owned(),
            ));
        }
        // Weights take the place of costs in the room of the mean's shares.
        let mut weights = std::mem::take(&mut self.motions);
        weights.clear();
        weights.extend(
            self.costs
                .iter()
                .map(|cost| ((least - cost) / self.options.temperature).exp()),
        );
        let sum: f64 = weights.iter().sum();
        let squares: f64 = weights.iter().map(|weight| weight * weight).sum();
        weights.iter_mut().for_each(|weight| *weight /= sum);
        weights.resize(samples.div_ceil(BLOCK) * BLOCK, 0.0);
        let done = self
            .engine
            .mean(&weights, &self.settings, workers, &mut self.mean);
        self.motions = weights;
        self.motions
            .resize(self.options.horizon * self.facts.free, 0.0);
        done?;
        if self.options.smoothing {
            smooth(&mut self.mean, self.facts.free, self.job.fixed);
        }
        self.outcome.cost = least;
        self.outcome.effective = sum * sum / squares;
        self.outcome.stuck = None;
        self.conclude(workers);
        Ok(&self.outcome)
    }

    /// Stays where it is.
    fn stay(&mut self, stuck: Stuck) {
        let steps = self.options.horizon;
        let outcome = &mut self.outcome;
        outcome.stuck = Some(stuck);
        outcome.twist = [0.0; 3];
        outcome.steering.clone_from(&self.situation.1);
        outcome.speeds.clear();
        outcome.speeds.resize(self.rover.wheels().len(), 0.0);
        outcome.twists.clear();
        outcome.twists.resize(steps, [0.0; 3]);
        outcome.poses.clear();
        outcome.poses.resize(steps + 1, self.situation.0);
        (outcome.cost, outcome.effective) = (0.0, 0.0);
        self.costs.clear();
        self.state.controls.fill([0.0; 3]);
        self.state.cycle = self.state.cycle.wrapping_add(1);
    }

    /// Where the new mean leads, and what to command first.
    fn conclude(&mut self, workers: Workers) {
        let free = self.facts.free;
        self.engine.nominal(
            &self.job,
            &self.mean,
            &self.settings,
            workers.level,
            &mut self.motions,
            &mut self.places,
        );
        for (control, mean) in self
            .state
            .controls
            .iter_mut()
            .zip(self.mean.chunks_exact(free))
        {
            *control = self.facts.twist(mean);
        }
        let outcome = &mut self.outcome;
        let dt = self.options.dt;
        ways(
            &self.facts,
            &self.motions,
            &self.places,
            self.situation.0,
            dt,
            &mut outcome.twists,
            &mut outcome.poses,
        );
        let first = self.job.fixed;
        outcome.twist = outcome.twists[first];
        outcome.steering.clone_from(&self.situation.1);
        outcome.speeds.clear();
        outcome.speeds.resize(self.rover.wheels().len(), 0.0);
        let moving = |twist: &&[f64; 3]| twist.iter().any(|part| *part != 0.0);
        if let Some(next) = outcome.twists[first..].iter().find(moving) {
            let mut angles = [0.0; MAX_WHEELS];
            let mut speeds = [0.0; MAX_WHEELS];
            let joints = outcome.steering.len();
            let inputs = Inputs {
                previous: Some(&self.situation.1),
                ..Inputs::default()
            };
            let goes = Twist::from(*next);
            self.rover.solve(
                goes,
                inputs,
                &mut angles[..joints],
                &mut speeds[..outcome.speeds.len()],
            );
            let stands = outcome.twist.iter().all(|part| *part == 0.0);
            // Where they were a little off, they come back no faster than they may.
            let most = self.facts.limits.steering_rate * dt;
            for (to, angle) in outcome.steering.iter_mut().zip(angles) {
                *to += (angle - *to).clamp(-most, most);
            }
            if !stands {
                outcome
                    .speeds
                    .copy_from_slice(&speeds[..self.rover.wheels().len()]);
            }
        }
        self.state.steering.clone_from(&outcome.steering);
        self.state.progress = self.job.progress;
        self.state.cycle = self.state.cycle.wrapping_add(1);
    }

    /// Poses and motions of a rollout that was recorded: `horizon + 1` and `horizon` rows.
    pub fn recorded(
        &mut self,
        rollout: usize,
        poses: &mut Vec<[f64; 3]>,
        twists: &mut Vec<[f64; 3]>,
    ) {
        self.engine
            .recorded(rollout, &self.settings, &mut self.motions, &mut self.places);
        ways(
            &self.facts,
            &self.motions,
            &self.places,
            self.situation.0,
            self.options.dt,
            twists,
            poses,
        );
    }

    /// The wishes of one rollout of the last cycle, in body axes.
    pub fn wishes(&mut self, rollout: usize, to: &mut Vec<[f64; 3]>) {
        self.engine
            .wishes(rollout, &self.settings, &mut self.motions);
        to.clear();
        to.extend(
            self.motions
                .chunks_exact(self.facts.free)
                .map(|wish| self.facts.twist(wish)),
        );
    }
}

/// Motions and places to twists and poses in the world.
fn ways(
    facts: &Facts,
    motions: &[f64],
    places: &[f64],
    start: [f64; 3],
    dt: f64,
    twists: &mut Vec<[f64; 3]>,
    poses: &mut Vec<[f64; 3]>,
) {
    twists.clear();
    twists.extend(
        motions
            .chunks_exact(facts.free)
            .map(|motion| facts.twist(motion)),
    );
    poses.clear();
    poses.push(start);
    let mut yaw = start[2];
    for (twist, place) in twists.iter().zip(places.chunks_exact(2)) {
        yaw += twist[2] * dt;
        poses.push([start[0] + place[0], start[1] + place[1], yaw]);
    }
}

/// A bound of the yaw rate of all rollouts [rad/s].
fn fastest_turn(facts: &Facts, job: &Job, motion: &[f64; 3]) -> f64 {
    let free = facts.free;
    let mut size = 0.0;
    for (k, now) in motion.iter().enumerate().take(free) {
        let means = job.mean.iter().skip(k).step_by(free);
        let wished = means.fold(now.abs(), |a, b| a.max(b.abs()));
        size += (wished + FARTHEST * job.sigma[k]).min(job.cap[k]) * facts.lengths[k];
    }
    facts.turns_at_most(size)
}

/// Replaces every value by that of the quadratic through it and two neighbours on either side.
///
/// Source: A. Savitzky & M. Golay, Analytical Chemistry 36(8), 1964.
fn smooth(mean: &mut [f64], free: usize, fixed: usize) {
    const TAPS: [f64; 5] = [
        -3.0 / 35.0,
        12.0 / 35.0,
        17.0 / 35.0,
        12.0 / 35.0,
        -3.0 / 35.0,
    ];
    let steps = mean.len() / free;
    for k in 0..free {
        let at = |t: usize| t.min(steps - 1) * free + k;
        // The two values before, as they were.
        let mut before = [mean[at(fixed)]; 2];
        for t in fixed..steps {
            let now = mean[at(t)];
            let window = [before[0], before[1], now, mean[at(t + 1)], mean[at(t + 2)]];
            let smoothed = window
                .iter()
                .zip(TAPS)
                .map(|(value, tap)| value * tap)
                .sum();
            before = [before[1], now];
            mean[at(t)] = smoothed;
        }
    }
}
