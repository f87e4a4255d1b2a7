//! Kernels of a cycle: sampled rollouts of one thread, the weighted sum of their controls, one block by given controls.

use super::cost::CostTerms;
use crate::motion::drive::{RolloutStart, TRACK};
use crate::motion::model::Model;
use crate::numbers::BLOCK;
use crate::numbers::noise::{self, PhiloxCounter};
use six_wheel_numerics::simd::float::Float;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::Kernel;
use six_wheel_numerics::simd::vector::Vector;

/// Input of one cycle's rollouts.
#[derive(Debug, Default)]
pub(crate) struct RolloutInput {
    pub initial: RolloutStart,
    /// Mean, standard deviation and largest magnitude of the controls: `[step][component]`, `[component]`,
    /// `[component]`.
    pub mean: Vec<f64>,
    pub sigma: Vec<f64>,
    pub cap: Vec<f64>,
    /// Correlation of the noise of a step with that of the next one.
    pub memory: f64,
    /// Number of steps whose controls are already sent.
    pub fixed: usize,
    /// Constant controls of the rollouts 1 and up; rollout 0 has the mean.
    pub constant: Vec<f64>,
    pub seed: u64,
    pub cycle: u32,
    pub samples: usize,
    /// Position of the rover and of the goal [m].
    pub start: [f64; 2],
    pub goal: Option<[f64; 2]>,
    /// Cosine and sine of the heading of the components' axes at the goal.
    pub goal_heading: Option<[f64; 2]>,
    pub has_path: bool,
    /// Arc length of the rover on the path [m].
    pub progress: f64,
    /// True if the rollouts' motions are kept for an extra cost.
    pub record: bool,
}

/// Memory of one thread, reused from cycle to cycle.
pub(crate) struct ThreadScratch<R> {
    pub noise: Vec<f32>,
    pub track: Vec<R>,
}

/// The rollouts of one thread.
pub(crate) struct RolloutTask<'a, R, const M: usize> {
    pub model: &'a Model<R, M>,
    pub terms: &'a CostTerms<'a, R>,
    pub input: &'a RolloutInput,
    pub steps: usize,
    /// Number of the first rollout.
    pub first: usize,
    pub controls: &'a mut [R],
    pub costs: &'a mut [R],
    pub motions: &'a mut [R],
    pub tracks: &'a mut [R],
    pub scratch: &'a mut ThreadScratch<R>,
}

impl<R: Float, const M: usize> Kernel for RolloutTask<'_, R, M> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) {
        let row = self.steps * M * BLOCK;
        let blocks = self.controls.chunks_exact_mut(row).zip(self.costs.chunks_exact_mut(BLOCK));
        let mut motions = self.motions.chunks_exact_mut(row);
        let mut tracks = self.tracks.chunks_exact_mut(self.steps * TRACK * BLOCK);
        for (b, (controls, costs)) in blocks.enumerate() {
            let first = self.first + b * BLOCK;
            let counter = PhiloxCounter { seed: self.input.seed, cycle: self.input.cycle, first: first as u32 };
            noise::fill(simd, counter, M, self.steps, &mut self.scratch.noise);
            sample_controls::<S, R, M>(simd, self.input, &self.scratch.noise, controls, first);
            let mut record = motions.next();
            let track = tracks.next().unwrap_or(&mut self.scratch.track);
            let lanes = Model::<R, M>::lane_count::<S>();
            // Their costs are added up while they are in the first-level cache.
            for at in (0..BLOCK).step_by(lanes) {
                let (start, record) = (&self.input.initial, record.as_deref_mut());
                self.model.drive(simd, start, at, controls, track, costs, record);
                self.terms.add(simd, track, costs, at..at + lanes);
            }
        }
    }
}

/// Controls of a block from its noise, an autoregressive process of order 1: `n_k = memory n_(k-1) + sqrt(1 - memory²)
/// e_k`.
#[inline(always)]
fn sample_controls<S: Vector, R: Float, const M: usize>(
    simd: S,
    input: &RolloutInput,
    noise: &[f32],
    controls: &mut [R],
    first: usize,
) {
    let number = |value: f64| Lanes::<S, R>::constant(simd, value);
    let lanes = R::lanes::<S>();
    let rows = controls.chunks_exact_mut(BLOCK).zip(noise.chunks_exact(BLOCK)).enumerate();
    let (memory, fresh) = (number(input.memory), number((1.0 - input.memory * input.memory).sqrt()));
    let mut last = [[R::default(); BLOCK]; M];
    let mut wide = [R::default(); BLOCK];
    for (row, (controls, noise)) in rows {
        let (t, k) = (row / M, row % M);
        for (wide, noise) in wide.iter_mut().zip(noise) {
            *wide = R::from(*noise);
        }
        let mean = number(input.mean[row]);
        let sigma = number(if t < input.fixed { 0.0 } else { input.sigma[k] });
        let (low, high) = (number(-input.cap[k]), number(input.cap[k]));
        for at in (0..BLOCK).step_by(lanes) {
            let fresh = if t == 0 { number(1.0) } else { fresh };
            let old = Lanes::from_slice(simd, &last[k][at..]) * memory;
            let new = Lanes::from_slice(simd, &wide[at..]).mul_add(fresh, old);
            new.copy_to_slice(&mut last[k][at..]);
            new.mul_add(sigma, mean).max(low).min(high).copy_to_slice(&mut controls[at..]);
        }
        if first > 0 {
            continue;
        }
        controls[0] = R::from_f64(input.mean[row].clamp(-input.cap[k], input.cap[k]));
        if t >= input.fixed {
            for (control, held) in controls[1..].iter_mut().zip(input.constant.chunks_exact(M)) {
                *control = R::from_f64(held[k]);
            }
        }
    }
}

/// Adds the controls of some blocks, each times its share.
pub(crate) struct WeightedSum<'a, R> {
    pub controls: &'a [R],
    pub shares: &'a [R],
    pub sums: &'a mut [R],
}

impl<R: Float> Kernel for WeightedSum<'_, R> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) {
        self.sums.fill(R::default());
        let lanes = R::lanes::<S>();
        let blocks = self.controls.chunks_exact(self.sums.len()).zip(self.shares.chunks_exact(BLOCK));
        for (controls, shares) in blocks {
            for (controls, sums) in controls.chunks_exact(BLOCK).zip(self.sums.chunks_exact_mut(BLOCK)) {
                for at in (0..BLOCK).step_by(lanes) {
                    let share = Lanes::<S, R>::from_slice(simd, &shares[at..]);
                    let sum = Lanes::from_slice(simd, &sums[at..]);
                    Lanes::from_slice(simd, &controls[at..]).mul_add(share, sum).copy_to_slice(&mut sums[at..]);
                }
            }
        }
    }
}

/// One block by given controls.
pub(crate) struct SingleBlock<'a, R, const M: usize> {
    pub model: &'a Model<R, M>,
    pub start: &'a RolloutStart,
    pub controls: &'a [R],
    pub track: &'a mut [R],
    pub motions: &'a mut [R],
}

impl<R: Float, const M: usize> Kernel for SingleBlock<'_, R, M> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) {
        let mut costs = [R::default(); BLOCK];
        for at in (0..BLOCK).step_by(Model::<R, M>::lane_count::<S>()) {
            let record = Some(&mut *self.motions);
            self.model.drive(simd, self.start, at, self.controls, self.track, &mut costs, record);
        }
    }
}
