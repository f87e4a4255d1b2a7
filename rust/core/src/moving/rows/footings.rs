//! Where rovers stand, row after row, and a row per lane.

use super::columns::Span;
use crate::batch::machine::lanes::{Lanes, Mask};
use crate::batch::machine::polynomials::{LARGEST_ANGLE, direction, sin_cos};
use crate::batch::machine::vector::Vector;
use crate::ground::Stand;
use crate::moving::Footing;
use crate::suspension::lanes::{LARGEST_TURN, MOST, Turned, Vectors, all, rotated, scaled};
use crate::suspension::{Chain, Joint, MAX_FREE, MAX_WHEELS};
use crate::terrain::normal;
use crate::wheels::Direction;

/// A wheel further than this from the ground hangs [m]: a thousand times what settling leaves.
const HANGING: f64 = 1e-6;

/// A free angle nearer than this to its stop is at it [rad].
const STOPPED: f64 = 1e-9;

/// Slopes beyond which a lane is left to the plain way.
const STEEP: f64 = 1e100;

/// Where rovers stand.
#[derive(Clone, Copy, Debug)]
pub enum Footings<'a> {
    /// As they have settled.
    Settled {
        /// The settled poses; a single one is every row.
        stands: &'a [Stand],
        /// Rows x, y, yaw.
        poses: &'a [[f64; 3]],
        /// Steering angles [rad]: none if all are 0, one row, or one per pose.
        steering: &'a [f64],
    },
    /// As somebody says; one row is every row.
    Told(Told<'a>),
}

/// The numbers of settled poses, row after row.
#[derive(Clone, Copy, Debug)]
pub struct Told<'a> {
    /// Roll and pitch of the body, one per row each [rad].
    pub roll: &'a [f64],
    /// See `roll`.
    pub pitch: &'a [f64],
    /// `world_from_body`.
    pub transform: &'a [[f64; 16]],
    /// Free angles [rad].
    pub joints: &'a [f64],
    /// Steering angles [rad].
    pub steering: &'a [f64],
    /// Contact angles [rad].
    pub angles: &'a [f64],
    /// Unit normals of the ground.
    pub normals: &'a [[f64; 3]],
    /// Least distances of the rims from the ground [m].
    pub gap: &'a [f64],
}

/// The numbers of one row, eight and eight, as they are turned into columns: roll, pitch, yaw and the free angles [rad];
/// the steering angles [rad]; of every wheel its gap [m], sine and cosine of its contact angle, and the slopes of
/// the ground where it is settled or else its normal.
type One = [[f64; MOST]; 2 + MAX_WHEELS];

/// The numbers of as many rows as there are lanes at most.
#[repr(align(64))]
pub(super) struct Eights([One; MOST]);

impl Eights {
    pub fn new() -> Self {
        Self([ZERO; MOST])
    }

    /// Eight columns of them.
    #[inline(always)]
    fn columns<S: Vector>(&self, simd: S, part: usize) -> [Lanes<S>; MOST] {
        let rows = self.0.as_flattened().as_flattened();
        Lanes::columns(
            simd,
            &rows[part * MOST..],
            size_of::<One>() / size_of::<f64>(),
        )
    }
}

/// The row of so many numbers each, of which there may be one for all.
fn row(values: &[f64], width: usize, k: usize) -> &[f64] {
    let first = if values.len() > width { k * width } else { 0 };
    values.get(first..first + width).unwrap_or_default()
}

const ZERO: One = [[0.0; MOST]; 2 + MAX_WHEELS];

