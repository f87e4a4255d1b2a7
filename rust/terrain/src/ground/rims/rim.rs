//! Contact of a wheel with the ground: the least vertical distance of a circle from a grid of heights, exactly.
//!
//! The circle `P(t) = centre + forward sin t - up cos t` is cut where its projection crosses grid lines. Over one
//! cell the gap is a trigonometric polynomial of second degree ([`Gap`]), whose second derivative is bounded from
//! its values at the ends of an arc: where it is positive there is at most one minimum, found by Newton's method
//! inside its bracket; where it is negative the minimum is an end; where it may change its sign and the arc may
//! still hold the least gap, the arc is halved. A dip and a hump in one cell are therefore both seen.
//!
//! Directions are pairs `(sin t, cos t)`; no angle is computed.

use super::circle::{Circle, Cuts, Gap, Jet, angle, between, inside, length, point, sine_between, turned};
use crate::terrain::{Cell, Terrain};
use six_wheel_kinematics::wheels::Direction;

/// Arcs are cut to this length [rad], and what then remains is at most [`REST`]: bounds by second derivatives
/// stay tight.
const LONGEST_ARC: f64 = 0.45;

/// Cosine of half a radian.
const REST: f64 = 0.877_582_561_890_372_8;

/// A minimum this far above the least one is not looked at more closely [m].
const TIE: f64 = 1e-7;

/// Arcs shorter than this are their ends [rad]: the gap inside differs by 1e-17 m or so.
const SHORTEST_ARC: f64 = 1e-8;

/// A local minimum of the gap along the rim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Minimum {
    /// Vertical distance of the rim over the ground [m].
    pub gap: f64,
    /// Contact angle.
    pub at: Direction,
    /// Derivatives of the ground's height by columns and rows [m]; on a crease the mix of both sides that is
    /// square to the rim.
    pub slope: [f64; 2],
}

/// Result of a search along the rim.
#[derive(Clone, Copy, Debug)]
pub struct Rim {
    /// The least gap over known ground; None where there is none.
    pub least: Option<Minimum>,
    /// The next best minimum, where it is no more than [`TIE`] above the least.
    pub next: Option<Minimum>,
    /// True if the projection lies over an unknown cell.
    pub unknown: bool,
    /// True if it leaves the map.
    pub outside: bool,
    /// The least gap so far, or that of another point of the rim [m].
    bound: f64,
}

impl Rim {
    /// Nothing yet.
    pub(crate) const NOTHING: Self =
        Self { least: None, next: None, unknown: false, outside: false, bound: f64::INFINITY };

    /// One minimum over ground that is known all along.
    #[inline]
    pub fn of(minimum: Minimum) -> Self {
        Self { least: Some(minimum), bound: minimum.gap, ..Self::NOTHING }
    }

    /// Takes in another minimum.
    fn offer(&mut self, minimum: Minimum) {
        self.bound = self.bound.min(minimum.gap);
        let Some(least) = self.least else {
            self.least = Some(minimum);
            return;
        };
        if minimum.gap < least.gap {
            self.next = Some(least);
            self.least = Some(minimum);
        } else if self.next.is_none_or(|next| minimum.gap < next.gap) {
            self.next = Some(minimum);
        }
    }
}

/// Part of the rim to search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RimSegment {
    /// The half with contact angles up to a quarter turn: all that ordinary ground can touch.
    Lower,
    /// The lower half, and the upper one if the ground beside it may be that high, or is not known.
    Whole,
}

/// Walks along the rim.
///
/// A point near the contact makes it quick: arcs that are higher everywhere are passed over.
pub(crate) fn walk(ground: &Terrain, circle: &Circle, part: RimSegment, near: Direction) -> Rim {
    let mut rim = Rim::NOTHING;
    rim.bound = gap_at(ground, circle, near);
    half(ground, circle, &mut rim);
    if part == RimSegment::Whole && upper_half_matters(ground, circle, rim.bound) {
        let turned = Circle { forward: circle.forward.map(|x| -x), up: circle.up.map(|x| -x), ..*circle };
        let mut upper = Rim::NOTHING;
        upper.bound = rim.bound;
        half(ground, &turned, &mut upper);
        for mut minimum in [upper.least, upper.next].into_iter().flatten() {
            minimum.at = Direction { sin: -minimum.at.sin, cos: -minimum.at.cos };
            rim.offer(minimum);
        }
        rim.unknown |= upper.unknown;
        rim.outside |= upper.outside;
    }
    let least = rim.bound;
    rim.next = rim.next.filter(|next| next.gap - least <= TIE);
    rim
}

