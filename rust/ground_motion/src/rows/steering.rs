//! Directions of steered wheels, in lanes: the same as `steer` for one rover.

use super::columns::{Way, angle_of, way};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_terrain::suspension::MAX_WHEELS;
use six_wheel_terrain::suspension::lanes::{Turned, Vectors, all, along, cross, dot, from_turned, less, scaled, sum};

/// Turns of Newton's method.
const TURNS: usize = 8;

/// A turn has to be shorter than this share of the last one, of which the first is taken to be half a radian: less than
/// what the plain way lets pass, so that it goes the same way.
const SHORTER: f64 = 0.4;

/// A turn shorter than this [rad] is the last one: what it leaves is its square, or some of them.
const LAST: f64 = 1e-8;

/// The same where the bend is known too: what it leaves is its cube.
const LAST_BENT: f64 = 2e-6;

/// Speeds below this share of those they are made of are for the plain way: there a sign, or a root, hangs on rounding.
const SLIGHT: f64 = 1e-9;

/// The same for how speeds change with the angle: nearly double roots are found as well as rounding lets them be.
const FLAT: f64 = 0.02;

/// A wheel in its own axes: ahead, to the left and up at the steering angle of the footing.
#[derive(Clone, Copy)]
pub(crate) struct Local<S: Vector> {
    /// Of the ground.
    pub normal: Vectors<S>,
    /// Velocity of its centre [m/s], and how its carrier turns [rad/s].
    pub velocity: Vectors<S>,
    pub turn: Vectors<S>,
    /// Its centre from the steering axis, ahead and to the left [m].
    pub offset: [f64; 2],
    pub radius: f64,
}

impl<S: Vector> Local<S> {
    /// Of no wheel.
    #[inline(always)]
    pub fn none(simd: S) -> Self {
        let zero = all(simd, 0.0);
        Self { normal: [zero; 3], velocity: [zero; 3], turn: [zero; 3], offset: [0.0; 2], radius: 1.0 }
    }

    fn is_beside(&self) -> bool {
        self.offset != [0.0; 2]
    }

    /// Velocity that this angle adds to that of its centre, which lies beside its axis [m/s], and the derivative by the
    /// angle.
    #[inline(always)]
    fn swung(&self, simd: S, (sin, cos): Turned<S>) -> (Vectors<S>, Vectors<S>) {
        let zero = all(simd, 0.0);
        let (x, y) = (all(simd, self.offset[0]), all(simd, self.offset[1]));
        let [ahead, left, _] = from_turned((-sin, cos), [x, y, zero]);
        let moved = cross(self.turn, [ahead - x, left - y, zero]);
        (moved, cross(self.turn, [-left, ahead, zero]))
    }

    /// The rate of its encoder when it rolls over a plane, turned like this, or at a contact angle [rad/s].
    #[inline(always)]
    pub fn rolling(&self, simd: S, turned: Turned<S>, at: Turned<S>) -> Lanes<S> {
        let mut velocity = self.velocity;
        if self.is_beside() {
            velocity = sum(velocity, self.swung(simd, turned).0);
        }
        let [ahead, _, up] = from_turned(turned, velocity);
        let along = ahead.mul_add(at.1, up * at.0);
        let [_, turning, _] = from_turned(turned, self.turn);
        along.mul_add(all(simd, 1.0 / self.radius), -turning)
    }

    /// The normal along the wheel's forward and upward axes where it is turned like this.
    #[inline(always)]
    pub fn upright(&self, turned: Turned<S>) -> [Lanes<S>; 2] {
        let [ahead, _, up] = from_turned(turned, self.normal);
        [ahead, up]
    }
}

/// A wheel's weight for its joint, and its sideways velocity.
#[derive(Clone, Copy)]
struct Aim<'a, S: Vector> {
    local: &'a Local<S>,
    /// `r n x w`, and the centre's velocity along the ground [m/s], ahead and to the left.
    rim: Vectors<S>,
    slide: Vectors<S>,
    /// 1, or 0 for one in the air beside one that touches.
    counts: Lanes<S>,
}

