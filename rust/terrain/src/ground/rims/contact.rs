//! Contacts of the wheels of one pose with the ground: a wheel in every lane.
//!
//! Input: circles over a grid of heights. Output: for every circle the least vertical distance from the ground,
//! exactly, the next best contact if it is as near, and flags of unknown ground and of the edge of the map.
//! [`super::walk`] searches along the rims.

use super::circles::{FAR, RIMS, RimLanes, WheelCircle, both, spread};
use super::interval::{AngleInterval, GapMinimum};
use super::walk::find_min_gap;
use crate::terrain::Terrain;
use six_wheel_kinematics::geometry::Direction;
use six_wheel_numerics::simd::vector::Vector;

/// A minimum this much above the least one is no contact [m].
const TIE: f64 = 1e-7;

/// A local minimum of the gap along the rim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Minimum {
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
pub(crate) struct RimContact {
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
    pub(crate) const NOTHING: Self = Self { least: None, next: None, unknown: false, outside: false };

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
pub(crate) enum RimSegment {
    /// The half with contact angles up to a quarter turn.
    Lower,
    /// The lower half, and the upper one if the ground around it may be that high, or is unknown.
    Whole,
}

/// The contacts of circles, one in every lane.
#[inline(always)]
pub(crate) fn find_contacts<S: Vector>(
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

#[cfg(test)]
mod tests {
    use six_wheel_numerics::simd::lanes::Lanes;
    use std::sync::Arc;

    use super::super::interval::TIE;
    use super::*;
    use crate::terrain::Heights;
    use six_wheel_numerics::error::Error;
    use six_wheel_numerics::simd::level::{Kernel, Level};

    /// The gap that an interval of one rim has, on every lane.
    struct Look<'a>(&'a Terrain, WheelCircle, [f64; 2]);

    impl Kernel for Look<'_> {
        type Output = f64;

        #[inline(always)]
        fn run<S: Vector>(self, simd: S) -> f64 {
            let rims = RimLanes::load(simd, &[self.1; RIMS], 0);
            let [start, end] = self.2.map(|angle| {
                let (sin, cos) = angle.sin_cos();
                [Lanes::splat(simd, sin), Lanes::splat(simd, cos)]
            });
            let margin = Lanes::splat(simd, TIE);
            let interval = AngleInterval { start, end, margin, is_closed: false, is_exact: false };
            spread(find_min_gap(simd, self.0, &rims, &interval).gap)[0]
        }
    }

    #[test]
    fn an_interval_without_a_minimum_has_none() -> Result<(), Error> {
        // The first cell of the map, prolonged to the wheel, would be nearer than the ground there.
        let heights = (0..81).map(|k| if k % 9 < 2 && k < 18 { 0.5 } else { 0.0 });
        let heights = Heights::Double(Arc::new(heights.collect()));
        let ground = Terrain::new(heights, 9, [1.0, 1.0], [0.0, 0.0], 0.0)?;
        let circle = WheelCircle { centre: [5.5, 5.5, 1.0], forward: [0.4, 0.0, 0.0], up: [0.0, 0.0, 0.4] };
        for level in Level::available() {
            assert_eq!(level.run_any(Look(&ground, circle, [0.2, 0.7])), FAR);
            let least = level.run_any(Look(&ground, circle, [-0.3, 0.7]));
            assert!((least - 0.6).abs() < 1e-15);
        }
        Ok(())
    }

    /// The contacts of the lower halves of circles.
    struct LowerContacts<'a>(&'a Terrain, &'a [WheelCircle; RIMS]);

    impl Kernel for LowerContacts<'_> {
        type Output = [RimContact; RIMS];

        #[inline(always)]
        fn run<S: Vector>(self, simd: S) -> Self::Output {
            find_contacts(simd, self.0, self.1, RIMS, RimSegment::Lower)
        }
    }

    #[test]
    fn contacts_are_those_of_dense_sampling_at_every_level() -> Result<(), Error> {
        let mut seed = 1_u64;
        let mut random = move |low: f64, high: f64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            low + (high - low) * (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        let heights = (0..400).map(|_| if random(0.0, 1.0) < 0.01 { f64::NAN } else { random(0.0, 0.4) });
        let heights = Heights::Double(Arc::new(heights.collect()));
        let ground = Terrain::new(heights, 20, [1.0, 1.0], [0.0, 0.0], 0.0)?;
        let mut halved = 0;
        for _ in 0..300 {
            let across = random(0.3, 3.0);
            let circles: [WheelCircle; RIMS] = std::array::from_fn(|_| {
                let ((sy, cy), (sp, cp)) = (random(-4.0, 4.0).sin_cos(), random(-0.5, 0.5).sin_cos());
                let (sr, cr) = random(-0.5, 0.5).sin_cos();
                let axis = |x: f64, y: f64, z: f64| [across * x, across * y, 0.3 * z];
                WheelCircle {
                    centre: [random(2.0, 17.0), random(2.0, 17.0), random(0.3, 0.8)],
                    forward: axis(cy * cp, sy * cp, -sp),
                    up: axis(cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr),
                }
            });
            let at = |circle: &WheelCircle, angle: f64| {
                let (sin, cos) = angle.sin_cos();
                let [x, y, z] = [0, 1, 2].map(|k| circle.centre[k] + circle.forward[k] * sin - circle.up[k] * cos);
                let inside = ground.on_grid(x, y) && x < 19.0 && y < 19.0;
                let height = |x: f64, y: f64| ground.cell(x as usize, y as usize).height(x.fract(), y.fract());
                (inside, z - if inside { height(x, y) } else { f64::NAN })
            };
            let scalar = Level::Scalar.run_any(LowerContacts(&ground, &circles));
            for level in Level::available() {
                let contacts = level.run_any(LowerContacts(&ground, &circles));
                assert_eq!(format!("{contacts:?}"), format!("{scalar:?}"), "{level:?}");
            }
            for (circle, contact) in circles.iter().zip(&scalar) {
                let half = std::f64::consts::FRAC_PI_2;
                let (mut least, mut unknown, mut outside) = (f64::INFINITY, false, false);
                for k in -4000..=4000 {
                    let (inside, gap) = at(circle, half * f64::from(k) / 4000.0);
                    outside |= !inside;
                    unknown |= inside && gap.is_nan();
                    least = least.min(gap);
                }
                assert!(contact.outside || !outside);
                assert!(contact.unknown || !unknown);
                let Some(found) = contact.least else {
                    assert!(unknown || outside);
                    continue;
                };
                halved += usize::from(found.gap < least - 1e-5);
                assert!(found.gap <= least + 1e-12 && found.gap > least - 2e-3, "{} {least}", found.gap);
                let (_, gap) = at(circle, found.at.sin.atan2(found.at.cos));
                // On a line of the grid rounding may take the cell beside it, which may not be known.
                assert!(gap.is_nan() || (gap - found.gap).abs() < 1e-9, "{} {gap}", found.gap);
            }
        }
        assert!(halved > 0);
        Ok(())
    }
}
