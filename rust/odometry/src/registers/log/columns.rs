//! Splits the rows of a log into columns of steps.

use super::{BlockScratch, LogBlock, Rows};
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::weave::unweave;

/// Splits rows into columns of steps: counts of wheels, middle angles and turns of joints [rad], durations [s].
#[inline(always)]
pub(crate) fn split_columns<S: Vector>(
    simd: S,
    rows: &Rows<'_>,
    angles: &[f64],
    count: usize,
    room: &mut BlockScratch,
    block: &mut LogBlock,
) {
    let pairs = rows.stamps.iter().zip(&rows.stamps[1..]);
    for (dt, (before, after)) in block.dt.0.iter_mut().zip(pairs) {
        *dt = after - before;
    }
    // Lanes without a row: steps of a second in which nothing moves.
    block.dt.0[count..].fill(1.0);
    let wheels = room.wheels.len();
    let pairs = rows.wheels.iter().zip(&rows.wheels[wheels..]);
    let flat = &mut room.flat[..count * wheels];
    for (counts, (before, after)) in flat.iter_mut().zip(pairs) {
        *counts = after - before;
    }
    unweave(simd, flat, &mut room.wheels);
    let joints = angles.len();
    let (middles, turns) = room.flat[..2 * count * joints].split_at_mut(count * joints);
    let mut joint = 0;
    while joint < joints {
        // Four at a time are the lanes of a register; most rovers have as many.
        let to = [&mut *middles, &mut *turns, &mut room.angles];
        joint += if joint + 4 <= joints {
            turn::<4>(rows.steering, angles, &room.per_count, joint, to)
        } else {
            turn::<1>(rows.steering, angles, &room.per_count, joint, to)
        };
    }
    let (middle, turned) = room.joints.split_at_mut(joints);
    unweave(simd, middles, middle);
    unweave(simd, turns, turned);
}

/// Middle angles, turns and angles of `N` joints from this one on, one row after the other. Returns N.
#[inline(always)]
fn turn<const N: usize>(
    steering: &[f64],
    angles: &[f64],
    per_count: &[f64],
    joint: usize,
    [middles, turns, ends]: [&mut [f64]; 3],
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
        let (mut middle, mut turned, mut end) = (start, start, start);
        for j in 0..N {
            end[j] = (after[j] - before[j]) * per_count[j] + start[j];
            middle[j] = (start[j] + end[j]) * 0.5;
            turned[j] = end[j] - start[j];
        }
        let here = row * joints + joint..row * joints + joint + N;
        middles[here.clone()].copy_from_slice(&middle);
        turns[here.clone()].copy_from_slice(&turned);
        ends[here].copy_from_slice(&end);
        (before, start) = (after, end);
    }
    N
}