impl<'a, S: Vector> Aim<'a, S> {
    #[inline(always)]
    fn new(simd: S, local: &'a Local<S>, counts: Lanes<S>) -> Self {
        let (normal, velocity) = (local.normal, local.velocity);
        let rim = scaled(cross(normal, local.turn), all(simd, local.radius));
        let along = scaled(normal, dot(normal, velocity));
        Self { local, rim, slide: less(velocity, along), counts }
    }

    /// Sideways velocity of the touching point, times the length of the normal across the axle, the derivative by the
    /// angle, and the second one beside that of a sine, for wheels on their axis [m/s].
    #[inline(always)]
    fn aside(&self, simd: S, turned: Turned<S>) -> Vectors<S> {
        let normal = self.local.normal;
        // The tilt of the axle against the ground has minus `level` as its derivative.
        let [level, tilt, up] = from_turned(turned, normal);
        let square = level.mul_add(level, up * up);
        let inverse = square.inverse_root();
        let share = square * inverse;
        let [rim_ahead, rim, _] = from_turned(turned, self.rim);
        let [ahead, across, _] = from_turned(turned, self.slide);
        let mut aside = share.mul_add(rim, across);
        let slope = tilt * level * inverse;
        let mut by = slope.mul_add(rim, -share.mul_add(rim_ahead, ahead));
        // Of the length itself the second derivative, then what changes with it.
        let bend = (tilt * tilt - slope.mul_add(slope, level * level)) * inverse;
        let mut bend = bend.mul_add(rim, -((slope + slope) * rim_ahead));
        if self.local.is_beside() {
            let (moved, change) = self.local.swung(simd, turned);
            let [ahead, across, _] = from_turned(turned, moved);
            let [_, on, _] = from_turned(turned, change);
            let up = dot(normal, moved);
            aside = aside + across - tilt * up;
            by = by + level.mul_add(up, -ahead) + on - tilt * dot(normal, change);
            bend = all(simd, 0.0);
        }
        scaled([aside, by, bend], self.counts)
    }

    /// Velocity of the touching point as the wheel points now: ahead and to the left [m/s].
    #[inline(always)]
    fn ways(&self) -> [Lanes<S>; 2] {
        let [nx, _, nz] = self.local.normal;
        let square = nx.mul_add(nx, nz * nz);
        let share = square * square.inverse_root();
        let [ahead, left, _] = along(self.slide, share, self.rim);
        [ahead * self.counts, left * self.counts]
    }

    /// Speeds of which these are made, or more [m/s].
    #[inline(always)]
    fn size(&self, simd: S) -> Lanes<S> {
        let [ahead, left] = self.local.offset;
        // The rim is not faster than its radius times that.
        let arm = all(simd, ahead.hypot(left) + 1.5 * self.local.radius);
        length(self.local.turn).mul_add(arm, length(self.local.velocity)) * self.counts
    }
}

/// The length of a vector, or more.
#[inline(always)]
fn length<S: Vector>([x, y, z]: Vectors<S>) -> Lanes<S> {
    x.abs() + y.abs() + z.abs()
}

/// Rotation of a joint, and its angle [rad].
#[derive(Clone, Copy)]
pub(crate) struct Aimed<S: Vector> {
    pub turned: Turned<S>,
    pub angle: Lanes<S>,
    /// True if wheels do not roll as well half a turn from there.
    pub beside: bool,
}

/// Direction of the wheels of one joint.
#[derive(Clone, Copy)]
struct Joint<S: Vector> {
    turned: Turned<S>,
    size: Lanes<S>,
    /// Length of the last turn [rad]; nothing where the root is found.
    last: Lanes<S>,
    open: Mask<S>,
}

impl<S: Vector> Joint<S> {
    /// A turn of Newton's method where it is open; lanes that have found theirs wait for the others, so that no lane
    /// depends on another.
    #[inline(always)]
    fn turn(&mut self, simd: S, [aside, by, bend]: Vectors<S>, last: f64, doubt: &mut Mask<S>) {
        let inverse = all(simd, 1.0).quotient(by);
        let step = -(aside * inverse);
        let bent = bend * inverse * (step * step);
        let step = bent.mul_add(all(simd, -0.5), step);
        let length = step.abs();
        let most = all(simd, SHORTER) * self.last;
        let steep = (all(simd, FLAT) * self.size).below(by.abs());
        *doubt = *doubt | (self.open & !(length.at_most(most) & steep));
        let (sin, cos) = self.turned;
        let (s, c) = (step.mul_add(cos, sin), cos - step * sin);
        let inverse = step.mul_add(step, all(simd, 1.0)).inverse_root();
        self.turned = (self.open.select(s * inverse, sin), self.open.select(c * inverse, cos));
        self.open = self.open & all(simd, last).below(length);
        self.last = length;
    }
}

