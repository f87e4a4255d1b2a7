//! A sampling planner: the rollouts of a cycle, their weights and what follows from them.

use super::cost::Path;
use super::costmap::Costmap;
use super::cycle::{CycleInput, CycleOutput, State};
use super::engine::{MppiConstants, RolloutEngine, SampledRollouts};
use super::kernels::RolloutInput;
use super::options::{Options, Precision};
use super::smooth::smooth;
use crate::motion::limits::RoverLimits;
use crate::numbers::BLOCK;
use six_wheel_control::controller::Limits;
use six_wheel_kinematics::rover::Rover;
use six_wheel_numerics::error::{Error, finite, not_negative, number};
use six_wheel_numerics::threads::workers::Workers;

/// A sampling planner of one rover.
pub struct Mppi {
    pub(crate) rover: Rover,
    pub(crate) bounds: RoverLimits,
    pub(crate) options: Options,
    pub(crate) constants: MppiConstants,
    pub(crate) noise: [f64; 3],
    pub(crate) state: State,
    pub(crate) engine: Box<dyn RolloutEngine>,
    pub(crate) path: Path,
    pub(crate) corners: Vec<[f64; 2]>,
    pub(crate) input: RolloutInput,
    /// Pose [m, m, rad] and steering angles [rad] at the start of the cycle.
    pub(crate) start: ([f64; 3], Vec<f64>),
    /// Number of cycles begun.
    pub(crate) cycles_started: u64,
    pub(crate) costs: Vec<f64>,
    pub(crate) mean: Vec<f64>,
    pub(crate) motions: Vec<f64>,
    pub(crate) places: Vec<f64>,
    pub(crate) output: CycleOutput,
}

getters! {
    Mppi:
    /// State kept from cycle to cycle.
    state: &State;
    /// Options of the planner.
    options: &Options;
    /// Rover that is planned for.
    rover: &Rover;
    /// Standard deviation of the noise [m/s, m/s, rad/s].
    noise: [f64; 3];
    /// Number of cycles begun, by which a caller of [`Self::finish_cycle`] checks that the rollouts are those that it
    /// started.
    cycles_started: u64;
}

impl Mppi {
    /// A planner before its first cycle. Fails if an option is invalid.
    pub fn new(rover: &Rover, limits: Limits, options: Options) -> Result<Self, Error> {
        options.check()?;
        let bounds = RoverLimits::new(rover, limits)?;
        let half = |limit: f64, usual: f64| {
            if limit.is_finite() { limit / 2.0 } else { usual }
        };
        let speed = half(limits.speed, 0.4);
        let noise = options.noise.unwrap_or([speed, speed, half(limits.yaw_rate, 0.5)]);
        let (sin, cos) = bounds.heading.sin_cos();
        // In the components' axes.
        let points = options.footprint.iter().map(|[x, y]| [cos * x + sin * y, cos * y - sin * x]).collect();
        let constants = MppiConstants { steps: options.horizon, dt: options.dt, weights: options.weights, points };
        let samples = options.samples;
        let engine: Box<dyn RolloutEngine> = match (options.precision, bounds.free) {
            (Precision::Double, 2) => Box::new(SampledRollouts::<f64, 2>::new(&bounds, &constants, samples)),
            (Precision::Double, _) => Box::new(SampledRollouts::<f64, 3>::new(&bounds, &constants, samples)),
            (Precision::Single, 2) => Box::new(SampledRollouts::<f32, 2>::new(&bounds, &constants, samples)),
            (Precision::Single, _) => Box::new(SampledRollouts::<f32, 3>::new(&bounds, &constants, samples)),
        };
        let count = options.horizon * bounds.free;
        let mut planner = Self {
            rover: rover.clone(),
            state: State { controls: Vec::new(), cycle: 0, steering: Vec::new(), progress: 0.0 },
            bounds,
            constants,
            noise,
            engine,
            path: Path::default(),
            corners: Vec::new(),
            input: RolloutInput::default(),
            start: Default::default(),
            cycles_started: 0,
            costs: Vec::new(),
            mean: vec![0.0; count],
            motions: vec![0.0; count],
            places: vec![0.0; 2 * options.horizon],
            output: CycleOutput::default(),
            options,
        };
        planner.reset();
        Ok(planner)
    }

    /// Resets the state to that of a new planner.
    pub fn reset(&mut self) {
        self.state = State {
            controls: vec![[0.0; 3]; self.options.horizon],
            cycle: 0,
            steering: self.bounds.joints.iter().map(|joint| joint.straight()).collect(),
            progress: 0.0,
        };
        self.state.steering.resize(self.rover.steered().len(), 0.0);
        self.rover.clip_steering(&mut self.state.steering);
    }

    /// Sets the state. Fails if its size is not that of this planner or a number is not finite.
    pub fn set_state(&mut self, state: State) -> Result<(), Error> {
        if state.controls.len() != self.options.horizon {
            let rule = format!("have {} rows", self.options.horizon);
            return Err(Error::value("controls", rule, state.controls.len().to_string()));
        }
        finite("controls", state.controls.as_flattened())?;
        self.rover.check_measured("steering", &state.steering)?;
        not_negative("progress", state.progress)?;
        self.state = state;
        Ok(())
    }

    /// Limits of the planned motions.
    pub fn limits(&self) -> &Limits {
        &self.bounds.limits
    }

    /// Costs of the rollouts of the last cycle.
    pub fn costs(&self) -> &[f64] {
        &self.costs[..self.options.samples.min(self.costs.len())]
    }

