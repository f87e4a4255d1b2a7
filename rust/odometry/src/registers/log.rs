//! Steps of a log: the lanes of a register are successive steps.
//!
//! Every sum over wheels has as many parts as a sample's registers have lanes, wheel by wheel the same one, and the parts
//! are added as a register's lanes are. What depends on the step before goes from row to row in between: angles of joints
//! and the heading, which are sums, and at the end the pose and its covariance. So a row's bits are those of a sample alone.

mod block;
mod columns;
mod lagged_column;
mod scratch;

pub(crate) use block::{LogBlock, Rows};
use block::{at, load, store};
use columns::split_columns;
use lagged_column::{LEAD, LaggedColumn, all, row};
pub(crate) use scratch::BlockScratch;

use super::plan::StepConstants;
use super::wheels::{
    Broadcast, InLanes, LaneSource, Register, Squares, accumulate_displacement, accumulate_noise, steering_error,
};
use crate::arithmetic::Fused;
use crate::motion::{ROUNDING, SUSPICIOUS};
use crate::settings::Settings;
use crate::spread::Covariance3;
use crate::state::State;
use crate::step::{SMALL_TURN, small_bend, step_jacobian};
use crate::uncertainty::{
    Bias, GyroscopeIncrement, StepJacobian, StepNoise, bias_covariance, fused_displacement, gain, propagate_error,
    remaining_covariance, remaining_error,
};
use six_wheel_kinematics::kernels::wheel_lanes::GROUP;
use six_wheel_numerics::error::HUGE;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::level::Kernel;
use six_wheel_numerics::simd::polynomials::sin_cos;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::weave::BLOCK;

/// Parts of a sum over wheels: the lanes of the registers of one sample.
const PARTS: usize = if cfg!(target_arch = "aarch64") { 2 } else { 4 };

/// Sums of three or six numbers, part by part: room that every sum writes before it reads it.
struct Sums<S: Vector> {
    three: [[Lanes<S>; 3]; PARTS],
    six: [[Lanes<S>; 6]; PARTS],
}

/// Integrates rows of a log, from these angles of the joints on, as far as they are usual. Only the state and the noise
/// of the last step change.
pub(crate) struct LogIntegrator<'a> {
    pub plan: &'a StepConstants,
    pub rows: Rows<'a>,
    pub angles: &'a [f64],
    pub room: &'a mut BlockScratch,
    pub block: &'a mut LogBlock,
    pub state: &'a mut State,
    pub noise: &'a mut StepNoise,
}

impl LogIntegrator<'_> {
    /// Integrates the rows and returns the number of usual ones.
    pub fn go(self) -> usize {
        let level = self.room.level;
        level.run(self).unwrap_or(0)
    }
}

impl Kernel for LogIntegrator<'_> {
    type Output = usize;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> usize {
        let Self { plan, rows, angles, room, block, state, noise } = self;
        debug_assert_eq!(plan.level.lanes(), PARTS);
        let lanes = S::F64_LANES;
        let zero = Lanes::splat(simd, 0.0);
        let mut sums = Sums { three: [[zero; 3]; PARTS], six: [[zero; 6]; PARTS] };
        let count = rows.stamps.len() - 1;
        split_columns(simd, &rows, angles, count, room, block);
        let mut usual = 0;
        while usual < count && step(simd, plan, &mut sums, &rows, usual / lanes, room, block) {
            usual += lanes;
        }
        let usual = usual.min(count);
        let registers = usual.div_ceil(lanes);
        let Some(last) = usual.checked_sub(1) else {
            return 0;
        };
        let ends = Covariance3::from(at(&block.open, last));
        (noise.own, noise.ends) = (Covariance3::from(at(&block.own, last)), ends.and(ends));
        for k in 0..usual.min(BLOCK) {
            block.heading.0[k] = state.walk.heading.value();
            state.walk.turn(block.displacement[2].0[k]);
            block.poses[2].0[k] = state.walk.yaw.value();
        }
        for (ends, carried) in room.ends.iter_mut().zip(&state.uncertainty.carried) {
            for (end, carried) in ends.iter_mut().zip(carried) {
                end.0[LEAD - 1] = *carried;
            }
        }
        if let Some(column) = state.uncertainty.carried.last().filter(|_| rows.leans) {
            for (end, column) in room.by_gyroscope.iter_mut().zip(column) {
                end.0[LEAD - 1] = *column;
            }
        }
        for k in 0..registers {
            place(simd, rows.leans, k, room, block);
        }
        if rows.leans {
            propagate_bias(rows.settings, usual, block, &mut state.uncertainty.bias);
        }
        for k in 0..registers {
            add_covariance(simd, plan, &mut sums, rows.leans, k, room, block);
        }
        sum(usual, block, state);
        for (ends, carried) in room.ends.iter().zip(&mut state.uncertainty.carried) {
            *carried = row(ends, last);
        }
        if let Some(column) = state.uncertainty.carried.last_mut().filter(|_| rows.leans) {
            *column = row(&room.by_gyroscope, last);
        }
        let smoothing = rows.settings.smoothing;
        let from = if smoothing > 0.0 { 0 } else { last };
        for k in from..usual {
            state.hold(at(&block.twists, k).into(), block.dt.0[k], smoothing);
        }
        usual
    }
}

