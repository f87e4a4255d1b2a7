//! Contacts of the wheels of one pose with the ground: a wheel in every lane.
//!
//! Input: circles over a grid of heights. Output: for every circle the least vertical distance from the ground,
//! exactly, the next best contact if it is as near, and flags of unknown ground and of the edge of the map.
//! [`super::walk`] searches along the rims.

use super::circles::{FAR, RIMS, RimLanes, WheelCircle, spread};
use super::interval::{AngleInterval, GapMinimum};
use super::walk::find_min_gap;
use crate::interval::both;
use crate::terrain::Terrain;
use six_wheel_kinematics::geometry::Direction;
use six_wheel_numerics::simd::vector::Vector;

/// A minimum this much above the least one is no contact [m].
const TIE: f64 = 1e-7;

/// A local minimum of the gap along the rim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Minimum {
    /// Vertical distance of the rim over the ground [m].
    pub gap: f64,
    /// Sine and cosine of its contact angle.
    pub at: Direction,
    /// Derivatives of the ground's height by columns and rows [m]; on a crease the weighted mean of both sides that is
    /// orthogonal to the rim.
    pub slope: [f64; 2],
}

/// Result of a search along the rim.
#[derive(Clone, Copy, Debug)]
pub struct RimContact {
    /// The least gap over known ground; None where there is none.
    pub least: Option<Minimum>,
    /// Contact angle of the next best minimum, where that is no more than 1e-7 m above the least.
    pub next: Option<Direction>,
    /// True if the projection lies over an unknown cell.
    pub unknown: bool,
    /// True if the projection leaves the map.
    pub outside: bool,
}

impl RimContact {
    /// No contact.
    pub const NOTHING: Self = Self { least: None, next: None, unknown: false, outside: false };

    /// The contact of the whole rim from those of its halves.
    fn joined(self, other: Self) -> Self {
        let (unknown, outside) = (self.unknown | other.unknown, self.outside | other.outside);
        let least = |half: &Self| half.least.map_or(f64::INFINITY, |least| least.gap);
        let (low, high) = if least(&other) < least(&self) { (other, self) } else { (self, other) };
        let is_near = least(&high) - least(&low) <= TIE;
        let next = low.next.or(high.least.filter(|_| is_near).map(|least| least.at));
        Self { least: low.least, next, unknown, outside }
    }

    /// The contact after a rotation of the circle by half a turn.
    fn turned_over(mut self) -> Self {
        let turned = |at: Direction| Direction { sin: -at.sin, cos: -at.cos };
        if let Some(least) = &mut self.least {
            least.at = turned(least.at);
        }
        self.next = self.next.map(turned);
        self
    }
}

/// Part of the rim to search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RimSegment {
    /// The half with contact angles up to a quarter turn.
    Lower,
    /// The lower half, and the upper one if the ground around it may be that high, or is unknown.
    Whole,
}

/// The contacts of circles, one in every lane.
#[inline(always)]
pub fn find_contacts<S: Vector>(
    simd: S,
    ground: &Terrain,
    circles: &[WheelCircle; RIMS],
    count: usize,
    segment: RimSegment,
) -> [RimContact; RIMS] {
    let mut contacts = [RimContact::NOTHING; RIMS];
    let mut first = 0;
    while first < count {
        let lanes = S::F64_LANES.min(RIMS - first);
        let mut rims = RimLanes::load(simd, circles, first);
        let mut upper = [false; RIMS];
        for half in 0..2 {
            let found = find_min_gap(simd, ground, &rims, &AngleInterval::lower(simd)).contacts();
            let contacts = &mut contacts[first..first + lanes];
            for (lane, (contact, found)) in contacts.iter_mut().zip(found).enumerate() {
                if half == 0 {
                    *contact = found;
                    let gap = found.least.map_or(f64::INFINITY, |least| least.gap);
                    upper[lane] = segment == RimSegment::Whole
                        && first + lane < count
                        && upper_half_matters(ground, &circles[first + lane], gap);
                } else if upper[lane] {
                    *contact = contact.joined(found.turned_over());
                }
            }
            if !upper.contains(&true) {
                break;
            }
            rims.turn_over();
        }
        first += S::F64_LANES;
    }
    contacts
}

impl<S: Vector> GapMinimum<S> {
    #[inline(always)]
    fn contacts(&self) -> [RimContact; RIMS] {
        let (gap, next_gap) = (spread(self.gap), spread(self.next_gap));
        let ([sin, cos], slope) = (both!(k, spread(self.at[k])), both!(k, spread(self.slope[k])));
        let [next_sin, next_cos] = both!(k, spread(self.next_at[k]));
        let (unknown, outside) = (self.unknown.booleans(), self.outside.booleans());
        let mut contacts = [RimContact::NOTHING; RIMS];
        for (k, contact) in contacts.iter_mut().enumerate().take(S::F64_LANES) {
            (contact.unknown, contact.outside) = (unknown[k], outside[k]);
            if gap[k] < FAR {
                let at = Direction { sin: sin[k], cos: cos[k] };
                contact.least = Some(Minimum { gap: gap[k], at, slope: [slope[0][k], slope[1][k]] });
                let next = Direction { sin: next_sin[k], cos: next_cos[k] };
                contact.next = (next_gap[k] - gap[k] <= TIE).then_some(next);
            }
        }
        contacts
    }
}

/// True if a part of the upper half may have a lesser gap than this [m], or is over unknown ground.
fn upper_half_matters(ground: &Terrain, circle: &WheelCircle, gap: f64) -> bool {
    let reach = |k: usize| {
        let (forward, up) = (circle.forward[k], circle.up[k]);
        (forward * forward + up * up).sqrt()
    };
    let (rx, ry) = (reach(0), reach(1));
    let [x, y, z] = circle.centre;
    let [rows, columns] = ground.shape();
    let low = [(x - rx).floor(), (y - ry).floor()];
    let high = [(x + rx).ceil(), (y + ry).ceil()];
    let inside = low[0] >= 0.0 && low[1] >= 0.0 && high[0] <= (columns - 1) as f64 && high[1] <= (rows - 1) as f64;
    if !inside {
        return true;
    }
    let (mut top, mut known) = (f64::NEG_INFINITY, true);
    for row in low[1] as usize..=high[1] as usize {
        for column in low[0] as usize..=high[0] as usize {
            let height = ground.heights().at(row * columns + column);
            known &= !height.is_nan();
            top = f64::max(top, height);
        }
    }
    // If the steering axis points upwards, the lowest point of the upper half is one of its ends.
    let lowest = z - if circle.up[2] >= 0.0 { circle.forward[2].abs() } else { reach(2) };
    !known || lowest - top < gap + TIE
}
