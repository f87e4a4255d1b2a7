//! A link of a chain: its pose and its motion.
//!
//! Two forms of a rotation: any rotation as a matrix, and a rotation about the x or y axis of the frame, without the
//! zeros and ones of that matrix. Chains in the axes of their body have the second
//! ([`Chain::is_planar`](super::Chain::is_planar)).

use crate::suspension::lanes::{Turned, Vectors, along, cross, dot, less, scaled, splat, sum, turn_about};
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::vector::Vector;

/// The joint of a link, in the axes of its parent.
#[derive(Clone, Copy)]
pub struct Hinge<S: Vector> {
    /// A point of the axis [m].
    pub origin: Vectors<S>,
    /// Direction of the axis.
    pub axis: [f64; 3],
    /// Index of the parent's axis that this axis is, if it is one.
    pub main_axis: Option<usize>,
    /// Sine and cosine of the angle of the link.
    pub turned: Turned<S>,
    /// Derivative of the angle of the link by the angle of the joint; None where it is 1.
    pub slope: Option<Lanes<S>>,
}

/// Rotation of a link against the frame, its origin, and the axis of its joint.
pub trait LinkPose<S: Vector>: Copy {
    /// The frame itself.
    fn frame(simd: S) -> Self;

    /// A point of the link [m].
    fn point(&self, local: Vectors<S>) -> Vectors<S>;

    /// Writes the pose of a link that this one carries.
    fn carry(&self, hinge: &Hinge<S>, pose: &mut Self);

    /// Derivatives of the position of a point along some directions by the angle of the joint ([`slopes_about`]).
    fn slopes<const N: usize>(&self, point: Vectors<S>, directions: &[Vectors<S>; N]) -> [Lanes<S>; N];
}

/// Any rotation.
#[derive(Clone, Copy)]
pub struct MatrixPose<S: Vector> {
    /// Axes of the link in the frame.
    pub(crate) columns: [Vectors<S>; 3],
    pub(crate) origin: Vectors<S>,
    /// The axis of the joint, times the derivative of the angle by that of the joint.
    pub(crate) axis: Vectors<S>,
}

#[inline_always]
impl<S: Vector> MatrixPose<S> {
    /// A link with this axis of its joint and this point of it, in the orientation of the frame.
    pub fn on_axis(axis: Vectors<S>, origin: Vectors<S>) -> Self {
        Self { axis, origin, ..Self::frame(origin[0].simd()) }
    }

    /// The vector `to` plus the columns times the factors.
    fn combined(&self, factors: Vectors<S>, to: Vectors<S>) -> Vectors<S> {
        let [x, y, z] = self.columns;
        along(along(along(to, factors[0], x), factors[1], y), factors[2], z)
    }

    /// The columns of a link about an axis of this one.
    fn carry_about_main(&self, k: usize, (sin, cos): Turned<S>, pose: &mut Self) {
        let (first, second) = ((k + 1) % 3, (k + 2) % 3);
        let (a, b) = (self.columns[first], self.columns[second]);
        pose.axis = self.columns[k];
        pose.columns[k] = pose.axis;
        for i in 0..3 {
            pose.columns[first][i] = a[i] * cos + b[i] * sin;
            pose.columns[second][i] = b[i] * cos - a[i] * sin;
        }
    }

