//! Forward kinematics of a chain: the pose of every link, a rover in every lane.
//!
//! Input: sines and cosines of all angles. Output: poses of the links and wheels, from the origin of the body, the
//! derivatives of points by the angles, and velocities. One body for a pose alone ([`super::Placed`]), for a pose in every
//! lane, in the world or in the axes of the body, and for one rover with its wheels in the lanes.

mod link;

pub use self::link::{Hinge, LinkPose, LinkVelocity, MatrixPose, PlanarLink, slopes_about};
use super::chain::{Chain, ChainLink, MAX_FREE, MAX_PARTS, MAX_STATE, MAX_WHEELS, Turning};
use super::dimensions::Differential;
use super::lanes::{Column, Turned, Vectors, columns, cross, dot, splat, sum, turn_about};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::polynomials::direction;
use six_wheel_numerics::simd::vector::Vector;

/// Angles of the joints of a chain.
pub struct JointAngles<'a, S: Vector> {
    /// The free angles [rad].
    pub(super) angles: [Lanes<S>; MAX_FREE],
    /// Sines and cosines of the free angles.
    pub(super) free: [Turned<S>; MAX_FREE],
    /// Sines and cosines of the steering angles; None if all are 0: knuckles are then left out.
    pub(super) steering: Option<&'a [Turned<S>; MAX_WHEELS]>,
}

#[inline_always]
impl<'a, S: Vector> JointAngles<'a, S> {
    /// From the first `count` free angles, at most [`super::lanes::LARGEST_TURN`] each.
    pub fn new(
        simd: S,
        angles: [Lanes<S>; MAX_FREE],
        count: usize,
        steering: Option<&'a [Turned<S>; MAX_WHEELS]>,
    ) -> Self {
        let mut free = [(Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0)); MAX_FREE];
        for (turned, angle) in free.iter_mut().zip(angles).take(count) {
            *turned = direction(simd, angle);
        }
        Self { angles, free, steering }
    }

    /// The joint of a link.
    fn hinge(&self, simd: S, link: &ChainLink, main_axis: Option<usize>) -> Hinge<S> {
        let (turned, slope) = match link.turning {
            Turning::Free(joint) => (self.free[joint % MAX_FREE], None),
            Turning::Across(joint, differential) => {
                let joint = joint % MAX_FREE;
                let (turned, slope) = across(simd, differential, self.angles[joint], self.free[joint]);
                (turned, Some(slope))
            }
            Turning::Steering(joint) => {
                let straight = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
                (self.steering.map_or(straight, |angles| angles[joint % MAX_WHEELS]), None)
            }
        };
        let axis = link.axis.into_inner().into();
        Hinge { origin: splat(simd, link.origin.into()), axis, main_axis, turned, slope }
    }
}

/// Sine and cosine of the angle of the right rocker by a differential, and its derivative by the angle of the left one;
/// NaN where the linkage has no solution.
#[inline(always)]
fn across<S: Vector>(simd: S, differential: Differential, left: Lanes<S>, turned: Turned<S>) -> (Turned<S>, Lanes<S>) {
    if differential == Differential::Gear {
        return ((-turned.0, turned.1), Lanes::splat(simd, -1.0));
    }
    let left = Column::of(left).0;
    let [sin, cos, slope] = columns(simd, |lane| {
        let [angle, slope] = differential.right(left[lane]).unwrap_or([f64::NAN; 2]);
        let (sin, cos) = angle.sin_cos();
        [sin, cos, slope]
    });
    ((sin, cos), slope)
}

/// A wheel: its centre from the origin of the body [m], forward and upward axis.
#[derive(Clone, Copy)]
pub(crate) struct WheelPose<S: Vector> {
    pub centre: Vectors<S>,
    pub forward: Vectors<S>,
    pub up: Vectors<S>,
}

/// Poses of the links of a chain.
pub struct LinkPoses<'a, S: Vector, P> {
    chain: &'a Chain,
    is_steered: bool,
    pub(crate) body: P,
    pub(crate) links: [P; MAX_PARTS],
    /// True where every differential has a solution.
    pub reaches: Mask<S>,
}

#[inline_always]
impl<'a, S: Vector, P: LinkPose<S>> LinkPoses<'a, S, P> {
    /// A chain in the axes of its body, before [`Self::place`].
    pub fn in_body(simd: S, chain: &'a Chain) -> Self {
        let body = P::frame(simd);
        Self { chain, is_steered: false, body, links: [body; MAX_PARTS], reaches: Mask::splat(simd, true) }
    }

    /// Computes the poses of the links at these angles.
    pub fn place(&mut self, simd: S, angles: &JointAngles<'_, S>) {
        self.is_steered = angles.steering.is_some();
        self.reaches = Mask::splat(simd, true);
        for &k in self.chain.placed_links(self.is_steered) {
            let link = &self.chain.parts()[k];
            // Written in place: a pose has the size of many registers.
            let (before, rest) = self.links.split_at_mut(k);
            let carrier = link.parent.map_or(&self.body, |parent| &before[parent]);
            let hinge = angles.hinge(simd, link, self.chain.main_axis(k));
            carrier.carry(&hinge, &mut rest[0]);
            if let Some(slope) = hinge.slope {
                self.reaches = self.reaches & slope.le(slope);
            }
        }
    }

