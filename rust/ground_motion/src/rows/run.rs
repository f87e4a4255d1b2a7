//! Kernels over many rows: as many at a time as there are lanes.

use super::prepared::{LaneConstants, Prepared};
use crate::lanes::columns::Span;
use crate::lanes::pose_lanes::PoseLanes;
use crate::lanes::settled_poses::LaneGather;
use crate::rates::constants::MotionConstants;
use crate::rates::contact_rows::{Contact, Contacts};
use crate::rates::least_squares::DenseLeastSquares;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::Kernel;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_terrain::suspension::kinematics::{JointAngles, LinkPoses, PlanarLink};
use six_wheel_terrain::suspension::{Chain, MAX_FREE, MAX_WHEELS};

/// Poses of links in the axes of the body.
pub(crate) type BodyPoses<'a, S> = LinkPoses<'a, S, PlanarLink<S>>;

/// Rows that one thread takes.
pub(crate) trait Rows: Sized {
    /// Solves all rows of a range. Has to be `#[inline(always)]`.
    fn solve_all<S: Vector>(lanes: &mut InLanes<'_, Self>, simd: S, links: &mut BodyPoses<'_, S>) -> Result<(), Error>;
}

/// A range of rows, and the constants of their chain.
pub(crate) struct InLanes<'a, R> {
    pub chain: &'a Chain,
    pub motion: &'a MotionConstants,
    /// The first of the rows among all of the inputs, and their number.
    pub first: usize,
    pub count: usize,
    /// Inputs of all rows, and outputs of these.
    pub range: R,
}

impl<R> InLanes<'_, R> {
    /// The rows, as many at a time as there are lanes, in the outputs and in the inputs.
    #[inline(always)]
    pub fn spans<S: Vector>(&self, _: S) -> impl Iterator<Item = [Span; 2]> + use<R, S> {
        let (start, rows) = (self.first, self.count);
        (0..rows).step_by(S::F64_LANES).map(move |first| {
            let count = S::F64_LANES.min(rows - first);
            [Span { first, count }, Span { first: start + first, count }]
        })
    }

    /// Places the chain at these free angles [rad], its wheels straight ahead.
    #[inline(always)]
    pub fn place<S: Vector>(&self, simd: S, links: &mut BodyPoses<'_, S>, angles: [Lanes<S>; MAX_FREE]) {
        links.place(simd, &JointAngles::new(simd, angles, self.motion.joints, None));
    }
}

impl<R: Rows> Kernel for InLanes<'_, R> {
    type Output = Result<(), Error>;

    #[inline(always)]
    fn run<S: Vector>(mut self, simd: S) -> Self::Output {
        let mut links = BodyPoses::in_body(simd, self.chain);
        R::solve_all(&mut self, simd, &mut links)
    }
}

/// Solves all rows in ranges, which `range` makes one after the other for the number of rows it is given. Fails at the first row
/// that has an error.
pub(crate) fn run_rows<R: Rows + Send>(
    chain: &Chain,
    prepared: &Prepared,
    workers: Workers,
    rows: usize,
    mut range: impl FnMut(usize) -> R + Send,
) -> Result<(), Error> {
    let LaneConstants { motion, .. } = prepared.lanes.as_ref().ok_or_else(|| {
        let rule = "have links that turn about x or y, those on one another about the same, and steer about z";
        Error::value("chain", rule, "one that does not")
    })?;
    let workers = workers.here();
    let share = workers.share(rows);
    let ranges = (0..rows).step_by(share).map(|first| {
        let count = share.min(rows - first);
        InLanes { chain, motion, first, count, range: range(count) }
    });
    workers.for_each(ranges, |range| workers.level.run_any(range))
}

/// The first `count` elements of a slice, which keeps the others.
pub(crate) fn take<'a, T>(slice: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    let (head, tail) = std::mem::take(slice).split_at_mut(count);
    *slice = tail;
    head
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
