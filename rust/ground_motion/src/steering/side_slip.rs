//! Sideways velocity of steered wheels as a function of their angle.
//!
//! With the velocity `v` of a wheel's centre, the rotation `w` of its carrier, its axle `a` and the normal `n` of the ground
//! the touching point is at `-r (n - (a . n) a) / q`, `q^2 = 1 - (a . n)^2`, from the centre, and goes sideways with `s`:
//!
//! ```text
//! q s = a . (v - n (n . v) + r q (n x w))
//! ```
//!
//! Without the last term, or where `n` is parallel to the steering axis, that is a sinusoid of the steering angle. The
//! last term has the opposite sign where the far side of the rim touches.

use crate::lanes::columns::inverse_length;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_terrain::suspension::lanes::{Turned, Vectors, all, along, cross, dot, from_turned, less, scaled, sum};
use six_wheel_terrain::suspension::{Chain, MAX_WHEELS};

/// A wheel in its own axes at a given steering angle: ahead, to the left and upwards.
#[derive(Clone, Copy)]
pub(crate) struct WheelAxes<S: Vector> {
    /// Unit normal of the ground.
    pub normal: Vectors<S>,
    /// Velocity of its centre [m/s], and angular velocity of the link that carries it [rad/s].
    pub velocity: Vectors<S>,
    pub turn: Vectors<S>,
    /// The sign bit where the far side of its rim touches.
    pub side: Lanes<S>,
    /// Its centre relative to a point of the steering axis: ahead, to the left and upwards [m].
    pub offset: [f64; 3],
    pub radius: f64,
}

impl<S: Vector> WheelAxes<S> {
    /// A wheel at rest on level ground.
    #[inline(always)]
    pub fn at_rest(simd: S) -> Self {
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        let normal = [zero, zero, one];
        Self { normal, velocity: [zero; 3], turn: [zero; 3], side: zero, offset: [0.0; 3], radius: 1.0 }
    }

    /// True if its centre lies off its steering axis.
    fn is_offset(&self) -> bool {
        self.offset[..2] != [0.0; 2]
    }

    /// Difference of the velocities of its centre after and before a rotation about the steering axis [m/s], and its
    /// derivative by the angle.
    #[inline(always)]
    fn offset_velocity(&self, simd: S, (sin, cos): Turned<S>) -> (Vectors<S>, Vectors<S>) {
        let zero = all(simd, 0.0);
        let (x, y) = (all(simd, self.offset[0]), all(simd, self.offset[1]));
        let [ahead, left, _] = from_turned((-sin, cos), [x, y, zero]);
        let moved = cross(self.turn, [ahead - x, left - y, zero]);
        (moved, cross(self.turn, [-left, ahead, zero]))
    }

    /// Rate of its encoder when it rolls at a contact angle, steered by `turned` [rad/s]: `v . T / r - w . axle`.
    #[inline(always)]
    pub fn rolling_speed(&self, simd: S, turned: Turned<S>, at: Turned<S>) -> Lanes<S> {
        let mut velocity = self.velocity;
        if self.is_offset() {
            velocity = sum(velocity, self.offset_velocity(simd, turned).0);
        }
        let [ahead, _, up] = from_turned(turned, velocity);
        let along = ahead.mul_add(at.1, up * at.0);
        let [_, turning, _] = from_turned(turned, self.turn);
        along.mul_add(all(simd, 1.0 / self.radius), -turning)
    }

    /// The normal along the wheel's forward and upward axes, steered by `turned`.
    #[inline(always)]
    pub fn normal_in_plane(&self, turned: Turned<S>) -> [Lanes<S>; 2] {
        let [ahead, _, up] = from_turned(turned, self.normal);
        [ahead, up]
    }
}

/// Sideways velocity of a wheel as a function of its angle.
#[derive(Clone, Copy)]
pub(super) struct SideSlipFunction<'a, S: Vector> {
    axes: &'a WheelAxes<S>,
    /// `r n x w` with the sign of the side of the rim, and `v - n (n . v)` [m/s].
    rim: Vectors<S>,
    slide: Vectors<S>,
    /// Factor of the wheel in the sum of its joint: 1, or 0 for a wheel in the air if another wheel of the joint
    /// touches.
    counts: Lanes<S>,
}

#[inline_always]
impl<'a, S: Vector> SideSlipFunction<'a, S> {
    fn new(simd: S, axes: &'a WheelAxes<S>, counts: Lanes<S>) -> Self {
        let (normal, velocity) = (axes.normal, axes.velocity);
        let rim = scaled(cross(normal, axes.turn), all(simd, axes.radius).xor_sign(axes.side));
        let along = scaled(normal, dot(normal, velocity));
        Self { axes, rim, slide: less(velocity, along), counts }
    }

