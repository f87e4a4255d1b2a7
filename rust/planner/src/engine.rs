//! A cycle in one kind of number: rollouts block by block, then weights and the new mean.
//!
//! Blocks are of a fixed size and sums go over them in a fixed order, so that no result depends on threads or levels.

use super::cost::{Judge, Path, Weights};
use super::costmap::Costmap;
use crate::motion::drive::{Begin, TRACK};
use crate::motion::limits::RoverLimits;
use crate::motion::model::Model;
use crate::numbers::BLOCK;
use crate::numbers::noise;
use crate::numbers::noise::Counter;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::float::Float;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::{Kernel, Level};
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_numerics::threads::workers::each;

/// Parts the new mean is added up in, whoever does it.
const STRIPES: usize = 4;

/// Input of one cycle's rollouts.
#[derive(Debug, Default)]
pub(crate) struct RolloutInput {
    pub begin: Begin,
    /// Mean, spread and largest of the wishes: `[step][component]`, `[component]`, `[component]`.
    pub mean: Vec<f64>,
    pub sigma: Vec<f64>,
    pub cap: Vec<f64>,
    /// Correlation of the noise of a step with that of the next one.
    pub memory: f64,
    /// Steps whose wishes cannot be changed any more.
    pub fixed: usize,
    /// Wishes of the first rollouts, held all the way; the very first is the mean.
    pub constant: Vec<f64>,
    pub seed: u64,
    pub cycle: u32,
    pub samples: usize,
    pub start: [f64; 2],
    pub goal: Option<[f64; 2]>,
    pub has_path: bool,
    pub progress: f64,
    /// True if the rollouts' motions are kept for an extra cost.
    pub record: bool,
}

/// Constants of all cycles.
#[derive(Clone, Debug)]
pub(crate) struct Settings {
    pub steps: usize,
    pub dt: f64,
    pub weights: Weights,
    pub points: Vec<[f64; 2]>,
}

/// A cycle in either kind of number.
pub(crate) trait Engine: Send + Sync {
    /// Drives all rollouts and adds up their costs.
    fn roll(
        &mut self,
        job: &RolloutInput,
        map: Option<&Costmap>,
        path: &Path,
        settings: &Settings,
        workers: Workers,
    ) -> Result<(), Error>;
    /// The cost of every rollout.
    fn costs(&self, to: &mut Vec<f64>);
    /// The mean of the wishes with these weights.
    fn mean(&mut self, weights: &[f64], settings: &Settings, workers: Workers, to: &mut [f64]) -> Result<(), Error>;
    /// Drives one rollout by these wishes; its motions `[step][component]` and places `[step][x, y]`.
    fn nominal(
        &mut self,
        job: &RolloutInput,
        wishes: &[f64],
        settings: &Settings,
        level: Level,
        motions: &mut [f64],
        places: &mut [f64],
    );
    /// Motions and places of one of the rollouts that were recorded.
    fn recorded(&self, rollout: usize, settings: &Settings, motions: &mut [f64], places: &mut [f64]);
    /// The wishes of one rollout.
    fn wishes(&self, rollout: usize, settings: &Settings, to: &mut [f64]);
}

/// Room of one thread.
struct ThreadScratch<R> {
    noise: Vec<f32>,
    track: Vec<R>,
}

pub(crate) struct Machine<R, const M: usize> {
    model: Model<R, M>,
    wishes: Vec<R>,
    costs: Vec<R>,
    rooms: Vec<ThreadScratch<R>>,
    sums: Vec<R>,
    shares: Vec<R>,
    path: Vec<[R; 4]>,
    motions: Vec<R>,
    tracks: Vec<R>,
}

impl<R: Float, const M: usize> Machine<R, M> {
    pub fn new(facts: &RoverLimits, settings: &Settings, samples: usize) -> Self {
        let blocks = samples.div_ceil(BLOCK);
        let row = settings.steps * M * BLOCK;
        Self {
            model: Model::new(facts, settings.dt),
            wishes: vec![R::default(); blocks * row],
            costs: vec![R::default(); blocks * BLOCK],
            rooms: Vec::new(),
            sums: vec![R::default(); STRIPES * row],
            shares: vec![R::default(); blocks * BLOCK],
            path: Vec::new(),
            motions: Vec::new(),
            tracks: Vec::new(),
        }
    }
}

/// The rollouts of one thread.
struct Roll<'a, R, const M: usize> {
    model: &'a Model<R, M>,
    judge: &'a Judge<'a, R>,
    job: &'a RolloutInput,
    steps: usize,
    first: usize,
    wishes: &'a mut [R],
    costs: &'a mut [R],
    motions: &'a mut [R],
    tracks: &'a mut [R],
    room: &'a mut ThreadScratch<R>,
}

