//! Parts of the rims to search in a round of Newton's method, and the least gap along them: a rim in every lane.
//!
//! The lanes are rims, of several poses or of one. The parts that a whole search leaves out have larger gaps than the
//! last contact.

use super::circles::{FAR, Point, RIMS, RimLanes, cells, spread};
use super::interval::{AngleInterval, GapMinimum};
use super::walk::find_min_gap;
use crate::pyramid::Pyramid;
use crate::suspension::lanes::Turned;
use crate::terrain::Terrain;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::polynomials::direction;
use six_wheel_numerics::simd::vector::Vector;

/// Height above the gap up to which other minima along the rim are kept [m].
pub const MARGIN: f64 = 1e-4;

/// Angle between points of [`SAMPLES`] [rad].
const BETWEEN: f64 = 0.22;

/// Sines and cosines of the multiples -5 to 5 of [`BETWEEN`].
const SAMPLES: [[f64; 2]; 11] = {
    let (step, mut samples) = ([0.218_229_623_080_869_32, 0.975_897_449_330_605_5], [[0.0, 1.0]; 11]);
    let mut k = 6;
    while k < 11 {
        let [sin, cos] = samples[k - 1];
        samples[k] = [sin * step[1] + cos * step[0], cos * step[1] - sin * step[0]];
        samples[10 - k] = [-samples[k][0], samples[k][1]];
        k += 1;
    }
    samples
};

/// Part of the rims to search.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Extent {
    /// About the sampled points of the rims with the least gaps.
    Sampled,
    /// The parts of the lower halves that may touch.
    Whole,
    /// An interval about the last contacts.
    Near,
    /// The parts of the lower halves that may touch, and the upper halves.
    Both,
}

#[inline_always]
impl Extent {
    /// All values.
    pub const ALL: [Self; 4] = [Self::Sampled, Self::Whole, Self::Near, Self::Both];

    /// Sine and cosine of the half range of the search, where it does not depend on the rim; `reach` is that of
    /// [`Self::Near`] [rad].
    pub fn half_width<S: Vector>(self, simd: S, reach: Lanes<S>) -> Option<Turned<S>> {
        match self {
            Self::Whole | Self::Both => None,
            Self::Near => Some(direction(simd, reach)),
            Self::Sampled => Some(direction(simd, Lanes::splat(simd, BETWEEN))),
        }
    }

    /// The least gap along this part of the rims, with the last contacts at these sines and cosines; true in the lanes
    /// in which no part that is left out can have a lesser gap.
    pub fn search<S: Vector>(
        self,
        simd: S,
        ground: &Terrain,
        rims: &RimLanes<S>,
        last: [Lanes<S>; 2],
        half_width: Option<Turned<S>>,
    ) -> (GapMinimum<S>, Mask<S>) {
        let last = match self {
            Self::Sampled => sampled(simd, ground, rims),
            _ => last,
        };
        let (interval, covers) = match half_width {
            None => whole_interval(simd, ground, rims, last),
            Some(turned) => (near_interval(simd, last, turned), Mask::splat(simd, false)),
        };
        halves(simd, ground, *rims, interval, covers, self == Self::Both)
    }
}

/// The least gap along an interval; minima of the upper halves, if these are searched, count as other minima. True in
/// the lanes in which no part that is left out can have a lesser gap.
#[inline(always)]
fn halves<S: Vector>(
    simd: S,
    ground: &Terrain,
    mut rims: RimLanes<S>,
    mut interval: AngleInterval<S>,
    mut covers: Mask<S>,
    both: bool,
) -> (GapMinimum<S>, Mask<S>) {
    let mut found = GapMinimum::none(simd);
    for half in 0..1 + usize::from(both) {
        let part = find_min_gap(simd, ground, &rims, &interval);
        if half == 0 {
            found = part;
        } else {
            found.others = found.others.min(part.gap).min(part.others);
            covers = Lanes::splat(simd, 0.0).lt(Lanes::splat(simd, 1.0));
        }
        // After half a turn, the upper half is the lower one.
        rims.turn_over();
        interval = AngleInterval::lower(simd);
    }
    (found, covers)
}

/// Sine and cosine of the sampled point with the least gap of every rim.
#[inline(always)]
fn sampled<S: Vector>(simd: S, ground: &Terrain, rims: &RimLanes<S>) -> [Lanes<S>; 2] {
    let (mut best, mut at) = (Lanes::splat(simd, FAR), [Lanes::splat(simd, 0.0); 2]);
    for point in &SAMPLES {
        let [sin, cos] = [Lanes::splat(simd, point[0]), Lanes::splat(simd, point[1])];
        let gap = gap(simd, ground, rims, [sin, cos]);
        let better = gap.lt(best);
        best = better.select(gap, best);
        at = [better.select(sin, at[0]), better.select(cos, at[1])];
    }
    at
}

/// The gap at a point of every rim.
#[inline(always)]
fn gap<S: Vector>(simd: S, ground: &Terrain, rims: &RimLanes<S>, [sin, cos]: [Lanes<S>; 2]) -> Lanes<S> {
    let mut at = rims.centre;
    for (k, at) in at.iter_mut().enumerate() {
        *at = *at + (rims.forward[k] * sin - rims.up[k] * cos);
    }
    let (column, row) = (at[0].floor(), at[1].floor());
    let cell = cells(simd, ground, column, row);
    let (a, b) = (at[0] - column, at[1] - row);
    at[2] - cell.height(a, b)
}

