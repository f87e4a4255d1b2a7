//! Where rovers stand, row after row, and a row per lane.

use super::columns::Span;
use crate::batch::machine::lanes::{Lanes, Mask};
use crate::batch::machine::polynomials::{LARGEST_ANGLE, direction, sin_cos};
use crate::batch::machine::vector::Vector;
use crate::ground::Stand;
use crate::moving::Footing;
use crate::suspension::lanes::{Column, LARGEST_TURN, MOST, Turned, Vectors, all, rotated, scaled};
use crate::suspension::{Chain, MAX_FREE, MAX_WHEELS};
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

/// The numbers of one row.
#[derive(Clone, Copy, Debug)]
pub(super) struct One {
    attitude: [f64; 3],
    joints: [f64; MAX_FREE],
    steering: [f64; MAX_WHEELS],
    at: [Direction; MAX_WHEELS],
    /// Not of unit length where it is settled.
    upwards: [[f64; 3]; MAX_WHEELS],
    touching: [bool; MAX_WHEELS],
    stopped: [bool; MAX_FREE],
}

/// Which of some gaps are closed, and which joints are at a stop: none unless a wheel hangs.
fn contacts(
    chain: &Chain,
    gaps: [f64; MAX_WHEELS],
    joints: &[f64; MAX_FREE],
) -> ([bool; MAX_WHEELS], [bool; MAX_FREE]) {
    let mut stopped = [false; MAX_FREE];
    if gaps.iter().any(|gap| *gap > HANGING) {
        for ((stopped, angle), joint) in stopped.iter_mut().zip(joints).zip(chain.joints()) {
            let range = joint.range;
            *stopped = *angle <= range.lower + STOPPED || *angle >= range.upper - STOPPED;
        }
    }
    let mut touching = [false; MAX_WHEELS];
    for (touching, gap) in touching.iter_mut().zip(gaps) {
        *touching = gap.abs() <= HANGING;
    }
    (touching, stopped)
}

/// The row of so many numbers each, of which there may be one for all.
fn row(values: &[f64], width: usize, k: usize) -> &[f64] {
    let first = if values.len() > width { k * width } else { 0 };
    values.get(first..first + width).unwrap_or_default()
}

impl Footings<'_> {
    #[inline(always)]
    pub(super) fn one(&self, chain: &Chain, k: usize) -> One {
        let mut one = One {
            attitude: [0.0; 3],
            joints: [0.0; MAX_FREE],
            steering: [0.0; MAX_WHEELS],
            at: [Direction { sin: 0.0, cos: 1.0 }; MAX_WHEELS],
            upwards: [[0.0, 0.0, 1.0]; MAX_WHEELS],
            touching: [false; MAX_WHEELS],
            stopped: [false; MAX_FREE],
        };
        let (wheels, steered) = (chain.wheels().len(), chain.steering().len());
        let mut gaps = [f64::NAN; MAX_WHEELS];
        match self {
            Self::Settled {
                stands,
                poses,
                steering,
            } => {
                let place = if stands.len() == 1 { 0 } else { k };
                let stand = &stands[place];
                let [_, roll, pitch, joints @ ..] = stand.state;
                one.attitude = [roll, pitch, poses[place][2]];
                one.joints = joints;
                for (wheel, gap) in gaps.iter_mut().enumerate().take(wheels) {
                    let contact = &stand.wheels[wheel];
                    let [x, y] = contact.gradient;
                    one.at[wheel] = contact.at;
                    one.upwards[wheel] = [-x, -y, 1.0];
                    *gap = contact.gap;
                }
                for (to, from) in one.steering.iter_mut().zip(row(steering, steered, place)) {
                    *to = *from;
                }
            }
            Self::Told(told) => {
                let place = if told.roll.len() == 1 { 0 } else { k };
                let transform = &told.transform[place];
                let yaw = transform[4].atan2(transform[0]);
                one.attitude = [told.roll[place], told.pitch[place], yaw];
                let free = chain.joints().len();
                for (to, from) in one.joints.iter_mut().zip(row(told.joints, free, place)) {
                    *to = *from;
                }
                for (to, from) in one
                    .steering
                    .iter_mut()
                    .zip(row(told.steering, steered, place))
                {
                    *to = *from;
                }
                for (wheel, gap) in gaps.iter_mut().enumerate().take(wheels) {
                    let which = place * wheels + wheel;
                    one.at[wheel] = Direction::from(told.angles[which]);
                    one.upwards[wheel] = told.normals[which];
                    *gap = told.gap[which];
                }
            }
        }
        (one.touching, one.stopped) = contacts(chain, gaps, &one.joints);
        one
    }

    /// Does something with one row, the plain way.
    pub fn with<T>(&self, chain: &Chain, k: usize, work: impl FnOnce(&mut Footing<'_>) -> T) -> T {
        let one = self.one(chain, k);
        let settled = matches!(self, Self::Settled { .. });
        let angles = one.at.map(|at| at.sin.atan2(at.cos));
        let normals = one.upwards.map(|[x, y, z]| match settled {
            true => normal([-x, -y]).into(),
            false => [x, y, z],
        });
        work(&mut Footing {
            attitude: one.attitude,
            joints: &one.joints[..chain.joints().len()],
            steering: &one.steering[..chain.steering().len()],
            angles: &angles[..chain.wheels().len()],
            normals: &normals[..chain.wheels().len()],
            touching: one.touching,
            stopped: one.stopped,
        })
    }
}