/// The gap at a point of the rim [m]; infinite where the ground is not known.
fn gap_at(ground: &Terrain, circle: &Circle, at: Direction) -> f64 {
    let [x, y] = point(circle, at);
    if !ground.on_grid(x, y) {
        return f64::INFINITY;
    }
    let [rows, columns] = ground.shape();
    let (column, row) = ((x as usize).min(columns - 2), (y as usize).min(rows - 2));
    let height = ground.cell(column, row).height(x - column as f64, y - row as f64);
    let gap = rise(circle, at) - height;
    // What rounding may take away from the minimum beside it.
    if gap.is_nan() { f64::INFINITY } else { gap + 1e-12 * (1.0 + height.abs()) }
}

/// Height of a point of the rim [m].
fn rise(circle: &Circle, Direction { sin, cos }: Direction) -> f64 {
    circle.centre[2] + circle.forward[2] * sin - circle.up[2] * cos
}

/// True if a part of the upper half may be nearer to the ground than this, or over ground that is not known.
pub(crate) fn upper_half_matters(ground: &Terrain, circle: &Circle, gap: f64) -> bool {
    let reach = |k: usize| length([circle.forward[k], circle.up[k]]);
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
    // The lowest point of the upper half, if the wheel stands upright, is one of its ends.
    let lowest = z - if circle.up[2] >= 0.0 { circle.forward[2].abs() } else { reach(2) };
    !known || lowest - top < gap + TIE
}

/// An arc over one cell.
struct Arc<'a> {
    gap: Gap,
    cell: &'a Cell,
    circle: &'a Circle,
    corner: [f64; 2],
}

impl Arc<'_> {
    /// Slope of the ground below a point of the rim.
    fn slope(&self, at: Direction) -> [f64; 2] {
        let [x, y] = point(self.circle, at);
        self.cell.slope(x - self.corner[0], y - self.corner[1])
    }

    fn minimum(&self, at: Direction, gap: f64) -> Minimum {
        Minimum { gap, at, slope: self.slope(at) }
    }

    /// Offers every minimum inside the arc that may be the least.
    fn search(&self, ends: [Direction; 2], jets: [Jet; 2], length: f64, rim: &mut Rim) {
        let ([g1, d1, c1], [g2, d2, c2]) = (jets[0], jets[1]);
        let eighth = length * length / 8.0;
        let doubt = self.gap.fourth * eighth;
        let (least, most) = (c1.min(c2) - doubt, c1.max(c2) + doubt);
        let bound = g1.min(g2) - most.max(0.0) * eighth;
        if most <= 0.0 || bound > rim.bound + TIE || length < SHORTEST_ARC {
            return; // concave, or too high
        }
        if least >= 0.0 {
            if d1 < 0.0 && d2 > 0.0 {
                let at = self.bottom(ends, d1 / (d1 - d2));
                rim.offer(self.minimum(at, self.gap.jet(at)[0]));
            }
            return;
        }
        let middle = between(ends[0], ends[1], 0.5);
        let jet = self.gap.jet(middle);
        if d1 < 0.0 && jet[1] == 0.0 && d2 > 0.0 {
            rim.offer(self.minimum(middle, jet[0]));
        }
        self.search([ends[0], middle], [jets[0], jet], 0.5 * length, rim);
        self.search([middle, ends[1]], [jet, jets[1]], 0.5 * length, rim);
    }

    /// The zero of the gap's derivative on a convex arc at whose ends it has different signs.
    fn bottom(&self, [mut low, mut high]: [Direction; 2], share: f64) -> Direction {
        let mut at = between(low, high, share);
        for _ in 0..60 {
            let [_, slope, curvature] = self.gap.jet(at);
            if slope > 0.0 {
                high = at;
            } else {
                low = at;
            }
            let step = -slope / curvature;
            let next = turned(at, step);
            // Leaving the bracket, or no curvature to go by: halve it.
            let inside = sine_between(low, next) >= 0.0 && sine_between(next, high) >= 0.0 && step.abs() < 1.0;
            if slope.abs() <= 1e-15 * self.gap.fourth || step == 0.0 {
                break;
            }
            at = if inside { next } else { between(low, high, 0.5) };
            if inside && step.abs() < 1e-9 || sine_between(low, high) < 1e-15 {
                break; // the next step would be 1e-18
            }
        }
        at
    }
}

