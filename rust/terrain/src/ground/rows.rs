//! Many poses settled, in lanes or one by one.

use super::batch;
use super::settler::Settler;
use super::stand::Stand;
use crate::suspension::MAX_WHEELS;
use six_wheel_numerics::error::{Error, finite};
use six_wheel_numerics::threads::workers::for_each;

/// Poses from which it is worth to start a thread: some ten microseconds each.
const WORTH_A_THREAD: usize = 64;

/// Poses from which it is worth to settle them in lanes.
const WORTH_LANES: usize = 8;

/// Nodes of a map for every pose up to which it is worth to know its highest places beforehand.
const WORTH_A_PYRAMID: usize = 64;

/// Settles every pose. Steering angles are one row for all poses or one per pose, none if all are 0. Fails, with
/// nothing written, where a number is not finite.
pub fn settle(
    settler: &Settler<'_>,
    poses: &[[f64; 3]],
    steering: &[f64],
    threads: usize,
    stands: &mut [Stand],
) -> Result<(), Error> {
    let joints = settler.chain.steering().len();
    for (k, pose) in poses.iter().enumerate() {
        finite("poses", pose).map_err(|error| error.at_row(k))?;
    }
    for (k, angles) in steering.chunks_exact(joints.max(1)).enumerate() {
        let one = steering.len() == joints;
        finite("steering", angles).map_err(|error| if one { error } else { error.at_row(k) })?;
    }
    let angles = |k: usize| {
        if steering.len() > joints { &steering[k * joints..][..joints] } else { steering }
    };
    let [rows, columns] = settler.ground.shape();
    if worth_lanes(poses.len()) && poses.len() * WORTH_A_PYRAMID > rows * columns {
        // It only saves time: where there is no memory for it, rims are walked without.
        let _ = settler.ground.pyramid();
    }
    let lanes = worth_lanes(poses.len());
    let share = poses.len().div_ceil(threads.max(1)).max(WORTH_A_THREAD);
    let parts = poses.chunks(share).zip(stands.chunks_mut(share));
    for_each(parts.enumerate(), |(k, (poses, stands))| {
        let angles = |row: usize| angles(k * share + row);
        settle_part(settler, poses, &angles, lanes, stands);
        Ok(())
    })
}

/// Settles poses of finite numbers with these steering angles, in lanes or one by one. What a pose comes to does not depend
/// on the others: `lanes` is to be the same for all parts of a batch.
pub(crate) fn settle_part<'a>(
    settler: &Settler<'_>,
    poses: &[[f64; 3]],
    angles: &dyn Fn(usize) -> &'a [f64],
    lanes: bool,
    stands: &mut [Stand],
) {
    let mut left = Vec::new();
    let in_lanes = lanes.then(|| {
        let padded = |k: usize| {
            let mut padded = [0.0; MAX_WHEELS];
            for (padded, angle) in padded.iter_mut().zip(angles(k)) {
                *padded = *angle;
            }
            padded
        };
        let steered = !poses.is_empty() && !angles(0).is_empty();
        batch::settle(settler, poses, &padded, steered, stands, &mut left)
    });
    if in_lanes.flatten().is_none() {
        left = (0..poses.len()).map(|k| (k, None)).collect();
    }
    for (k, near) in left {
        let settled = settler.settle_near(poses[k].into(), angles(k), near);
        stands[k] = Stand::of(&settled);
    }
}

/// True if a batch of so many poses is settled in lanes.
pub(crate) fn worth_lanes(poses: usize) -> bool {
    poses >= WORTH_LANES
}
