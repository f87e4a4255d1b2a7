//! Steps of many short logs, one log in every lane.

use super::tile::{LANES, PerStep, STEPS, WIDTH, columns, durations};
use crate::geometry::Steps;
use six_wheel_numerics::simd::vector::Vector;

/// Logs of `count` steps each that have been checked, with one start for every log or one for all.
#[derive(Clone, Copy)]
pub struct Logs<'a> {
    /// Twists, log after log.
    pub twists: &'a [[f64; 3]],
    /// Steps of a log.
    pub count: usize,
    /// Durations of the steps [s].
    pub steps: Steps<'a>,
    /// First poses.
    pub starts: &'a [[f64; 3]],
}

/// Receives the steps of a group of logs, tile by tile.
pub trait StepVisitor<S: Vector> {
    /// Twists of the next steps, one register per number, and the durations of the steps [s].
    fn tile(&mut self, simd: S, twists: &[S::f64s; WIDTH], dts: &PerStep<S>);
}

/// Passes the steps of as many logs as there are lanes, from log `first` on, to a visitor; missing logs are padded with
/// steps without motion.
#[inline(always)]
pub fn side_by_side<S: Vector>(simd: S, logs: Logs<'_>, first: usize, visitor: &mut impl StepVisitor<S>) {
    let Logs { count, steps, .. } = logs;
    let mut logs = logs.twists[first * count..].chunks_exact(count.max(1));
    let logs: [&[[f64; 3]]; LANES] = std::array::from_fn(|_| logs.next().unwrap_or_default());
    let tiles = logs.map(|log| log.as_flattened().as_chunks().0);
    let constant = durations(simd, steps, 0);
    let mut numbers = [simd.splat_f64s(0.0); WIDTH];
    let mut padded = [[0.0; WIDTH]; LANES];
    for k in 0..count.div_ceil(STEPS) {
        let first = k * STEPS;
        let dts = match steps {
            Steps::Constant(_) => constant,
            Steps::Each(_) => durations(simd, steps, first),
        };
        if count - first < STEPS {
            for (padded, log) in padded.iter_mut().zip(logs) {
                let numbers = log.get(first..).unwrap_or_default().as_flattened();
                padded[..numbers.len()].copy_from_slice(numbers);
            }
        }
        let twists: [&[f64; WIDTH]; LANES] = std::array::from_fn(|lane| tiles[lane].get(k).unwrap_or(&padded[lane]));
        columns(simd, &twists, &mut numbers);
        visitor.tile(simd, &numbers, &dts);
    }
}