/// Interval of contact angles about the last contact.
#[inline(always)]
fn near_interval<S: Vector>(simd: S, [s, c]: [Lanes<S>; 2], (sin, cos): Turned<S>) -> AngleInterval<S> {
    let (zero, unit) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let (low, high) = ([s * cos - c * sin, c * cos + s * sin], [s * cos + c * sin, c * cos - s * sin]);
    let (starts, ends) = (zero.lt(low[1]), zero.lt(high[1]));
    AngleInterval {
        start: [starts.select(low[0], -unit), starts.select(low[1], zero)],
        end: [ends.select(high[0], unit), ends.select(high[1], zero)],
        margin: Lanes::splat(simd, MARGIN),
        is_closed: false,
        is_exact: false,
    }
}

/// The interval of contact angles that may have gaps as small as the last contact: points higher above the highest
/// ground around have larger ones. True in the lanes in which the upper half has none either.
#[inline(always)]
pub fn whole_interval<S: Vector>(
    simd: S,
    ground: &Terrain,
    rims: &RimLanes<S>,
    last: [Lanes<S>; 2],
) -> (AngleInterval<S>, Mask<S>) {
    let (zero, unit) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let margin = Lanes::splat(simd, MARGIN);
    let gap = gap(simd, ground, rims, last);
    // Unknown ground gives no bound.
    let far = Lanes::splat(simd, FAR);
    let gap = gap.le(far).select(gap, far) + margin + margin;
    let size = (rims.forward[2] * rims.forward[2] + rims.up[2] * rims.up[2]).sqrt();
    let inverse = unit / size;
    let (cos, sin) = (rims.up[2] * inverse, -(rims.forward[2] * inverse));
    let [rear, front] = highest_beside(simd, ground, rims, &rims.point(sin, cos));
    let mut interval = AngleInterval { margin, is_closed: false, ..AngleInterval::lower(simd) };
    // Cosine and sine of the angle from the lowest point at which the rim is that high.
    let near = ((rims.centre[2] - front - gap) * inverse).min(unit);
    let far = (unit - near * near).max(zero).sqrt();
    let end = [sin * near + cos * far, cos * near - sin * far];
    let ends = zero.lt(near) & zero.lt(end[1]);
    interval.end = [ends.select(end[0], unit), ends.select(end[1], zero)];
    let near = ((rims.centre[2] - rear - gap) * inverse).min(unit);
    let far = (unit - near * near).max(zero).sqrt();
    let start = [sin * near - cos * far, cos * near + sin * far];
    let starts = zero.lt(near) & zero.lt(start[1]);
    interval.start = [starts.select(start[0], -unit), starts.select(start[1], zero)];
    (interval, starts & ends)
}

/// The highest ground under the parts of the rims behind and before their lowest points [m]; infinity where it is unknown.
#[inline(always)]
fn highest_beside<S: Vector>(simd: S, ground: &Terrain, rims: &RimLanes<S>, lowest: &Point<S>) -> [Lanes<S>; 2] {
    let zero = Lanes::splat(simd, 0.0);
    let [mut rear, mut front] = [[[zero; 2]; 2]; 2];
    for k in 0..2 {
        // A point at an angle from the lowest one is `tangent sin + spoke cos`, with a cosine of either sign.
        let (ahead, aside) = (lowest.tangent[k], lowest.spoke[k].abs());
        let (low, high) = (ahead.min(zero) - aside, ahead.max(zero) + aside);
        rear[0][k] = (rims.centre[k] - high).floor();
        rear[1][k] = (rims.centre[k] - low).floor();
        front[0][k] = (rims.centre[k] + low).floor();
        front[1][k] = (rims.centre[k] + high).floor();
    }
    [highest(simd, ground, rear), highest(simd, ground, front)]
}

/// The highest ground over boxes from cell to cell [m]; infinity where it is unknown. The number is the same with and
/// without the pyramid of the map, so that no result depends on the calls before.
#[inline(always)]
fn highest<S: Vector>(simd: S, ground: &Terrain, [low, high]: [[Lanes<S>; 2]; 2]) -> Lanes<S> {
    let (zero, far) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, f64::INFINITY));
    let [rows, columns] = ground.shape();
    let last = [Lanes::splat(simd, columns as f64 - 2.0), Lanes::splat(simd, rows as f64 - 2.0)];
    // False for NaN.
    let on_map = zero.le(low[0])
        & zero.le(low[1])
        & high[0].le(last[0])
        & high[1].le(last[1])
        & low[0].le(high[0])
        & low[1].le(high[1]);
    if let Some(pyramid) = ground.known_pyramid() {
        let low = [on_map.select(low[0], zero), on_map.select(low[1], zero)];
        let high = [on_map.select(high[0], zero), on_map.select(high[1], zero)];
        // SAFETY: they are whole, in order and on the map, or the first cell.
        let (extremes, fits) = unsafe { pyramid.around([low, high]) };
        let [_, minus_highest] = extremes.deinterleave2();
        return (on_map & fits).select(-minus_highest, far);
    }
    let inside = spread(on_map.select(Lanes::splat(simd, 1.0), zero));
    let (x0, y0, x1, y1) = (spread(low[0]), spread(low[1]), spread(high[0]), spread(high[1]));
    let mut top = [f64::INFINITY; RIMS];
    for lane in 0..S::F64_LANES {
        if inside[lane] > 0.0 {
            let ends = [[x0[lane], y0[lane]], [x1[lane], y1[lane]]];
            let ends = ends.map(|end| end.map(|cell| cell as usize));
            top[lane] = Pyramid::highest_around(ground.heights(), ground.shape(), ends);
        }
    }
    Lanes::from_slice(simd, &top)
}
