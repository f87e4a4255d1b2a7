//! Settled poses, row after row, and a row per lane.

use super::columns::Span;
use crate::Footing;
use six_wheel_kinematics::wheels::Direction;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::polynomials::{LARGEST_ANGLE, direction, sin_cos};
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_terrain::ground::{CONTACT, NUMBERS, Stand};
use six_wheel_terrain::suspension::lanes::{LARGEST_TURN, MOST, Turned, Vectors, all, dot};
use six_wheel_terrain::suspension::{Chain, Joint, MAX_FREE, MAX_STATE, MAX_WHEELS};
use six_wheel_terrain::terrain::normal;

/// A wheel further than this from the ground hangs [m]: a thousand times what settling leaves.
const HANGING: f64 = 1e-6;

/// A free angle nearer than this to its stop is at it [rad].
const STOPPED: f64 = 1e-9;

/// Slopes beyond which a lane is left to the plain way.
const STEEP: f64 = 1e100;

/// Registers of stands from those that are read to those that are fetched.
const AHEAD: usize = 2;

/// Settled poses, row after row.
#[derive(Clone, Copy, Debug)]
pub enum SettledPoses<'a> {
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
    Input(SettledPoseInput<'a>),
}

/// The numbers of settled poses, row after row.
#[derive(Clone, Copy, Debug)]
pub struct SettledPoseInput<'a> {
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
pub(crate) struct Eights([One; MOST]);

impl Eights {
    pub fn new() -> Self {
        Self([ZERO; MOST])
    }

    /// Eight columns of them.
    #[inline(always)]
    fn columns<S: Vector>(&self, simd: S, part: usize) -> [Lanes<S>; MOST] {
        let rows = self.0.as_flattened().as_flattened();
        Lanes::columns(simd, &rows[part * MOST..], size_of::<One>() / size_of::<f64>())
    }
}

/// The row of so many numbers each, of which there may be one for all.
fn row(values: &[f64], width: usize, k: usize) -> &[f64] {
    let first = if values.len() > width { k * width } else { 0 };
    values.get(first..first + width).unwrap_or_default()
}

const ZERO: One = [[0.0; MOST]; 2 + MAX_WHEELS];

