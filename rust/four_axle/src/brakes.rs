//! Brakes on the pivots of both pairs.

/// The brake on the pivots of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Brake {
    /// The angles of the pair are fixed.
    Locked,
    /// The axles turn by the motion of their wheels.
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

named_values! { Pair as "pair": "front" => Front, "rear" => Rear }

/// Both brakes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Brakes {
    /// Brake of the front pair.
    pub front: Brake,
    /// Brake of the rear pair.
    pub rear: Brake,
}

impl Brakes {
    /// Both pairs locked.
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
