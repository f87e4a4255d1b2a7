//! The input of settling, a chain and its ground, and the status of the result.

use nalgebra::Vector3;

use crate::suspension::Chain;
use crate::terrain::Terrain;
use six_wheel_numerics::simd::level::Level;

/// Outcome of settling a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Status {
    /// Every wheel touches, or as many as the state determines.
    Settled,
    /// A joint is at its stop, and a wheel is in the air.
    AtStop,
    /// A rim leaves the map.
    OffMap,
    /// A rim is over unknown ground.
    UnknownCells,
    /// No state was found that closes the gaps.
    NotConverged,
    /// The rover or a bogie tips over while the heights increase from 0 to those of the map.
    TipsOver,
}

impl Status {
    /// Every reported status, in the order of their codes.
    pub const ALL: [Self; 5] = [Self::Settled, Self::AtStop, Self::OffMap, Self::UnknownCells, Self::NotConverged];

    /// Its name in Python.
    pub fn name(self) -> &'static str {
        match self {
            Self::Settled => "settled",
            Self::AtStop => "at_stop",
            Self::OffMap => "off_map",
            Self::UnknownCells => "unknown_cells",
            Self::NotConverged | Self::TipsOver => "not_converged",
        }
    }

    /// The status that is reported: a pose that tips over has not converged.
    #[inline]
    pub fn reported(self) -> Self {
        match self {
            Self::TipsOver => Self::NotConverged,
            other => other,
        }
    }

    /// Reason of a failure, for texts; empty for a settled pose.
    pub fn reason(self) -> &'static str {
        match self {
            Self::Settled | Self::AtStop => "",
            Self::OffMap => "the rim of a wheel leaves the map",
            Self::UnknownCells => "the rim of a wheel lies over ground that is not known",
            Self::NotConverged => "no state was found that closes the gaps",
            Self::TipsOver => "as the ground grows from flat to what it is, the rover or a bogie tips over",
        }
    }

    /// True for a settled pose, with or without a joint at a stop.
    #[inline]
    pub fn stands(self) -> bool {
        matches!(self, Self::Settled | Self::AtStop)
    }
}

/// Settles a chain on the ground.
#[derive(Clone, Copy, Debug)]
pub struct Settler<'a> {
    /// The ground.
    pub ground: &'a Terrain,
    /// The chain that stands on it.
    pub chain: &'a Chain,
    /// Centre of mass in the body [m]: it decides which of several wheels is in the air.
    pub balance: Vector3<f64>,
    /// Instruction level for several wheels at once.
    pub level: Level,
}

impl<'a> Settler<'a> {
    /// A chain with its default centre of mass, [`Chain::balance`].
    #[inline]
    pub fn new(ground: &'a Terrain, chain: &'a Chain) -> Self {
        Self { ground, chain, balance: chain.balance(), level: Level::best() }
    }
}
