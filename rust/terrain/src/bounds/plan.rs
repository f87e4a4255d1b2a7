//! The intervals of a pose, the status of each, and the constants of a rover from which they are computed.

use super::belly::Belly;
use super::boxes::{self, Patch, TiltLimits};
use super::side::Side;
use crate::suspension::{Bogie, Differential, Dimensions};
use six_wheel_numerics::error::{Error, number};

/// Status of the bounds of a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum BoundStatus {
    /// The quantities of the settled rover are inside the intervals.
    Bounded = 0,
    /// A wheel or the belly may be outside the map.
    OffMap = 1,
    /// A height under a wheel or the belly is unknown.
    UnknownCells = 2,
    /// Some heights of the wheels have no solution, or more than one, so that nothing is proved.
    Unsolved = 3,
    /// The angles may exceed those at which the wheels are in their boxes.
    Beyond = 4,
    /// A joint may be at its stop, with a wheel in the air.
    AtStop = 5,
}

/// The intervals of a pose, in the order in which [`bounds`] writes them.
pub const QUANTITIES: [&str; 9] =
    ["z", "roll", "pitch", "tilt", "clearance", "rocker", "bogie_left", "bogie_right", "wheel_drop"];

/// Number of intervals of a pose.
pub(super) const COUNT: usize = QUANTITIES.len();

/// Index of the tilt among them.
pub(super) const TILT: usize = 3;

/// Largest displacement, seen from above, of a part of the body from its position on a level rover inside its box.
#[derive(Clone, Copy, Debug)]
pub(super) struct VisibilityBox {
    /// Absolute coordinates in the body [m].
    pub(super) place: [f64; 3],
    /// Radius of a wheel, 0 for the belly [m].
    pub(super) radius: f64,
    /// Largest displacements along and across the body [m].
    pub(super) room: [f64; 2],
}

impl VisibilityBox {
    /// For a part of half length and half width `half`, centred at `place` on a level rover.
    fn new(patch: Patch, place: [f64; 3], half: [f64; 2], radius: f64) -> Self {
        let room = |axis: usize| patch.half[axis] - half[axis] - (patch.centre[axis] - place[axis]).abs();
        let far = [place[0].abs() + half[0], place[1].abs() + half[1], place[2].abs()];
        Self { place: if radius > 0.0 { place.map(f64::abs) } else { far }, radius, room: [room(0), room(1)] }
    }
}

/// Constants of a rover for the kernel.
#[derive(Clone, Debug)]
pub struct BoundsConstants {
    pub(super) side: Side,
    /// Boxes of the left and the right wheels, front to rear, in parts.
    pub(super) wheels: [[[Patch; 3]; 3]; 2],
    /// Box of the belly in parts, and of its middle.
    pub(super) belly: [Patch; 6],
    pub(super) middle: Patch,
    pub(super) plate: Belly,
    /// Axis of the rockers in the body [m].
    pub(super) pivot: [f64; 3],
    pub(super) radius: f64,
    /// Smallest lateral distance of a wheel, and the differences of each pair from it [m].
    pub(super) lateral: f64,
    pub(super) offsets: [f64; 3],
    /// Pairs of wheels, from the front: the rocker's, the bogie's ahead and the bogie's behind.
    pub(super) roles: [usize; 3],
    /// From D to the rocker's wheel and to B; from B to its wheels ahead and behind.
    pub(super) vectors: [[f64; 3]; 4],
    /// Displacements of the wheels of each pair, and of the belly, within their boxes.
    pub(super) rooms: [VisibilityBox; 4],
    /// See [`boxes::sag`].
    pub(super) sag: [f64; 4],
    /// Largest displacement of a wheel by a coupling bar against that by a gear [m].
    pub(super) looseness: f64,
    pub(super) within: TiltLimits,
    /// Largest absolute mean of the rockers' angles by their coupling [rad].
    pub(super) slack: f64,
    pub(super) rocker_limit: [f64; 2],
    pub(super) bogie_limit: [f64; 2],
}

impl BoundsConstants {
    /// For a rover with this belly; its boxes hold the wheels at angles inside the limits.
    pub fn new(dimensions: &Dimensions, plate: Belly, within: TiltLimits) -> Result<Self, Error> {
        let largest = 40_f64.to_radians();
        for (name, angle) in [("attitude", within.attitude), ("rocker", within.rocker), ("bogie", within.bogie)] {
            if !(angle > 0.0 && angle <= largest) {
                let rule = "be positive and at most 40 degrees";
                return Err(Error::value(name, rule, number(angle)));
            }
        }
        let pivot = dimensions.rocker_pivot;
        let lateral: [f64; 3] = std::array::from_fn(|pair| dimensions.level_place(pair)[1]);
        let least = lateral.iter().fold(f64::INFINITY, |least, y| least.min(*y));
        let [ahead, behind] = dimensions.bogie_to_wheels;
        let vectors = [dimensions.rocker_to_wheel, dimensions.rocker_to_bogie, ahead, behind];
        let swings = [within.rocker, within.rocker, within.rocker + within.bogie, within.rocker + within.bogie];
        let middle = (plate.x[0] + plate.x[1]) / 2.0;
        let Belly { x, half_width, z } = plate;
        let left = boxes::wheels(dimensions, within);
        let radius = dimensions.wheel_radius;
        let belly = boxes::plate(x, [-half_width, half_width], z, within);
        let rooms = std::array::from_fn(|k| match k {
            3 => VisibilityBox::new(belly, [middle, 0.0, z], [(x[1] - x[0]) / 2.0, half_width], 0.0),
            _ => VisibilityBox::new(left[k], dimensions.level_place(k), [radius, 0.0], radius),
        });
        let slack = slack(dimensions.differential, within.rocker)?;
        let arms: f64 = vectors.iter().map(|[x, _, z]| x.hypot(*z)).sum();
        Ok(Self {
            side: Side::new(dimensions)?,
            rooms,
            looseness: 2.0 * slack * arms,
            within,
            wheels: [left.map(|patch| patch.parts(3)), left.map(|patch| patch.mirrored().parts(3))],
            belly: belly.parts(3),
            middle: boxes::plate([middle; 2], [0.0; 2], z, within),
            plate,
            pivot,
            radius,
            lateral: least,
            offsets: lateral.map(|y| y - least),
            roles: match dimensions.bogie {
                Bogie::Behind => [0, 1, 2],
                Bogie::InFront => [2, 0, 1],
            },
            vectors,
            sag: std::array::from_fn(|k| boxes::sag(vectors[k], swings[k])),
            slack,
            rocker_limit: [dimensions.rocker_limit.lower, dimensions.rocker_limit.upper],
            bogie_limit: [dimensions.bogie_limit.lower, dimensions.bogie_limit.upper],
        })
    }
}

/// Largest absolute mean angle of the rockers for a left one up to `largest` [rad].
pub(super) fn slack(differential: Differential, largest: f64) -> Result<f64, Error> {
    if differential == Differential::Gear {
        return Ok(0.0);
    }
    const STEPS: i32 = 64;
    let mut most = 0.0_f64;
    for k in -STEPS..=STEPS {
        // The right rocker may exceed the range of the left one.
        let left = 1.5 * largest * f64::from(k) / f64::from(STEPS);
        let Some([right, _]) = differential.right(left) else {
            let rule = "reach as far as the rockers may turn";
            return Err(Error::value("differential_bar", rule, number(left)));
        };
        most = most.max(((left + right) / 2.0).abs());
    }
    // With a margin for the curve between two samples.
    Ok(1.01 * most + 1e-6)
}
