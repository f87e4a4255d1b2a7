//! Input of the rollouts of a cycle.

use super::cycle::CycleInput;
use super::kernels::RolloutInput;
use super::mppi::Mppi;
use crate::motion::limits::RoverLimits;
use crate::motion::steering_setpoint;

/// Upper bound of the noise in standard deviations: with uniform numbers of 24 bits it is below this.
const FARTHEST: f64 = 6.0;

impl Mppi {
    /// Sets the path, if it is another one, and the rover's arc length on it.
    pub(crate) fn update_path(&mut self, path: Option<&[[f64; 2]]>, pose: [f64; 3]) {
        let place = [pose[0], pose[1]];
        let Some(path) = path else {
            self.input.has_path = false;
            self.input.progress = 0.0;
            return;
        };
        let same = self.input.has_path && self.corners == path;
        if !same {
            self.corners.clear();
            self.corners.extend_from_slice(path);
            self.path.set_corners(path);
        }
        self.input.has_path = !self.path.is_empty();
        // On the same path the search is limited to the distance of one horizon, so that the path may cross itself.
        let (from, to) = if same {
            let reach = self.fastest() * self.options.dt * self.options.horizon as f64;
            (self.state.progress - reach, self.state.progress + reach)
        } else {
            (0.0, f64::INFINITY)
        };
        self.input.progress = self.path.nearest(place, from, to);
    }

    /// Upper bound of the origin's speed [m/s].
    fn fastest(&self) -> f64 {
        let [vx, vy, _] = self.noise;
        let controls = self.state.controls.iter().map(|[x, y, _]| x.hypot(*y));
        let free = controls.fold(0.0, f64::max) + FARTHEST * vx.hypot(vy);
        self.bounds.limits.speed.min(free).max(0.1)
    }

    /// Writes the input of the rollouts: the mean, shifted by one step, the noise and the start.
    pub(crate) fn prepare(&mut self, cycle: &CycleInput<'_>) {
        let (bounds, options, input) = (&self.bounds, &self.options, &mut self.input);
        let limits = &bounds.limits;
        let free = bounds.free;
        let shift = usize::from(self.state.cycle > 0);
        input.mean.clear();
        for t in 0..options.horizon {
            let from = (t + shift).min(options.horizon - 1);
            input.mean.extend_from_slice(&bounds.motion(self.state.controls[from])[..free]);
        }
        input.cap.clear();
        input.sigma.clear();
        let [sx, sy, sw] = self.noise;
        for k in 0..free {
            let turns = k + 1 == free;
            input.cap.push(if turns { limits.yaw_rate } else { limits.speed });
            input.sigma.push(match (turns, free, k) {
                (true, ..) => sw,
                (_, 3, 1) => sy,
                (_, 3, _) => sx,
                _ => (bounds.heading.cos() * sx).hypot(bounds.heading.sin() * sy),
            });
        }
        input.memory = if options.correlation > 0.0 { (-options.dt / options.correlation).exp() } else { 0.0 };
        input.fixed = options.fixed();
        input.seed = options.seed;
        input.cycle = self.state.cycle;
        input.samples = options.samples;
        input.start = [cycle.pose[0], cycle.pose[1]];
        let end = self.corners.last().filter(|_| input.has_path).copied();
        input.goal = cycle.goal.or(end);
        input.goal_heading = cycle.goal_yaw.map(|yaw| {
            let (sin, cos) = (yaw + bounds.heading).sin_cos();
            [cos, sin]
        });
        input.record = cycle.record;
        // Constant controls: stop; spin to either side; forwards and backwards.
        input.constant.clear();
        input.constant.resize(free, 0.0);
        for k in [free - 1, 0] {
            for side in [1.0, -1.0] {
                let size = (2.0 * input.sigma[k]).min(input.cap[k]);
                input.constant.extend((0..free).map(|j| if j == k { side * size } else { 0.0 }));
            }
        }
        let motion = bounds.motion(cycle.twist);
        steering_setpoint::initialize(bounds, motion, &self.start.1, &mut input.initial);
        input.initial.heading = cycle.pose[2] + bounds.heading;
        let aside = options.footprint.iter().any(|point| *point != [0.0; 2]);
        input.initial.headings = input.has_path || aside || input.goal_heading.is_some();
        input.initial.effort = options.weights.effort * options.dt;
        input.initial.scrub = options.weights.scrub * options.dt;
        let fastest = fastest_turn(bounds, input, &motion);
        input.initial.choose_series(fastest, options.dt);
    }
}

/// A bound of the yaw rate of all rollouts [rad/s].
fn fastest_turn(bounds: &RoverLimits, input: &RolloutInput, motion: &[f64; 3]) -> f64 {
    let free = bounds.free;
    let mut size = 0.0;
    for (k, now) in motion.iter().enumerate().take(free) {
        let means = input.mean.iter().skip(k).step_by(free);
        let wished = means.fold(now.abs(), |a, b| a.max(b.abs()));
        size += (wished + FARTHEST * input.sigma[k]).min(input.cap[k]) * bounds.lengths[k];
    }
    bounds.turns_at_most(size)
}
