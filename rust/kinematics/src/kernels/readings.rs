//! Readings of many rows, a row in every lane, block by block.

use super::normal_equations::{ForwardConstants, ReadingLanes};
use crate::table::Log;
use six_wheel_numerics::columns::{BLOCK, Column, store, transpose_to_columns};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::polynomials::sin_cos;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::stream::prefetch_ahead;

/// Readings of a block; no rates where none are given, or they do not matter.
#[derive(Clone, Copy)]
pub(crate) struct ReadingColumns<'a> {
    pub steering: &'a [Column],
    pub speeds: &'a [Column],
    pub rates: &'a [Column],
}

impl<'a> ReadingColumns<'a> {
    /// Columns of the readings of a block.
    #[inline(always)]
    pub fn load<S: Vector>(
        simd: S,
        constants: &ForwardConstants,
        log: Log<'_>,
        columns: &'a mut [Column],
    ) -> ReadingColumns<'a> {
        let (steering, rest) = columns.split_at_mut(constants.joints);
        let (speeds, rates) = rest.split_at_mut(constants.wheels.len());
        transpose_to_columns(simd, log.steering, steering);
        transpose_to_columns(simd, log.speeds, speeds);
        if !rates.is_empty() {
            transpose_to_columns(simd, log.steering_rates.unwrap_or_default(), rates);
        }
        ReadingColumns { steering, speeds, rates }
    }
}

/// Register `k` of a block.
#[derive(Clone, Copy)]
struct Register<'a> {
    columns: ReadingColumns<'a>,
    k: usize,
}

#[inline_always]
impl<'a, S: Vector> ReadingLanes<'a, S> for Register<'a> {
    type Cell = Column;

    fn speeds(self) -> &'a [Column] {
        self.columns.speeds
    }

    fn load(self, simd: S, cell: &Column) -> Lanes<S> {
        cell.load(simd, self.k)
    }

    fn store(self, cell: &mut Column, lanes: Lanes<S>) {
        cell.store(self.k, lanes);
    }

    fn angle(self, simd: S, joint: usize) -> Lanes<S> {
        self.columns.steering[joint].load(simd, self.k)
    }

    fn direction(self, simd: S, _: usize, angle: Lanes<S>, heading: f64) -> [Lanes<S>; 2] {
        let (sin, cos) = sin_cos(simd, angle + Lanes::splat(simd, heading));
        [sin, cos]
    }

    fn rate(self, simd: S, joint: usize) -> Option<Lanes<S>> {
        #[expect(clippy::manual_map, reason = "a closure over registers would be a call")]
        match self.columns.rates.get(joint) {
            Some(rate) => Some(rate.load(simd, self.k)),
            None => None,
        }
    }
}

/// Results of the least squares of a block that fits need beside its twists.
pub(crate) struct FitColumns<'a> {
    /// Reading of each wheel along its rows [m/s].
    pub readings: &'a mut [[Column; 2]],
    /// Velocity of the centre of the pivots, and yaw rate times the size of the rover [m/s].
    pub unknowns: [Column; 3],
    /// Sum of squares of the rim speeds [m²/s²].
    pub rolling: Column,
    /// Not 0 where the row is solved on its own: sizes are extreme, or the twist is hardly determined.
    pub rare: Column,
}

impl<'a> FitColumns<'a> {
    /// Columns of zeros; readings are kept of as many wheels as `readings` has columns for.
    #[inline]
    pub fn new(readings: &'a mut [[Column; 2]]) -> Self {
        Self { readings, unknowns: [Column::ZERO; 3], rolling: Column::ZERO, rare: Column::ZERO }
    }
}

/// Solves the first `count` rows of a block, in whole registers. Marks the rare rows; true if there are none.
#[inline(always)]
pub(crate) fn solve_block<S: Vector, const KEEP: bool>(
    simd: S,
    constants: &ForwardConstants,
    (columns, count): (ReadingColumns<'_>, usize),
    twists: &mut [Column; 3],
    kept: &mut FitColumns<'_>,
    log: Log<'_>,
) -> bool {
    if constants.solution.is_some() {
        solve_registers::<S, KEEP, true>(simd, constants, (columns, count), twists, kept, log)
    } else {
        solve_registers::<S, KEEP, false>(simd, constants, (columns, count), twists, kept, log)
    }
}

/// [`solve_block`] with the constants of [`ForwardConstants::sum`].
#[inline(always)]
fn solve_registers<S: Vector, const KEEP: bool, const CENTRED: bool>(
    simd: S,
    constants: &ForwardConstants,
    (columns, count): (ReadingColumns<'_>, usize),
    twists: &mut [Column; 3],
    kept: &mut FitColumns<'_>,
    log: Log<'_>,
) -> bool {
    let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let mut all: Mask<S> = Mask::splat(simd, true);
    for k in 0..count.min(BLOCK).div_ceil(S::F64_LANES) {
        prefetch_ahead(simd, log.steering, k, BLOCK / S::F64_LANES);
        prefetch_ahead(simd, log.speeds, k, BLOCK / S::F64_LANES);
        let register = Register { columns, k };
        let sums = constants.sum::<S, Register<'_>, KEEP, CENTRED>(simd, register, kept.readings);
        let (unknowns, is_solved) = constants.solve::<S, CENTRED>(simd, &sums);
        if KEEP {
            kept.rolling.store(k, sums.rolling);
            store(unknowns, &mut kept.unknowns, k);
        }
        store(constants.twist_at_origin(unknowns), twists, k);
        kept.rare.store(k, is_solved.select(zero, one));
        all = all & is_solved;
    }
    all.all()
}
