//! Brakes on the pivots of both pairs, and when each may be set or released.
//!
//! Both pairs may be locked where the axle lines share a point: else the robot is frozen. Both may be free
//! where they do not: else nothing but the wheels holds the body, and those may as well swing the axles. At
//! any angles one of the two is allowed, so that a standing robot can always hand over from one pair to the
//! other.

use std::str::FromStr;

use nalgebra::{Matrix2, SMatrix, Vector2, Vector3};

use super::{Axles, FourAxle, RANK_TOLERANCE};
use crate::error::{Error, ErrorKind, numbers};
use crate::jacobi::Jacobi;

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
    /// Of the front pair.
    pub front: Brake,
    /// Of the rear pair.
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

    /// Whether both brakes are like this.
    pub fn both(self, brake: Brake) -> bool {
        self.front == brake && self.rear == brake
    }
}

impl Default for Brakes {
    fn default() -> Self {
        Self::LOCKED
    }
}

impl FourAxle {
    /// Locks a pair. Fails, and changes nothing, where both pairs locked could not move.
    pub fn lock(&self, angles: &Axles, brakes: Brakes, pair: Pair) -> Result<Brakes, Error> {
        self.check_angles(angles)?;
        let locked = brakes.with(pair, Brake::Locked);
        if locked == brakes || !locked.both(Brake::Locked) {
            return Ok(locked);
        }
        self.check_free(angles, pair).map(|()| locked)
    }

    /// Fails if both pairs locked could not move, with the angles this pair would have to have.
    pub(super) fn check_free(&self, angles: &Axles, pair: Pair) -> Result<(), Error> {
        let mobility = self.judge(angles);
        if mobility.degree() > 0 {
            return Ok(());
        }
        let remedy = self
            .remedy(angles, pair)
            .map_or_else(|| "beyond the steering range".into(), |[left, right]| format!("({left:.6}, {right:.6})"));
        let rule = format!(
            "let the robot move with front and rear locked (axle lines without a common point: \
             driving slides {:.3} m per metre, smallest singular value {:.3}; beside the {} axles as they \
             are, {} must be at {remedy})",
            mobility.slip,
            mobility.singular_values[2],
            pair.other().name(),
            pair.name(),
        );
        Err(Error::value("angles", rule, numbers(angles)).of_kind(ErrorKind::Infeasible))
    }

    /// Frees a pair. Fails, and changes nothing, where both pairs free would leave the body adrift.
    ///
    /// The counterpart of [`Self::lock`]: with both pairs free the axle lines must not share a point, which
    /// alone holds the body. Otherwise the same wheel speeds could drive it or swing its axles.
    pub fn release(&self, angles: &Axles, brakes: Brakes, pair: Pair) -> Result<Brakes, Error> {
        self.check_angles(angles)?;
        let freed = brakes.with(pair, Brake::Free);
        if freed == brakes || !freed.both(Brake::Free) || self.judge(angles).degree() == 0 {
            return Ok(freed);
        }
        let rule = format!(
            "hold the body while front and rear are free (the robot could move, and no brake would say how; \
             lock {} first)",
            pair.other().name()
        );
        Err(Error::value("angles", rule, numbers(angles)).of_kind(ErrorKind::Infeasible))
    }

    /// Sets both brakes: locks first, but where that would freeze the robot, releases first.
    pub fn switch(&self, angles: &Axles, from: Brakes, to: Brakes) -> Result<Brakes, Error> {
        let pairs = [Pair::Rear, Pair::Front];
        let locks = |brakes| {
            let wanted = pairs.into_iter().filter(|pair| to.of(*pair) == Brake::Locked);
            wanted.into_iter().try_fold(brakes, |brakes, pair| self.lock(angles, brakes, pair))
        };
        let releases = |brakes| {
            let wanted = pairs.into_iter().filter(|pair| to.of(*pair) == Brake::Free);
            wanted.into_iter().try_fold(brakes, |brakes, pair| self.release(angles, brakes, pair))
        };
        locks(from).and_then(releases).or_else(|refused| releases(from).and_then(locks).map_err(|_| refused))
    }

    /// Angles of a pair nearest in slip at which it can be locked beside the other pair as it is.
    fn remedy(&self, angles: &Axles, pair: Pair) -> Option<[f64; 2]> {
        let normals = self.side_slip(angles);
        let [left, right] = pair.axles();
        let [first, second] = pair.other().axles();
        let held = Jacobi::new(&SMatrix::<f64, 2, 3>::from_rows(&[
            normals.row(first).into_owned(),
            normals.row(second).into_owned(),
        ]));
        let (one, two) = (held.turn.column(2), held.turn.column(1));
        let slip = |motion: &Vector3<f64>| {
            Vector2::new(normals.row(left).transpose().dot(motion), normals.row(right).transpose().dot(motion))
        };
        let motion = if held.values.y > RANK_TOLERANCE {
            one.into_owned()
        } else {
            // In line: the centre of rotation may lie anywhere on their line.
            let slips = Matrix2::from_columns(&[slip(&one.into_owned()), slip(&two.into_owned())]);
            let best = Jacobi::new(&slips).turn.column(1).into_owned();
            one * best.x + two * best.y
        };
        let aimed = self.aim(self.unit(motion), angles).ok()?;
        Some([aimed[left], aimed[right]])
    }
}
