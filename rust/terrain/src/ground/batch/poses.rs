//! Numbers of the poses that are settled together, and their loads and stores.

use super::pivots::PivotOrder;
use super::scan::{Site, StateLanes};
use crate::ground::rims::circles::{FAR, RIMS, spread};
use crate::ground::rims::extent::Extent;
use crate::ground::settler::Settler;
use crate::ground::stand::Stand;
use crate::suspension::{MAX_WHEELS, PlanPose, State};
use crate::terrain::Terrain;
use six_wheel_kinematics::geometry::Direction;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::vector::Vector;

/// Least and largest half range of a search near the last contact [rad].
pub(super) const LOOK: [f64; 2] = [0.02, 0.3];

/// Poses that are settled together: their numbers stay in the second-level cache.
pub(super) const CHUNK: usize = 512;

/// Rounds after which a pose is left to [`Settler::settle_near`].
pub(super) const ROUNDS: u8 = 24;

/// State of the solution for a pose.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum SolveState {
    /// Far from the ground: the next search is about the lowest of some points of the rim.
    Far,
    /// The next search is along the parts of the lower halves of the rims that may touch.
    Whole,
    /// The gaps are closed; the next search includes the upper halves of the rims.
    Both,
    /// Nearly settled, and whole rims have been searched without another contact: the next search, near the contacts,
    /// is the last.
    Sure,
    /// The next search is near the last contacts.
    Short,
}

impl SolveState {
    /// Part of the rims that the next round searches.
    #[inline(always)]
    pub fn extent(self) -> Extent {
        match self {
            Self::Far => Extent::Sampled,
            Self::Whole => Extent::Whole,
            Self::Sure | Self::Short => Extent::Near,
            Self::Both => Extent::Both,
        }
    }
}

/// Numbers of the poses, column by column.
pub(super) mod column {
    use crate::suspension::{MAX_STATE, MAX_WHEELS};

    /// x, y, sine and cosine of the heading.
    pub const POSE: usize = 0;
    /// Largest gap of the last round [m].
    pub const WORST: usize = 4;
    /// Damping factor of the last step.
    pub const SHARE: usize = 5;
    /// Half range of the next search near the last contacts [rad].
    pub const LOOK: usize = 6;
    pub const STATE: usize = 7;
    /// Sine and cosine of the contact angle of every wheel.
    pub const CONTACT: usize = STATE + MAX_STATE;
    /// Sine and cosine of every steering angle.
    pub const STEERING: usize = CONTACT + 2 * MAX_WHEELS;
    pub const COUNT: usize = STEERING + 2 * MAX_WHEELS;
}

/// `N` poses that are being settled.
pub(super) struct PoseBatch<const N: usize> {
    pub columns: [[f64; N]; column::COUNT],
    pub rounds: [u8; N],
    pub states: [SolveState; N],
}

impl<const N: usize> PoseBatch<N> {
    /// Poses before [`SettleRange::begin`].
    pub const EMPTY: Self = Self { columns: [[0.0; N]; column::COUNT], rounds: [0; N], states: [SolveState::Far; N] };
}

/// Values of `rounds` for a pose whose gaps are closed: no other contact is possible, or one may be.
pub(super) const DONE: u8 = u8::MAX;
pub(super) const LEFT: u8 = DONE - 1;

/// A row for [`Settler::settle_near`], and the state in which its gaps are closed, if one was found.
pub(crate) type Left = (usize, Option<State>);

/// Poses that one thread settles.
pub(super) struct SettleRange<'a, 'b> {
    pub settler: &'a Settler<'b>,
    pub order: &'a PivotOrder,
    pub poses: &'a [[f64; 3]],
    pub steering: &'a dyn Fn(usize) -> [f64; MAX_WHEELS],
    pub steered: bool,
    pub stands: &'a mut [Stand],
    /// Rows for [`Settler::settle_near`].
    pub left: &'a mut Vec<Left>,
}

