//! Rows of robust fits on their way, and the constants of the rover that their rounds need.

use crate::kernels::readings;
use crate::kernels::readings::{FitColumns, Rows, products};
use crate::rover_data::RoverData;
use six_wheel_numerics::columns::{BLOCK, Column};

/// Lanes at most.
pub(crate) const LANES: usize = 8;

/// Wheels at most: their registers are sorted by comparing neighbours.
pub(crate) const MOST: usize = 8;

/// Constants of a rover for the robust kernel.
pub(crate) struct RobustConstants {
    pub(crate) wheels: Vec<Wheel>,
}

/// A wheel with the sums of the products of its rows, for the unknowns about the centre and for the twist itself.
pub(crate) struct Wheel {
    pub(crate) rows: Rows,
    pub(crate) normal: [f64; 6],
    pub(crate) raw: [f64; 6],
}

impl RobustConstants {
    /// Nothing where there are too many wheels.
    pub fn new(rover: &RoverData, forward: &readings::ForwardConstants<'_>) -> Option<Self> {
        let raw = |rows: [[f64; 3]; 2]| {
            let [cx, cy] = [rover.centre.x, rover.centre.y];
            products(rows.map(|[x, y, z]| [x, y, z * rover.size - x * cy + y * cx]))
        };
        let wheel = |rows: &Rows| Wheel { rows: *rows, normal: rows.normal(), raw: raw(rows.rows) };
        let wheels: Vec<_> = forward.wheels.iter().map(wheel).collect();
        (wheels.len() <= MOST).then_some(Self { wheels })
    }
}

/// Rows on their way: those of a block, or those of many blocks that take long.
pub(crate) struct Block<'a> {
    pub kept: FitColumns<'a>,
    pub weights: &'a mut [Column],
    /// Squared noise at least, and square of the scale of the last round [m²/s²].
    pub(crate) least: Column,
    pub(crate) scale: Column,
    /// The ones that have not settled.
    pub(crate) active: [usize; BLOCK],
    pub left: usize,
    /// Rounds that are left to them.
    pub(crate) rounds: usize,
}