impl<R: Float, const M: usize> Kernel for Roll<'_, R, M> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) {
        let row = self.steps * M * BLOCK;
        let blocks = self.wishes.chunks_exact_mut(row).zip(self.costs.chunks_exact_mut(BLOCK));
        let mut motions = self.motions.chunks_exact_mut(row);
        let mut tracks = self.tracks.chunks_exact_mut(self.steps * TRACK * BLOCK);
        for (b, (wishes, costs)) in blocks.enumerate() {
            let first = self.first + b * BLOCK;
            let counter = Counter { seed: self.job.seed, cycle: self.job.cycle, first: first as u32 };
            noise::fill(simd, counter, M, self.steps, &mut self.room.noise);
            wish::<S, R, M>(simd, self.job, &self.room.noise, wishes, first);
            let mut record = motions.next();
            let track = tracks.next().unwrap_or(&mut self.room.track);
            let abreast = Model::<R, M>::abreast::<S>();
            // Judged while they are in the first-level cache.
            for at in (0..BLOCK).step_by(abreast) {
                let (begin, record) = (&self.job.begin, record.as_deref_mut());
                self.model.drive(simd, begin, at, wishes, track, costs, record);
                self.judge.add(simd, track, costs, at..at + abreast);
            }
        }
    }
}

/// Noise to wishes.
#[inline(always)]
fn wish<S: Vector, R: Float, const M: usize>(
    simd: S,
    job: &RolloutInput,
    noise: &[f32],
    wishes: &mut [R],
    first: usize,
) {
    let number = |value: f64| Lanes::<S, R>::constant(simd, value);
    let lanes = R::lanes::<S>();
    let rows = wishes.chunks_exact_mut(BLOCK).zip(noise.chunks_exact(BLOCK)).enumerate();
    let (memory, fresh) = (number(job.memory), number((1.0 - job.memory * job.memory).sqrt()));
    let mut last = [[R::default(); BLOCK]; M];
    let mut wide = [R::default(); BLOCK];
    for (row, (wishes, noise)) in rows {
        let (t, k) = (row / M, row % M);
        for (wide, noise) in wide.iter_mut().zip(noise) {
            *wide = R::from(*noise);
        }
        let mean = number(job.mean[row]);
        let sigma = number(if t < job.fixed { 0.0 } else { job.sigma[k] });
        let (low, high) = (number(-job.cap[k]), number(job.cap[k]));
        for at in (0..BLOCK).step_by(lanes) {
            let fresh = if t == 0 { number(1.0) } else { fresh };
            let old = Lanes::from_slice(simd, &last[k][at..]) * memory;
            let new = Lanes::from_slice(simd, &wide[at..]).mul_add(fresh, old);
            new.copy_to_slice(&mut last[k][at..]);
            new.mul_add(sigma, mean).max(low).min(high).copy_to_slice(&mut wishes[at..]);
        }
        if first > 0 {
            continue;
        }
        wishes[0] = R::from_f64(job.mean[row].clamp(-job.cap[k], job.cap[k]));
        if t >= job.fixed {
            for (wish, held) in wishes[1..].iter_mut().zip(job.constant.chunks_exact(M)) {
                *wish = R::from_f64(held[k]);
            }
        }
    }
}

/// Adds the wishes of some blocks, each times its share.
struct Add<'a, R> {
    wishes: &'a [R],
    shares: &'a [R],
    sums: &'a mut [R],
}

impl<R: Float> Kernel for Add<'_, R> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) {
        self.sums.fill(R::default());
        let lanes = R::lanes::<S>();
        let blocks = self.wishes.chunks_exact(self.sums.len()).zip(self.shares.chunks_exact(BLOCK));
        for (wishes, shares) in blocks {
            for (wishes, sums) in wishes.chunks_exact(BLOCK).zip(self.sums.chunks_exact_mut(BLOCK)) {
                for at in (0..BLOCK).step_by(lanes) {
                    let share = Lanes::<S, R>::from_slice(simd, &shares[at..]);
                    let sum = Lanes::from_slice(simd, &sums[at..]);
                    Lanes::from_slice(simd, &wishes[at..]).mul_add(share, sum).copy_to_slice(&mut sums[at..]);
                }
            }
        }
    }
}

/// One block by given wishes.
pub(crate) struct Alone<'a, R, const M: usize> {
    pub model: &'a Model<R, M>,
    pub begin: &'a Begin,
    pub wishes: &'a [R],
    pub track: &'a mut [R],
    pub motions: &'a mut [R],
}

impl<R: Float, const M: usize> Kernel for Alone<'_, R, M> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) {
        let mut costs = [R::default(); BLOCK];
        for at in (0..BLOCK).step_by(Model::<R, M>::abreast::<S>()) {
            let (begin, record) = (self.begin, Some(&mut *self.motions));
            self.model.drive(simd, begin, at, self.wishes, self.track, &mut costs, record);
        }
    }
}

