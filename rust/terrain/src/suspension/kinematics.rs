//! Forward kinematics of a chain: a rotation matrix and an origin per link, a rover in every lane.
//!
//! Input: sines and cosines of all angles. Output: poses of the links and wheels, from the origin of the body, and the
//! derivatives of a wheel's gap by the state. One body for one pose ([`super::Placed`]) and for a pose in every lane.

use super::chain::{Chain, ChainLink, MAX_FREE, MAX_PARTS, MAX_STATE, MAX_WHEELS, Turning};
use super::lanes::{Turned, Vectors, across, cross, dot, less, scaled};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::polynomials::direction;
use six_wheel_numerics::simd::vector::Vector;

/// Sines and cosines of the angles of a chain.
pub(crate) struct ChainAngles<'a, S: Vector> {
    pub yaw: Turned<S>,
    pub roll: Turned<S>,
    pub pitch: Turned<S>,
    /// The free angles [rad].
    pub joints: [Lanes<S>; MAX_FREE],
    pub free: [Turned<S>; MAX_FREE],
    /// None where all are 0: links that steer and carry nothing but wheels are then left out.
    pub steering: Option<&'a [Turned<S>; MAX_WHEELS]>,
}

#[inline_always]
impl<'a, S: Vector> ChainAngles<'a, S> {
    /// Those of a state, up to a hundred turns.
    pub fn of_state(
        simd: S,
        yaw: Turned<S>,
        state: &[Lanes<S>; MAX_STATE],
        steering: Option<&'a [Turned<S>; MAX_WHEELS]>,
    ) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        let (mut joints, mut free) = ([zero; MAX_FREE], [(zero, zero); MAX_FREE]);
        for (joint, turned) in free.iter_mut().enumerate() {
            joints[joint] = state[3 + joint];
            *turned = direction(simd, state[3 + joint]);
        }
        Self { yaw, roll: direction(simd, state[1]), pitch: direction(simd, state[2]), joints, free, steering }
    }

    /// Sine and cosine of the angle of a link, and its derivative by that of its joint.
    pub fn turned(&self, simd: S, link: &ChainLink) -> (Turned<S>, Lanes<S>) {
        let one = Lanes::splat(simd, 1.0);
        match link.turning {
            Turning::Free(joint) => (self.free[joint % MAX_FREE], one),
            Turning::Across(joint, differential) => {
                across(simd, differential, self.joints[joint % MAX_FREE], self.free[joint % MAX_FREE])
            }
            Turning::Steering(joint) => {
                (self.steering.map_or((Lanes::splat(simd, 0.0), one), |angles| angles[joint % MAX_WHEELS]), one)
            }
        }
    }
}

/// Columns of the rotation of a link, and a point that it carries [m].
#[derive(Clone, Copy)]
pub(crate) struct LinkPose<S: Vector> {
    pub columns: [Vectors<S>; 3],
    pub origin: Vectors<S>,
}

#[inline_always]
impl<S: Vector> LinkPose<S> {
    /// A vector of the link, in the axes of the chain's frame.
    pub fn rotated(&self, simd: S, local: [f64; 3], from: Vectors<S>) -> Vectors<S> {
        let mut point = from;
        for (column, length) in self.columns.iter().zip(local) {
            let length = Lanes::splat(simd, length);
            for k in 0..3 {
                point[k] = column[k].mul_add(length, point[k]);
            }
        }
        point
    }

    /// A point of the link.
    pub fn point(&self, simd: S, local: [f64; 3]) -> Vectors<S> {
        self.rotated(simd, local, self.origin)
    }