impl Footings<'_> {
    /// Whether anything is steered.
    fn steers(&self) -> bool {
        match self {
            Self::Settled { steering, .. } => !steering.is_empty(),
            Self::Told(told) => !told.steering.is_empty(),
        }
    }

    /// Puts down the numbers of a row.
    #[inline(always)]
    fn put(&self, chain: &Chain, k: usize, one: &mut One) {
        let [body, steered, contacts @ ..] = one;
        let (place, steering) = match self {
            Self::Settled {
                stands,
                poses,
                steering,
            } => {
                let place = if stands.len() == 1 { 0 } else { k };
                let stand = &stands[place];
                let [_, roll, pitch, a, b, c] = stand.state;
                *body = [roll, pitch, poses[place][2], a, b, c, 0.0, 0.0];
                for (numbers, contact) in contacts.iter_mut().zip(&stand.wheels) {
                    let (at, [x, y]) = (contact.at, contact.gradient);
                    numbers[..5].copy_from_slice(&[contact.gap, at.sin, at.cos, x, y]);
                }
                (place, *steering)
            }
            Self::Told(told) => {
                let place = if told.roll.len() == 1 { 0 } else { k };
                let transform = &told.transform[place];
                let yaw = transform[4].atan2(transform[0]);
                body[..3].copy_from_slice(&[told.roll[place], told.pitch[place], yaw]);
                let angles = row(told.joints, chain.joints().len(), place);
                body[3..3 + angles.len()].copy_from_slice(angles);
                let wheels = chain.wheels().len();
                for (wheel, numbers) in contacts.iter_mut().enumerate().take(wheels) {
                    let which = place * wheels + wheel;
                    let at = Direction::from(told.angles[which]);
                    let [x, y, z] = told.normals[which];
                    *numbers = [told.gap[which], at.sin, at.cos, x, y, z, 0.0, 0.0];
                }
                (place, told.steering)
            }
        };
        if !steering.is_empty() {
            let angles = row(steering, chain.steering().len(), place);
            steered[..angles.len()].copy_from_slice(angles);
        }
    }

    /// Does something with one row, the plain way.
    pub fn with<T>(&self, chain: &Chain, k: usize, work: impl FnOnce(&mut Footing<'_>) -> T) -> T {
        let mut one = ZERO;
        self.put(chain, k, &mut one);
        let settled = matches!(self, Self::Settled { .. });
        let (mut angles, mut normals) = ([0.0; MAX_WHEELS], [[0.0, 0.0, 1.0]; MAX_WHEELS]);
        let (mut touching, mut stopped) = ([false; MAX_WHEELS], [false; MAX_FREE]);
        let (wheels, free) = (chain.wheels().len(), chain.joints().len());
        let mut hangs = false;
        for wheel in 0..wheels {
            let [gap, sin, cos, x, y, z, ..] = one[2 + wheel];
            angles[wheel] = sin.atan2(cos);
            normals[wheel] = match settled {
                true => normal([x, y]).into(),
                false => [x, y, z],
            };
            touching[wheel] = gap.abs() <= HANGING;
            hangs |= gap > HANGING;
        }
        let joints = &one[0][3..3 + free];
        // None is at a stop unless a wheel hangs.
        if hangs {
            for ((stopped, angle), joint) in stopped.iter_mut().zip(joints).zip(chain.joints()) {
                let [lower, upper] = stops(joint);
                *stopped = *angle <= lower || *angle >= upper;
            }
        }
        let [roll, pitch, yaw, ..] = one[0];
        work(&mut Footing {
            attitude: [roll, pitch, yaw],
            joints,
            steering: &one[1][..chain.steering().len()],
            angles: &angles[..wheels],
            normals: &normals[..wheels],
            touching,
            stopped,
        })
    }
}

/// From where on a free angle is at its lower and its upper stop [rad].
fn stops(joint: &Joint) -> [f64; 2] {
    [joint.range.lower + STOPPED, joint.range.upper - STOPPED]
}

/// Rows where they stand, in lanes.
pub(super) struct Standing<S: Vector> {
    /// Of roll and pitch.
    pub roll: Turned<S>,
    pub pitch: Turned<S>,
    pub joints: [Lanes<S>; MAX_FREE],
    /// Angles of the steering joints [rad].
    pub steering: [Lanes<S>; MAX_WHEELS],
    /// Whether one of them is not 0.
    pub steers: bool,
    /// Of the contact angles.
    pub at: [Turned<S>; MAX_WHEELS],
    /// Of the ground, in the body.
    pub normals: [Vectors<S>; MAX_WHEELS],
    /// 1 where a wheel touches, and whether all do in every lane.
    pub touching: [Lanes<S>; MAX_WHEELS],
    pub all_touch: bool,
    /// 1 where a joint is at a stop, and whether any is.
    pub stopped: [Lanes<S>; MAX_FREE],
    pub any_stopped: bool,
    /// Where nothing touches.
    pub nowhere: Mask<S>,
}

