//! A chain to be put on the ground, and what comes of it.

use nalgebra::Vector3;

use crate::suspension::Chain;
use crate::terrain::Terrain;
use six_wheel_numerics::simd::level::Level;

/// Outcome of settling a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Status {
    /// Every wheel touches that can.
    Settled,
    /// A joint is at its stop, and a wheel hangs in the air for it.
    AtStop,
    /// A rim leaves the map.
    OffMap,
    /// A rim lies over ground that is not known.
    UnknownCells,
    /// No state was found that closes the gaps.
    NotConverged,
    /// The rover or a bogie tips over while the heights grow from 0 to those of the map.
    TipsOver,
}

impl Status {
    /// Every status that is told, in the order of its codes.
    pub const ALL: [Self; 5] = [Self::Settled, Self::AtStop, Self::OffMap, Self::UnknownCells, Self::NotConverged];

    /// The name Python knows it by.
    pub fn name(self) -> &'static str {
        match self {
            Self::Settled => "settled",
            Self::AtStop => "at_stop",
            Self::OffMap => "off_map",
            Self::UnknownCells => "unknown_cells",
            Self::NotConverged | Self::TipsOver => "not_converged",
        }
    }

    /// As it is told: what tips over has not converged.
    #[inline]
    pub fn told(self) -> Self {
        match self {
            Self::TipsOver => Self::NotConverged,
            other => other,
        }
    }

    /// Reason for which nothing stands; empty for a pose that stands.
    pub fn reason(self) -> &'static str {
        match self {
            Self::Settled | Self::AtStop => "",
            Self::OffMap => "the rim of a wheel leaves the map",
            Self::UnknownCells => "the rim of a wheel lies over ground that is not known",
            Self::NotConverged => "no state was found that closes the gaps",
            Self::TipsOver => "as the ground grows from flat to what it is, the rover or a bogie tips over",
        }
    }

    /// True if the rover stands in the state.
    #[inline]
    pub fn stands(self) -> bool {
        matches!(self, Self::Settled | Self::AtStop)
    }
}

/// Puts a chain on the ground.
#[derive(Clone, Copy, Debug)]
pub struct Settler<'a> {
    /// The ground.
    pub ground: &'a Terrain,
    /// The chain that stands on it.
    pub chain: &'a Chain,
    /// Centre of the weight in the body [m]: it decides between several wheels that might hang.
    pub balance: Vector3<f64>,
    /// Instruction level for several wheels at once.
    pub level: Level,
}

impl<'a> Settler<'a> {
    /// A chain with its weight where [`Chain::balance`] says.
    #[inline]
    pub fn new(ground: &'a Terrain, chain: &'a Chain) -> Self {
        Self { ground, chain, balance: chain.balance(), level: Level::best() }
    }
}
