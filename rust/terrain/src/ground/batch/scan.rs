//! The wheels of a chain over the ground at given states: gaps, other near minima, and the system of Newton's step.
//!
//! A pose in every lane, whose wheels are searched one after another ([`WheelByWheel`]), or one pose, whose wheels are
//! searched together, a wheel in every lane ([`AllWheels`]). Both take the same operations, so both give the same bits.

use pulp::Scalar;

use super::pivots::{PivotOrder, Rows};
use crate::ground::rims::circles::{FAR, RIMS, RimLanes, WheelCircle, spread};
use crate::ground::rims::extent::Extent;
use crate::suspension::kinematics::{JointAngles, WheelPose, WorldPoses};
use crate::suspension::lanes::{Turned, Vectors, columns, sum};
use crate::suspension::{Chain, MAX_STATE, MAX_WHEELS};
use crate::terrain::Terrain;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::polynomials::direction;
use six_wheel_numerics::simd::vector::Vector;

/// [`RimScan::clear`] where the upper halves were not searched and may have a lower gap.
pub(crate) const UPPER: f64 = -1.0;

/// Poses in the axes of the grid [m], in lanes, with their states.
pub(crate) struct StateLanes<S: Vector> {
    pub origin: [Lanes<S>; 2],
    pub yaw: Turned<S>,
    pub state: [Lanes<S>; MAX_STATE],
    /// None where all angles are 0.
    pub steering: Option<[Turned<S>; MAX_WHEELS]>,
    /// Sine and cosine of the last contact angles.
    pub contacts: [[Lanes<S>; 2]; MAX_WHEELS],
}

/// The least gap of a wheel along the part of its rim that was searched.
#[derive(Clone, Copy)]
pub(crate) struct WheelGap<S: Vector> {
    /// The gap [m]; [`FAR`] where there is no minimum.
    pub gap: Lanes<S>,
    /// Sine and cosine of the contact angle.
    pub at: [Lanes<S>; 2],
    /// Derivatives of the ground's height by columns and rows [m].
    pub slope: [Lanes<S>; 2],
    /// Height of other minima above the gap, up to the margin of the search [m]; below 0 if it is not known.
    pub clear: Lanes<S>,
}

/// Result of a search along the rims.
pub(crate) struct RimScan<S: Vector> {
    pub rows: Rows<S>,
    pub found: [WheelGap<S>; MAX_WHEELS],
    pub worst: Lanes<S>,
    /// Smallest height of other minima along the rims above the gap, up to the margin of the search [m]; below 0 if it is not
    /// known.
    pub clear: Lanes<S>,
    /// True if every rim that is to touch has a contact, and every differential has a solution.
    pub touches: Mask<S>,
}

/// A chain over the ground, and the equations of its step.
#[derive(Clone, Copy)]
pub(crate) struct Site<'a> {
    pub chain: &'a Chain,
    pub ground: &'a Terrain,
    pub order: &'a PivotOrder,
}

impl Site<'_> {
    /// Columns and rows of the grid per metre.
    #[inline(always)]
    pub fn per_metre<S: Vector>(&self, simd: S) -> [Lanes<S>; 2] {
        let spacing = self.ground.placement().spacing();
        [Lanes::splat(simd, 1.0 / spacing[0]), Lanes::splat(simd, 1.0 / spacing[1])]
    }
}

/// Search of the rims of all wheels.
pub(crate) trait WheelSearch<S: Vector>: Copy {
    /// Searches a part of the rims; `reach` is the half range of [`Extent::Near`] [rad].
    fn scan(self, simd: S, site: &Site<'_>, here: &StateLanes<S>, extent: Extent, reach: Lanes<S>) -> RimScan<S>;
}

/// Poses in the lanes, one wheel after another.
#[derive(Clone, Copy)]
pub(crate) struct WheelByWheel;

impl<S: Vector> WheelSearch<S> for WheelByWheel {
    #[inline(always)]
    fn scan(self, simd: S, site: &Site<'_>, here: &StateLanes<S>, extent: Extent, reach: Lanes<S>) -> RimScan<S> {
        let per_metre = site.per_metre(simd);
        let poses = here.poses(simd, site.chain);
        let mut scan = RimScan::empty(simd, poses.links.reaches);
        let half_width = extent.half_width(simd, reach);
        for wheel in 0..site.chain.wheels().len().min(MAX_WHEELS) {
            let at = poses.wheel(simd, wheel);
            let rims = here.rims(simd, site, wheel, &at, per_metre);
            let (found, covers) = extent.search(simd, site.ground, &rims, here.contacts[wheel], half_width);
            let clear = covers.select(found.others - found.gap, Lanes::splat(simd, UPPER));
            let found = WheelGap { gap: found.gap, at: found.at, slope: found.slope, clear };
            scan.add(simd, site, &poses, wheel, &at, per_metre, found);
        }
        scan
    }
}

/// One pose, and its wheels in the lanes of this level.
#[derive(Clone, Copy)]
pub(crate) struct AllWheels<W: Vector>(pub W);

impl<W: Vector> WheelSearch<Scalar> for AllWheels<W> {
    #[inline(always)]
    fn scan(
        self,
        simd: Scalar,
        site: &Site<'_>,
        here: &StateLanes<Scalar>,
        extent: Extent,
        reach: Lanes<Scalar>,
    ) -> RimScan<Scalar> {
        let wide = self.0;
        let per_metre = site.per_metre(simd);
        let poses = here.poses(simd, site.chain);
        let mut scan = RimScan::empty(simd, poses.links.reaches);
        let circles = here.circles(simd, site, &poses, per_metre);
        let half_width = extent.half_width(wide, Lanes::splat(wide, reach.last(simd)));
        let count = site.chain.wheels().len().min(MAX_WHEELS);
        let mut gaps = [[0.0; RIMS]; 6];
        let mut first = 0;
        while first < count {
            let rims = RimLanes::load(wide, &circles, first);
            let contacts = columns(wide, |lane| {
                let [sin, cos] = here.contacts[(first + lane).min(MAX_WHEELS - 1)];
                [sin.last(simd), cos.last(simd)]
            });
            let (found, covers) = extent.search(wide, site.ground, &rims, contacts, half_width);
            let clear = covers.select(found.others - found.gap, Lanes::splat(wide, UPPER));
            let numbers = [found.gap, found.at[0], found.at[1], found.slope[0], found.slope[1], clear];
            for k in 0..6 {
                let lanes = spread(numbers[k]);
                let width = W::F64_LANES.min(RIMS - first);
                gaps[k][first..first + width].copy_from_slice(&lanes[..width]);
            }
            first += W::F64_LANES;
        }
        for wheel in 0..count {
            let [gap, sin, cos, along, across, clear] = columns(simd, |_| gaps.map(|gaps| gaps[wheel]));
            let found = WheelGap { gap, at: [sin, cos], slope: [along, across], clear };
            scan.add(simd, site, &poses, wheel, &poses.wheel(simd, wheel), per_metre, found);
        }
        scan
    }
}

#[inline_always]
impl<S: Vector> RimScan<S> {
    /// No wheel yet.
    pub fn empty(simd: S, reaches: Mask<S>) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        let none = WheelGap { gap: zero, at: [zero; 2], slope: [zero; 2], clear: zero };
        Self {
            rows: [([zero; MAX_STATE], zero); MAX_WHEELS],
            found: [none; MAX_WHEELS],
            worst: zero,
            clear: Lanes::splat(simd, FAR),
            touches: reaches,
        }
    }