/// The numbers of these rows of the first columns, one in every lane.
#[inline(always)]
pub(super) fn gather<S: Vector, const N: usize, const COUNT: usize>(
    simd: S,
    columns: &[[f64; N]],
    rows: &[u16],
) -> [Lanes<S>; COUNT] {
    let mut lanes = [Lanes::splat(simd, 0.0); COUNT];
    for (lanes, column) in lanes.iter_mut().zip(columns) {
        let mut values = [0.0; RIMS];
        for lane in 0..S::F64_LANES {
            values[lane] = column[rows[lane.min(rows.len() - 1)] as usize % N];
        }
        *lanes = Lanes::from_slice(simd, &values);
    }
    lanes
}

/// Writes the number of every lane to these rows of a column.
#[inline(always)]
pub(super) fn scatter<S: Vector, const N: usize>(column: &mut [f64; N], rows: &[u16], lanes: Lanes<S>) {
    let values = spread(lanes);
    for (&row, value) in rows.iter().zip(values) {
        column[row as usize % N] = value;
    }
}

/// A pose in the axes of the grid.
#[derive(Clone, Copy)]
pub(crate) struct PoseOnGrid {
    /// Position relative to node (0, 0) [m].
    pub origin: [f64; 2],
    pub heading: Direction,
}

impl PoseOnGrid {
    pub fn new(ground: &Terrain, pose: PlanPose) -> Self {
        let PlanPose { x, y, yaw } = pose.relative_to(ground.placement().origin());
        let turn = ground.placement().turn();
        let (sin, cos) = yaw.sin_cos();
        let heading = Direction { sin: sin * turn.cos - cos * turn.sin, cos: cos * turn.cos + sin * turn.sin };
        Self { origin: ground.placement().grid_axes([x, y]), heading }
    }
}

impl SettleRange<'_, '_> {
    /// The chain, the ground and the equations.
    #[inline(always)]
    pub(super) fn site(&self) -> Site<'_> {
        Site { chain: self.settler.chain, ground: self.settler.ground, order: self.order }
    }

    /// Writes the columns of poses before their first round.
    pub(super) fn begin<const N: usize>(&self, batch: &mut PoseBatch<N>, first: usize, count: usize) {
        for row in 0..count {
            let PoseOnGrid { origin, heading } = PoseOnGrid::new(self.settler.ground, self.poses[first + row].into());
            let numbers = [origin[0], origin[1], heading.sin, heading.cos, FAR, 1.0, LOOK[1]];
            for (column, number) in batch.columns.iter_mut().zip(numbers) {
                column[row] = number;
            }
            if self.steered {
                for (joint, angle) in (self.steering)(first + row).into_iter().enumerate() {
                    let (sin, cos) = angle.sin_cos();
                    batch.columns[column::STEERING + 2 * joint][row] = sin;
                    batch.columns[column::STEERING + 2 * joint + 1][row] = cos;
                }
            }
        }
        batch.columns[column::STATE..column::CONTACT].as_flattened_mut().fill(0.0);
        for wheel in 0..MAX_WHEELS {
            batch.columns[column::CONTACT + 2 * wheel].fill(0.0);
            batch.columns[column::CONTACT + 2 * wheel + 1].fill(1.0);
        }
        batch.rounds.fill(0);
        batch.states.fill(SolveState::Far);
    }

    #[inline(always)]
    pub(super) fn here<S: Vector, const N: usize>(&self, simd: S, batch: &PoseBatch<N>, rows: &[u16]) -> StateLanes<S> {
        let columns = &batch.columns;
        let zero = Lanes::splat(simd, 0.0);
        let [x, y, sin, cos] = gather(simd, &columns[column::POSE..], rows);
        let mut here = StateLanes {
            origin: [x, y],
            yaw: (sin, cos),
            state: gather(simd, &columns[column::STATE..], rows),
            steering: None,
            contacts: [[zero; 2]; MAX_WHEELS],
        };
        for (k, contact) in here.contacts.iter_mut().enumerate() {
            *contact = gather(simd, &columns[column::CONTACT + 2 * k..], rows);
        }
        if self.steered {
            let mut steering = [(zero, zero); MAX_WHEELS];
            for (k, turned) in steering.iter_mut().enumerate() {
                let [sin, cos] = gather(simd, &columns[column::STEERING + 2 * k..], rows);
                *turned = (sin, cos);
            }
            here.steering = Some(steering);
        }
        here
    }
}
