//! Settling of many poses, in lanes or one by one.

use super::batch;
use super::settler::{Settler, Status};
use super::stand::Stand;
use crate::suspension::{MAX_WHEELS, PlanPose};
use six_wheel_numerics::error::{Error, ErrorKind, finite};
use six_wheel_numerics::threads::workers::Workers;

/// Number of poses from which starting a thread is faster: each takes some ten microseconds.
const WORTH_A_THREAD: usize = 64;

/// Largest number of poses that a thread takes at a time: some ten milliseconds.
const MOST: usize = 2048;

/// Nodes of a map per pose up to which building its pyramid of extremes is faster than settling without it.
const WORTH_A_PYRAMID: usize = 64;

/// True for the steering angles of a pose without a settled pose, as the motion on the ground returns them: all are
/// NaN.
fn is_all_nan(steering: &[f64]) -> bool {
    !steering.is_empty() && steering.iter().all(|angle| angle.is_nan())
}

/// Settles every pose. Steering angles are one row for all poses or one per pose, none if all are 0. A pose with a row of
/// NaN has not converged. Fails, with nothing written, where another number is not finite.
pub fn settle(
    settler: &Settler<'_>,
    poses: &[[f64; 3]],
    steering: &[f64],
    workers: Workers,
    stands: &mut [Stand],
) -> Result<(), Error> {
    let joints = settler.chain.steering().len();
    for (k, pose) in poses.iter().enumerate() {
        finite("poses", pose).map_err(|error| error.at_row(k))?;
    }
    let one = steering.len() == joints;
    for (k, angles) in steering.chunks_exact(joints.max(1)).enumerate() {
        if is_all_nan(angles) && (!one || poses.len() == 1) {
            continue;
        }
        finite("steering", angles).map_err(|error| if one { error } else { error.at_row(k) })?;
    }
    let angles = |k: usize| {
        if steering.len() > joints { &steering[k * joints..][..joints] } else { steering }
    };
    let [rows, columns] = settler.ground.shape();
    if poses.len() * WORTH_A_PYRAMID > rows * columns {
        // The pyramid saves time only: without memory for it, rims are searched without it.
        match settler.ground.pyramid(workers.is_interrupted) {
            Err(error) if error.kind == ErrorKind::Interrupted => return Err(error),
            _ => (),
        }
    }
    let share = poses.len().div_ceil(workers.threads.max(1)).clamp(WORTH_A_THREAD, MOST);
    let parts = poses.chunks(share).zip(stands.chunks_mut(share));
    workers.for_each(parts.enumerate(), |(k, (poses, stands))| {
        let angles = |row: usize| angles(k * share + row);
        settle_part(settler, poses, &angles, stands);
        Ok(())
    })
}

/// Settles poses of finite numbers with these steering angles. The result of a pose does not depend on the others.
pub(crate) fn settle_part<'a>(
    settler: &Settler<'_>,
    poses: &[[f64; 3]],
    angles: &dyn Fn(usize) -> &'a [f64],
    stands: &mut [Stand],
) {
    let padded = |k: usize| {
        let mut padded = [0.0; MAX_WHEELS];
        if !is_all_nan(angles(k)) {
            for (padded, angle) in padded.iter_mut().zip(angles(k)) {
                *padded = *angle;
            }
        }
        padded
    };
    let steered = !poses.is_empty() && !angles(0).is_empty();
    for (k, near) in batch::settle(settler, poses, &padded, steered, stands) {
        if !is_all_nan(angles(k)) {
            stands[k] = settler.settle_near(poses[k].into(), angles(k), near);
        }
    }
    for (_, stand) in stands.iter_mut().enumerate().filter(|(k, _)| is_all_nan(angles(*k))) {
        *stand = Stand::nothing(Status::NotConverged);
    }
}

impl Settler<'_> {
    /// Settles the chain at a pose with these steering angles (none of them if all are 0). Fails where a number is not
    /// finite.
    pub fn settle(&self, pose: PlanPose, steering: &[f64]) -> Result<Stand, Error> {
        finite("poses", &[pose.x, pose.y, pose.yaw])?;
        finite("steering", steering)?;
        Ok(self.settle_finite(pose, steering))
    }

    /// [`Self::settle`] for finite numbers.
    #[inline]
    pub fn settle_finite(&self, pose: PlanPose, steering: &[f64]) -> Stand {
        let mut stand = [Stand::nothing(Status::NotConverged)];
        settle_part(self, &[[pose.x, pose.y, pose.yaw]], &|_| steering, &mut stand);
        stand[0]
    }
}