/// A bound of the heights of the rim between two directions.
fn lowest(circle: &Circle, from: Direction, to: Direction) -> f64 {
    let (start, end) = (rise(circle, from), rise(circle, to));
    // The arc hangs below its chord by at most chord^2 / 8 of the radius, and a bit where it is long.
    let (sin, cos) = (to.sin - from.sin, to.cos - from.cos);
    let sag = (sin * sin + cos * cos) * 0.25;
    start.min(end) - sag * length([circle.forward[2], circle.up[2]])
}

/// The end of an arc: the gap there, its slope along the rim, and the slope of the ground.
struct End {
    at: Direction,
    gap: f64,
    rise: f64,
    slope: [f64; 2],
}

/// Walks along the half of the rim with positive cosines.
fn half(ground: &Terrain, circle: &Circle, rim: &mut Rim) {
    let Some(cuts) = Cuts::of(circle) else {
        // So many lines that heights no longer describe what the wheel stands on.
        rim.unknown = true;
        return;
    };
    let [rows, columns] = ground.shape();
    let mut before: Option<End> = None;
    for pair in cuts.cuts[..cuts.count].windows(2) {
        let (from, to) = (pair[0], pair[1]);
        if to.sin - from.sin < 1e-14 && (to.cos - from.cos).abs() < 1e-14 {
            continue; // a node of the grid: the cell between its two lines is not touched
        }
        let [x, y] = point(circle, inside(from, to));
        let inside = x >= 0.0 && y >= 0.0 && x < (columns - 1) as f64 && y < (rows - 1) as f64;
        let cell = inside.then(|| ground.cell(x as usize, y as usize));
        rim.outside |= cell.is_none();
        rim.unknown |= cell.is_some_and(|cell| !cell.is_known());
        let Some(cell) = cell.filter(Cell::is_known) else {
            edge(before.take(), None, rim);
            continue;
        };
        if lowest(circle, from, to) - cell.highest() > rim.bound + TIE {
            before = None; // and so are its ends
            continue;
        }
        let corner = [x as usize as f64, y as usize as f64];
        let arc = Arc { gap: Gap::new(&cell, circle, corner), cell: &cell, circle, corner };
        let mut start = from;
        let mut jet = arc.gap.jet(start);
        edge(before.take(), Some(End { at: start, gap: jet[0], rise: jet[1], slope: arc.slope(start) }), rim);
        loop {
            let whole = start.sin * to.sin + start.cos * to.cos >= REST;
            let end = if whole { to } else { turned(start, LONGEST_ARC) };
            let last = arc.gap.jet(end);
            arc.search([start, end], [jet, last], angle(start, end), rim);
            (start, jet) = (end, last);
            if whole {
                break;
            }
            if jet[1] == 0.0 {
                rim.offer(arc.minimum(start, jet[0]));
            }
        }
        before = Some(End { at: to, gap: jet[0], rise: jet[1], slope: arc.slope(to) });
    }
    edge(before, None, rim);
}

/// Offers the point between two arcs if the gap falls towards it from both sides; where there is known ground on
/// one side only, if it falls from there.
fn edge(before: Option<End>, after: Option<End>, rim: &mut Rim) {
    let (end, share) = match (&before, &after) {
        (None, None) => return,
        (Some(end), None) if end.rise <= 0.0 => (end, 1.0),
        (None, Some(end)) if end.rise >= 0.0 => (end, 1.0),
        (Some(left), Some(right)) if left.rise <= 0.0 && right.rise >= 0.0 => {
            let turn = right.rise - left.rise;
            (left, if turn > 0.0 { right.rise / turn } else { 0.5 })
        }
        _ => return,
    };
    let other = after.as_ref().unwrap_or(end).slope;
    let other = if before.is_none() { end.slope } else { other };
    rim.offer(Minimum {
        gap: end.gap,
        at: end.at,
        slope: [0, 1].map(|k| share * end.slope[k] + (1.0 - share) * other[k]),
    });
}