    /// A link, or the body.
    fn link(&self, link: Option<usize>) -> &P {
        link.map_or(&self.body, |link| &self.links[link])
    }

    /// The link that carries a wheel, or its knuckle.
    pub fn wheel_link(&self, wheel: usize) -> &P {
        self.link(self.chain.mount(wheel).link)
    }

    /// The centre of a wheel straight ahead [m].
    pub fn centre(&self, simd: S, wheel: usize) -> Vectors<S> {
        let mount = self.chain.mount(wheel);
        self.link(mount.link).point(splat(simd, mount.centre))
    }

    /// The centre of a wheel at this sine and cosine of its steering angle, from its centre straight ahead [m].
    pub fn steered_centre(&self, simd: S, wheel: usize, turned: Turned<S>, straight: Vectors<S>) -> Vectors<S> {
        let mount = self.chain.mount(wheel);
        if !mount.is_offset() {
            return straight;
        }
        let offset = turn_about::<2, S>(turned, splat(simd, mount.offset));
        self.link(mount.link).point(sum(splat(simd, mount.pivot), offset))
    }

    /// A point of the steering axis of a wheel [m].
    pub fn pivot(&self, simd: S, wheel: usize) -> Vectors<S> {
        let mount = self.chain.mount(wheel);
        self.link(mount.link).point(splat(simd, mount.pivot))
    }

    /// The links with free angles that carry a wheel, innermost first, and their joints.
    pub fn movers(&self, wheel: usize) -> impl Iterator<Item = (P, usize)> {
        let movers = self.chain.mount(wheel).movers.iter();
        movers.map(|&(link, joint)| (self.links[link], joint))
    }
}

#[inline_always]
impl<S: Vector> LinkPoses<'_, S, PlanarLink<S>> {
    /// Sets the velocities of the links by these rates of the free angles [rad/s].
    pub fn set_rates(&mut self, rates: &[Lanes<S>; MAX_FREE]) {
        for &k in self.chain.placed_links(false) {
            let link = &self.chain.parts()[k];
            let (before, rest) = self.links.split_at_mut(k);
            let carrier = link.parent.map_or(&self.body, |parent| &before[parent]);
            if let Turning::Free(joint) | Turning::Across(joint, _) = link.turning {
                carrier.carry_rate(rates[joint % MAX_FREE], &mut rest[0]);
            }
        }
    }
}

/// A chain in the world.
pub(crate) struct WorldPoses<'a, S: Vector> {
    pub links: LinkPoses<'a, S, MatrixPose<S>>,
    /// Axes of roll and pitch.
    pub roll_axis: Vectors<S>,
    pub pitch_axis: Vectors<S>,
}

#[inline_always]
impl<'a, S: Vector> WorldPoses<'a, S> {
    /// Computes the poses of a chain whose body has the rotation `Rz(yaw) Ry(pitch) Rx(roll)`.
    pub fn new(
        simd: S,
        chain: &'a Chain,
        [(sy, cy), (sp, cp), (sr, cr)]: [Turned<S>; 3],
        angles: &JointAngles<'_, S>,
    ) -> Self {
        let columns = [
            [cy * cp, sy * cp, -sp],
            [cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr],
            [cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr],
        ];
        let mut links = LinkPoses::<S, MatrixPose<S>>::in_body(simd, chain);
        links.body.columns = columns;
        links.place(simd, angles);
        Self { links, roll_axis: columns[0], pitch_axis: [-sy, cy, Lanes::splat(simd, 0.0)] }
    }

    /// A wheel.
    pub fn wheel(&self, simd: S, wheel: usize) -> WheelPose<S> {
        let (chain, mount) = (self.links.chain, self.links.chain.mount(wheel));
        let (link, centre) = match self.links.is_steered {
            true => (chain.wheels()[wheel].part, chain.wheels()[wheel].centre.into()),
            false => (mount.link, mount.centre),
        };
        let pose = self.links.link(link);
        WheelPose { centre: pose.point(splat(simd, centre)), forward: pose.columns[0], up: pose.columns[2] }
    }

    /// Derivatives of the gap of a wheel by the state, at a point of its rim over ground with this gradient.
    pub fn gap_slopes(
        &self,
        simd: S,
        wheel: usize,
        point: Vectors<S>,
        gradient: [Lanes<S>; 2],
    ) -> [Lanes<S>; MAX_STATE] {
        let (zero, unit) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let upwards = [-gradient[0], -gradient[1], unit];
        let moment = cross(point, upwards);
        let mut slopes = [zero; MAX_STATE];
        slopes[0] = unit;
        slopes[1] = dot(self.roll_axis, moment);
        slopes[2] = dot(self.pitch_axis, moment);
        for (link, joint) in self.links.movers(wheel) {
            let [slope] = link.slopes(point, &[upwards]);
            slopes[3 + joint] = slopes[3 + joint] + slope;
        }
        slopes
    }
}
