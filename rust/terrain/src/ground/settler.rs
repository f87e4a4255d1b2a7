//! A chain to be put on the ground, and what comes of it.

use nalgebra::Vector3;

use super::touch::Touches;
use crate::suspension::{Chain, MAX_FREE, State};
use crate::terrain::Terrain;
use six_wheel_numerics::simd::level::Level;

/// What came of settling a pose.
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
    /// While the ground grows from flat to what it is the rover, or a bogie, tips over.
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

    /// Why nothing stands; nothing where something does.
    pub fn reason(self) -> &'static str {
        match self {
            Self::Settled | Self::AtStop => "",
            Self::OffMap => "the rim of a wheel leaves the map",
            Self::UnknownCells => "the rim of a wheel lies over ground that is not known",
            Self::NotConverged => "no state was found that closes the gaps",
            Self::TipsOver => "as the ground grows from flat to what it is, the rover or a bogie tips over",
        }
    }

    /// Whether the state is one that the rover stands in.
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
    /// What stands on it.
    pub chain: &'a Chain,
    /// Where the weight acts, in the body [m]: it decides which wheel hangs where several might.
    pub balance: Vector3<f64>,
    /// With which instructions wheels are looked at together.
    pub level: Level,
}

/// A pose with what came of it.
#[derive(Clone, Debug)]
pub struct Settled<'a> {
    /// What came of it.
    pub status: Status,
    /// Where the chain stands; where it does not, NaN.
    pub state: State,
    /// Its wheels there; None where it does not stand.
    pub touches: Option<Touches<'a>>,
    /// Which joints are at their stops: -1 the lower, 1 the upper.
    pub stops: [i8; MAX_FREE],
    /// Bits of the wheels in the air.
    pub hanging: u32,
}

impl<'a> Settler<'a> {
    /// A chain with its weight where [`Chain::balance`] says.
    #[inline]
    pub fn new(ground: &'a Terrain, chain: &'a Chain) -> Self {
        Self { ground, chain, balance: chain.balance(), level: Level::best() }
    }
}
