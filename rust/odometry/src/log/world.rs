//! A register of steps in world axes, and their covariances.

use super::block::LogBlock;
use super::body::Sums;
use super::in_parts;
use super::lagged_column::{LaggedColumn, all};
use super::scratch::BlockScratch;
use crate::propagation::arc::{Arc, StepJacobian, propagate_error};
use crate::propagation::covariance::Covariance3;
use crate::propagation::fusion::bias_covariance_increment;
use crate::step::StepConstants;
use crate::step::sums::{PARTS, add_parts};
use six_wheel_kinematics::kernels::wheel_lanes::GROUP;
use six_wheel_numerics::columns::{load, store};
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::polynomials::sin_cos;
use six_wheel_numerics::simd::vector::Vector;

/// Rotates a register of steps, with their errors, to world axes.
#[inline(always)]
pub(crate) fn world_step<S: Vector>(
    simd: S,
    has_gyroscope: bool,
    k: usize,
    scratch: &mut BlockScratch,
    block: &mut LogBlock,
) {
    let displacement = load(simd, &block.displacement, k);
    let (sin, cos) = sin_cos(simd, block.heading.load(simd, k));
    let arc = Arc::new(simd, displacement[2] * Lanes::splat(simd, 0.5));
    let jacobian = StepJacobian::new(displacement, arc, [sin, cos]);
    for columns in [&mut block.own, &mut block.open] {
        let covariance = Covariance3::from(load(simd, columns, k));
        store(covariance.displacement_image(&jacobian.by_displacement).into(), columns, k);
    }
    for ends in &mut scratch.ends {
        displacement_error(&jacobian, ends, k);
    }
    if has_gyroscope {
        displacement_error(&jacobian, &mut scratch.by_gyroscope, k);
        let [x, y, z] = load(simd, &block.by_bias, k);
        let dt = -block.dt.load(simd, k);
        store(jacobian.displacement_error([x * dt, y * dt, z * dt]), &mut block.by_bias, k);
    }
    store(jacobian.yaw_lever(), &mut block.lever, k);
    let [east, north] = jacobian.shift;
    block.poses[0].store(k, east);
    block.poses[1].store(k, north);
}

/// Replaces errors of displacements by the errors of the pose at the end of their steps.
#[inline(always)]
fn displacement_error<S: Vector>(jacobian: &StepJacobian<S>, errors: &mut [LaggedColumn; 3], k: usize) {
    let ended = jacobian.displacement_error(all(jacobian.shift[0].simd(), errors, k, 0));
    for (end, column) in ended.into_iter().zip(errors) {
        column.store(k, end);
    }
}

/// Adds the steps of a register to the settled part of the pose's covariance.
#[inline(always)]
pub(crate) fn add_covariance<S: Vector>(
    simd: S,
    constants: &StepConstants,
    sums: &mut Sums<S>,
    has_gyroscope: bool,
    k: usize,
    scratch: &BlockScratch,
    block: &mut LogBlock,
) {
    let lever = load(simd, &block.lever, k);
    let mut sum = Covariance3::zero(simd);
    in_parts!(
        constants,
        steered,
        |part, g, group, place| {
            let ends = &scratch.ends[g * GROUP + place];
            let (before, end) = (all(simd, ends, k, 1), all(simd, ends, k, 0));
            sum = sum.and_square(propagate_error(lever, before, end));
        },
        {
            sums.six[part] = sum.into();
            sum = Covariance3::zero(simd);
        }
    );
    let mut whole = Covariance3::from(add_parts(sums.six, PARTS));
    let mut own = Covariance3::from(load(simd, &block.own, k));
    if has_gyroscope {
        let ends = &scratch.by_gyroscope;
        let (before, end) = (all(simd, ends, k, 1), all(simd, ends, k, 0));
        whole = whole.and_square(propagate_error(lever, before, end));
    }
    own = own.and(whole);
    if has_gyroscope {
        let (cross, by_bias) = (load(simd, &block.cross, k), load(simd, &block.by_bias, k));
        own = own.and(bias_covariance_increment(lever, cross, by_bias, block.bias.load(simd, k)));
    }
    store(own.into(), &mut block.own, k);
}
