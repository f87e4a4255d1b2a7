//! A cycle in one precision: rollouts block by block, then the new mean.
//!
//! Blocks are of a fixed size and sums go over them in a fixed order, so that no result depends on threads or levels.

use super::cost::{CostTerms, Path, Weights};
use super::costmap::Costmap;
use super::kernels::{RolloutInput, RolloutTask, SingleBlock, ThreadScratch, WeightedSum};
use crate::motion::drive::{RolloutStart, TRACK};
use crate::motion::limits::RoverLimits;
use crate::motion::model::Model;
use crate::numbers::BLOCK;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::float::Float;
use six_wheel_numerics::simd::level::Level;
use six_wheel_numerics::threads::workers::Workers;

/// Number of partial sums of the new mean, independent of the number of threads.
const STRIPES: usize = 4;

/// Most steps of rollouts in one task: interrupts are checked between tasks.
const TASK: usize = 1 << 18;

/// Constants of all cycles.
#[derive(Clone, Debug)]
pub(crate) struct MppiConstants {
    pub steps: usize,
    pub dt: f64,
    pub weights: Weights,
    pub points: Vec<[f64; 2]>,
}

/// A cycle in either precision.
pub(crate) trait RolloutEngine: Send + Sync {
    /// Samples and simulates all rollouts and adds up their costs.
    fn sample_rollouts(
        &mut self,
        input: &RolloutInput,
        map: Option<&Costmap>,
        path: &Path,
        constants: &MppiConstants,
        workers: Workers,
    ) -> Result<(), Error>;
    /// The cost of every rollout.
    fn costs(&self, to: &mut Vec<f64>);
    /// The mean of the controls with these weights.
    fn mean(&mut self, weights: &[f64], workers: Workers, to: &mut [f64]) -> Result<(), Error>;
    /// Simulates one rollout of these controls; writes its motions `[step][component]` and positions `[step][x, y]`.
    fn nominal(&mut self, start: &RolloutStart, controls: &[f64], level: Level, to: [&mut [f64]; 2]);
    /// Motions and positions of one of the rollouts that were recorded.
    fn recorded(&self, rollout: usize, to: [&mut [f64]; 2]);
    /// The controls of one rollout.
    fn controls(&self, rollout: usize, to: &mut [f64]);
}

/// The rollouts of a cycle, in blocks `[step][component][rollout]`.
pub(crate) struct SampledRollouts<R, const M: usize> {
    model: Model<R, M>,
    steps: usize,
    controls: Vec<R>,
    costs: Vec<R>,
    scratch: Vec<ThreadScratch<R>>,
    sums: Vec<R>,
    shares: Vec<R>,
    path: Vec<[R; 4]>,
    motions: Vec<R>,
    tracks: Vec<R>,
}

impl<R: Float, const M: usize> SampledRollouts<R, M> {
    pub fn new(bounds: &RoverLimits, constants: &MppiConstants, samples: usize) -> Self {
        let blocks = samples.div_ceil(BLOCK);
        let row = constants.steps * M * BLOCK;
        Self {
            model: Model::new(bounds, constants.dt),
            steps: constants.steps,
            controls: vec![R::default(); blocks * row],
            costs: vec![R::default(); blocks * BLOCK],
            scratch: Vec::new(),
            sums: vec![R::default(); STRIPES * row],
            shares: vec![R::default(); blocks * BLOCK],
            path: Vec::new(),
            motions: Vec::new(),
            tracks: Vec::new(),
        }
    }

    /// Numbers of a block's controls, and of its track.
    fn block_sizes(&self) -> [usize; 2] {
        [M, TRACK].map(|width| self.steps * width * BLOCK)
    }
}