/// Rows where they stand, in lanes.
pub(super) struct Standing<S: Vector> {
    /// Of roll and pitch.
    pub roll: Turned<S>,
    pub pitch: Turned<S>,
    pub joints: [Lanes<S>; MAX_FREE],
    /// Angles of the steering joints [rad].
    pub steering: [Lanes<S>; MAX_WHEELS],
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

/// What [`Standing`] is made of, as it is read.
struct Read {
    attitude: [Column; 3],
    joints: [Column; MAX_FREE],
    steering: [Column; MAX_WHEELS],
    at: [[Column; 2]; MAX_WHEELS],
    upwards: [[Column; 3]; MAX_WHEELS],
    touching: [Column; MAX_WHEELS],
    stopped: [Column; MAX_FREE],
    nowhere: Column,
}

impl Read {
    const ZERO: Self = Self {
        attitude: [Column::ZERO; 3],
        joints: [Column::ZERO; MAX_FREE],
        steering: [Column::ZERO; MAX_WHEELS],
        at: [[Column::ZERO; 2]; MAX_WHEELS],
        upwards: [[Column::ZERO; 3]; MAX_WHEELS],
        touching: [Column::ZERO; MAX_WHEELS],
        stopped: [Column::ZERO; MAX_FREE],
        nowhere: Column::ZERO,
    };

    #[inline(always)]
    fn put(&mut self, lane: usize, one: &One) {
        let lane = lane % MOST;
        for k in 0..3 {
            self.attitude[k].0[lane] = one.attitude[k];
        }
        for k in 0..MAX_FREE {
            self.joints[k].0[lane] = one.joints[k];
        }
        for k in 0..MAX_WHEELS {
            self.steering[k].0[lane] = one.steering[k];
            self.at[k][0].0[lane] = one.at[k].sin;
            self.at[k][1].0[lane] = one.at[k].cos;
            for i in 0..3 {
                self.upwards[k][i].0[lane] = one.upwards[k][i];
            }
        }
    }
}

impl<S: Vector> Standing<S> {
    /// Some rows; adds to the doubtful lanes those that are not for lanes.
    #[inline(always)]
    pub fn new(
        simd: S,
        chain: &Chain,
        footings: &Footings<'_>,
        span: Span,
        doubt: &mut Mask<S>,
    ) -> Self {
        let mut read = Read::ZERO;
        let (mut all_touch, mut any_stopped) = (true, false);
        let wheels = chain.wheels().len().min(MAX_WHEELS);
        for lane in 0..S::F64_LANES {
            let one = footings.one(chain, span.first + lane.min(span.count - 1));
            read.put(lane, &one);
            let touching = &one.touching[..wheels];
            all_touch &= !touching.contains(&false);
            if !touching.contains(&true) {
                read.nowhere.0[lane] = 1.0;
            }
            any_stopped |= one.stopped.contains(&true);
            for (column, touches) in read.touching.iter_mut().zip(one.touching) {
                column.0[lane] = f64::from(u8::from(touches));
            }
            for (column, stopped) in read.stopped.iter_mut().zip(one.stopped) {
                column.0[lane] = f64::from(u8::from(stopped));
            }
        }
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        let [roll, pitch, yaw] = [
            read.attitude[0].load(simd),
            read.attitude[1].load(simd),
            read.attitude[2].load(simd),
        ];
        let nowhere = zero.below(read.nowhere.load(simd));
        let mut plain = all(simd, LARGEST_ANGLE).below(yaw.abs());
        let far = all(simd, LARGEST_TURN);
        plain = plain | far.below(roll.abs()) | far.below(pitch.abs());
        let mut standing = Self {
            roll: direction(simd, roll),
            pitch: direction(simd, pitch),
            joints: [zero; MAX_FREE],
            steering: [zero; MAX_WHEELS],
            at: [(zero, one); MAX_WHEELS],
            normals: [[zero; 3]; MAX_WHEELS],
            touching: [zero; MAX_WHEELS],
            all_touch,
            stopped: [zero; MAX_FREE],
            any_stopped,
            nowhere,
        };
        for k in 0..chain.joints().len().min(MAX_FREE) {
            standing.joints[k] = read.joints[k].load(simd);
            plain = plain | far.below(standing.joints[k].abs());
            standing.stopped[k] = read.stopped[k].load(simd);
        }
        for k in 0..chain.steering().len().min(MAX_WHEELS) {
            standing.steering[k] = read.steering[k].load(simd);
            plain = plain | far.below(standing.steering[k].abs());
        }
        let heading = sin_cos(simd, yaw);
        let settled = matches!(footings, Footings::Settled { .. });
        for k in 0..wheels {
            standing.touching[k] = read.touching[k].load(simd);
            standing.at[k] = (read.at[k][0].load(simd), read.at[k][1].load(simd));
            let up = [
                read.upwards[k][0].load(simd),
                read.upwards[k][1].load(simd),
                read.upwards[k][2].load(simd),
            ];
            let mut normal = standing.in_body(heading, up);
            if settled {
                let square = up[0].mul_add(up[0], up[1].mul_add(up[1], one));
                plain = plain | all(simd, STEEP).below(square);
                normal = scaled(normal, one.quotient(square.sqrt()));
            }
            standing.normals[k] = normal;
        }
        *doubt = *doubt | (plain & !nowhere);
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
pub(super) fn on_plane<S: Vector>(simd: S, forward: Lanes<S>, up: Lanes<S>) -> Turned<S> {
    let inverse = all(simd, 1.0).quotient(forward.mul_add(forward, up * up).sqrt());
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