impl<R: Float, const M: usize> Engine for Machine<R, M> {
    fn roll(
        &mut self,
        job: &RolloutInput,
        map: Option<&Costmap>,
        path: &Path,
        settings: &Settings,
        workers: Workers,
    ) -> Result<(), Error> {
        let steps = settings.steps;
        let row = steps * M * BLOCK;
        let blocks = self.costs.len() / BLOCK;
        if job.has_path {
            path.write(job.start, &mut self.path);
        } else {
            self.path.clear();
        }
        let judge = Judge {
            map,
            points: &settings.points,
            start: job.start,
            goal: job.goal,
            path: &self.path,
            spacing: path.spacing(),
            length: path.length(),
            progress: job.progress,
            weights: settings.weights,
            dt: settings.dt,
        };
        let kept = if job.record { blocks } else { 0 };
        self.motions.resize(kept * row, R::default());
        self.tracks.resize(kept * steps * TRACK * BLOCK, R::default());
        let share = blocks.div_ceil(workers.threads.clamp(1, blocks));
        let hands = blocks.div_ceil(share);
        while self.rooms.len() < hands {
            let room = ThreadScratch { noise: vec![0.0; row], track: vec![R::default(); steps * TRACK * BLOCK] };
            self.rooms.push(room);
        }
        self.costs.fill(R::default());
        let parts = self.wishes.chunks_mut(share * row).zip(self.costs.chunks_mut(share * BLOCK));
        let parts = parts.zip(self.rooms.iter_mut());
        let mut motions = self.motions.chunks_mut((share * row).max(1));
        let mut tracks = self.tracks.chunks_mut((share * steps * TRACK * BLOCK).max(1));
        let model = &self.model;
        let jobs = parts.enumerate().map(|(k, ((wishes, costs), room))| Roll {
            model,
            judge: &judge,
            job,
            steps,
            first: k * share * BLOCK,
            wishes,
            costs,
            motions: motions.next().unwrap_or_default(),
            tracks: tracks.next().unwrap_or_default(),
            room,
        });
        each(jobs, |roll| {
            workers.level.run_any(roll);
            Ok(())
        })
    }

    fn costs(&self, to: &mut Vec<f64>) {
        to.clear();
        to.extend(self.costs.iter().map(|cost| cost.to_f64()));
    }

    fn mean(&mut self, weights: &[f64], settings: &Settings, workers: Workers, to: &mut [f64]) -> Result<(), Error> {
        let row = settings.steps * M * BLOCK;
        for (share, weight) in self.shares.iter_mut().zip(weights) {
            *share = R::from_f64(*weight);
        }
        let blocks = self.costs.len() / BLOCK;
        let part = blocks.div_ceil(STRIPES);
        self.sums.fill(R::default());
        let parts = self.wishes.chunks(part * row).zip(self.shares.chunks(part * BLOCK));
        let jobs =
            parts.zip(self.sums.chunks_exact_mut(row)).map(|((wishes, shares), sums)| Add { wishes, shares, sums });
        let work = |add: Add<'_, R>| {
            workers.level.run_any(add);
            Ok(())
        };
        if workers.threads > 1 {
            each(jobs, work)?;
        } else {
            let mut jobs = jobs;
            jobs.try_for_each(work)?;
        }
        for (k, to) in to.iter_mut().enumerate() {
            let rows = self.sums.chunks_exact(row).map(|sums| &sums[k * BLOCK..(k + 1) * BLOCK]);
            *to = rows.flatten().map(|part| part.to_f64()).sum();
        }
        Ok(())
    }

    fn nominal(
        &mut self,
        job: &RolloutInput,
        wishes: &[f64],
        settings: &Settings,
        level: Level,
        motions: &mut [f64],
        places: &mut [f64],
    ) {
        let row = settings.steps * M * BLOCK;
        // The room of the sums is as large as a block's wishes.
        let (all, rest) = self.sums.split_at_mut(row);
        for (all, wish) in all.chunks_exact_mut(BLOCK).zip(wishes) {
            all.fill(R::from_f64(*wish));
        }
        let Some(room) = self.rooms.first_mut() else {
            return;
        };
        let alone = Alone {
            model: &self.model,
            begin: &job.begin,
            wishes: all,
            track: &mut room.track,
            motions: &mut rest[..row],
        };
        level.run_any(alone);
        for (to, from) in motions.iter_mut().zip(rest.chunks_exact(BLOCK)) {
            *to = from[0].to_f64();
        }
        read(&room.track, 0, places);
    }

    fn recorded(&self, rollout: usize, settings: &Settings, motions: &mut [f64], places: &mut [f64]) {
        let (block, lane) = (rollout / BLOCK, rollout % BLOCK);
        let row = settings.steps * M * BLOCK;
        for (to, from) in motions.iter_mut().zip(self.motions[block * row..].chunks_exact(BLOCK)) {
            *to = from[lane].to_f64();
        }
        read(&self.tracks[block * settings.steps * TRACK * BLOCK..], lane, places);
    }

    fn wishes(&self, rollout: usize, settings: &Settings, to: &mut [f64]) {
        let (block, lane) = (rollout / BLOCK, rollout % BLOCK);
        let row = settings.steps * M * BLOCK;
        for (to, from) in to.iter_mut().zip(self.wishes[block * row..].chunks_exact(BLOCK)) {
            *to = from[lane].to_f64();
        }
    }
}

/// Places of one rollout of a track.
fn read<R: Float>(track: &[R], lane: usize, places: &mut [f64]) {
    for (place, step) in places.chunks_exact_mut(2).zip(track.chunks_exact(TRACK * BLOCK)) {
        (place[0], place[1]) = (step[lane].to_f64(), step[BLOCK + lane].to_f64());
    }
}