    /// Writes the pose of a link on this one, turned like this, and the direction of its axis: of this axis, if it is one.
    pub fn carry(
        &self,
        simd: S,
        (link, main_axis): (&ChainLink, Option<usize>),
        (sin, cos): Turned<S>,
        pose: &mut Self,
        axis: &mut Vectors<S>,
    ) {
        pose.origin = self.point(simd, link.origin.into());
        if let Some(k) = main_axis {
            let (first, second) = ((k + 1) % 3, (k + 2) % 3);
            let (a, b) = (self.columns[first], self.columns[second]);
            *axis = self.columns[k];
            pose.columns[k] = *axis;
            for i in 0..3 {
                pose.columns[first][i] = a[i] * cos + b[i] * sin;
                pose.columns[second][i] = b[i] * cos - a[i] * sin;
            }
            return;
        }
        // R = I + sin [a]x + (1 - cos) (a a' - I)   (Rodrigues)
        let a: [f64; 3] = link.axis.into_inner().into();
        let zero = Lanes::splat(simd, 0.0);
        *axis = self.rotated(simd, a, [zero; 3]);
        let versine = Lanes::splat(simd, 1.0) - cos;
        for k in 0..3 {
            let (next, last) = ((k + 1) % 3, (k + 2) % 3);
            let mut column = [zero; 3];
            column[k] = versine.mul_add(Lanes::splat(simd, a[k] * a[k]), cos);
            column[next] = sin.mul_add(Lanes::splat(simd, a[last]), versine * Lanes::splat(simd, a[k] * a[next]));
            column[last] = versine * Lanes::splat(simd, a[k] * a[last]) - sin * Lanes::splat(simd, a[next]);
            for i in 0..3 {
                let [x, y, z] = [0, 1, 2].map(|j| self.columns[j][i]);
                pose.columns[k][i] = dot([x, y, z], column);
            }
        }
    }
}

/// A wheel: its centre from the origin of the body [m], forward and upward axis.
#[derive(Clone, Copy)]
pub(crate) struct WheelPose<S: Vector> {
    pub centre: Vectors<S>,
    pub forward: Vectors<S>,
    pub up: Vectors<S>,
}

/// Poses of the links of a chain.
pub(crate) struct LinkPoses<'a, S: Vector> {
    chain: &'a Chain,
    is_steered: bool,
    pub body: LinkPose<S>,
    /// Axes about which roll and pitch turn the body.
    pub roll_axis: Vectors<S>,
    pub pitch_axis: Vectors<S>,
    pub links: [LinkPose<S>; MAX_PARTS],
    /// Axis of every link, times the derivative of its angle by that of its joint.
    pub axes: [Vectors<S>; MAX_PARTS],
    /// True where every differential reaches.
    pub reaches: Mask<S>,
}

#[inline_always]
impl<'a, S: Vector> LinkPoses<'a, S> {
    /// Places the chain.
    pub fn new(simd: S, chain: &'a Chain, angles: &ChainAngles<'_, S>) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        let ((sy, cy), (sr, cr), (sp, cp)) = (angles.yaw, angles.roll, angles.pitch);
        // Rz(yaw) Ry(pitch) Rx(roll)
        let columns = [
            [cy * cp, sy * cp, -sp],
            [cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr],
            [cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr],
        ];
        let body = LinkPose { columns, origin: [zero; 3] };
        let mut poses = Self {
            chain,
            is_steered: angles.steering.is_some(),
            body,
            roll_axis: columns[0],
            pitch_axis: [-sy, cy, zero],
            links: [body; MAX_PARTS],
            axes: [[zero; 3]; MAX_PARTS],
            reaches: Mask::splat(simd, true),
        };
        for (k, link) in chain.parts().iter().enumerate().take(MAX_PARTS) {
            if !poses.is_steered && chain.is_knuckle(k) {
                continue;
            }
            // Written where it stays: a pose is as large as twelve registers.
            let (before, rest) = poses.links.split_at_mut(k);
            let parent = link.parent.map_or(&body, |parent| &before[parent]);
            let (turned, slope) = angles.turned(simd, link);
            let mut axis = [zero; 3];
            parent.carry(simd, (link, chain.main_axis(k)), turned, &mut rest[0], &mut axis);
            if let Turning::Across(..) = link.turning {
                axis = scaled(axis, slope);
                poses.reaches = poses.reaches & slope.le(slope);
            }
            poses.axes[k] = axis;
        }
        poses
    }

    /// A wheel.
    pub fn wheel(&self, simd: S, wheel: usize) -> WheelPose<S> {
        let (link, centre) = self.chain.mount(wheel, self.is_steered);
        let pose = link.map_or(&self.body, |link| &self.links[link]);
        WheelPose { centre: pose.point(simd, centre), forward: pose.columns[0], up: pose.columns[2] }
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
        for &(link, joint) in self.chain.movers(wheel) {
            let arm = less(point, self.links[link].origin);
            slopes[3 + joint] = slopes[3 + joint] + dot(self.axes[link], cross(arm, upwards));
        }
        slopes
    }
}
