//! Which way steered wheels point, in lanes: what `moving::steer` does for one rover.

use super::columns::{Way, angle_of, way};
use crate::batch::machine::lanes::{Lanes, Mask};
use crate::batch::machine::vector::Vector;
use crate::suspension::MAX_WHEELS;
use crate::suspension::lanes::{Turned, Vectors, all, cross, dot, scaled, sum};

/// Turns of Newton's method.
const TURNS: usize = 8;

/// A turn has to be shorter than this share of the last one, of which the first is taken to be half a radian: less than
/// what the plain way lets pass, so that it goes the same way.
const SHORTER: f64 = 0.4;

/// A turn shorter than this [rad] is the last one: what it leaves is its square, or some of them.
const LAST: f64 = 1e-8;

/// Speeds below this share of those they are made of are for the plain way: there a sign, or a root, hangs on rounding.
const SLIGHT: f64 = 1e-9;

/// The same for how speeds change with the angle: nearly double roots are found as well as rounding lets them be.
const FLAT: f64 = 0.02;

/// A wheel in its own axes: ahead, to the left and up at the steering angle of the footing.
#[derive(Clone, Copy)]
pub(super) struct Local<S: Vector> {
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
        Self {
            normal: [zero; 3],
            velocity: [zero; 3],
            turn: [zero; 3],
            offset: [0.0; 2],
            radius: 1.0,
        }
    }

    fn is_beside(&self) -> bool {
        self.offset != [0.0; 2]
    }

    /// The velocity of its centre where it is turned like this [m/s], and the derivative by the angle; that is None where the
    /// centre lies on the axis.
    #[inline(always)]
    fn swung(&self, simd: S, (sin, cos): Turned<S>) -> (Vectors<S>, Option<Vectors<S>>) {
        if !self.is_beside() {
            return (self.velocity, None);
        }
        let zero = all(simd, 0.0);
        let (x, y) = (all(simd, self.offset[0]), all(simd, self.offset[1]));
        let to = [x.mul_add(cos, -(y * sin)), x.mul_add(sin, y * cos)];
        let moved = cross(self.turn, [to[0] - x, to[1] - y, zero]);
        let on = cross(self.turn, [-to[1], to[0], zero]);
        (sum(self.velocity, moved), Some(on))
    }

    /// The rate of its encoder when it rolls over a plane, turned like this, or at a contact angle [rad/s].
    #[inline(always)]
    pub fn rolling(&self, simd: S, turned: Turned<S>, at: Turned<S>) -> Lanes<S> {
        let (sin, cos) = turned;
        let (velocity, _) = self.swung(simd, turned);
        let ahead = velocity[0].mul_add(cos, velocity[1] * sin);
        let along = ahead.mul_add(at.1, velocity[2] * at.0);
        let turning = self.turn[1].mul_add(cos, -(self.turn[0] * sin));
        along.mul_add(all(simd, 1.0 / self.radius), -turning)
    }

    /// The normal along the wheel's forward and upward axes where it is turned like this.
    #[inline(always)]
    pub fn upright(&self, (sin, cos): Turned<S>) -> [Lanes<S>; 2] {
        let [x, y, z] = self.normal;
        [x.mul_add(cos, y * sin), z]
    }
}

/// What a wheel counts for its joint, and what it does sideways.
#[derive(Clone, Copy)]
struct Aim<S: Vector> {
    local: Local<S>,
    /// `r n x w` [m/s].
    rim: Vectors<S>,
    /// 1, or 0 for one in the air beside one that touches.
    counts: Lanes<S>,
}

impl<S: Vector> Aim<S> {
    /// How fast the touching point goes sideways, times the length of the normal across the axle, and the derivative
    /// by the angle [m/s].
    #[inline(always)]
    fn aside(&self, simd: S, turned: Turned<S>) -> [Lanes<S>; 2] {
        let (sin, cos) = turned;
        let [nx, ny, nz] = self.local.normal;
        let (velocity, change) = self.local.swung(simd, turned);
        let across = |[x, y, _]: Vectors<S>| y.mul_add(cos, -(x * sin));
        let ahead = |[x, y, _]: Vectors<S>| x.mul_add(cos, y * sin);
        // The tilt of the axle against the ground has minus `level` as its derivative.
        let (tilt, level) = (ny.mul_add(cos, -(nx * sin)), nx.mul_add(cos, ny * sin));
        let share = level.mul_add(level, nz * nz).sqrt();
        let up = dot(self.local.normal, velocity);
        let (rim, rim_on) = (across(self.rim), -ahead(self.rim));
        let aside = share.mul_add(rim, across(velocity) - tilt * up);
        let mut by = level.mul_add(up, -ahead(velocity));
        by = share.mul_add(rim_on, by) + (tilt * level).quotient(share) * rim;
        if let Some(change) = change {
            by = by + across(change) - tilt * dot(self.local.normal, change);
        }
        [aside * self.counts, by * self.counts]
    }

    /// Where the touching point goes as the wheel points now: ahead and to the left [m/s].
    #[inline(always)]
    fn ways(&self) -> [Lanes<S>; 2] {
        let [nx, ny, nz] = self.local.normal;
        let share = nx.mul_add(nx, nz * nz).sqrt();
        let velocity = self.local.velocity;
        let up = dot(self.local.normal, velocity);
        let of = |n: Lanes<S>, v: Lanes<S>, rim: Lanes<S>| share.mul_add(rim, v - n * up);
        [
            of(nx, velocity[0], self.rim[0]) * self.counts,
            of(ny, velocity[1], self.rim[1]) * self.counts,
        ]
    }