/// Turns every joint to where the touching points of its wheels go. Adds to the doubtful lanes those that do not get
/// there quickly.
#[inline(always)]
pub(crate) fn aimed<S: Vector>(
    simd: S,
    steering: impl Fn(usize) -> Option<usize> + Copy,
    locals: &[Local<S>],
    touching: &[Lanes<S>; MAX_WHEELS],
    doubt: &mut Mask<S>,
) -> [Option<Aimed<S>>; MAX_WHEELS] {
    let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
    // Of every joint its wheels, whether one of them touches, where they go, and how fast.
    let mut wheels = [0_u32; MAX_WHEELS];
    let mut touches = [zero; MAX_WHEELS];
    let (mut ways, mut sizes) = ([[zero; 2]; MAX_WHEELS], [zero; MAX_WHEELS]);
    let mut beside = [false; MAX_WHEELS];
    for (wheel, touching) in touching.iter().enumerate().take(locals.len()) {
        if let Some(joint) = steering(wheel) {
            wheels[joint] |= 1 << wheel;
            touches[joint] = touches[joint].max(*touching);
        }
    }
    let mut aims = [None; MAX_WHEELS];
    for (wheel, (aim, local)) in aims.iter_mut().zip(locals).enumerate() {
        let Some(joint) = steering(wheel) else {
            continue;
        };
        let counts = zero.below(touches[joint]).select(touching[wheel], one);
        let aims = Aim::new(simd, local, counts);
        let [ahead, left] = aims.ways();
        ways[joint] = [ways[joint][0] + ahead, ways[joint][1] + left];
        sizes[joint] = sizes[joint] + aims.size(simd);
        beside[joint] |= local.is_beside();
        *aim = Some(aims);
    }
    let nowhere = Joint { turned: (zero, one), size: zero, last: all(simd, 0.5), open: zero.below(zero) };
    let mut joints = [nowhere; MAX_WHEELS];
    for (k, joint) in joints.iter_mut().enumerate() {
        if wheels[k] == 0 {
            continue;
        }
        let Way { turned, rests, .. } = way(ways[k], (zero, one), doubt);
        let slight = ways[k][0].abs().below(all(simd, SLIGHT) * sizes[k]);
        *doubt = *doubt | (slight & !rests);
        *joint = Joint { turned, size: sizes[k], open: !rests, ..nowhere };
    }
    for _ in 0..TURNS {
        let mut open = zero.below(zero);
        for (k, joint) in joints.iter_mut().enumerate() {
            if !joint.open.any() {
                continue;
            }
            let (mut sums, mut left) = ([zero; 3], wheels[k]);
            while let Some(aim) = aims.get(left.trailing_zeros() as usize) {
                left &= left - 1;
                if let Some(aim) = aim {
                    sums = sum(sums, aim.aside(simd, joint.turned));
                }
            }
            let last = if beside[k] { LAST } else { LAST_BENT };
            joint.turn(simd, sums, last, doubt);
            open = open | joint.open;
        }
        // Whoever is in doubt need not be waited for.
        if !(open & !*doubt).any() {
            break;
        }
    }
    let mut aimed = [None; MAX_WHEELS];
    for (k, (found, joint)) in aimed.iter_mut().zip(&joints).enumerate() {
        if wheels[k] == 0 {
            continue;
        }
        *doubt = *doubt | joint.open;
        let (sin, cos) = joint.turned;
        let square = cos.abs().below(all(simd, SLIGHT));
        *doubt = *doubt | square;
        let behind = cos.sign();
        if beside[k] {
            *doubt = *doubt | cos.below(zero);
        }
        let turned = (sin.flip(behind), cos.flip(behind));
        *found = Some(Aimed { turned, angle: angle_of(simd, turned), beside: beside[k] });
    }
    aimed
}