impl SettledPoses<'_> {
    /// Steering angles, none if all are 0.
    fn steering(&self) -> &[f64] {
        match self {
            Self::Settled { steering, .. } => steering,
            Self::Input(told) => told.steering,
        }
    }

    /// Puts down the numbers of a row.
    #[inline(always)]
    fn put(&self, chain: &Chain, k: usize, one: &mut One) {
        let [body, steered, contacts @ ..] = one;
        let (place, steering) = match self {
            Self::Settled { stands, poses, steering } => {
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
            Self::Input(told) => {
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

/// Input of some rows, as it is read.
enum Given<'a> {
    /// The poses and the numbers of the stands.
    Settled(&'a [[f64; 3]], [&'a [f64; NUMBERS]; MOST]),
    Input(&'a Eights),
}

/// Direction of the ground's normal, in the world.
enum Upwards<S: Vector> {
    Normal(Vectors<S>),
    /// Derivatives of its height.
    Slopes([Lanes<S>; 2]),
}

/// Eight numbers of each from the same one on.
#[inline(always)]
fn eights<'a>(numbers: &[&'a [f64; NUMBERS]; MOST], first: usize) -> [&'a [f64; MOST]; MOST] {
    let mut eights = [&[0.0; MOST]; MOST];
    for (eight, row) in eights.iter_mut().zip(numbers) {
        *eight = row[first..].first_chunk().unwrap_or(&[0.0; MOST]);
    }
    eights
}

impl<'a> Given<'a> {
    #[inline(always)]
    fn new<S: Vector>(simd: S, chain: &Chain, footings: &SettledPoses<'a>, span: Span, read: &'a mut Eights) -> Self {
        let row = |lane: usize| span.first + lane.min(span.count - 1);
        if let SettledPoses::Settled { stands, poses, .. } = *footings {
            let mut numbers = [stands[0].numbers(); MOST];
            if stands.len() > 1 {
                for (lane, numbers) in numbers.iter_mut().enumerate().take(S::F64_LANES) {
                    *numbers = stands[row(lane)].numbers();
                    // Asked for beforehand: a stand is several lines, and eight of them more than the processor follows.
                    let ahead = AHEAD * S::F64_LANES * size_of::<Stand>();
                    for k in (0..NUMBERS).step_by(MOST) {
                        simd.fetch(numbers.as_ptr().wrapping_add(k).wrapping_byte_add(ahead));
                    }
                }
            }
            return Self::Settled(poses, numbers);
        }
        for (lane, one) in read.0.iter_mut().enumerate().take(S::F64_LANES) {
            footings.put(chain, row(lane), one);
        }
        Self::Input(read)
    }

    /// Roll, pitch and yaw, and the free angles [rad].
    #[inline(always)]
    fn body<S: Vector>(&self, simd: S, span: Span) -> (Vectors<S>, [Lanes<S>; MAX_FREE]) {
        match self {
            Self::Settled(poses, numbers) => {
                let first = eights(numbers, 0);
                let [_, roll, pitch, a, b, c, ..] = Lanes::columns_of(simd, &first);
                let yaw = match poses {
                    [[_, _, yaw]] => all(simd, *yaw),
                    _ => span.read::<S, 3>(simd, poses.as_flattened(), 3)[2],
                };
                ([roll, pitch, yaw], [a, b, c])
            }
            Self::Input(eights) => {
                let [roll, pitch, yaw, a, b, c, ..] = eights.columns(simd, 0);
                ([roll, pitch, yaw], [a, b, c])
            }
        }
    }

    /// Gap and contact angle of a wheel, and where the ground faces.
    #[inline(always)]
    fn contact<S: Vector>(&self, simd: S, wheel: usize) -> (Lanes<S>, Turned<S>, Upwards<S>) {
        match self {
            Self::Settled(_, numbers) => {
                // Eight numbers, of which the last contact has only six left.
                let first = (MAX_STATE + CONTACT * wheel).min(NUMBERS - MOST);
                let columns = Lanes::columns_of(simd, &eights(numbers, first));
                let [gap, sin, cos, x, y] = match wheel + 1 < MAX_WHEELS {
                    true => [columns[0], columns[1], columns[2], columns[3], columns[4]],
                    false => [columns[2], columns[3], columns[4], columns[5], columns[6]],
                };
                (gap, (sin, cos), Upwards::Slopes([x, y]))
            }
            Self::Input(eights) => {
                let [gap, sin, cos, x, y, z, ..] = eights.columns(simd, 2 + wheel);
                (gap, (sin, cos), Upwards::Normal([x, y, z]))
            }
        }
    }
}

/// Angles from which on a free angle is at its lower and its upper stop [rad].
fn stops(joint: &Joint) -> [f64; 2] {
    [joint.range.lower + STOPPED, joint.range.upper - STOPPED]
}

/// Rows where they stand, in lanes.
pub(crate) struct Standing<S: Vector> {
    /// Of roll and pitch.
    pub roll: Turned<S>,
    pub pitch: Turned<S>,
    pub joints: [Lanes<S>; MAX_FREE],
    /// Angles of the steering joints [rad].
    pub steering: [Lanes<S>; MAX_WHEELS],
    /// True if one of them is not 0.
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
    /// Lanes in which nothing touches.
    pub nowhere: Mask<S>,
}

impl<S: Vector> Standing<S> {
    /// Nothing is read yet.
    #[inline(always)]
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
            touching: [zero; MAX_WHEELS],
            all_touch: true,
            stopped: [zero; MAX_FREE],
            any_stopped: false,
            nowhere: zero.at_most(zero),
        }
    }

    /// Reads some rows, of the same footings as before; adds to the doubtful lanes those that are not for lanes.
    #[inline(always)]
    pub fn read(
        &mut self,
        simd: S,
        chain: &Chain,
        footings: &SettledPoses<'_>,
        span: Span,
        read: &mut Eights,
        doubt: &mut Mask<S>,
    ) {
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        let given = Given::new(simd, chain, footings, span, read);
        let ([roll, pitch, yaw], joints) = given.body(simd, span);
        let far = all(simd, LARGEST_TURN);
        let mut plain = all(simd, LARGEST_ANGLE).below(yaw.abs());
        plain = plain | far.below(roll.abs()) | far.below(pitch.abs());
        let standing = self;
        (standing.roll, standing.pitch) = (direction(simd, roll), direction(simd, pitch));
        standing.steers = !footings.steering().is_empty();
        (standing.all_touch, standing.any_stopped) = (true, false);
        standing.nowhere = zero.at_most(zero);
        let steered = chain.steering().len();
        if standing.steers {
            let steering = footings.steering();
            standing.steering = match steering.len() > steered {
                true => span.read(simd, steering, steered),
                // The same for all of them.
                false => Span { first: 0, count: 1 }.read(simd, steering, steered),
            };
            for angle in &standing.steering[..steered.min(MAX_WHEELS)] {
                plain = plain | far.below(angle.abs());
            }
        }
        let axes = axes(standing.roll, standing.pitch, sin_cos(simd, yaw));
        let (hanging, mut hangs) = (all(simd, HANGING), zero.below(zero));
        for k in 0..chain.wheels().len().min(MAX_WHEELS) {
            let (gap, at, upwards) = given.contact(simd, k);
            let touches = gap.abs().at_most(hanging);
            standing.touching[k] = touches.select(one, zero);
            standing.all_touch &= !(!touches).any();
            standing.nowhere = standing.nowhere & !touches;
            hangs = hangs | hanging.below(gap);
            standing.at[k] = at;
            standing.normals[k] = match upwards {
                Upwards::Normal(normal) => {
                    let [ahead, left, up] = axes;
                    [dot(ahead, normal), dot(left, normal), dot(up, normal)]
                }
                Upwards::Slopes([x, y]) => {
                    let square = x.mul_add(x, y.mul_add(y, one));
                    plain = plain | all(simd, STEEP).below(square);
                    let size = square.inverse_root();
                    let (x, y) = (x * size, y * size);
                    let [ahead, left, up] = axes;
                    let upwards = [-x, -y, size];
                    [dot(ahead, upwards), dot(left, upwards), dot(up, upwards)]
                }
            };
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
    }
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

/// The direction in which a wheel rolls over a plane, and where it touches, from its axes and the plane's normal: the
/// sine and cosine of its contact angle.
#[inline(always)]
pub(crate) fn on_plane<S: Vector>(forward: Lanes<S>, up: Lanes<S>) -> Turned<S> {
    let inverse = forward.mul_add(forward, up * up).inverse_root();
    (-(forward * inverse), up * inverse)
}
