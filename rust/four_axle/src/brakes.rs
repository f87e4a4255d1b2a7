//! Brakes on the pivots of both pairs.

use std::str::FromStr;

use six_wheel_numerics::error::Error;

/// The brake on the pivots of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Brake {
    /// The angles of the pair stay.
    Locked,
    /// The wheels turn the axles.
    Free,
}

/// Two axles with a common brake.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pair {
    /// Front left and front right.
    Front,
    /// Rear left and rear right.
    Rear,
}

impl Pair {
    /// Its name in arguments and messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Front => "front",
            Self::Rear => "rear",
        }
    }

    /// Indices of its axles.
    pub fn axles(self) -> [usize; 2] {
        match self {
            Self::Front => [0, 1],
            Self::Rear => [2, 3],
        }
    }

    /// The pair at the other end.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Front => Self::Rear,
            Self::Rear => Self::Front,
        }
    }
}

impl FromStr for Pair {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        match name {
            "front" => Ok(Self::Front),
            "rear" => Ok(Self::Rear),
            _ => Err(Error::value("pair", "be 'front' or 'rear'", format!("{name:?}"))),
        }
    }
}

/// Both brakes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Brakes {
    /// Brake of the front pair.
    pub front: Brake,
    /// Brake of the rear pair.
    pub rear: Brake,
}

impl Brakes {
    /// Nothing turns on its pivot.
    pub const LOCKED: Self = Self { front: Brake::Locked, rear: Brake::Locked };

    /// The brake of a pair.
    pub fn of(self, pair: Pair) -> Brake {
        match pair {
            Pair::Front => self.front,
            Pair::Rear => self.rear,
        }
    }

    /// The same with the brake of one pair changed.
    #[must_use]
    pub fn with(self, pair: Pair, brake: Brake) -> Self {
        match pair {
            Pair::Front => Self { front: brake, ..self },
            Pair::Rear => Self { rear: brake, ..self },
        }
    }

    /// True if both brakes are in this state.
    pub fn both(self, brake: Brake) -> bool {
        self.front == brake && self.rear == brake
    }
}

impl Default for Brakes {
    fn default() -> Self {
        Self::LOCKED
    }
}
