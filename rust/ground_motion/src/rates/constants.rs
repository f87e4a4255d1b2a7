//! Constants of a chain for the rates that follow the ground.

use super::least_squares::{PivotOrder, UNKNOWNS};
use six_wheel_terrain::suspension::lanes::ChainConstants;
use six_wheel_terrain::suspension::{Chain, MAX_FREE, MAX_WHEELS};

/// Constants of a chain for the rates that follow the ground.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MotionConstants {
    /// Number of wheels, and of free angles.
    pub wheels: usize,
    pub joints: usize,
    /// Of every wheel [m].
    pub radii: [f64; MAX_WHEELS],
    /// The free angles, those first that move few wheels.
    order: [usize; MAX_FREE],
    /// Bits of the free angles that may move each wheel.
    moved: [u32; MAX_WHEELS],
    /// Where there are as many rates as wheels.
    pub pivot_order: Option<PivotOrder>,
}

impl MotionConstants {
    /// Of any chain of so many wheels and free angles: each of these may move every wheel.
    pub fn dense(wheels: usize, joints: usize, radii: [f64; MAX_WHEELS]) -> Self {
        let order = std::array::from_fn(|joint| joint);
        Self { wheels, joints, radii, order, moved: [u32::MAX; MAX_WHEELS], pivot_order: None }
    }

    /// Of a chain whose rows go into lanes.
    pub fn new(chain: &Chain, plan: &ChainConstants) -> Self {
        let (wheels, joints) = (chain.wheels().len(), chain.joints().len());
        let mut radii = [1.0; MAX_WHEELS];
        for (radius, wheel) in radii.iter_mut().zip(chain.wheels()) {
            *radius = wheel.radius;
        }
        let mut constants = Self::dense(wheels, joints, radii);
        constants.order[..joints].copy_from_slice(plan.order());
        for wheel in 0..wheels {
            constants.moved[wheel] = plan.moved(wheel);
        }
        if [joints + 3, wheels] == [UNKNOWNS; 2] {
            let rise = std::array::from_fn(|wheel| plan.rise(wheel));
            constants.pivot_order = PivotOrder::new(rise, std::array::from_fn(|wheel| plan.parts_in(wheel)));
        }
        constants
    }

    /// The free angles, those first that move few wheels.
    pub fn order(&self) -> &[usize] {
        &self.order[..self.joints.min(MAX_FREE)]
    }

    /// True if a rate may move a wheel: those of the body do.
    #[inline(always)]
    pub fn moves(&self, column: usize, wheel: usize) -> bool {
        column < 6 || self.moved[wheel % MAX_WHEELS] >> (column - 6) & 1 == 1
    }
}
