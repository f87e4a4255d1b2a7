//! Settled poses, row after row, and the loads of a row into every lane.

use super::columns::Span;
use six_wheel_kinematics::geometry::Direction;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_terrain::ground::{CONTACT, NUMBERS, Stand};
use six_wheel_terrain::suspension::lanes::{MOST, Turned, Vectors, all};
use six_wheel_terrain::suspension::{Chain, MAX_FREE, MAX_STATE, MAX_WHEELS};

/// Distance between the poses that are read and those that are prefetched, in registers.
const AHEAD: usize = 2;

/// Settled poses, row after row.
#[derive(Clone, Copy, Debug)]
pub enum SettledPoses<'a> {
    /// Results of settling.
    Settled {
        /// The settled poses; a single one is every row.
        stands: &'a [Stand],
        /// Rows x, y [m], yaw [rad].
        poses: &'a [[f64; 3]],
        /// Steering angles [rad]: none if all are 0, one row, or one per pose.
        steering: &'a [f64],
    },
    /// Given as numbers; one row is every row.
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

/// The numbers of one row in groups of eight, the unit of the transposition into lanes: roll, pitch, yaw and the free
/// angles [rad]; then of every wheel its gap [m], sine and cosine of its contact angle, and the normal of the ground.
type PoseRow = [[f64; MOST]; 1 + MAX_WHEELS];

/// The numbers of as many rows as there are lanes at most.
#[repr(align(64))]
pub(crate) struct LaneGather([PoseRow; MOST]);

#[inline_always]
impl LaneGather {
    pub fn new() -> Self {
        Self([[[0.0; MOST]; 1 + MAX_WHEELS]; MOST])
    }

    /// Group `part` of eight numbers of each row, transposed into lanes.
    fn columns<S: Vector>(&self, simd: S, part: usize) -> [Lanes<S>; MOST] {
        let rows = self.0.as_flattened().as_flattened();
        Lanes::columns(simd, &rows[part * MOST..], size_of::<PoseRow>() / size_of::<f64>())
    }
}

impl SettledPoses<'_> {
    /// Steering angles, none if all are 0.
    pub(super) fn steering(&self) -> &[f64] {
        match self {
            Self::Settled { steering, .. } => steering,
            Self::Input(input) => input.steering,
        }
    }
}

impl SettledPoseInput<'_> {
    /// Writes the numbers of a row.
    fn gather(&self, chain: &Chain, k: usize, row: &mut PoseRow) {
        let [body, contacts @ ..] = row;
        let place = if self.roll.len() == 1 { 0 } else { k };
        let transform = &self.transform[place];
        let yaw = transform[4].atan2(transform[0]);
        body[..3].copy_from_slice(&[self.roll[place], self.pitch[place], yaw]);
        let (wheels, free) = (chain.wheels().len(), chain.joints().len());
        body[3..3 + free].copy_from_slice(&self.joints[place * free..][..free]);
        for (wheel, numbers) in contacts.iter_mut().enumerate().take(wheels) {
            let which = place * wheels + wheel;
            let at = Direction::from(self.angles[which]);
            let [x, y, z] = self.normals[which];
            *numbers = [self.gap[which], at.sin, at.cos, x, y, z, 0.0, 0.0];
        }
    }
}

/// Numbers of the rows that are read together.
pub(super) enum PoseSource<'a> {
    /// The poses, and the numbers of the settled poses.
    Settled(&'a [[f64; 3]], [&'a [f64; NUMBERS]; MOST]),
    Input(&'a LaneGather),
}

/// The ground's normal in the world, as it was given.
pub(super) enum NormalSource<S: Vector> {
    Normal(Vectors<S>),
    /// Derivatives of the ground's height by x and y.
    Slopes([Lanes<S>; 2]),
}

/// Eight consecutive numbers of each row, from number `first` on.
#[inline(always)]
fn eights<'a>(numbers: &[&'a [f64; NUMBERS]; MOST], first: usize) -> [&'a [f64; MOST]; MOST] {
    let mut eights = [&[0.0; MOST]; MOST];
    for (eight, row) in eights.iter_mut().zip(numbers) {
        *eight = row[first..].first_chunk().unwrap_or(&[0.0; MOST]);
    }
    eights
}

#[inline_always]
impl<'a> PoseSource<'a> {
    pub fn new<S: Vector>(
        simd: S,
        chain: &Chain,
        poses: &SettledPoses<'a>,
        span: Span,
        gather: &'a mut LaneGather,
    ) -> Self {
        let row = |lane: usize| span.first + lane.min(span.count - 1);
        let input = match *poses {
            SettledPoses::Input(input) => input,
            SettledPoses::Settled { stands, poses, .. } => {
                let mut numbers = [stands[0].numbers(); MOST];
                if stands.len() > 1 {
                    for (lane, numbers) in numbers.iter_mut().enumerate().take(S::F64_LANES) {
                        *numbers = stands[row(lane)].numbers();
                        // Fetched beforehand: a settled pose is several lines, and eight of them more than the processor follows.
                        let ahead = AHEAD * S::F64_LANES * size_of::<Stand>();
                        for k in (0..NUMBERS).step_by(MOST) {
                            simd.prefetch(numbers.as_ptr().wrapping_add(k).wrapping_byte_add(ahead));
                        }
                    }
                }
                return Self::Settled(poses, numbers);
            }
        };
        for (lane, row_numbers) in gather.0.iter_mut().enumerate().take(S::F64_LANES) {
            input.gather(chain, row(lane), row_numbers);
        }
        Self::Input(gather)
    }

    /// Roll, pitch and yaw, and the free angles [rad].
    pub fn body<S: Vector>(&self, simd: S, span: Span) -> (Vectors<S>, [Lanes<S>; MAX_FREE]) {
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
            Self::Input(gather) => {
                let [roll, pitch, yaw, a, b, c, ..] = gather.columns(simd, 0);
                ([roll, pitch, yaw], [a, b, c])
            }
        }
    }

    /// Gap [m] and contact angle of a wheel, and the normal of the ground.
    pub fn contact<S: Vector>(&self, simd: S, wheel: usize) -> (Lanes<S>, Turned<S>, NormalSource<S>) {
        match self {
            Self::Settled(_, numbers) => {
                // Eight numbers, of which the last contact has only six left.
                let first = (MAX_STATE + CONTACT * wheel).min(NUMBERS - MOST);
                let columns = Lanes::columns_of(simd, &eights(numbers, first));
                let [gap, sin, cos, x, y] = match wheel + 1 < MAX_WHEELS {
                    true => [columns[0], columns[1], columns[2], columns[3], columns[4]],
                    false => [columns[2], columns[3], columns[4], columns[5], columns[6]],
                };
                (gap, (sin, cos), NormalSource::Slopes([x, y]))
            }
            Self::Input(gather) => {
                let [gap, sin, cos, x, y, z, ..] = gather.columns(simd, 1 + wheel);
                (gap, (sin, cos), NormalSource::Normal([x, y, z]))
            }
        }
    }
}