    /// Adds a wheel that touches: its row `d gap / d state`, and its gap on the right-hand side.
    #[allow(clippy::too_many_arguments)] // three callers, which name them
    pub fn add(
        &mut self,
        simd: S,
        site: &Site<'_>,
        poses: &WorldPoses<'_, S>,
        wheel: usize,
        at: &WheelPose<S>,
        per_metre: [Lanes<S>; 2],
        found: WheelGap<S>,
    ) {
        self.found[wheel] = found;
        if !site.order.touches(wheel) {
            return;
        }
        let radius = Lanes::splat(simd, site.chain.wheels()[wheel].radius);
        let gradient = [found.slope[0] * per_metre[0], found.slope[1] * per_metre[1]];
        let mut spoke: Vectors<S> = [Lanes::splat(simd, 0.0); 3];
        for (k, spoke) in spoke.iter_mut().enumerate() {
            *spoke = (at.forward[k] * found.at[0] - at.up[k] * found.at[1]) * radius;
        }
        let point = sum(at.centre, spoke);
        self.rows[wheel] = (poses.gap_slopes(simd, wheel, point, gradient), -found.gap);
        self.worst = self.worst.max(found.gap.abs());
        self.clear = self.clear.min(found.clear);
        self.touches = self.touches & found.gap.abs().lt(Lanes::splat(simd, 0.5 * FAR));
    }
}

#[inline_always]
impl<S: Vector> StateLanes<S> {
    /// The chain at these states.
    pub fn poses<'a>(&self, simd: S, chain: &'a Chain) -> WorldPoses<'a, S> {
        let [_, roll, pitch, joints @ ..] = self.state;
        let angles = JointAngles::new(simd, joints, chain.joints().len(), self.steering.as_ref());
        WorldPoses::new(simd, chain, [self.yaw, direction(simd, pitch), direction(simd, roll)], &angles)
    }

    /// The circles of a wheel, in columns, rows and metres.
    fn rims(&self, simd: S, site: &Site<'_>, wheel: usize, at: &WheelPose<S>, per_metre: [Lanes<S>; 2]) -> RimLanes<S> {
        let radius = Lanes::splat(simd, site.chain.wheels()[wheel].radius);
        let scale = [radius * per_metre[0], radius * per_metre[1], radius];
        let mut rims = RimLanes {
            centre: [
                (self.origin[0] + at.centre[0]) * per_metre[0],
                (self.origin[1] + at.centre[1]) * per_metre[1],
                self.state[0] + at.centre[2],
            ],
            forward: at.forward,
            up: at.up,
        };
        for (k, scale) in scale.into_iter().enumerate() {
            rims.forward[k] = rims.forward[k] * scale;
            rims.up[k] = rims.up[k] * scale;
        }
        rims
    }
}

impl StateLanes<Scalar> {
    /// The circles of all wheels; those that the chain does not have repeat the first.
    #[inline(always)]
    pub fn circles(
        &self,
        simd: Scalar,
        site: &Site<'_>,
        poses: &WorldPoses<'_, Scalar>,
        per_metre: [Lanes<Scalar>; 2],
    ) -> [WheelCircle; RIMS] {
        let mut circles = [WheelCircle { centre: [0.0; 3], forward: [0.0; 3], up: [0.0; 3] }; RIMS];
        let wheels = site.chain.wheels().len().min(MAX_WHEELS);
        for (wheel, circle) in circles[..wheels].iter_mut().enumerate() {
            let rims = self.rims(simd, site, wheel, &poses.wheel(simd, wheel), per_metre);
            for k in 0..3 {
                circle.centre[k] = rims.centre[k].last(simd);
                circle.forward[k] = rims.forward[k].last(simd);
                circle.up[k] = rims.up[k].last(simd);
            }
        }
        for wheel in site.chain.wheels().len()..RIMS {
            circles[wheel] = circles[0];
        }
        circles
    }
}