    /// Speeds of which these are made, or more [m/s].
    #[inline(always)]
    fn size(&self, simd: S) -> Lanes<S> {
        let length = |[x, y, z]: Vectors<S>| x.abs() + y.abs() + z.abs();
        let [ahead, left] = self.local.offset;
        let arm = all(simd, ahead.hypot(left));
        let swing = length(self.local.turn) * arm;
        (length(self.local.velocity) + length(self.rim) + swing) * self.counts
    }
}

/// How far a joint turns, and its angle [rad].
#[derive(Clone, Copy)]
pub(super) struct Aimed<S: Vector> {
    pub turned: Turned<S>,
    pub angle: Lanes<S>,
    /// Whether half a turn from there wheels do not roll as well.
    pub beside: bool,
}

/// Where the wheels of one joint point.
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
    fn turn<'a>(&mut self, simd: S, aims: impl Iterator<Item = &'a Aim<S>>, doubt: &mut Mask<S>)
    where
        S: 'a,
    {
        let zero = all(simd, 0.0);
        let (mut aside, mut by) = (zero, zero);
        for aim in aims {
            let [one, slope] = aim.aside(simd, self.turned);
            (aside, by) = (aside + one, by + slope);
        }
        let step = -(aside.quotient(by));
        let length = step.abs();
        let most = all(simd, SHORTER) * self.last;
        let steep = (all(simd, FLAT) * self.size).below(by.abs());
        *doubt = *doubt | (self.open & !(length.at_most(most) & steep));
        let (sin, cos) = self.turned;
        let (s, c) = (step.mul_add(cos, sin), cos - step * sin);
        let inverse = step.mul_add(step, all(simd, 1.0)).inverse_root();
        self.turned = (
            self.open.select(s * inverse, sin),
            self.open.select(c * inverse, cos),
        );
        self.open = self.open & all(simd, LAST).below(length);
        self.last = length;
    }
}

/// Turns every joint to where the touching points of its wheels go. Adds to the doubtful lanes those that do not get
/// there quickly.
#[inline(always)]
pub(super) fn aimed<S: Vector>(
    simd: S,
    steering: impl Fn(usize) -> Option<usize> + Copy,
    locals: &[Local<S>],
    touching: &[Lanes<S>; MAX_WHEELS],
    doubt: &mut Mask<S>,
) -> [Option<Aimed<S>>; MAX_WHEELS] {
    let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
    let still = Aim {
        local: Local::none(simd),
        rim: [zero; 3],
        counts: one,
    };
    let mut aims = [still; MAX_WHEELS];
    let joint_of = |wheel: usize| (wheel < locals.len()).then(|| steering(wheel)).flatten();
    let of = |joint: usize| move |wheel: &usize| joint_of(*wheel) == Some(joint);
    let mut joints: [Option<Joint<S>>; MAX_WHEELS] = [None; MAX_WHEELS];
    for (joint, slot) in joints.iter_mut().enumerate() {
        let wheels = || (0..MAX_WHEELS).filter(of(joint));
        if wheels().next().is_none() {
            continue;
        }
        let mut touches = zero;
        for wheel in wheels() {
            touches = touches.max(touching[wheel]);
        }
        let (mut size, mut way_of) = (zero, [zero; 2]);
        for wheel in wheels() {
            let (aim, local) = (&mut aims[wheel], &locals[wheel]);
            aim.local = *local;
            aim.rim = scaled(cross(local.normal, local.turn), all(simd, local.radius));
            aim.counts = zero.below(touches).select(touching[wheel], one);
            let [ahead, left] = aim.ways();
            way_of = [way_of[0] + ahead, way_of[1] + left];
            size = size + aim.size(simd);
        }
        let Way { turned, rests, .. } = way(way_of, (zero, one), doubt);
        let slight = way_of[0].abs().below(all(simd, SLIGHT) * size);
        *doubt = *doubt | (slight & !rests);
        *slot = Some(Joint {
            turned,
            size,
            last: all(simd, 0.5),
            open: !rests,
        });
    }
    for _ in 0..TURNS {
        let mut open = zero.below(zero);
        for (joint, slot) in joints.iter_mut().enumerate() {
            let Some(found) = slot else { continue };
            let wheels = aims.iter().enumerate();
            let own = wheels.filter(|(wheel, _)| of(joint)(wheel));
            found.turn(simd, own.map(|(_, aim)| aim), doubt);
            open = open | found.open;
        }
        // Whoever is in doubt need not be waited for.
        if !(open & !*doubt).any() {
            break;
        }
    }
    let mut aimed = [None; MAX_WHEELS];
    for (joint, (found, slot)) in aimed.iter_mut().zip(&joints).enumerate() {
        let Some(Joint { turned, open, .. }) = slot else {
            continue;
        };
        *doubt = *doubt | *open;
        let (sin, cos) = *turned;
        let mut wheels = (0..MAX_WHEELS).filter(of(joint));
        let beside = wheels.any(|wheel| aims[wheel].local.is_beside());
        let square = cos.abs().below(all(simd, SLIGHT));
        *doubt = *doubt | square;
        let behind = cos.sign();
        if beside {
            *doubt = *doubt | cos.below(zero);
        }
        let turned = (sin.flip(behind), cos.flip(behind));
        *found = Some(Aimed {
            turned,
            angle: angle_of(simd, turned),
            beside,
        });
    }
    aimed
}