    /// `q s` [m/s], its first derivative by the angle, and its second derivative less that of a sinusoid, `-q s`; the
    /// latter for wheels on their axis.
    fn at(&self, simd: S, turned: Turned<S>) -> Vectors<S> {
        let normal = self.axes.normal;
        // The derivative of `tilt = a . n` by the angle is minus `level`.
        let [level, tilt, up] = from_turned(turned, normal);
        let square = level.mul_add(level, up * up);
        let inverse = inverse_length(simd, square);
        let share = square * inverse;
        let [rim_ahead, rim, _] = from_turned(turned, self.rim);
        let [ahead, across, _] = from_turned(turned, self.slide);
        let mut value = share.mul_add(rim, across);
        let slope = tilt * level * inverse;
        let mut by = slope.mul_add(rim, -share.mul_add(rim_ahead, ahead));
        // The second derivative of `q`, then `q'' rim + 2 q' rim'`.
        let bend = (tilt * tilt - slope.mul_add(slope, level * level)) * inverse;
        let mut bend = bend.mul_add(rim, -((slope + slope) * rim_ahead));
        if self.axes.is_offset() {
            let (moved, change) = self.axes.offset_velocity(simd, turned);
            let [ahead, across, _] = from_turned(turned, moved);
            let [_, on, _] = from_turned(turned, change);
            let up = dot(normal, moved);
            value = value + across - tilt * up;
            by = by + level.mul_add(up, -ahead) + on - tilt * dot(normal, change);
            bend = all(simd, 0.0);
        }
        scaled([value, by, bend], self.counts)
    }

    /// Velocity of the touching point at the given steering angle: ahead and to the left [m/s].
    fn velocity(&self, simd: S) -> [Lanes<S>; 2] {
        let [nx, _, nz] = self.axes.normal;
        let square = nx.mul_add(nx, nz * nz);
        let [ahead, left, _] = along(self.slide, square * inverse_length(simd, square), self.rim);
        [ahead * self.counts, left * self.counts]
    }

    /// A bound of the speeds that the sideways velocity is a sum of [m/s].
    fn size(&self, simd: S) -> Lanes<S> {
        let [ahead, left, _] = self.axes.offset;
        // `|r n x w|` is at most `r |w|`.
        let arm = all(simd, ahead.hypot(left) + 1.5 * self.axes.radius);
        sum_of_sizes(self.axes.turn).mul_add(arm, sum_of_sizes(self.axes.velocity)) * self.counts
    }
}

/// Sum of the magnitudes of a vector's components: a bound of its length.
#[inline(always)]
fn sum_of_sizes<S: Vector>([x, y, z]: Vectors<S>) -> Lanes<S> {
    x.abs() + y.abs() + z.abs()
}

/// Wheels that one joint steers.
#[derive(Clone, Copy)]
pub(super) struct JointWheels<S: Vector> {
    /// Bits of the wheels.
    wheels: u32,
    /// Sum of the velocities of the touching points at the given steering angles, ahead and to the left [m/s].
    pub velocity: [Lanes<S>; 2],
    /// A bound of the speeds that the sideways velocity is a sum of [m/s].
    pub size: Lanes<S>,
    /// True if the centre of a wheel lies off the steering axis.
    pub is_offset: bool,
}

impl<S: Vector> JointWheels<S> {
    /// True if the joint steers a wheel.
    #[inline(always)]
    pub fn any(&self) -> bool {
        self.wheels != 0
    }
}

/// Sideways velocities of all wheels, joint by joint.
pub(super) struct SideSlip<'a, S: Vector> {
    functions: [Option<SideSlipFunction<'a, S>>; MAX_WHEELS],
    pub joints: [JointWheels<S>; MAX_WHEELS],
}

#[inline_always]
impl<'a, S: Vector> SideSlip<'a, S> {
    /// The functions of wheels in these axes. A wheel in the air is left out of the sum of its joint if another one
    /// touches.
    pub fn new(simd: S, chain: &Chain, axes: &'a [WheelAxes<S>], touching: &[Lanes<S>; MAX_WHEELS]) -> Self {
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        let none = JointWheels { wheels: 0, velocity: [zero; 2], size: zero, is_offset: false };
        let mut slip = Self { functions: [None; MAX_WHEELS], joints: [none; MAX_WHEELS] };
        let mut touches = [zero; MAX_WHEELS];
        for (wheel, touching) in touching.iter().enumerate().take(axes.len()) {
            if let Some(joint) = chain.steering_joint(wheel) {
                touches[joint % MAX_WHEELS] = touches[joint % MAX_WHEELS].max(*touching);
            }
        }
        for (wheel, (function, axes)) in slip.functions.iter_mut().zip(axes).enumerate() {
            let Some(joint) = chain.steering_joint(wheel).map(|joint| joint % MAX_WHEELS) else {
                continue;
            };
            let counts = zero.lt(touches[joint]).select(touching[wheel], one);
            let its = SideSlipFunction::new(simd, axes, counts);
            let [ahead, left] = its.velocity(simd);
            let joint = &mut slip.joints[joint];
            joint.wheels |= 1 << wheel;
            joint.velocity = [joint.velocity[0] + ahead, joint.velocity[1] + left];
            joint.size = joint.size + its.size(simd);
            joint.is_offset |= axes.is_offset();
            *function = Some(its);
        }
        slip
    }

    /// Sum over the wheels of a joint: see [`SideSlipFunction::at`].
    pub fn at(&self, simd: S, joint: usize, turned: Turned<S>) -> Vectors<S> {
        let (mut sums, mut left) = ([all(simd, 0.0); 3], self.joints[joint].wheels);
        while let Some(function) = self.functions.get(left.trailing_zeros() as usize) {
            left &= left - 1;
            if let Some(function) = function {
                sums = sum(sums, function.at(simd, turned));
            }
        }
        sums
    }
}
