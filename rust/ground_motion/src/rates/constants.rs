//! Constants of a chain for the rates that follow the ground.

use nalgebra::Vector3;

use super::point_rows::{in_body, point_rows};
use six_wheel_terrain::suspension::{Chain, MAX_FREE, MAX_WHEELS};

/// Columns of the planar motion: `vx, vy, wz`.
pub(crate) const PLAN: [usize; 3] = [0, 1, 5];

/// Columns of the rates that follow from the ground: `vz, wx, wy` and the rates of the free angles.
pub(crate) const FOLLOWING: [usize; 3 + MAX_FREE] = [2, 3, 4, 6, 7, 8];

/// Most unknowns: rates that follow the ground.
pub(crate) const UNKNOWNS: usize = FOLLOWING.len();

/// Elimination order of the rates that follow the ground, for as many rates as wheels that all touch: each rate by the
/// equation of the wheel in which it has the largest part on level ground.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PivotOrder {
    /// The wheels, in the order of the rates.
    pub wheels: [usize; UNKNOWNS],
    /// Bits of the later equations that contain a rate, once the rates before it are eliminated.
    pub others: [u32; UNKNOWNS],
}

impl PivotOrder {
    /// The order for `rise`, the vertical velocities of all wheels on level ground per rate, and `bits`, the rates that
    /// move each wheel. None where two rates have proportional columns there.
    pub fn new(rise: [[f64; UNKNOWNS]; UNKNOWNS], bits: [u32; UNKNOWNS]) -> Option<Self> {
        let mut rows: [_; UNKNOWNS] = std::array::from_fn(|wheel| (wheel, rise[wheel]));
        let mut others = [0; UNKNOWNS];
        for j in 0..UNKNOWNS {
            let size = |k: &usize| rows[*k].1[j].abs();
            let pivot = (j..UNKNOWNS).max_by(|a, b| size(a).total_cmp(&size(b)))?;
            rows.swap(j, pivot);
            let (_, from) = rows[j];
            for (_, row) in &mut rows[j + 1..] {
                let share = row[j] / from[j];
                (j..UNKNOWNS).for_each(|k| row[k] -= share * from[k]);
            }
        }
        let wheels = rows.map(|(wheel, _)| wheel);
        let mut bits = wheels.map(|wheel| bits[wheel]);
        for j in 0..UNKNOWNS {
            for k in j + 1..UNKNOWNS {
                if bits[k] >> j & 1 == 1 {
                    others[j] |= 1 << k;
                    bits[k] |= bits[j];
                }
            }
        }
        Some(Self { wheels, others })
    }
}

/// Constants of a chain for the rates that follow the ground.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MotionConstants {
    /// Number of wheels, and of free angles.
    pub wheels: usize,
    pub joints: usize,
    /// Radius of every wheel [m].
    pub radii: [f64; MAX_WHEELS],
    /// The free angles by the number of wheels that they move, fewest first.
    order: [usize; MAX_FREE],
    /// Bits of the free angles that may move each wheel.
    moved: [u32; MAX_WHEELS],
    /// None unless there are as many rates as wheels.
    pub pivot_order: Option<PivotOrder>,
    /// Bits of the steering joints on whose axis the mean of their wheels' centres lies: that mean moves as the axis
    /// does.
    centred: u32,
}

impl MotionConstants {
    /// Constants of any chain with these numbers of wheels and free angles: each free angle may move every wheel.
    pub fn dense(wheels: usize, joints: usize, radii: [f64; MAX_WHEELS]) -> Self {
        let order = std::array::from_fn(|joint| joint);
        Self { wheels, joints, radii, order, moved: [u32::MAX; MAX_WHEELS], pivot_order: None, centred: 0 }
    }

    /// Constants of a chain.
    pub fn new(chain: &Chain) -> Self {
        let (wheels, joints) = (chain.wheels().len(), chain.joints().len());
        let mut radii = [1.0; MAX_WHEELS];
        for (radius, wheel) in radii.iter_mut().zip(chain.wheels()) {
            *radius = wheel.radius;
        }
        let mut constants = Self::dense(wheels, joints, radii);
        for (wheel, bits) in constants.moved.iter_mut().enumerate().take(wheels) {
            *bits = chain.mount(wheel).movers.iter().fold(0, |bits, (_, joint)| bits | 1 << joint);
        }
        let moved = constants.moved;
        let count = |joint: &usize| (0..wheels).filter(|&wheel| moved[wheel] >> joint & 1 == 1).count();
        constants.order[..joints].sort_by_key(count);
        for joint in 0..chain.steering().len() {
            let own = (0..wheels).filter(|&wheel| chain.steering_joint(wheel) == Some(joint));
            let sum = own.map(|wheel| chain.mount(wheel).offset).fold([0.0; 2], |[x, y], at| [x + at[0], y + at[1]]);
            constants.centred |= u32::from(sum == [0.0; 2]) << joint;
        }
        if [joints + 3, wheels] == [UNKNOWNS; 2] {
            constants.pivot_order = constants.level_pivots(chain);
        }
        constants
    }

    /// The elimination order: the free angles in the order of [`Self::order`], then the body's vz, wx and wy.
    fn level_pivots(&self, chain: &Chain) -> Option<PivotOrder> {
        let level = in_body(chain, &[], &[])?;
        let joints = self.order().iter().map(|joint| 6 + joint);
        let columns: Vec<usize> = joints.chain(FOLLOWING.into_iter().take(3)).collect();
        let rise = |wheel: usize| {
            let ([row], _) = point_rows(&level, wheel, level.wheel(wheel).centre, [Vector3::z()]);
            std::array::from_fn(|k| row[columns[k]])
        };
        let bits = |wheel: usize| {
            let moved = columns.iter().enumerate().filter(|(_, column)| self.moves(**column, wheel));
            moved.fold(0, |bits, (k, _)| bits | 1 << k)
        };
        PivotOrder::new(std::array::from_fn(rise), std::array::from_fn(bits))
    }

    /// The free angles by the number of wheels that they move, fewest first.
    pub fn order(&self) -> &[usize] {
        &self.order[..self.joints.min(MAX_FREE)]
    }

    /// True if the mean of the centres of a steering joint's wheels lies on its axis.
    pub fn is_centred(&self, joint: usize) -> bool {
        self.centred >> joint & 1 == 1
    }

    /// True if a rate may move a wheel; the body's rates move every wheel.
    #[inline(always)]
    pub fn moves(&self, column: usize, wheel: usize) -> bool {
        column < 6 || self.moved[wheel % MAX_WHEELS] >> (column - 6) & 1 == 1
    }
}