impl<R: Float, const M: usize> RolloutEngine for SampledRollouts<R, M> {
    fn sample_rollouts(
        &mut self,
        input: &RolloutInput,
        map: Option<&Costmap>,
        path: &Path,
        constants: &MppiConstants,
        workers: Workers,
    ) -> Result<(), Error> {
        let [row, track] = self.block_sizes();
        let blocks = self.costs.len() / BLOCK;
        self.path.clear();
        if input.has_path {
            path.write(input.start, &mut self.path);
        }
        let terms = CostTerms {
            map,
            points: &constants.points,
            start: input.start,
            goal: input.goal,
            goal_heading: input.goal_heading,
            path: &self.path,
            spacing: path.spacing(),
            length: path.length(),
            progress: input.progress,
            weights: constants.weights,
            dt: constants.dt,
        };
        let kept = if input.record { blocks } else { 0 };
        self.motions.resize(kept * row, R::default());
        self.tracks.resize(kept * track, R::default());
        let share = blocks.div_ceil(workers.threads.clamp(1, blocks)).min((TASK / (BLOCK * self.steps)).max(1));
        let scratch = || ThreadScratch { noise: vec![0.0; row], track: vec![R::default(); track] };
        self.scratch.resize_with(self.scratch.len().max(blocks.div_ceil(share)), scratch);
        self.costs.fill(R::default());
        let parts = self.controls.chunks_mut(share * row).zip(self.costs.chunks_mut(share * BLOCK));
        let parts = parts.zip(self.scratch.iter_mut());
        let mut motions = self.motions.chunks_mut(share * row);
        let mut tracks = self.tracks.chunks_mut(share * track);
        let (model, steps) = (&self.model, self.steps);
        let tasks = parts.enumerate().map(|(k, ((controls, costs), scratch))| RolloutTask {
            model,
            terms: &terms,
            input,
            steps,
            first: k * share * BLOCK,
            controls,
            costs,
            motions: motions.next().unwrap_or_default(),
            tracks: tracks.next().unwrap_or_default(),
            scratch,
        });
        workers.for_each(tasks, |task| {
            workers.level.run_any(task);
            Ok(())
        })
    }

    fn costs(&self, to: &mut Vec<f64>) {
        to.clear();
        to.extend(self.costs.iter().map(|cost| cost.to_f64()));
    }

    fn mean(&mut self, weights: &[f64], workers: Workers, to: &mut [f64]) -> Result<(), Error> {
        let [row, _] = self.block_sizes();
        for (share, weight) in self.shares.iter_mut().zip(weights) {
            *share = R::from_f64(*weight);
        }
        let part = (self.costs.len() / BLOCK).div_ceil(STRIPES);
        self.sums.fill(R::default());
        let parts = self.controls.chunks(part * row).zip(self.shares.chunks(part * BLOCK));
        let parts = parts.zip(self.sums.chunks_exact_mut(row));
        let tasks = parts.map(|((controls, shares), sums)| WeightedSum { controls, shares, sums });
        workers.for_each(tasks, |task| {
            workers.level.run_any(task);
            Ok(())
        })?;
        for (k, to) in to.iter_mut().enumerate() {
            let rows = self.sums.chunks_exact(row).map(|sums| &sums[k * BLOCK..(k + 1) * BLOCK]);
            *to = rows.flatten().map(|part| part.to_f64()).sum();
        }
        Ok(())
    }

    fn nominal(&mut self, start: &RolloutStart, controls: &[f64], level: Level, [motions, positions]: [&mut [f64]; 2]) {
        let [row, _] = self.block_sizes();
        // The memory of the sums is reused: it is larger than the controls and motions of a block.
        let (block, rest) = self.sums.split_at_mut(row);
        for (block, control) in block.chunks_exact_mut(BLOCK).zip(controls) {
            block.fill(R::from_f64(*control));
        }
        let Some(scratch) = self.scratch.first_mut() else {
            return;
        };
        let track = &mut scratch.track;
        level.run_any(SingleBlock { model: &self.model, start, controls: block, track, motions: &mut rest[..row] });
        read_lane(rest, 0, motions);
        read_positions(&scratch.track, 0, positions);
    }

    fn recorded(&self, rollout: usize, [motions, positions]: [&mut [f64]; 2]) {
        let [row, track] = self.block_sizes();
        let (block, lane) = (rollout / BLOCK, rollout % BLOCK);
        read_lane(&self.motions[block * row..], lane, motions);
        read_positions(&self.tracks[block * track..], lane, positions);
    }

    fn controls(&self, rollout: usize, to: &mut [f64]) {
        let [row, _] = self.block_sizes();
        read_lane(&self.controls[rollout / BLOCK * row..], rollout % BLOCK, to);
    }
}

/// One rollout of a block.
fn read_lane<R: Float>(block: &[R], lane: usize, to: &mut [f64]) {
    for (to, from) in to.iter_mut().zip(block.chunks_exact(BLOCK)) {
        *to = from[lane].to_f64();
    }
}

/// Positions of one rollout of a track.
fn read_positions<R: Float>(track: &[R], lane: usize, positions: &mut [f64]) {
    for (position, step) in positions.chunks_exact_mut(2).zip(track.chunks_exact(TRACK * BLOCK)) {
        (position[0], position[1]) = (step[lane].to_f64(), step[BLOCK + lane].to_f64());
    }
}
