//! Rows of robust fits that have not converged, and the constants of the rover for their rounds.

use crate::kernels::normal_equations::ForwardConstants;
use crate::kernels::readings::FitColumns;
use crate::kernels::wheel_rows::RowPair;
use crate::rover_data::RoverData;
use six_wheel_numerics::columns::{BLOCK, Column};

/// Lanes at most.
pub(crate) const LANES: usize = 8;

/// Wheels of rovers whose rows go together: their registers are sorted by comparing neighbours.
pub(crate) const MOST: usize = 8;

/// Constants of a rover for robust fits.
#[derive(Clone, Debug)]
pub(crate) struct RobustConstants {
    pub(crate) wheels: Vec<RobustWheel>,
    /// Sums of the products of the rows of every wheel, for the twist itself.
    pub(crate) raw: Vec<[f64; 6]>,
}

/// A wheel with the sums of the products of its rows.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RobustWheel {
    pub(crate) rows: RowPair,
    pub(crate) normal: [f64; 6],
}

impl RobustWheel {
    pub fn new(rows: RowPair) -> Self {
        Self { rows, normal: rows.normal() }
    }
}

impl RobustConstants {
    /// None where there are too many wheels.
    pub fn new(rover: &RoverData, forward: &ForwardConstants) -> Option<Self> {
        let [cx, cy] = [rover.centre.x, rover.centre.y];
        let raw = |RowPair(rows): RowPair| RowPair(rows.map(|[x, y, z]| [x, y, z * rover.size - x * cy + y * cx]));
        let rows = || forward.wheels.iter().map(|wheel| wheel.rows);
        (forward.wheels.len() <= MOST).then(|| Self {
            wheels: rows().map(RobustWheel::new).collect(),
            raw: rows().map(|rows| raw(rows).normal()).collect(),
        })
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