impl<S: Vector> Standing<S> {
    /// Some rows; adds to the doubtful lanes those that are not for lanes.
    #[inline(always)]
    pub fn new(
        simd: S,
        chain: &Chain,
        footings: &Footings<'_>,
        span: Span,
        read: &mut Eights,
        doubt: &mut Mask<S>,
    ) -> Self {
        for (lane, one) in read.0.iter_mut().enumerate().take(S::F64_LANES) {
            footings.put(chain, span.first + lane.min(span.count - 1), one);
        }
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        let [roll, pitch, yaw, joints @ ..] = read.columns(simd, 0);
        let far = all(simd, LARGEST_TURN);
        let mut plain = all(simd, LARGEST_ANGLE).below(yaw.abs());
        plain = plain | far.below(roll.abs()) | far.below(pitch.abs());
        let mut standing = Self {
            roll: direction(simd, roll),
            pitch: direction(simd, pitch),
            joints: [zero; MAX_FREE],
            steering: [zero; MAX_WHEELS],
            steers: footings.steers(),
            at: [(zero, one); MAX_WHEELS],
            normals: [[zero; 3]; MAX_WHEELS],
            touching: [zero; MAX_WHEELS],
            all_touch: true,
            stopped: [zero; MAX_FREE],
            any_stopped: false,
            nowhere: zero.at_most(zero),
        };
        if standing.steers {
            let angles = read.columns(simd, 1);
            let steered = chain.steering().len();
            for (to, angle) in standing.steering.iter_mut().zip(angles).take(steered) {
                *to = angle;
                plain = plain | far.below(angle.abs());
            }
        }
        let heading = sin_cos(simd, yaw);
        let settled = matches!(footings, Footings::Settled { .. });
        let (hanging, mut hangs) = (all(simd, HANGING), zero.below(zero));
        for k in 0..chain.wheels().len().min(MAX_WHEELS) {
            let [gap, sin, cos, x, y, z, ..] = read.columns(simd, 2 + k);
            let touches = gap.abs().at_most(hanging);
            standing.touching[k] = touches.select(one, zero);
            standing.all_touch &= !(!touches).any();
            standing.nowhere = standing.nowhere & !touches;
            hangs = hangs | hanging.below(gap);
            standing.at[k] = (sin, cos);
            let upwards = if settled { [-x, -y, one] } else { [x, y, z] };
            let mut normal = standing.in_body(heading, upwards);
            if settled {
                let square = x.mul_add(x, y.mul_add(y, one));
                plain = plain | all(simd, STEEP).below(square);
                normal = scaled(normal, square.inverse_root());
            }
            standing.normals[k] = normal;
        }
        let hang = hangs.any();
        for (k, joint) in chain.joints().iter().enumerate().take(MAX_FREE) {
            standing.joints[k] = joints[k];
            plain = plain | far.below(joints[k].abs());
            if hang {
                let [lower, upper] = stops(joint).map(|stop| all(simd, stop));
                let stopped = hangs & (joints[k].at_most(lower) | upper.at_most(joints[k]));
                standing.stopped[k] = stopped.select(one, zero);
                standing.any_stopped |= stopped.any();
            }
        }
        *doubt = *doubt | (plain & !standing.nowhere);
        standing
    }

    /// A vector of the world in the axes of the body.
    #[inline(always)]
    fn in_body(&self, heading: Turned<S>, [x, y, z]: Vectors<S>) -> Vectors<S> {
        // Turned backwards about z, y, x.
        let (sy, cy) = heading;
        let (sp, cp) = self.pitch;
        let (sr, cr) = self.roll;
        let (x, y) = (x.mul_add(cy, y * sy), y.mul_add(cy, -(x * sy)));
        let (x, z) = (x.mul_add(cp, -(z * sp)), z.mul_add(cp, x * sp));
        [x, y.mul_add(cr, z * sr), z.mul_add(cr, -(y * sr))]
    }
}

/// The direction in which a wheel rolls over a plane, and where it touches, from its axes and the plane's normal: the
/// sine and cosine of its contact angle.
#[inline(always)]
pub(super) fn on_plane<S: Vector>(forward: Lanes<S>, up: Lanes<S>) -> Turned<S> {
    let inverse = forward.mul_add(forward, up * up).inverse_root();
    (-(forward * inverse), up * inverse)
}

/// The tangent of a rim at a contact angle, and the way from its centre to there for a radius of 1.
#[inline(always)]
pub(super) fn rim<S: Vector>(
    (sin, cos): Turned<S>,
    forward: Vectors<S>,
    up: Vectors<S>,
) -> [Vectors<S>; 2] {
    // h cos + u sin; a quarter turn on u cos - h sin, which is minus the spoke.
    let [tangent, inwards] = rotated((sin, cos), forward, up);
    [tangent, [-inwards[0], -inwards[1], -inwards[2]]]
}
