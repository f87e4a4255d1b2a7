//! Settled poses in lanes: attitude, angles and contacts of a row in each.

use super::columns::{Span, roots, wrap_far};
use super::settled_poses::{LaneGather, NormalSource, PoseSource, SettledPoses};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::polynomials::{direction, sin_cos};
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_terrain::suspension::lanes::{Turned, Vectors, all, dot};
use six_wheel_terrain::suspension::{Chain, Joint, MAX_FREE, MAX_WHEELS};

/// A wheel farther than this from the ground is in the air [m]: a thousand times the residual of settling.
const HANGING: f64 = 1e-6;

/// A free angle nearer than this to its stop is at it [rad].
const STOPPED: f64 = 1e-9;

/// Squares of slopes beyond this are scaled before their root is taken.
const STEEP: f64 = 1e36;

/// Wheels on the ground.
#[derive(Clone, Copy)]
pub(crate) struct Touching<S: Vector> {
    /// 1 where a wheel touches.
    pub wheels: [Lanes<S>; MAX_WHEELS],
    /// True if all wheels touch in every lane.
    pub all: bool,
    /// Lanes in which no wheel touches.
    pub none: Mask<S>,
}

impl<S: Vector> Touching<S> {
    /// The numbers of a wheel where it touches, 0 elsewhere.
    #[inline(always)]
    pub fn only<const N: usize>(&self, simd: S, wheel: usize, numbers: [Lanes<S>; N]) -> [Lanes<S>; N] {
        let mut numbers = numbers;
        if !self.all {
            let zero = all(simd, 0.0);
            for number in &mut numbers {
                *number = zero.lt(self.wheels[wheel]).select(*number, zero);
            }
        }
        numbers
    }
}

/// Settled poses, a row in every lane.
pub(crate) struct PoseLanes<S: Vector> {
    /// Sines and cosines of roll and pitch.
    pub roll: Turned<S>,
    pub pitch: Turned<S>,
    /// Free angles, less whole turns of those beyond [`super::columns::wrap_far`] [rad].
    pub joints: [Lanes<S>; MAX_FREE],
    /// Angles of the steering joints [rad].
    pub steering: [Lanes<S>; MAX_WHEELS],
    /// True if any steering angle is not 0.
    pub steers: bool,
    /// Sines and cosines of the contact angles.
    pub at: [Turned<S>; MAX_WHEELS],
    /// Unit normals of the ground at the wheels, in the body.
    pub normals: [Vectors<S>; MAX_WHEELS],
    pub touching: Touching<S>,
    /// 1 where a joint is at a stop.
    pub stopped: [Lanes<S>; MAX_FREE],
    /// True if any joint is at a stop in any lane.
    pub any_stopped: bool,
}

#[inline_always]
impl<S: Vector> PoseLanes<S> {
    /// Level and straight, before anything is read.
    pub fn new(simd: S) -> Self {
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        Self {
            roll: (zero, one),
            pitch: (zero, one),
            joints: [zero; MAX_FREE],
            steering: [zero; MAX_WHEELS],
            steers: false,
            at: [(zero, one); MAX_WHEELS],
            normals: [[zero; 3]; MAX_WHEELS],
            touching: Touching { wheels: [zero; MAX_WHEELS], all: true, none: Mask::splat(simd, true) },
            stopped: [zero; MAX_FREE],
            any_stopped: false,
        }
    }

    /// Reads some rows, of the same array as before.
    pub fn read(&mut self, simd: S, chain: &Chain, poses: &SettledPoses<'_>, span: Span, gather: &mut LaneGather) {
        let source = PoseSource::new(simd, chain, poses, span, gather);
        let ([roll, pitch, yaw], joints) = source.body(simd, span);
        let [a, b, c] = joints;
        let [roll, pitch, yaw, a, b, c] = wrap_far(simd, [roll, pitch, yaw, a, b, c]);
        (self.roll, self.pitch, self.joints) = (direction(simd, roll), direction(simd, pitch), [a, b, c]);
        self.read_steering(simd, chain, poses, span);
        let axes = axes(self.roll, self.pitch, sin_cos(simd, yaw));
        let hangs = self.read_contacts(simd, chain, &source, axes);
        self.find_stops(simd, chain.joints(), joints, hangs);
    }