    /// The columns of a link about any axis: `R = I + sin [a]x + (1 - cos) (a a' - I)` (Rodrigues).
    fn carry_about_any(&self, a: [f64; 3], (sin, cos): Turned<S>, pose: &mut Self) {
        let simd = sin.simd();
        let zero = Lanes::splat(simd, 0.0);
        pose.axis = self.combined(splat(simd, a), [zero; 3]);
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

#[inline_always]
impl<S: Vector> LinkPose<S> for MatrixPose<S> {
    fn frame(simd: S) -> Self {
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let columns = [[one, zero, zero], [zero, one, zero], [zero, zero, one]];
        Self { columns, origin: [zero; 3], axis: [zero; 3] }
    }

    fn point(&self, local: Vectors<S>) -> Vectors<S> {
        self.combined(local, self.origin)
    }

    fn carry(&self, hinge: &Hinge<S>, pose: &mut Self) {
        pose.origin = self.point(hinge.origin);
        match hinge.main_axis {
            Some(k) => self.carry_about_main(k, hinge.turned, pose),
            None => self.carry_about_any(hinge.axis, hinge.turned, pose),
        }
        if let Some(slope) = hinge.slope {
            pose.axis = scaled(pose.axis, slope);
        }
    }

    fn slopes<const N: usize>(&self, point: Vectors<S>, directions: &[Vectors<S>; N]) -> [Lanes<S>; N] {
        slopes_about(self.axis, less(point, self.origin), directions)
    }
}

/// Derivatives of the position of a point along some directions by an angle about an axis: `axis . (arm x direction)`.
#[inline(always)]
pub fn slopes_about<S: Vector, const N: usize>(
    axis: Vectors<S>,
    arm: Vectors<S>,
    directions: &[Vectors<S>; N],
) -> [Lanes<S>; N] {
    let mut slopes = [arm[0]; N];
    for (slope, direction) in slopes.iter_mut().zip(directions) {
        *slope = dot(axis, cross(arm, *direction));
    }
    slopes
}

/// Motion of a body.
#[derive(Clone, Copy)]
pub struct LinkVelocity<S: Vector> {
    /// Velocity of its point at the origin of the frame [m/s].
    pub linear: Vectors<S>,
    /// [rad/s]
    pub angular: Vectors<S>,
}

#[inline_always]
impl<S: Vector> LinkVelocity<S> {
    /// The velocity of a point of the body [m/s]: `v + w x p`.
    pub fn at(&self, point: Vectors<S>) -> Vectors<S> {
        sum(self.linear, cross(self.angular, point))
    }
}

/// The axis of the frame about which a link is rotated.
#[derive(Clone, Copy, PartialEq, Eq)]
enum LinkAxis {
    /// None: the link is the frame itself.
    Fixed,
    X,
    Y,
}

/// A link that is rotated about the x or y axis of the frame, or the frame itself, with its motion against the frame.
#[derive(Clone, Copy)]
pub struct PlanarLink<S: Vector> {
    axis: LinkAxis,
    turned: Turned<S>,
    origin: Vectors<S>,
    /// Derivative of the angle of the link (z towards x or y) by the angle of its joint.
    slope: Lanes<S>,
    /// Rate of that angle, the sum of those of the joints [rad/s].
    rate: Lanes<S>,
    /// Sums of the rates of the joints times the coordinates of their axes: z, and x or y [m/s].
    moments: [Lanes<S>; 2],
}

#[inline_always]
impl<S: Vector> PlanarLink<S> {
    /// A vector of the link, in the axes of the frame.
    pub fn rotated(&self, vector: Vectors<S>) -> Vectors<S> {
        self.turn(self.turned, vector)
    }

    /// A vector of the frame, in the axes of the link.
    pub fn in_own_axes(&self, vector: Vectors<S>) -> Vectors<S> {
        self.turn((-self.turned.0, self.turned.1), vector)
    }

    fn turn(&self, turned: Turned<S>, vector: Vectors<S>) -> Vectors<S> {
        match self.axis {
            LinkAxis::X => turn_about::<0, S>(turned, vector),
            // The frame itself has the angle 0.
            _ => turn_about::<1, S>(turned, vector),
        }
    }

    /// The coordinate towards which a positive angle rotates z: x about the y axis, -y about the x axis.
    fn ahead(&self, vector: Vectors<S>) -> Lanes<S> {
        if self.axis == LinkAxis::X { vector[1] } else { vector[0] }
    }

    /// Sets the velocity of a link that this one carries, by the rate of its joint [rad/s].
    pub fn carry_rate(&self, rate: Lanes<S>, link: &mut Self) {
        let rate = link.slope * rate;
        link.rate = self.rate + rate;
        link.moments =
            [rate.mul_add(link.origin[2], self.moments[0]), rate.mul_add(link.ahead(link.origin), self.moments[1])];
    }

    /// The velocity of a point of the link at this velocity of the frame and constant steering angles [m/s]: `v + w x p
    /// + sum of q a x (p - o)` over the joints.
    pub fn velocity(&self, frame: &LinkVelocity<S>, point: Vectors<S>) -> Vectors<S> {
        let [x, y, z] = frame.at(point);
        let ahead = self.rate.mul_add(point[2], -self.moments[0]);
        let up = self.moments[1] - self.rate * self.ahead(point);
        match self.axis {
            LinkAxis::Fixed => [x, y, z],
            LinkAxis::X => [x, y + ahead, z + up],
            LinkAxis::Y => [x + ahead, y, z + up],
        }
    }

    /// Angular velocity of the link at this velocity of the frame [rad/s].
    pub fn angular_velocity(&self, frame: &LinkVelocity<S>) -> Vectors<S> {
        let [x, y, z] = frame.angular;
        match self.axis {
            LinkAxis::Fixed => [x, y, z],
            LinkAxis::X => [x - self.rate, y, z],
            LinkAxis::Y => [x, y + self.rate, z],
        }
    }
}

#[inline_always]
impl<S: Vector> LinkPose<S> for PlanarLink<S> {
    fn frame(simd: S) -> Self {
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let turned = (zero, one);
        Self { axis: LinkAxis::Fixed, turned, origin: [zero; 3], slope: one, rate: zero, moments: [zero; 2] }
    }

    fn point(&self, local: Vectors<S>) -> Vectors<S> {
        sum(self.origin, self.rotated(local))
    }

    /// The angles of links on one another add up.
    fn carry(&self, hinge: &Hinge<S>, pose: &mut Self) {
        let (sin, cos) = hinge.turned;
        let slope = hinge.slope.unwrap_or(Lanes::splat(sin.simd(), 1.0));
        (pose.axis, pose.slope) = match hinge.main_axis {
            Some(0) => (LinkAxis::X, -slope),
            _ => (LinkAxis::Y, slope),
        };
        pose.turned = hinge.turned;
        pose.origin = hinge.origin;
        if self.axis != LinkAxis::Fixed {
            let (s, c) = self.turned;
            pose.origin = self.point(hinge.origin);
            pose.turned = (s.mul_add(cos, c * sin), c.mul_add(cos, -(s * sin)));
        }
    }

    fn slopes<const N: usize>(&self, point: Vectors<S>, directions: &[Vectors<S>; N]) -> [Lanes<S>; N] {
        let arm = less(point, self.origin);
        let (ahead, down) = (arm[2] * self.slope, self.ahead(arm) * self.slope);
        let mut slopes = [ahead; N];
        for (slope, direction) in slopes.iter_mut().zip(directions) {
            *slope = ahead.mul_add(self.ahead(*direction), -(down * direction[2]));
        }
        slopes
    }
}
