//! A register of steps in body axes: displacements, their covariances and the fusion with a gyroscope.

use super::block::{LogBlock, Rows};
use super::in_parts;
use super::lagged_column::all;
use super::scratch::BlockScratch;
use crate::motion::{ROUNDING, SUSPICIOUS};
use crate::propagation::covariance::Covariance3;
use crate::propagation::fusion::{GyroscopeIncrement, remaining_covariance, remaining_error};
use crate::step::StepConstants;
use crate::step::sums::{PARTS, add_parts};
use crate::step::terms::{NoiseTerms, gyroscope_deviation};
use crate::step::wheels::{Broadcast, LaneSource, Register, accumulate_displacement, accumulate_noise, steering_error};
use six_wheel_kinematics::kernels::wheel_lanes::GROUP;
use six_wheel_numerics::columns::store;
use six_wheel_numerics::error::HUGE;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;

/// Parts of sums of three or six numbers. The memory is shared by all sums, which write it before they read it.
pub(crate) struct Sums<S: Vector> {
    pub three: [[Lanes<S>; 3]; PARTS],
    pub six: [[Lanes<S>; 6]; PARTS],
}

impl<S: Vector> Sums<S> {
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        Self { three: [[zero; 3]; PARTS], six: [[zero; 6]; PARTS] }
    }
}

/// Computes a register of steps in body axes. Returns false if the readings of one of them have to be checked.
#[inline(always)]
pub(crate) fn body_step<S: Vector>(
    simd: S,
    constants: &StepConstants,
    sums: &mut Sums<S>,
    rows: &Rows<'_>,
    k: usize,
    scratch: &mut BlockScratch,
    block: &mut LogBlock,
) -> bool {
    let splat = |number| Lanes::splat(simd, number);
    let dt = block.dt.load(simd, k);
    let terms = NoiseTerms::new(rows.settings, dt, false);
    let (mut displacement, is_fine) = sum_displacement(simd, constants, sums, &terms, k, scratch);
    let (mut own, slips) = sum_noise(simd, constants, sums, &terms, displacement, scratch);
    block.slips.store(k, slips.select(splat(1.0), splat(0.0)));
    let mut open = steering_covariance(simd, constants, sums, &terms, k, scratch);
    if rows.has_gyroscope {
        [own, open] = fuse_gyroscope(simd, rows, [own, open], &mut displacement, k, scratch, block);
    }
    let [x, y, yaw] = displacement;
    let twist = [x / dt, y / dt, yaw / dt];
    let mut is_fine = is_fine & splat(f64::MIN_POSITIVE).le(dt) & dt.le(splat(f64::MAX));
    for (part, rate) in displacement.into_iter().zip(twist) {
        is_fine = is_fine & part.abs().lt(splat(HUGE)) & rate.abs().le(splat(f64::MAX));
    }
    for variance in own.and(open.and(open)).diagonal() {
        is_fine = is_fine & variance.abs().lt(splat(HUGE));
    }
    if (!is_fine).any() {
        return false;
    }
    let per_second = splat(1.0) / dt;
    for (g, group) in constants.groups.iter().enumerate() {
        for place in 0..group.count {
            let slid = Register(simd, 0).of(&scratch.places[g * GROUP + place].slid);
            scratch.wheels[group.wheels[place]].store(k, slid * per_second);
        }
    }
    store(displacement, &mut block.displacement, k);
    store(twist, &mut block.twists, k);
    store(own.into(), &mut block.own, k);
    store(open.into(), &mut block.open, k);
    true
}

/// Fuses displacements and the errors of joints with a gyroscope. Returns the covariances after the fusion.
#[inline(always)]
fn fuse_gyroscope<S: Vector>(
    simd: S,
    rows: &Rows<'_>,
    [own, open]: [Covariance3<Lanes<S>>; 2],
    displacement: &mut [Lanes<S>; 3],
    k: usize,
    scratch: &mut BlockScratch,
    block: &mut LogBlock,
) -> [Covariance3<Lanes<S>>; 2] {
    let dt = block.dt.load(simd, k);
    let gyroscope = GyroscopeIncrement {
        is_read: block.is_read.load(simd, k),
        turn: block.turn.load(simd, k),
        deviation: gyroscope_deviation(rows.settings, dt),
        bias_variance: block.bias.load(simd, k),
    };
    let gain = gyroscope.kalman_gain(own.and(open.and(open)), dt);
    *displacement = gyroscope.posterior_displacement(gain, *displacement);
    for ends in &mut scratch.ends {
        let half = remaining_error(gain, all(simd, ends, k, 0));
        for (column, half) in ends.iter_mut().zip(half) {
            column.store(k, half);
        }
    }
    let error = gyroscope.error(gain);
    for (end, error) in scratch.by_gyroscope.iter_mut().zip(error) {
        end.store(k, error);
    }
    store(gain, &mut block.by_bias, k);
    [remaining_covariance(gain, own), remaining_covariance(gain, open).and_square(error)]
}

