//! The rows of a log as columns of steps.

use super::{BlockScratch, LogBlock, Rows};
use six_wheel_numerics::columns::transpose_to_columns;
use six_wheel_numerics::simd::vector::Vector;

/// Splits rows into columns of steps: counts of wheels, middle angles and increments of joints [rad], durations [s].
#[inline(always)]
pub(crate) fn split_columns<S: Vector>(
    simd: S,
    rows: &Rows<'_>,
    angles: &[f64],
    count: usize,
    scratch: &mut BlockScratch,
    block: &mut LogBlock,
) {
    let pairs = rows.stamps.iter().zip(&rows.stamps[1..]);
    for (dt, (before, after)) in block.dt.0.iter_mut().zip(pairs) {
        *dt = after - before;
    }
    // Lanes without a row are steps of 1 s without motion.
    block.dt.0[count..].fill(1.0);
    let wheels = scratch.wheels.len();
    let pairs = rows.wheels.iter().zip(&rows.wheels[wheels..]);
    let flat = &mut scratch.flat[..count * wheels];
    for (counts, (before, after)) in flat.iter_mut().zip(pairs) {
        *counts = after - before;
    }
    transpose_to_columns(simd, flat, &mut scratch.wheels);
    let joints = angles.len();
    let (middles, increments) = scratch.flat[..2 * count * joints].split_at_mut(count * joints);
    let mut joint = 0;
    while joint < joints {
        // Four joints, the number of most rovers, are compiled to registers of four.
        let to = [&mut *middles, &mut *increments, &mut scratch.angles];
        joint += if joint + 4 <= joints {
            integrate_joints::<4>(rows.steering, angles, &scratch.per_count, joint, to)
        } else {
            integrate_joints::<1>(rows.steering, angles, &scratch.per_count, joint, to)
        };
    }
    let (middle, increment) = scratch.joints.split_at_mut(joints);
    transpose_to_columns(simd, middles, middle);
    transpose_to_columns(simd, increments, increment);
}

/// Writes middle angles, increments and angles at the end [rad] of `N` joints from this one on, row by row. Returns N.
#[inline(always)]
fn integrate_joints<const N: usize>(
    steering: &[f64],
    angles: &[f64],
    per_count: &[f64],
    joint: usize,
    [middles, increments, ends]: [&mut [f64]; 3],
) -> usize {
    let joints = angles.len();
    let of = |all: &[f64], row: usize| -> [f64; N] {
        let numbers = all.get(row * joints + joint..).and_then(|rest| rest.first_chunk());
        numbers.copied().unwrap_or([f64::NAN; N])
    };
    let (mut start, per_count) = (of(angles, 0), of(per_count, 0));
    let mut before = of(steering, 0);
    for row in 0..middles.len() / joints {
        let after = of(steering, row + 1);
        let (mut middle, mut increment, mut end) = (start, start, start);
        for j in 0..N {
            end[j] = (after[j] - before[j]) * per_count[j] + start[j];
            middle[j] = (start[j] + end[j]) * 0.5;
            increment[j] = end[j] - start[j];
        }
        let here = row * joints + joint..row * joints + joint + N;
        middles[here.clone()].copy_from_slice(&middle);
        increments[here.clone()].copy_from_slice(&increment);
        ends[here].copy_from_slice(&end);
        (before, start) = (after, end);
    }
    N
}
