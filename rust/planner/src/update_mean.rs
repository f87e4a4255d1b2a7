//! Results of a cycle: the path of the new mean, and the first command.

use super::mppi::Mppi;
use crate::motion::limits::{ImmobileReason, RoverLimits};
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::{Inputs, MAX_WHEELS};
use six_wheel_numerics::threads::workers::Workers;

impl Mppi {
    /// Writes the output of a rover that cannot move: zero twist and speeds.
    pub(crate) fn hold_position(&mut self, stuck: ImmobileReason) {
        let steps = self.options.horizon;
        let output = &mut self.output;
        output.stuck = Some(stuck);
        output.arrived = false;
        output.twist = [0.0; 3];
        output.steering.clone_from(&self.start.1);
        output.speeds.clear();
        output.speeds.resize(self.rover.wheels().len(), 0.0);
        output.twists.clear();
        output.twists.resize(steps, [0.0; 3]);
        output.poses.clear();
        output.poses.resize(steps + 1, self.start.0);
        (output.cost, output.effective) = (0.0, 0.0);
        self.costs.clear();
        self.state.controls.fill([0.0; 3]);
        self.state.cycle = self.state.cycle.wrapping_add(1);
    }

    /// Computes the path of the new mean, and the first command.
    pub(crate) fn update_mean(&mut self, workers: Workers) {
        let free = self.bounds.free;
        let to = [&mut self.motions[..], &mut self.places];
        self.engine.nominal(&self.input.initial, &self.mean, workers.level, to);
        for (control, mean) in self.state.controls.iter_mut().zip(self.mean.chunks_exact(free)) {
            *control = self.bounds.twist(mean);
        }
        let output = &mut self.output;
        let dt = self.options.dt;
        to_world(&self.bounds, &self.motions, &self.places, self.start.0, dt, &mut output.twists, &mut output.poses);
        let first = self.input.fixed;
        output.twist = output.twists[first];
        output.steering.clone_from(&self.start.1);
        output.speeds.clear();
        output.speeds.resize(self.rover.wheels().len(), 0.0);
        let moving = |twist: &&[f64; 3]| twist.iter().any(|part| *part != 0.0);
        if let Some(next) = output.twists[first..].iter().find(moving) {
            let mut angles = [0.0; MAX_WHEELS];
            let mut speeds = [0.0; MAX_WHEELS];
            let joints = output.steering.len();
            let inputs = Inputs { previous: Some(&self.start.1), ..Inputs::default() };
            let goes = Twist::from(*next);
            self.rover.solve(goes, inputs, &mut angles[..joints], &mut speeds[..output.speeds.len()]);
            let stands = output.twist.iter().all(|part| *part == 0.0);
            // Angles change by at most the steering rate times the step.
            let most = self.bounds.limits.steering_rate * dt;
            for (to, angle) in output.steering.iter_mut().zip(angles) {
                *to += (angle - *to).clamp(-most, most);
            }
            if !stands {
                output.speeds.copy_from_slice(&speeds[..self.rover.wheels().len()]);
            }
        }
        self.state.steering.clone_from(&output.steering);
        self.state.progress = self.input.progress;
        self.state.cycle = self.state.cycle.wrapping_add(1);
    }

    /// Poses and motions of a rollout that was recorded: `horizon + 1` and `horizon` rows.
    pub fn recorded(&mut self, rollout: usize, poses: &mut Vec<[f64; 3]>, twists: &mut Vec<[f64; 3]>) {
        self.engine.recorded(rollout, [&mut self.motions, &mut self.places]);
        to_world(&self.bounds, &self.motions, &self.places, self.start.0, self.options.dt, twists, poses);
    }

    /// The controls of one rollout of the last cycle, in body axes.
    pub fn controls(&mut self, rollout: usize, to: &mut Vec<[f64; 3]>) {
        self.engine.controls(rollout, &mut self.motions);
        to.clear();
        to.extend(self.motions.chunks_exact(self.bounds.free).map(|control| self.bounds.twist(control)));
    }
}

/// Converts motions in components and positions relative to the start to body twists and poses in the world.
fn to_world(
    bounds: &RoverLimits,
    motions: &[f64],
    places: &[f64],
    start: [f64; 3],
    dt: f64,
    twists: &mut Vec<[f64; 3]>,
    poses: &mut Vec<[f64; 3]>,
) {
    twists.clear();
    twists.extend(motions.chunks_exact(bounds.free).map(|motion| bounds.twist(motion)));
    poses.clear();
    poses.push(start);
    let mut yaw = start[2];
    for (twist, place) in twists.iter().zip(places.chunks_exact(2)) {
        yaw += twist[2] * dt;
        poses.push([start[0] + place[0], start[1] + place[1], yaw]);
    }
}