/// Goes over the places of a plan in parts, as the lanes of a sample's registers do, `$of` each group; `$done` after each part.
macro_rules! in_parts {
    ($plan: ident, $of: ident, |$part: ident, $g: ident, $group: ident, $place: ident| $each: block, $done: block) => {
        for $part in 0..PARTS {
            for ($g, $group) in $plan.groups.iter().enumerate() {
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

/// Sum of the parts, added in the order of a register's lanes.
#[inline(always)]
fn total<S: Vector, const N: usize>(mut sums: [[Lanes<S>; N]; PARTS]) -> [Lanes<S>; N] {
    let mut parts = PARTS;
    while parts > 1 {
        parts /= 2;
        for i in 0..parts {
            let others = sums[i + parts];
            for (sum, other) in sums[i].iter_mut().zip(others) {
                *sum = *sum + other;
            }
        }
    }
    sums[0]
}

/// Makes a register of steps in body axes; true if all of them are usual.
#[inline(always)]
fn step<S: Vector>(
    simd: S,
    plan: &StepConstants,
    sums: &mut Sums<S>,
    rows: &Rows<'_>,
    k: usize,
    room: &mut BlockScratch,
    block: &mut LogBlock,
) -> bool {
    let splat = |number| Lanes::splat(simd, number);
    let zero = splat(0.0);
    let dt = block.dt.load(simd, k);
    let by = InLanes(simd);
    let terms = rows.settings.terms(by, dt);
    let mut usual = splat(f64::MIN_POSITIVE).at_most(dt) & dt.at_most(splat(f64::MAX));
    let joints = room.joints.len() / 2;
    let mut said = [zero; 3];
    in_parts!(
        plan,
        count,
        |part, g, group, place| {
            let mut joint = None;
            if place < group.steered {
                let (middles, turns) = room.joints.split_at(joints);
                let column = g * GROUP + place;
                joint = Some([middles[column].load(simd, k), turns[column].load(simd, k)]);
            }
            let counts = room.wheels[group.wheels[place]].load(simd, k);
            let wheel = (group, Broadcast(simd, place));
            let to = (&mut room.places[g * GROUP + place], 0);
            usual = usual & accumulate_displacement(simd, wheel, counts, joint, terms.most, &mut said, to);
        },
        {
            sums.three[part] = said;
            said = [zero; 3];
        }
    );
    let mut displacement = total(sums.three);
    let mut suspects = zero.below(zero);
    let mut squares = Squares::new(simd);
    in_parts!(
        plan,
        count,
        |part, g, group, place| {
            let wheel = (group, Broadcast(simd, place));
            let to = (&mut room.places[g * GROUP + place], 0);
            suspects = suspects | accumulate_noise(simd, wheel, displacement, &terms, &mut squares, to);
        },
        {
            sums.six[part] = squares.0;
            squares = Squares::new(simd);
        }
    );
    let mut own = total(sums.six);
    if terms.slip_bound.is_none() && suspects.any() {
        suspects = beyond_rounding(simd, room, suspects);
    }
    block.slips.store(k, suspects.select(splat(1.0), zero));
    in_parts!(
        plan,
        steered,
        |part, g, group, place| {
            let wheel = (group, Broadcast(simd, place));
            let half = steering_error(simd, wheel, &terms, (&room.places[g * GROUP + place], 0));
            squares.add_square(half);
            for (half, column) in half.into_iter().zip(&mut room.ends[g * GROUP + place]) {
                column.store(k, half);
            }
        },
        {
            sums.six[part] = squares.0;
            squares = Squares::new(simd);
        }
    );
    let mut open = total(sums.six);
    if rows.leans {
        let turned = GyroscopeIncrement {
            says: block.says.load(simd, k),
            turn: block.turn.load(simd, k),
            deviation: rows.settings.turn_deviation(by, dt),
            bias_variance: block.bias.load(simd, k),
        };
        let (wheels, ends) = (Covariance3::from(own), Covariance3::from(open));
        let (gain, variance) = gain(by, &turned, wheels.and(ends.and(ends)), dt);
        usual = usual & zero.below(variance);
        displacement = fused_displacement(by, gain, displacement, turned.turn);
        for ends in &mut room.ends {
            let half = remaining_error(by, gain, all(simd, ends, k, 0));
            for (column, half) in ends.iter_mut().zip(half) {
                column.store(k, half);
            }
        }
        let column = [gain[0] * turned.deviation, gain[1] * turned.deviation, gain[2] * turned.deviation];
        for (end, column) in room.by_gyroscope.iter_mut().zip(column) {
            end.store(k, column);
        }
        own = remaining_covariance(by, gain, wheels).into();
        open = remaining_covariance(by, gain, ends).and_square(by, column).into();
        store(gain, &mut block.by_bias, k);
    }
    let [x, y, yaw] = displacement;
    let twist = [x.quotient(dt), y.quotient(dt), yaw.quotient(dt)];
    let huge = splat(HUGE);
    for (part, rate) in displacement.into_iter().zip(twist) {
        usual = usual & part.abs().below(huge) & rate.abs().at_most(splat(f64::MAX));
    }
    for variance in [own[0], own[3], own[5]] {
        usual = usual & variance.abs().below(huge);
    }
    let half = yaw * splat(0.5);
    usual = usual & half.abs().below(splat(SMALL_TURN));
    if (!usual).any() {
        return false;
    }
    let per = splat(1.0).quotient(dt);
    for (g, group) in plan.groups.iter().enumerate() {
        for place in 0..group.count {
            let slid = Register(simd, 0).of(&room.places[g * GROUP + place].slid);
            room.wheels[group.wheels[place]].store(k, slid * per);
        }
    }
    store(displacement, &mut block.displacement, k);
    store(twist, &mut block.twists, k);
    store(own, &mut block.own, k);
    store(open, &mut block.open, k);
    true
}

/// True in the steps in which a wheel slid further than the noise and the rounding of the others' fit explain.
#[inline(always)]
fn beyond_rounding<S: Vector>(simd: S, room: &BlockScratch, suspects: Mask<S>) -> Mask<S> {
    let here = Register(simd, 0);
    let splat = |number| Lanes::splat(simd, number);
    let mut furthest = splat(0.0);
    for place in &room.places {
        furthest = furthest.max(here.of(&place.rolled).abs());
    }
    let mut slips = furthest.below(furthest);
    for place in &room.places {
        let explained = splat(SUSPICIOUS) * here.of(&place.variance).sqrt();
        let bound = explained + splat(ROUNDING) * furthest;
        slips = slips | bound.below(here.of(&place.slid));
    }
    slips & suspects
}

/// A register of steps in world axes.
#[inline(always)]
fn place<S: Vector>(simd: S, leans: bool, k: usize, room: &mut BlockScratch, block: &mut LogBlock) {
    let by = InLanes(simd);
    let displacement = load(simd, &block.displacement, k);
    let (sin, cos) = sin_cos(simd, block.heading.load(simd, k));
    let bend = small_bend(by, displacement[2] * Lanes::splat(simd, 0.5));
    let jacobian: StepJacobian<Lanes<S>> = step_jacobian(by, displacement, bend, [sin, cos]);
    let matrix = jacobian.by_displacement;
    for columns in [&mut block.own, &mut block.open] {
        let spread = Covariance3::from(load(simd, columns, k));
        store(spread.displaced(by, &matrix).into(), columns, k);
    }
    for ends in &mut room.ends {
        end(by, &jacobian, ends, k);
    }
    if leans {
        end(by, &jacobian, &mut room.by_gyroscope, k);
        let [x, y, z] = load(simd, &block.by_bias, k);
        let dt = -block.dt.load(simd, k);
        let by_bias = jacobian.ended(by, [x * dt, y * dt, z * dt]);
        store(by_bias, &mut block.by_bias, k);
    }
    store(jacobian.lever(), &mut block.lever, k);
    let [east, north] = jacobian.shift;
    block.poses[0].store(k, east);
    block.poses[1].store(k, north);
}

/// Errors of the displacement that two steps share, at the end of the first.
#[inline(always)]
fn end<S: Vector>(by: InLanes<S>, jacobian: &StepJacobian<Lanes<S>>, errors: &mut [LaggedColumn; 3], k: usize) {
    let ended = jacobian.ended(by, all(by.0, errors, k, 0));
    for (end, column) in ended.into_iter().zip(errors) {
        column.store(k, end);
    }
}

/// The bias of a gyroscope goes along, row by row: its covariance with the pose at the start of every step.
#[inline(always)]
fn propagate_bias(settings: &Settings, count: usize, block: &mut LogBlock, bias: &mut Option<Bias>) {
    let Some(bias) = bias else { return };
    for k in 0..count {
        let cross: [f64; 3] = bias.cross.into();
        let (lever, by_bias) = (at(&block.lever, k), at(&block.by_bias, k));
        for (column, cross) in block.cross.iter_mut().zip(cross) {
            column.0[k] = cross;
        }
        bias.propagate(Fused, lever, by_bias, settings.wandered(block.dt.0[k]));
    }
}

/// A register of what steps add to what is settled of the pose's covariance.
#[inline(always)]
fn add_covariance<S: Vector>(
    simd: S,
    plan: &StepConstants,
    sums: &mut Sums<S>,
    leans: bool,
    k: usize,
    room: &BlockScratch,
    block: &mut LogBlock,
) {
    let by = InLanes(simd);
    let lever = load(simd, &block.lever, k);
    let mut squares = Squares::new(simd);
    in_parts!(
        plan,
        steered,
        |part, g, group, place| {
            let ends = &room.ends[g * GROUP + place];
            let (before, end) = (all(simd, ends, k, 1), all(simd, ends, k, 0));
            squares.add_square(propagate_error(by, lever, before, end));
        },
        {
            sums.six[part] = squares.0;
            squares = Squares::new(simd);
        }
    );
    let mut whole = Covariance3::from(total(sums.six));
    let mut own = Covariance3::from(load(simd, &block.own, k));
    if leans {
        let ends = &room.by_gyroscope;
        let (before, end) = (all(simd, ends, k, 1), all(simd, ends, k, 0));
        whole = whole.and_square(by, propagate_error(by, lever, before, end));
    }
    own = own.and(whole);
    if leans {
        let (cross, by_bias) = (load(simd, &block.cross, k), load(simd, &block.by_bias, k));
        own = own.and(bias_covariance(by, lever, cross, by_bias, block.bias.load(simd, k)));
    }
    store(own.into(), &mut block.own, k);
}

/// Sums that go from row to row: the pose, and the settled part of its covariance.
#[inline(always)]
fn sum(count: usize, block: &mut LogBlock, state: &mut State) {
    let uncertainty = &mut state.uncertainty;
    let mut settled = uncertainty.settled;
    for k in 0..count.min(BLOCK) {
        let lever = at(&block.lever, k);
        let added = Covariance3::from(at(&block.own, k));
        settled = settled.swung(Fused, lever).and(added);
        for (part, column) in <[f64; 6]>::from(settled).into_iter().zip(&mut block.own) {
            column.0[k] = part;
        }
        state.walk.shift(block.poses[0].0[k], block.poses[1].0[k]);
        block.poses[0].0[k] = state.walk.x.value();
        block.poses[1].0[k] = state.walk.y.value();
        uncertainty.carry_yaw_offset(lever);
    }
    if let Some(last) = count.checked_sub(1) {
        uncertainty.settle(settled, Covariance3::from(at(&block.open, last)));
    }
}
