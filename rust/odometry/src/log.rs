//! Steps of a log: the lanes of a register are successive steps.
//!
//! Every sum over wheels has the parts of the sum of one sample ([`crate::step::sums`]), each with the same wheels,
//! added in the same order. Quantities that depend on the step before are computed row by row: angles of joints and the
//! heading, which are sums, and at the end the pose and its covariance. So the bits of a row are those of an update by
//! one sample.

mod block;
mod body;
mod columns;
mod lagged_column;
mod scratch;
mod world;

use block::at;
pub(crate) use block::{LogBlock, Rows};
use body::{Sums, body_step};
use columns::split_columns;
use lagged_column::{LEAD, row};
pub(crate) use scratch::BlockScratch;
use world::{add_covariance, world_step};

use crate::propagation::covariance::{Covariance3, lane};
use crate::state::State;
use crate::step::StepConstants;
use crate::uncertainty::StepNoise;
use six_wheel_numerics::columns::BLOCK;
use six_wheel_numerics::simd::level::Kernel;
use six_wheel_numerics::simd::vector::Vector;

/// Loop over the wheels of each part of a sum, as the lanes of a sample's registers add them: over the first `$of`
/// (count or steered) lanes of each group; `$done` after each part.
macro_rules! in_parts {
    ($constants: ident, $of: ident, |$part: ident, $g: ident, $group: ident, $place: ident| $each: block, $done: block) => {
        for $part in 0..PARTS {
            for ($g, $group) in $constants.groups.iter().enumerate() {
                let mut $place = $part;
                while $place < $group.$of {
                    $each
                    $place += PARTS;
                }
            }
            $done
        }
    };
}
use in_parts;

/// Integrates rows of a log from these angles of the joints [rad], until the first one whose readings have to be
/// checked. Only the state and the noise of the last step change.
pub(crate) struct LogIntegrator<'a> {
    pub constants: &'a StepConstants,
    pub rows: Rows<'a>,
    pub angles: &'a [f64],
    pub scratch: &'a mut BlockScratch,
    pub block: &'a mut LogBlock,
    pub state: &'a mut State,
    pub noise: &'a mut StepNoise,
}

impl LogIntegrator<'_> {
    /// Integrates the rows and returns their number.
    pub fn integrate(self) -> usize {
        let level = self.scratch.level;
        level.run_any(self)
    }
}

impl Kernel for LogIntegrator<'_> {
    type Output = usize;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> usize {
        let Self { constants, rows, angles, scratch, block, state, noise } = self;
        let mut sums = Sums::new(simd);
        let total = rows.stamps.len() - 1;
        split_columns(simd, &rows, angles, total, scratch, block);
        let mut count = 0;
        while count < total && body_step(simd, constants, &mut sums, &rows, count / S::F64_LANES, scratch, block) {
            count += S::F64_LANES;
        }
        let count = count.min(total);
        let registers = count.div_ceil(S::F64_LANES);
        let Some(last) = count.checked_sub(1) else {
            return 0;
        };
        let ends = Covariance3::from(at(&block.open, last));
        (noise.own, noise.ends) = (Covariance3::from(at(&block.own, last)), ends.and(ends));
        load_state(state, rows.has_gyroscope, count, scratch, block);
        for k in 0..registers {
            world_step(simd, rows.has_gyroscope, k, scratch, block);
        }
        if rows.has_gyroscope {
            propagate_bias(&rows, count, block, state);
        }
        for k in 0..registers {
            add_covariance(simd, constants, &mut sums, rows.has_gyroscope, k, scratch, block);
        }
        accumulate_poses(count, block, state);
        store_state(&rows, last, scratch, block, state);
        count
    }
}

/// Writes headings at the start of every step, yaws at their ends, and the errors of readings before the first step.
#[inline(always)]
fn load_state(state: &mut State, has_gyroscope: bool, count: usize, scratch: &mut BlockScratch, block: &mut LogBlock) {
    for k in 0..count.min(BLOCK) {
        block.heading.0[k] = state.pose_sums.heading.value();
        state.pose_sums.turn(block.displacement[2].0[k]);
        block.poses[2].0[k] = state.pose_sums.yaw.value();
    }
    for (ends, carried) in scratch.ends.iter_mut().zip(&state.uncertainty.carried) {
        for (end, carried) in ends.iter_mut().zip(carried) {
            end.0[LEAD - 1] = *carried;
        }
    }
    if let Some(column) = state.uncertainty.carried.last().filter(|_| has_gyroscope) {
        for (end, column) in scratch.by_gyroscope.iter_mut().zip(column) {
            end.0[LEAD - 1] = *column;
        }
    }
}

/// Propagates the bias of a gyroscope, row by row: its covariance with the pose at the start of every step.
#[inline(always)]
fn propagate_bias(rows: &Rows<'_>, count: usize, block: &mut LogBlock, state: &mut State) {
    let Some(bias) = &mut state.uncertainty.bias else { return };
    for k in 0..count {
        let cross: [f64; 3] = bias.cross.into();
        let (lever, by_bias) = (at(&block.lever, k), at(&block.by_bias, k));
        for (column, cross) in block.cross.iter_mut().zip(cross) {
            column.0[k] = cross;
        }
        bias.propagate(lane(lever), lane(by_bias), rows.settings.bias_variance_increment(block.dt.0[k]));
    }
}

/// Sums from row to row: the position, and the settled part of the covariance.
#[inline(always)]
fn accumulate_poses(count: usize, block: &mut LogBlock, state: &mut State) {
    let uncertainty = &mut state.uncertainty;
    let mut settled = uncertainty.settled.lane();
    for k in 0..count.min(BLOCK) {
        let lever = lane(at(&block.lever, k));
        settled = settled.propagate(lever).and(Covariance3::from(at(&block.own, k)).lane());
        for (part, column) in <[f64; 6]>::from(settled.total()).into_iter().zip(&mut block.own) {
            column.0[k] = part;
        }
        state.pose_sums.shift(block.poses[0].0[k], block.poses[1].0[k]);
        block.poses[0].0[k] = state.pose_sums.x.value();
        block.poses[1].0[k] = state.pose_sums.y.value();
        uncertainty.propagate_yaw_offset(lever);
    }
    if let Some(last) = count.checked_sub(1) {
        uncertainty.settle(settled.total(), Covariance3::from(at(&block.open, last)));
    }
}

/// Sets the errors of readings and the twist of the state after the last step.
#[inline(always)]
fn store_state(rows: &Rows<'_>, last: usize, scratch: &BlockScratch, block: &LogBlock, state: &mut State) {
    for (ends, carried) in scratch.ends.iter().zip(&mut state.uncertainty.carried) {
        *carried = row(ends, last);
    }
    if let Some(column) = state.uncertainty.carried.last_mut().filter(|_| rows.has_gyroscope) {
        *column = row(&scratch.by_gyroscope, last);
    }
    let smoothing = rows.settings.smoothing;
    let first = if smoothing > 0.0 { 0 } else { last };
    for k in first..=last {
        state.hold_twist(at(&block.twists, k).into(), block.dt.0[k], smoothing);
    }
}