/// The least-squares displacements in body axes, and the lanes whose readings need no check.
#[inline(always)]
fn sum_displacement<S: Vector>(
    simd: S,
    constants: &StepConstants,
    sums: &mut Sums<S>,
    terms: &NoiseTerms<S>,
    k: usize,
    scratch: &mut BlockScratch,
) -> ([Lanes<S>; 3], Mask<S>) {
    let zero = Lanes::splat(simd, 0.0);
    let joints = scratch.joints.len() / 2;
    let mut is_fine = Mask::splat(simd, true);
    let mut sum = [zero; 3];
    in_parts!(
        constants,
        count,
        |part, g, group, place| {
            let mut joint = None;
            if place < group.steered {
                let (middles, increments) = scratch.joints.split_at(joints);
                let column = g * GROUP + place;
                joint = Some([middles[column].load(simd, k), increments[column].load(simd, k)]);
            }
            let wheel = (group, Broadcast(simd, place));
            let turned = scratch.wheels[group.wheels[place]].load(simd, k) * wheel.1.of(&group.per_count[0]);
            let to = (&mut scratch.places[g * GROUP + place], 0);
            is_fine = is_fine & accumulate_displacement(simd, wheel, turned, joint, terms, &mut sum, to);
        },
        {
            sums.three[part] = sum;
            sum = [zero; 3];
        }
    );
    (add_parts(sums.three, PARTS), is_fine)
}

/// Covariances of the displacements by errors of their steps alone, and the steps in which a wheel slid further than
/// the noise explains.
#[inline(always)]
fn sum_noise<S: Vector>(
    simd: S,
    constants: &StepConstants,
    sums: &mut Sums<S>,
    terms: &NoiseTerms<S>,
    displacement: [Lanes<S>; 3],
    scratch: &mut BlockScratch,
) -> (Covariance3<Lanes<S>>, Mask<S>) {
    let mut suspects = Mask::splat(simd, false);
    let mut sum = Covariance3::zero(simd);
    in_parts!(
        constants,
        count,
        |part, g, group, place| {
            let wheel = (group, &group.constant, Broadcast(simd, place));
            let to = (&mut scratch.places[g * GROUP + place], 0);
            suspects = suspects | accumulate_noise(simd, wheel, displacement, terms, &mut sum, to);
        },
        {
            sums.six[part] = sum.into();
            sum = Covariance3::zero(simd);
        }
    );
    if terms.slip_bound.is_none() && suspects.any() {
        suspects = beyond_rounding(simd, scratch, suspects);
    }
    (add_parts(sums.six, PARTS).into(), suspects)
}

/// Covariances of the displacements by the joints' readings at one end, and their errors.
#[inline(always)]
fn steering_covariance<S: Vector>(
    simd: S,
    constants: &StepConstants,
    sums: &mut Sums<S>,
    terms: &NoiseTerms<S>,
    k: usize,
    scratch: &mut BlockScratch,
) -> Covariance3<Lanes<S>> {
    let mut sum = Covariance3::zero(simd);
    in_parts!(
        constants,
        steered,
        |part, g, group, place| {
            let wheel = (group, Broadcast(simd, place));
            let half = steering_error(simd, wheel, terms, (&scratch.places[g * GROUP + place], 0));
            sum = sum.and_square(half);
            for (half, column) in half.into_iter().zip(&mut scratch.ends[g * GROUP + place]) {
                column.store(k, half);
            }
        },
        {
            sums.six[part] = sum.into();
            sum = Covariance3::zero(simd);
        }
    );
    add_parts(sums.six, PARTS).into()
}

/// True in the steps in which a wheel slid further than the noise and the rounding of the others' fit explain.
#[inline(always)]
fn beyond_rounding<S: Vector>(simd: S, scratch: &BlockScratch, suspects: Mask<S>) -> Mask<S> {
    let here = Register(simd, 0);
    let splat = |number| Lanes::splat(simd, number);
    let mut furthest = splat(0.0);
    for place in &scratch.places {
        furthest = furthest.max(here.of(&place.rolled).abs());
    }
    let mut slips = Mask::splat(simd, false);
    for place in &scratch.places {
        let explained = splat(SUSPICIOUS) * here.of(&place.variance).sqrt();
        let bound = explained + splat(ROUNDING) * furthest;
        slips = slips | bound.lt(here.of(&place.slid));
    }
    slips & suspects
}