    fn read_steering(&mut self, simd: S, chain: &Chain, poses: &SettledPoses<'_>, span: Span) {
        let (angles, steered) = (poses.steering(), chain.steering().len());
        self.steers = !angles.is_empty();
        if self.steers {
            self.steering = match angles.len() > steered {
                true => span.read(simd, angles, steered),
                // The same for all of them.
                false => Span { first: 0, count: 1 }.read(simd, angles, steered),
            };
        }
    }

    /// Reads gaps, contact angles and normals. Returns the lanes in which a wheel is in the air.
    fn read_contacts(&mut self, simd: S, chain: &Chain, source: &PoseSource<'_>, axes: [Vectors<S>; 3]) -> Mask<S> {
        let (zero, one, hanging) = (all(simd, 0.0), all(simd, 1.0), all(simd, HANGING));
        let mut hangs = Mask::splat(simd, false);
        (self.touching.all, self.touching.none) = (true, Mask::splat(simd, true));
        for wheel in 0..chain.wheels().len().min(MAX_WHEELS) {
            let (gap, at, upwards) = source.contact(simd, wheel);
            let touches = gap.abs().le(hanging);
            self.touching.wheels[wheel] = touches.select(one, zero);
            self.touching.all &= touches.all();
            self.touching.none = self.touching.none & !touches;
            hangs = hangs | hanging.lt(gap);
            self.at[wheel] = at;
            let normal = match upwards {
                NormalSource::Normal(normal) => normal,
                NormalSource::Slopes(slopes) => normal(simd, slopes),
            };
            let [ahead, left, up] = axes;
            self.normals[wheel] = [dot(ahead, normal), dot(left, normal), dot(up, normal)];
        }
        hangs
    }

    /// Finds the free angles at their stops: there are none unless a wheel is in the air.
    fn find_stops(&mut self, simd: S, joints: &[Joint], angles: [Lanes<S>; MAX_FREE], hangs: Mask<S>) {
        self.any_stopped = false;
        if !hangs.any() {
            return;
        }
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        for (k, joint) in joints.iter().enumerate().take(MAX_FREE) {
            let lower = all(simd, joint.range.lower + STOPPED);
            let upper = all(simd, joint.range.upper - STOPPED);
            let stopped = hangs & (angles[k].le(lower) | upper.le(angles[k]));
            self.stopped[k] = stopped.select(one, zero);
            self.any_stopped |= stopped.any();
        }
    }
}

/// Unit normal, upwards, of ground with these slopes along x and y.
#[inline(always)]
fn normal<S: Vector>(simd: S, [mut x, mut y]: [Lanes<S>; 2]) -> Vectors<S> {
    let one = all(simd, 1.0);
    let mut z = one;
    let mut square = x.mul_add(x, y.mul_add(y, one));
    let steep = all(simd, STEEP).lt(square);
    if steep.any() {
        let size = steep.select(x.abs().max(y.abs()), one);
        (x, y, z) = (x / size, y / size, one / size);
        square = x.mul_add(x, y.mul_add(y, z * z));
    }
    let [inverse, _] = roots(simd, square);
    [-(x * inverse), -(y * inverse), z * inverse]
}

/// The axes of a body in the world.
#[inline(always)]
fn axes<S: Vector>((sr, cr): Turned<S>, (sp, cp): Turned<S>, (sy, cy): Turned<S>) -> [Vectors<S>; 3] {
    let (ahead, to_left) = ([cy * sp, sy * sp], [-sy, cy]);
    [
        [cy * cp, sy * cp, -sp],
        [ahead[0].mul_add(sr, to_left[0] * cr), ahead[1].mul_add(sr, to_left[1] * cr), cp * sr],
        [ahead[0].mul_add(cr, -(to_left[0] * sr)), ahead[1].mul_add(cr, -(to_left[1] * sr)), cp * cr],
    ]
}
