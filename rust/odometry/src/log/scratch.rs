//! Memory of a block of a log that grows with the number of wheels and joints.

use super::lagged_column::{LEAD, LaggedColumn};
use crate::step::{StepConstants, StepScratch};
use six_wheel_kinematics::kernels::wheel_lanes::GROUP;
use six_wheel_numerics::columns::{BLOCK, Column};
use six_wheel_numerics::simd::level::Level;

/// Memory of a block per wheel and joint. Every block writes it before it reads it, except the row before the first one
/// in `ends`, which is loaded from the state.
pub struct BlockScratch {
    /// Instructions of its kernels.
    pub level: Level,
    /// Rows before they are split into columns.
    pub(crate) flat: Vec<f64>,
    /// Angle of every joint per count of its encoder [rad].
    pub(crate) per_count: Vec<f64>,
    /// Angles of the joints, row by row [rad].
    pub(crate) angles: Vec<f64>,
    /// Per wheel of the rover: its counts; then the speed at which its contact slid [m/s].
    pub(crate) wheels: Vec<Column>,
    /// Middle angles of the joints, then their increments [rad].
    pub(crate) joints: Vec<Column>,
    /// Per lane of the groups of wheels.
    pub(crate) places: Vec<StepScratch>,
    /// Per joint: error of the displacement by half the deviation of its angle; then that of the pose at the end of
    /// every step.
    pub(crate) ends: Vec<[LaggedColumn; 3]>,
    /// Errors by half the deviation of a gyroscope's reading, likewise.
    pub(crate) by_gyroscope: [LaggedColumn; 3],
}

/// A vector of `count` elements; None if there is not enough memory.
fn allocate<T: Clone>(one: T, count: usize) -> Option<Vec<T>> {
    let mut all = Vec::new();
    all.try_reserve_exact(count).ok()?;
    all.resize(count, one);
    Some(all)
}

impl BlockScratch {
    pub(crate) fn new(constants: &StepConstants) -> Option<Self> {
        let wheels: usize = constants.groups.iter().map(|group| group.count).sum();
        let joints: usize = constants.groups.iter().map(|group| group.steered).sum();
        let mut per_count = allocate(0.0, joints)?;
        for (joint, per_count) in per_count.iter_mut().enumerate() {
            *per_count = constants.groups[joint / GROUP].per_count[1][joint % GROUP];
        }
        Some(Self {
            level: Level::best(),
            per_count,
            flat: allocate(0.0, BLOCK * wheels.max(2 * joints))?,
            angles: allocate(0.0, BLOCK * joints)?,
            wheels: allocate(Column::ZERO, wheels)?,
            joints: allocate(Column::ZERO, 2 * joints)?,
            places: allocate(StepScratch::default(), GROUP * constants.groups.len())?,
            ends: allocate([LaggedColumn([0.0; LEAD + BLOCK]); 3], joints)?,
            by_gyroscope: [LaggedColumn([0.0; LEAD + BLOCK]); 3],
        })
    }

    /// Angles of the joints after a step [rad].
    #[inline]
    pub fn angles(&self, row: usize) -> &[f64] {
        let joints = self.ends.len();
        &self.angles[row * joints..(row + 1) * joints]
    }
}
