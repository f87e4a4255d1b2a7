//! A chain in lanes, a rover in each: where its wheels are in the body, and what its free angles do to them.
//!
//! The work of [`Chain::place`](super::Chain::place) does for one rover, in the axes of its body, for chains whose parts turn about the body's y axis or
//! about its x axis, those on one another about the same, and whose steered wheels are mounted on what steers them:
//! every vehicle that has a name here. So a part is an angle and a point, and stays in its plane.

mod plan;

use pulp::Simd;

pub use self::plan::ChainConstants;
use self::plan::{MOST_PARTS, Wheel};
use super::chain::{MAX_FREE, MAX_WHEELS};
use super::dimensions::Differential;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::polynomials::direction;
pub use six_wheel_numerics::simd::vec3::{
    Vec3 as Vectors, add as sum, add_scaled as along, cross, dot, scale as scaled, sub as less,
};
use six_wheel_numerics::simd::vector::Vector;

/// Sine and cosine.
pub type Turned<S> = (Lanes<S>, Lanes<S>);

/// Lanes of the widest level.
pub const MOST: usize = 8;

/// A number of as many rovers as there are lanes at most.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Column(pub [f64; MOST]);

#[inline_always]
impl Column {
    /// All zero.
    pub const ZERO: Self = Self([0.0; MOST]);

    /// The number of as many rovers as there are lanes.
    pub fn load<S: Simd>(&self, simd: S) -> Lanes<S> {
        Lanes::load(simd, S::as_simd_f64s(&self.0[..S::F64_LANES]).0, 0)
    }

    /// The lanes as a column, zero beyond them.
    pub fn of<S: Simd>(lanes: Lanes<S>) -> Self {
        let mut column = Self::ZERO;
        lanes.store(S::as_mut_simd_f64s(&mut column.0[..S::F64_LANES]).0, 0);
        column
    }
}

/// Angles [rad] beyond which a lane is left to one pose at a time: a joint that has turned a hundred times.
pub const LARGEST_TURN: f64 = 600.0;

/// The same number in every lane.
#[inline(always)]
pub fn all<S: Simd>(simd: S, value: f64) -> Lanes<S> {
    Lanes::splat(simd, value)
}

#[inline(always)]
fn triple<S: Simd>(simd: S, [x, y, z]: [f64; 3]) -> Vectors<S> {
    [all(simd, x), all(simd, y), all(simd, z)]
}

/// A vector in axes that are turned like this about the upward one.
#[inline(always)]
pub fn from_turned<S: Simd>((s, c): Turned<S>, [x, y, up]: Vectors<S>) -> Vectors<S> {
    [x.mul_add(c, y * s), y.mul_add(c, -(x * s)), up]
}

/// A part in lanes, or the body: how far it is turned in its plane, x and z (0) or y and z (1), with z towards x or y, and a
/// point of it [m].
#[derive(Clone, Copy)]
pub struct Limb<S: Simd> {
    plane: usize,
    turned: Turned<S>,
    origin: Vectors<S>,
}

#[inline_always]
impl<S: Simd> Limb<S> {
    /// A vector in its own axes, in those of the body.
    pub fn out(&self, vector: Vectors<S>) -> Vectors<S> {
        self.by(self.turned, vector)
    }

    /// A vector of the body in its own axes.
    pub fn own(&self, vector: Vectors<S>) -> Vectors<S> {
        self.by((-self.turned.0, self.turned.1), vector)
    }

    fn by(&self, (sin, cos): Turned<S>, [x, y, z]: Vectors<S>) -> Vectors<S> {
        let ahead = if self.plane == 0 { x } else { y };
        let up = z.mul_add(cos, -(ahead * sin));
        let ahead = ahead.mul_add(cos, z * sin);
        match self.plane {
            0 => [ahead, y, up],
            _ => [x, ahead, up],
        }
    }

    fn point(&self, simd: S, local: [f64; 3]) -> Vectors<S> {
        sum(self.origin, self.out(triple(simd, local)))
    }