    /// Samples the rollouts of a cycle and their costs. The state of the planner does not change before
    /// [`Self::finish_cycle`].
    pub fn start_cycle(&mut self, input: CycleInput<'_>, workers: Workers) -> Result<(), Error> {
        finite("state.pose", &input.pose)?;
        finite("state.twist", &input.twist)?;
        if let Some(steering) = input.steering {
            self.rover.check_measured("state.steering", steering)?;
        }
        finite("path", input.path.unwrap_or_default().as_flattened())?;
        finite("goal", &input.goal.unwrap_or_default())?;
        finite("goal", input.goal_yaw.as_slice())?;
        if input.path.is_some_and(|path| path.len() < 2) {
            let got = input.path.unwrap_or_default().len().to_string();
            return Err(Error::value("path", "have two points or more", got));
        }
        if let Some(map) = input.costmap {
            map.check_holds(input.pose)?;
        }
        // Without a goal, a path or extra costs all motions cost the same. A rover that cannot move needs no goal.
        let aimless = input.path.is_none() && input.goal.is_none() && !input.record;
        if aimless && self.bounds.stuck.is_none() {
            let rule = "be given, or a path or an extra_cost: without one there is nowhere to go";
            return Err(Error::value("goal", rule, "none".to_owned()));
        }
        self.cycles_started += 1;
        let steering = input.steering.unwrap_or(&self.state.steering);
        self.start.0 = input.pose;
        self.start.1.clear();
        self.start.1.extend_from_slice(steering);
        self.rover.clip_steering(&mut self.start.1);
        if self.bounds.stuck.is_some() {
            return Ok(());
        }
        self.update_path(input.path, input.pose);
        self.prepare(&input);
        self.engine.sample_rollouts(&self.input, input.costmap, &self.path, &self.constants, workers)?;
        self.engine.costs(&mut self.costs);
        Ok(())
    }

    /// True if the rover is within one standard deviation of its goal, in position and yaw: that of the displacement by
    /// the noise of one step.
    fn is_at_goal(&self) -> bool {
        let ([x, y, yaw], [vx, vy, omega]) = (self.start.0, self.noise);
        let is_there = |[goal_x, goal_y]: [f64; 2]| (goal_x - x).hypot(goal_y - y) <= vx.hypot(vy) * self.options.dt;
        let (sin, cos) = (yaw + self.bounds.heading).sin_cos();
        let is_turned = |[goal_cos, goal_sin]: [f64; 2]| {
            let angle = (cos * goal_sin - sin * goal_cos).atan2(cos * goal_cos + sin * goal_sin);
            angle.abs() <= omega * self.options.dt
        };
        self.input.goal.is_some_and(is_there) && self.input.goal_heading.is_none_or(is_turned)
    }

    /// True if every rollout of the last cycle costs at least one collision, and the plan reaches a lethal position of
    /// this map.
    pub fn is_blocked(&self, map: &Costmap) -> bool {
        let is_lethal = |[x, y, _]: &[f64; 3]| map.nearest([*x, *y]) >= map.lethal().unwrap_or(f64::INFINITY);
        self.output.cost >= self.options.weights.collision && self.output.poses.iter().any(is_lethal)
    }

    /// Adds extra costs, weights the rollouts and updates the mean. Fails, without effect, if an extra cost is not a
    /// number.
    pub fn finish_cycle(&mut self, extra: Option<&[f64]>, workers: Workers) -> Result<&CycleOutput, Error> {
        let samples = self.options.samples;
        if let Some(extra) = extra {
            if extra.len() != samples {
                let rule = format!("return {samples} costs, one per rollout");
                return Err(Error::value("extra_cost", rule, extra.len().to_string()));
            }
            if let Some(worst) = extra.iter().position(|cost| cost.is_nan() || *cost == f64::NEG_INFINITY) {
                let rule = "return numbers";
                return Err(Error::value("extra_cost", rule, number(extra[worst])).at_row(worst));
            }
        }
        if let Some(stuck) = self.bounds.stuck {
            self.hold_position(stuck);
            return Ok(&self.output);
        }
        for (cost, extra) in self.costs.iter_mut().zip(extra.unwrap_or_default()) {
            *cost += extra;
        }
        self.costs.truncate(samples);
        let least = self.costs.iter().copied().fold(f64::INFINITY, f64::min);
        if least == f64::INFINITY {
            let rule = "leave one rollout possible";
            return Err(Error::value("extra_cost", rule, "infinity for all".to_owned()));
        }
        // The memory of the motions is reused for the weights.
        let mut weights = std::mem::take(&mut self.motions);
        weights.clear();
        weights.extend(self.costs.iter().map(|cost| ((least - cost) / self.options.temperature).exp()));
        let sum: f64 = weights.iter().sum();
        let squares: f64 = weights.iter().map(|weight| weight * weight).sum();
        weights.iter_mut().for_each(|weight| *weight /= sum);
        weights.resize(samples.div_ceil(BLOCK) * BLOCK, 0.0);
        let done = self.engine.mean(&weights, workers, &mut self.mean);
        self.motions = weights;
        self.motions.resize(self.options.horizon * self.bounds.free, 0.0);
        done?;
        if self.options.smoothing {
            smooth(&mut self.mean, self.bounds.free, self.input.fixed);
        }
        self.output.cost = least;
        self.output.effective = sum * sum / squares;
        self.output.stuck = None;
        self.output.arrived = self.is_at_goal();
        self.update_mean(workers);
        Ok(&self.output)
    }
}
