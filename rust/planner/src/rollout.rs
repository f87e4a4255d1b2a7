//! Rollouts of given controls within a rover's limits, without a planner.

use super::kernels::SingleBlock;
use crate::motion::drive::{RolloutStart, TRACK};
use crate::motion::limits::RoverLimits;
use crate::motion::model::Model;
use crate::motion::steering_setpoint;
use crate::numbers::BLOCK;
use six_wheel_control::controller::Limits;
use six_wheel_kinematics::rover::Rover;
use six_wheel_numerics::error::{Error, finite, not_negative, positive};
use six_wheel_numerics::threads::workers::Workers;

/// Motion of a rover at the start of rollouts.
#[derive(Clone, Copy, Debug, Default)]
pub struct Present<'a> {
    /// Twist in body axes [m/s, m/s, rad/s].
    pub twist: [f64; 3],
    /// Steering angles [rad]; if not given, those in their ranges nearest to 0.
    pub steering: Option<&'a [f64]>,
    /// Dead time from a control to its effect, during which the motion is constant [s].
    pub delay: f64,
}

/// Poses of rollouts of `count` steps each, `count + 1` rows with the start first, with the motions that a planner
/// executes for these controls. A rover that cannot move stays.
#[allow(clippy::too_many_arguments)] // the rover, the columns, the present, the results
pub fn rollout(
    rover: &Rover,
    limits: Limits,
    controls: &[[f64; 3]],
    count: usize,
    dt: f64,
    starts: &[[f64; 3]],
    present: Present<'_>,
    poses: &mut [[f64; 3]],
    workers: Workers,
) -> Result<(), Error> {
    positive("dt", dt)?;
    not_negative("delay", present.delay)?;
    finite("controls", controls.as_flattened())?;
    finite("start", starts.as_flattened())?;
    finite("twist", &present.twist)?;
    finite("steering", present.steering.unwrap_or_default())?;
    let bounds = RoverLimits::new(rover, limits)?;
    let follow = if bounds.free == 2 { drive::<2> } else { drive::<3> };
    let share = workers.share_of_logs(poses.len() / (count + 1), count);
    let parts = poses.chunks_mut(share * (count + 1)).enumerate();
    workers.for_each(parts, |(k, poses)| {
        let first = k * share;
        let start = |k: usize| starts[if starts.len() == 1 { 0 } else { first + k }];
        for (k, poses) in poses.chunks_exact_mut(count + 1).enumerate() {
            poses.fill(start(k));
        }
        if bounds.stuck.is_none() && count > 0 {
            let end = first + poses.len() / (count + 1);
            follow(&bounds, &controls[first * count..end * count], count, dt, present, poses, workers);
        }
        Ok(())
    })
}

/// Simulates some rollouts; every row of `poses` holds the start pose on entry.
fn drive<const M: usize>(
    bounds: &RoverLimits,
    controls: &[[f64; 3]],
    count: usize,
    dt: f64,
    present: Present<'_>,
    poses: &mut [[f64; 3]],
    workers: Workers,
) {
    let model = Model::<f64, M>::new(bounds, dt);
    let straight: Vec<f64> = bounds.joints.iter().map(|joint| joint.straight()).collect();
    let mut initial = RolloutStart::default();
    let motion = bounds.motion(present.twist);
    steering_setpoint::initialize(bounds, motion, present.steering.unwrap_or(&straight), &mut initial);
    initial.heading = bounds.heading;
    let largest = |twist: &[f64; 3]| bounds.size_of(twist);
    let fastest = controls.iter().chain([&present.twist]).map(largest).fold(0.0, f64::max);
    initial.choose_series(bounds.turns_at_most(fastest), dt);
    let late = ((present.delay / dt).round() as usize).min(count);
    let mut columns = vec![0.0; count * M * BLOCK];
    let mut motions = columns.clone();
    let mut track = vec![0.0; count * TRACK * BLOCK];
    let blocks = controls.chunks(BLOCK * count).zip(poses.chunks_mut(BLOCK * (count + 1)));
    for (controls, poses) in blocks {
        for (lane, rollout) in controls.chunks_exact(count).enumerate() {
            for t in 0..count {
                let control = t.checked_sub(late).map_or(motion, |t| bounds.motion(rollout[t]));
                for (k, part) in control.iter().enumerate().take(M) {
                    columns[(t * M + k) * BLOCK + lane] = *part;
                }
            }
        }
        workers.level.run_any(SingleBlock {
            model: &model,
            start: &initial,
            controls: &columns,
            track: &mut track,
            motions: &mut motions,
        });
        for (lane, poses) in poses.chunks_exact_mut(count + 1).enumerate() {
            let [x, y, mut yaw] = poses[0];
            let (sin, cos) = yaw.sin_cos();
            for t in 0..count {
                let place = |k: usize| track[(t * TRACK + k) * BLOCK + lane];
                yaw += motions[(t * M + M - 1) * BLOCK + lane] * dt;
                let (ahead, aside) = (place(0), place(1));
                poses[t + 1] = [x + cos * ahead - sin * aside, y + sin * ahead + cos * aside, yaw];
            }
        }
    }
}
