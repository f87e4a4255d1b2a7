//! Memory of a block of a log that is the same for every rover, and the output of its rows.

use std::ops::Range;

use super::scratch::BlockScratch;
use crate::propagation::covariance::Covariance3;
use crate::samples::recording::TrackRows;
use crate::settings::Settings;
use crate::uncertainty::{ROUNDING, rounded};
use six_wheel_numerics::columns::{Column, load, store, transpose_to_rows};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::level::Kernel;
use six_wheel_numerics::simd::vector::Vector;

/// Rows of a log, with the one before them.
#[derive(Clone, Copy)]
pub(crate) struct Rows<'a> {
    /// Readings of the wheels, in units of their encoders.
    pub wheels: &'a [f64],
    /// Readings of the steering joints, in units of their encoders.
    pub steering: &'a [f64],
    /// [s]
    pub stamps: &'a [f64],
    pub settings: &'a Settings,
    /// True if a gyroscope is fused in these rows, or was in the row before; its columns are in the block.
    pub has_gyroscope: bool,
}

/// Memory of a block that is the same for every rover.
#[derive(Default)]
pub struct LogBlock {
    /// Duration of every step [s].
    pub dt: Column,
    /// 1 where a wheel slid further than the noise explains.
    pub slips: Column,
    /// Gyroscope of every step, in the fields of
    /// [`GyroscopeIncrement`](crate::propagation::fusion::GyroscopeIncrement): 1 where one is read, yaw increment
    /// [rad], variance of the bias [rad²/s²].
    pub is_read: Column,
    pub turn: Column,
    pub bias: Column,
    /// Gain of the gyroscope; then the derivative of the end of the step by the bias [m s, m s, s].
    pub(crate) by_bias: [Column; 3],
    /// Covariance of the bias with the pose at the start of the step.
    pub(crate) cross: [Column; 3],
    /// In body axes [m, m, rad].
    pub(crate) displacement: [Column; 3],
    /// [m/s, m/s, rad/s]
    pub(crate) twists: [Column; 3],
    /// Covariance by errors of the step alone: of the displacement in body axes; then of its end in world axes; then
    /// the settled part of the covariance of the pose.
    pub(crate) own: [Column; 6],
    /// Covariance by errors of the joints' readings at one end; then the open part of the covariance of the pose.
    pub(crate) open: [Column; 6],
    /// At the start of the step [rad].
    pub(crate) heading: Column,
    /// Displacement of every step in world axes; then the pose [m, m, rad].
    pub(crate) poses: [Column; 3],
    /// Derivative of the end position by the yaw at the start [m].
    pub(crate) lever: [Column; 2],
    /// Covariance of the pose, whole matrices.
    pub(crate) covariances: [Column; 9],
}

/// A row of columns.
#[inline(always)]
pub(crate) fn at<const N: usize>(columns: &[Column; N], row: usize) -> [f64; N] {
    let mut numbers = [0.0; N];
    for (number, column) in numbers.iter_mut().zip(columns) {
        *number = column.0[row];
    }
    numbers
}

impl LogBlock {
    /// Writes the integrated rows to the track.
    #[inline]
    pub fn write(&mut self, scratch: &BlockScratch, rows: Range<usize>, wheels: usize, track: &mut TrackRows<'_>) {
        let write = Write { block: self, scratch, rows, wheels, track };
        scratch.level.run_any(write);
    }

    /// Copies the residuals of a step [m/s].
    pub fn last_residual(&self, scratch: &BlockScratch, row: usize, residual: &mut [f64]) {
        for (residual, column) in residual.iter_mut().zip(&scratch.wheels) {
            *residual = column.0[row];
        }
    }
}

struct Write<'a, 'b> {
    block: &'a mut LogBlock,
    scratch: &'a BlockScratch,
    rows: Range<usize>,
    wheels: usize,
    track: &'a mut TrackRows<'b>,
}

impl Kernel for Write<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) {
        let Self { block, scratch, rows, wheels, track } = self;
        let poses = track.poses[rows.clone()].as_flattened_mut();
        transpose_to_rows(simd, &block.poses, poses);
        transpose_to_rows(simd, &block.twists, track.twists[rows.clone()].as_flattened_mut());
        if let Some(residuals) = &mut track.residuals {
            let residuals = &mut residuals[rows.start * wheels..rows.end * wheels];
            transpose_to_rows(simd, &scratch.wheels, residuals);
        }
        if let Some(covariances) = &mut track.covariances {
            for k in 0..rows.len().div_ceil(S::F64_LANES) {
                report_covariance(simd, k, rows.len(), block);
            }
            transpose_to_rows(simd, &block.covariances, covariances[rows].as_flattened_mut());
        }
    }
}

/// A register of covariances of the pose, without a negative variance in any direction.
#[inline(always)]
fn report_covariance<S: Vector>(simd: S, k: usize, rows: usize, block: &mut LogBlock) {
    let (settled, open) = (load(simd, &block.own, k), load(simd, &block.open, k));
    let rounding = Lanes::splat(simd, ROUNDING);
    let covariance = rounded(Covariance3::from(settled).and(open.into()), rounding);
    let zero = Lanes::splat(simd, 0.0);
    let mut negative = Mask::splat(simd, false);
    for minor in covariance.minors() {
        negative = negative | minor.lt(zero);
    }
    let [xx, xy, xz, yy, yz, zz] = covariance.into();
    store([xx, xy, xz, xy, yy, yz, xz, yz, zz], &mut block.covariances, k);
    if negative.any() {
        for row in k * S::F64_LANES..rows.min((k + 1) * S::F64_LANES) {
            let [xx, xy, xz, _, yy, yz, _, _, zz] = at(&block.covariances, row);
            let covariance = Covariance3::from([xx, xy, xz, yy, yz, zz]);
            if covariance.may_be_negative() {
                let matrix: [[f64; 3]; 3] = covariance.without_negative().matrix().into();
                for (part, column) in matrix.as_flattened().iter().zip(&mut block.covariances) {
                    column.0[row] = *part;
                }
            }
        }
    }
}