    /// A vector along its plane and upwards.
    fn in_plane(&self, [x, y, z]: Vectors<S>) -> [Lanes<S>; 2] {
        [if self.plane == 0 { x } else { y }, z]
    }
}

/// The chain in lanes, in the axes of the body.
pub struct Placing<'a, S: Simd> {
    plan: &'a ChainConstants,
    /// The body, and every part.
    limbs: [Limb<S>; MOST_PARTS + 1],
    slopes: [Lanes<S>; MOST_PARTS],
    /// Centres of the wheels, straight ahead until somebody steers them [m].
    pub centres: [Vectors<S>; MAX_WHEELS],
    /// Linear and angular velocity of the body [m/s, rad/s].
    body: [Vectors<S>; 2],
    /// Angular velocity of every limb in its plane against the body [rad/s], and less the velocity that it gives a
    /// point at the body's origin, along the plane and upwards [m/s].
    flow: [[Lanes<S>; 3]; MOST_PARTS + 1],
}

/// Sine and cosine of the angle that a differential gives the other side, and its derivative by the angle of this one; NaN where
/// it does not reach.
#[inline(always)]
pub(super) fn across<S: Vector>(
    simd: S,
    differential: Differential,
    left: Lanes<S>,
    turned: Turned<S>,
) -> (Turned<S>, Lanes<S>) {
    if differential == Differential::Gear {
        return ((-turned.0, turned.1), Lanes::splat(simd, -1.0));
    }
    let mut columns = [Column::of(left); 3];
    for lane in 0..S::F64_LANES {
        let reached = differential.right(columns[0].0[lane]);
        let [angle, slope] = reached.unwrap_or([f64::NAN; 2]);
        let (sin, cos) = angle.sin_cos();
        for (column, value) in columns.iter_mut().zip([sin, cos, slope]) {
            column.0[lane] = value;
        }
    }
    let turned = (columns[0].load(simd), columns[1].load(simd));
    (turned, columns[2].load(simd))
}

#[inline_always]
impl<'a, S: Vector> Placing<'a, S> {
    /// Room for a chain, which is nowhere yet.
    pub fn new(simd: S, plan: &'a ChainConstants) -> Self {
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        let body = Limb { plane: 0, turned: (zero, one), origin: [zero; 3] };
        Self {
            plan,
            limbs: [body; MOST_PARTS + 1],
            slopes: [one; MOST_PARTS],
            centres: [[zero; 3]; MAX_WHEELS],
            body: [[zero; 3]; 2],
            flow: [[zero; 3]; MOST_PARTS + 1],
        }
    }

    /// Places it at these free angles, of [`LARGEST_TURN`] at most.
    pub fn place(&mut self, simd: S, joints: &[Lanes<S>; MAX_FREE]) {
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        let mut free = [(zero, one); MAX_FREE];
        for (turned, angle) in free.iter_mut().zip(joints).take(self.plan.joints()) {
            *turned = direction(simd, *angle);
        }
        for (k, part) in self.plan.parts.iter().enumerate().take(MOST_PARTS) {
            let joint = part.joint % MAX_FREE;
            let (mut turned, mut slope) = match part.across {
                None => (free[joint], one),
                Some(by) => across(simd, by, joints[joint], free[joint]),
            };
            if part.plane == 1 {
                // About x, from z to y backwards.
                (turned.0, slope) = (-turned.0, -slope);
            }
            let mut origin = triple(simd, part.origin);
            if part.parent > 0 {
                let parent = &self.limbs[part.parent];
                origin = parent.point(simd, part.origin);
                let ((sin, cos), (s, c)) = (parent.turned, turned);
                turned = (sin.mul_add(c, cos * s), cos.mul_add(c, -(sin * s)));
            }
            self.limbs[k + 1] = Limb { plane: part.plane, turned, origin };
            self.slopes[k] = slope;
        }
        for (k, wheel) in self.plan.wheels.iter().enumerate().take(MAX_WHEELS) {
            let [x, y, z] = wheel.pivot;
            let [ahead, left, up] = wheel.offset;
            self.centres[k] = self.limbs[wheel.limb].point(simd, [x + ahead, y + left, z + up]);
        }
    }

