//! Input of the rollouts of a cycle.

use super::cycle::Situation;
use super::engine::RolloutInput;
use super::mppi::Mppi;
use crate::motion::limits::RoverLimits;
use crate::motion::setting;

/// More standard deviations than any noise has: its uniform numbers have 24 bits.
const FARTHEST: f64 = 6.0;

impl Mppi {
    /// Takes the path, if it is another one, and where the rover is along it.
    pub(crate) fn follow(&mut self, path: Option<&[[f64; 2]]>, pose: [f64; 3]) {
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
    pub(crate) fn prepare(&mut self, situation: &Situation<'_>) {
        let (facts, options, job) = (&self.facts, &self.options, &mut self.job);
        let limits = &facts.limits;
        let free = facts.free;
        let shift = usize::from(self.state.cycle > 0);
        job.mean.clear();
        for t in 0..options.horizon {
            let from = (t + shift).min(options.horizon - 1);
            job.mean.extend_from_slice(&facts.motion(self.state.controls[from])[..free]);
        }
        job.cap.clear();
        job.sigma.clear();
        let [sx, sy, sw] = self.noise;
        for k in 0..free {
            let turns = k + 1 == free;
            job.cap.push(if turns { limits.yaw_rate } else { limits.speed });
            job.sigma.push(match (turns, free, k) {
                (true, ..) => sw,
                (_, 3, 1) => sy,
                (_, 3, _) => sx,
                _ => (facts.heading.cos() * sx).hypot(facts.heading.sin() * sy),
            });
        }
        job.memory = if options.correlation > 0.0 { (-options.dt / options.correlation).exp() } else { 0.0 };
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
                job.constant.extend((0..free).map(|j| if j == k { side * size } else { 0.0 }));
            }
        }
        let motion = facts.motion(situation.twist);
        setting::begin(facts, motion, &self.situation.1, &mut job.begin);
        job.begin.heading = situation.pose[2] + facts.heading;
        let aside = options.footprint.iter().any(|point| *point != [0.0; 2]);
        job.begin.headings = job.has_path || aside;
        job.begin.effort = options.weights.effort * options.dt;
        job.begin.scrub = options.weights.scrub * options.dt;
        let fastest = fastest_turn(facts, job, &motion);
        job.begin.turns(fastest, options.dt);
    }
}

/// A bound of the yaw rate of all rollouts [rad/s].
fn fastest_turn(facts: &RoverLimits, job: &RolloutInput, motion: &[f64; 3]) -> f64 {
    let free = facts.free;
    let mut size = 0.0;
    for (k, now) in motion.iter().enumerate().take(free) {
        let means = job.mean.iter().skip(k).step_by(free);
        let wished = means.fold(now.abs(), |a, b| a.max(b.abs()));
        size += (wished + FARTHEST * job.sigma[k]).min(job.cap[k]) * facts.lengths[k];
    }
    facts.turns_at_most(size)
}
