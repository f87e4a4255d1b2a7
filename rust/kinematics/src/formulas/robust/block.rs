//! Rows of robust fits on their way, and the constants of the rover that their rounds need.

use crate::batch::formulas::readings::{self, Kept, Rows, products};
use crate::batch::machine::weave::{BLOCK, Column};
use crate::rover_data::RoverData;

/// Lanes at most.
pub(super) const LANES: usize = 8;

/// Wheels at most: their registers are sorted by comparing neighbours.
pub(in crate::batch::formulas) const MOST: usize = 8;

/// What the kernel needs to know of a rover.
pub(in crate::batch::formulas) struct Plan {
    pub(super) wheels: Vec<Wheel>,
}

/// A wheel with the sums of the products of its rows, for the unknowns about the centre and for the twist itself.
pub(super) struct Wheel {
    pub(super) rows: Rows,
    pub(super) normal: [f64; 6],
    pub(super) raw: [f64; 6],
}

impl Plan {
    /// Nothing where there are too many wheels.
    pub fn new(rover: &RoverData, forward: &readings::Plan<'_>) -> Option<Self> {
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
pub(in crate::batch::formulas) struct Block<'a> {
    pub kept: Kept<'a>,
    pub weights: &'a mut [Column],
    /// Squared noise at least, and square of the scale of the last round [m²/s²].
    pub(super) least: Column,
    pub(super) scale: Column,
    /// The ones that have not settled.
    pub(super) active: [usize; BLOCK],
    pub left: usize,
    /// Rounds that are left to them.
    pub(super) rounds: usize,
}