    /// Moves the centre of a wheel to where it is turned like this about its steering axis.
    pub fn steer(&mut self, simd: S, wheel: usize, turned: Turned<S>) {
        self.centres[wheel] = self.steered(simd, wheel, turned);
    }

    /// The centre of a wheel turned like this about its steering axis.
    pub fn steered(&self, simd: S, wheel: usize, (sin, cos): Turned<S>) -> Vectors<S> {
        let Wheel { offset, pivot, .. } = &self.plan.wheels[wheel];
        let [ahead, left, up] = *offset;
        if [ahead, left] == [0.0; 2] {
            return self.centres[wheel];
        }
        let offset = from_turned((-sin, cos), triple(simd, [ahead, left, up]));
        let limb = self.limb(wheel);
        let own = sum(triple(simd, *pivot), offset);
        sum(limb.origin, limb.out(own))
    }

    /// The limb that carries a wheel.
    pub fn limb(&self, wheel: usize) -> &Limb<S> {
        &self.limbs[self.plan.wheels[wheel].limb]
    }

    /// A point of the steering axis of a wheel.
    pub fn pivot(&self, simd: S, wheel: usize) -> Vectors<S> {
        self.limb(wheel).point(simd, self.plan.wheels[wheel].pivot)
    }

    /// The limbs that carry a wheel, innermost first.
    pub fn movers(&self, wheel: usize) -> &'a [usize] {
        &self.plan.wheels[wheel].movers
    }

    /// The free angle that turns a limb, and how a point that it carries moves by its rate, along its plane and downwards.
    pub fn swing(&self, mover: usize, point: Vectors<S>) -> (usize, [Lanes<S>; 2]) {
        let (limb, slope) = (&self.limbs[mover + 1], self.slopes[mover]);
        let [ahead, up] = limb.in_plane(less(point, limb.origin));
        let joint = self.plan.parts[mover].joint % MAX_FREE;
        (joint, [up * slope, ahead * slope])
    }

    /// The part of that motion in a direction.
    pub fn swung(&self, mover: usize, [forth, down]: [Lanes<S>; 2], to: Vectors<S>) -> Lanes<S> {
        let [along, up] = self.limbs[mover + 1].in_plane(to);
        forth.mul_add(along, -(down * up))
    }

    /// Moves the parts at these rates of the body and the free angles.
    pub fn moves(&mut self, body: [Vectors<S>; 2], rates: &[Lanes<S>; MAX_FREE]) {
        self.body = body;
        for (k, part) in self.plan.parts.iter().enumerate().take(MOST_PARTS) {
            let limb = &self.limbs[k + 1];
            let [ahead, up] = limb.in_plane(limb.origin);
            let rate = self.slopes[k] * rates[part.joint % MAX_FREE];
            let [turns, forth, down] = self.flow[part.parent];
            self.flow[k + 1] = [turns + rate, rate.mul_add(up, forth), rate.mul_add(ahead, down)];
        }
    }

    /// The velocity of a point of a wheel's carrier as the parts move [m/s], and how the carrier turns [rad/s]: see
    /// `moving::contact::carried`.
    pub fn carried(&self, wheel: usize, point: Vectors<S>) -> [Vectors<S>; 2] {
        let which = self.plan.wheels[wheel].limb;
        let ([velocity, mut turn], limb) = (self.body, &self.limbs[which]);
        let mut velocity = sum(velocity, cross(turn, point));
        if which > 0 {
            let [turns, forth, down] = self.flow[which];
            let [ahead, up] = limb.in_plane(point);
            let along = turns.mul_add(up, -forth);
            velocity[2] = velocity[2] + (down - turns * ahead);
            if limb.plane == 0 {
                velocity[0] = velocity[0] + along;
                turn[1] = turn[1] + turns;
            } else {
                velocity[1] = velocity[1] + along;
                turn[0] = turn[0] - turns;
            }
        }
        [velocity, turn]
    }
}
