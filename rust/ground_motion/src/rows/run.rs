//! The way through many rows: as many at a time as there are lanes, and those that are not for lanes by themselves.

use super::columns::{Span, truths};
use super::least_squares::Square;
use super::prepared::Prepared;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::Mask;
use six_wheel_numerics::simd::level::Kernel;
use six_wheel_numerics::simd::level::Level;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_terrain::suspension::lanes::{ChainConstants, Placing};

/// Rows that one thread takes.
pub(crate) trait Rows: Sized {
    /// Room beside the chain for some of them, made once for all.
    type Scratch<S: Vector>;

    /// Nothing is in it yet.
    fn room<S: Vector>(simd: S) -> Self::Scratch<S>;

    /// Number of rows.
    fn count(&self) -> usize;

    /// Some of them, in lanes, and the lanes that are for the plain way. Has to be `#[inline(always)]`.
    fn some<S: Vector>(
        lanes: &mut InLanes<'_, Self>,
        simd: S,
        span: Span,
        placing: &mut Placing<'_, S>,
        room: &mut Self::Scratch<S>,
    ) -> Mask<S>;

    /// One of them, the plain way.
    fn one(&mut self, row: usize) -> Result<(), Error>;
}

/// Rows, and what is known beforehand of the chain that they are about.
pub(crate) struct InLanes<'a, R> {
    pub plan: &'a ChainConstants,
    pub square: Option<&'a Square>,
    pub job: R,
}

impl<R: Rows> Kernel for InLanes<'_, R> {
    type Output = Result<(), Error>;

    #[inline(always)]
    fn run<S: Vector>(mut self, simd: S) -> Self::Output {
        let rows = self.job.count();
        let mut placing = Placing::new(simd, self.plan);
        let mut room = R::room(simd);
        for first in (0..rows).step_by(S::F64_LANES) {
            let count = S::F64_LANES.min(rows - first);
            let span = Span { first, count };
            let doubt = R::some(&mut self, simd, span, &mut placing, &mut room);
            if doubt.any() {
                let doubtful = truths(simd, doubt);
                for lane in 0..count {
                    if doubtful.0[lane] != 0.0 {
                        self.job.one(first + lane)?;
                    }
                }
            }
        }
        Ok(())
    }
}

/// Works through all of them. Fails at the first one that does.
pub(crate) fn through(prepared: &Prepared, level: Level, mut job: impl Rows) -> Result<(), Error> {
    match &prepared.plan {
        Some(plan) if level != Level::Scalar => {
            let square = prepared.square.as_ref();
            let done = level.run(InLanes { plan, square, job });
            done.unwrap_or(Ok(()))
        }
        _ => (0..job.count()).try_for_each(|row| job.one(row)),
    }
}
