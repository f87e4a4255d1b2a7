//! Kernels over many rows: as many at a time as there are lanes.

use super::prepared::{LaneConstants, Prepared};
use crate::lanes::columns::{Span, direction_of};
use crate::lanes::pose_lanes::PoseLanes;
use crate::lanes::settled_poses::LaneGather;
use crate::rates::constants::MotionConstants;
use crate::rates::contact_rows::{Contact, Contacts, RimPoint};
use crate::rates::least_squares::DenseLeastSquares;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::Kernel;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_terrain::suspension::kinematics::{JointAngles, LinkPoses, PlanarLink};
use six_wheel_terrain::suspension::lanes::{Turned, Vectors, all};
use six_wheel_terrain::suspension::{Chain, MAX_FREE, MAX_WHEELS};

/// Poses of links in the axes of the body.
pub(crate) type BodyPoses<'a, S> = LinkPoses<'a, S, PlanarLink<S>>;

/// A range that is solved some rows at a time.
pub(crate) trait SolveRows {
    /// Solves as many rows as there are lanes, or fewer: `spans` in the outputs and in the inputs. Has to be
    /// `#[inline(always)]`.
    fn solve_rows<S: Vector>(
        &mut self,
        simd: S,
        spans: [Span; 2],
        links: &mut BodyPoses<'_, S>,
        scratch: &mut MotionScratch<S>,
    ) -> Result<(), Error>;
}

/// A range of rows that one thread takes, and the constants of their chain.
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
    /// Places the chain at these free angles [rad], its wheels straight ahead.
    #[inline(always)]
    pub fn place<S: Vector>(&self, simd: S, links: &mut BodyPoses<'_, S>, angles: [Lanes<S>; MAX_FREE]) {
        links.place(simd, &JointAngles::new(simd, angles, self.motion.joints, None));
    }

    /// Sine and cosine of the steering angle at which a wheel has settled; None straight ahead.
    #[inline(always)]
    pub fn settled_direction<S: Vector>(&self, simd: S, poses: &PoseLanes<S>, wheel: usize) -> Option<Turned<S>> {
        match self.chain.steering_joint(wheel) {
            Some(joint) if poses.steers => Some(direction_of(simd, poses.steering[joint % MAX_WHEELS])),
            _ => None,
        }
    }

    /// The centre of a wheel at this sine and cosine of its steering angle [m], and its contact.
    #[inline(always)]
    pub fn contact<S: Vector>(
        &self,
        links: &BodyPoses<'_, S>,
        wheel: usize,
        turned: Option<Turned<S>>,
        at: Turned<S>,
    ) -> (Vectors<S>, RimPoint<S>) {
        let simd = at.0.simd();
        let mut centre = links.centre(simd, wheel);
        if let Some(turned) = turned {
            centre = links.steered_centre(simd, wheel, turned, centre);
        }
        let radius = all(simd, self.motion.radii[wheel]);
        (centre, RimPoint::new(links.wheel_link(wheel), centre, radius, turned, at))
    }
}

impl<R> Kernel for InLanes<'_, R>
where
    Self: SolveRows,
{
    type Output = Result<(), Error>;

    #[inline(always)]
    fn run<S: Vector>(mut self, simd: S) -> Self::Output {
        let mut links = BodyPoses::in_body(simd, self.chain);
        let mut scratch = MotionScratch::new(simd);
        for first in (0..self.count).step_by(S::F64_LANES) {
            let count = S::F64_LANES.min(self.count - first);
            let spans = [Span { first, count }, Span { first: self.first + first, count }];
            self.solve_rows(simd, spans, &mut links, &mut scratch)?;
        }
        Ok(())
    }
}

/// Solves all rows in ranges, which `range` makes one after the other for the number of rows it is given. Fails at the first row
/// that has an error.
pub(crate) fn run_rows<R: Send>(
    chain: &Chain,
    prepared: &Prepared,
    workers: Workers,
    rows: usize,
    mut range: impl FnMut(usize) -> R + Send,
) -> Result<(), Error>
where
    for<'a> InLanes<'a, R>: SolveRows,
{
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
