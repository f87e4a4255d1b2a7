//! Kernels over many rows: as many at a time as there are lanes.

use super::prepared::Prepared;
use crate::lanes::columns::Span;
use crate::lanes::pose_lanes::PoseLanes;
use crate::lanes::settled_poses::LaneGather;
use crate::rates::constants::MotionConstants;
use crate::rates::contact_rows::{Contact, Contacts};
use crate::rates::least_squares::DenseLeastSquares;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::level::{Kernel, Level};
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_terrain::suspension::MAX_WHEELS;
use six_wheel_terrain::suspension::lanes::{ChainConstants, Placing};

/// Rows that one thread takes.
pub(crate) trait Rows: Sized {
    /// Memory beside the chain, made once for all rows.
    type Scratch<S: Vector>;

    /// Empty memory. Has to be `#[inline(always)]`.
    fn scratch<S: Vector>(simd: S) -> Self::Scratch<S>;

    /// Number of rows.
    fn count(&self) -> usize;

    /// Some of them, a row in every lane. Has to be `#[inline(always)]`.
    fn solve_lanes<S: Vector>(
        lanes: &mut InLanes<'_, Self>,
        simd: S,
        span: Span,
        placing: &mut Placing<'_, S>,
        scratch: &mut Self::Scratch<S>,
    ) -> Result<(), Error>;
}

/// Rows, and the constants of their chain.
pub(crate) struct InLanes<'a, R> {
    pub plan: &'a ChainConstants,
    pub motion: &'a MotionConstants,
    pub range: R,
}

impl<R: Rows> Kernel for InLanes<'_, R> {
    type Output = Result<(), Error>;

    #[inline(always)]
    fn run<S: Vector>(mut self, simd: S) -> Self::Output {
        let rows = self.range.count();
        let mut placing = Placing::new(simd, self.plan);
        let mut scratch = R::scratch(simd);
        for first in (0..rows).step_by(S::F64_LANES) {
            let count = S::F64_LANES.min(rows - first);
            R::solve_lanes(&mut self, simd, Span { first, count }, &mut placing, &mut scratch)?;
        }
        Ok(())
    }
}

/// Computes all rows of a range. Fails at the first one that does.
pub(crate) fn run_rows(prepared: &Prepared, level: Level, range: impl Rows) -> Result<(), Error> {
    let constants = prepared.lanes.as_ref().ok_or_else(|| {
        let rule = "have links that turn about x or y, those on one another about the same, and steer about z";
        Error::value("chain", rule, "one that does not")
    })?;
    level.run_any(InLanes { plan: &constants.chain, motion: &constants.motion, range })
}

/// Memory for settled poses, their contacts and the equations of the rates.
pub(crate) struct MotionScratch<S: Vector> {
    pub gather: LaneGather,
    pub equations: DenseLeastSquares<S>,
    pub contacts: Contacts<S>,
    pub poses: PoseLanes<S>,
}

impl<S: Vector> MotionScratch<S> {
    /// Nothing is in it yet.
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        Self {
            gather: LaneGather::new(),
            equations: DenseLeastSquares::new(simd),
            contacts: [Contact::zero(simd); MAX_WHEELS],
            poses: PoseLanes::new(simd),
        }
    }
}
