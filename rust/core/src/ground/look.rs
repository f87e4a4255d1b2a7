//! A look at the rims of poses in lanes: gaps, what else is near, and the system of Newton's step.

use super::plan::{Placing, Plan, Rows, Turned, Vectors};
use super::rims::{FAR, Found, Rims, Stretch, cells, floor, search};
use crate::batch::machine::lanes::{Lanes, Mask};
use crate::batch::machine::polynomials::direction;
use crate::batch::machine::vector::Vector;
use crate::suspension::{MAX_STATE, MAX_WHEELS};
use crate::terrain::Terrain;

/// Lanes of the widest level.
pub(super) const MOST: usize = 8;

/// How far above the gap anything else along the rim is of interest [m].
pub(super) const MARGIN: f64 = 1e-4;

/// The numbers of the lanes.
#[inline(always)]
pub(super) fn spread<S: Vector>(lanes: Lanes<S>) -> [f64; MOST] {
    let mut values = [0.0; MOST];
    lanes.store(S::as_mut_simd_f64s(&mut values).0, 0);
    values
}

/// Where poses are in the axes of the grid [m], in lanes, and what is known of them.
pub(super) struct Here<S: Vector> {
    pub origin: [Lanes<S>; 2],
    pub yaw: Turned<S>,
    pub state: [Lanes<S>; MAX_STATE],
    pub steering: [Turned<S>; MAX_WHEELS],
    /// Sine and cosine of the last contact angles.
    pub contacts: [[Lanes<S>; 2]; MAX_WHEELS],
}

/// How much of the rims to look at.
pub(super) enum Extent<S: Vector> {
    /// All that may touch.
    Whole,
    /// So far to either side of the last contacts [rad].
    Near(Lanes<S>),
}

/// What a look at the rims has found.
pub(super) struct Look<S: Vector> {
    pub rows: Rows<S>,
    pub found: [Found<S>; MAX_WHEELS],
    pub worst: Lanes<S>,
    /// How much higher anything else along the rims is, up to [`MARGIN`] [m]; below 0 where that is not known.
    pub clear: Lanes<S>,
    /// Whether every rim has a contact there.
    pub touches: Mask<S>,
}

impl<S: Vector> Here<S> {
    /// Looks at all rims.
    #[inline(always)]
    pub fn look(&self, simd: S, plan: &Plan, ground: &Terrain, extent: &Extent<S>) -> Look<S> {
        let (zero, unit) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let spacing = ground.spacing();
        let per_metre = [
            Lanes::splat(simd, 1.0 / spacing[0]),
            Lanes::splat(simd, 1.0 / spacing[1]),
        ];
        let placing = Placing::new(simd, plan, self.yaw, &self.state, &self.steering);
        let nothing = Found {
            gap: zero,
            at: [zero, unit],
            slope: [zero; 2],
            others: zero,
        };
        let mut look = Look {
            rows: [([zero; MAX_STATE], zero); MAX_WHEELS],
            found: [nothing; MAX_WHEELS],
            worst: zero,
            clear: Lanes::splat(simd, FAR),
            touches: zero.below(unit),
        };
        let near = match extent {
            Extent::Whole => None,
            Extent::Near(reach) => Some(direction(simd, *reach)),
        };
        for wheel in 0..plan.wheels() {
            let at = &placing.wheels[wheel];
            let radius = Lanes::splat(simd, plan.radius(wheel));
            let scale = [radius * per_metre[0], radius * per_metre[1], radius];
            let mut rims = Rims {
                centre: [
                    (self.origin[0] + at.centre[0]) * per_metre[0],
                    (self.origin[1] + at.centre[1]) * per_metre[1],
                    self.state[0] + at.centre[2],
                ],
                forward: at.forward,
                up: at.up,
            };
            for (k, scale) in scale.into_iter().enumerate() {
                rims.forward[k] = rims.forward[k] * scale;
                rims.up[k] = rims.up[k] * scale;
            }
            let last = self.contacts[wheel];
            let (stretch, covers) = match near {
                None => whole_rims(simd, ground, &rims, last),
                Some(turned) => (short_look(simd, last, turned), unit.below(zero)),
            };
            let found = search(simd, ground, &rims, &stretch);
            let gradient = [found.slope[0] * per_metre[0], found.slope[1] * per_metre[1]];
            let mut spoke: Vectors<S> = [zero; 3];
            for (k, spoke) in spoke.iter_mut().enumerate() {
                *spoke = (at.forward[k] * found.at[0] - at.up[k] * found.at[1]) * radius;
            }
            let point = placing.rim(wheel, spoke);
            look.rows[wheel] = (placing.slopes(simd, wheel, point, gradient), -found.gap);
            look.worst = look.worst.max(found.gap.abs());
            let clear = covers.select(found.others - found.gap, -unit);
            look.clear = look.clear.min(clear);
            look.touches = look.touches & found.gap.abs().below(Lanes::splat(simd, 0.5 * FAR));
            look.found[wheel] = found;
        }
        look
    }
}

/// What is near the last contact.
#[inline(always)]
fn short_look<S: Vector>(simd: S, [s, c]: [Lanes<S>; 2], (sin, cos): Turned<S>) -> Stretch<S> {
    let (zero, unit) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let (low, high) = (
        [s * cos - c * sin, c * cos + s * sin],
        [s * cos + c * sin, c * cos - s * sin],
    );
    let (starts, ends) = (zero.below(low[1]), zero.below(high[1]));
    Stretch {
        start: [starts.select(low[0], -unit), starts.select(low[1], zero)],
        end: [ends.select(high[0], unit), ends.select(high[1], zero)],
        margin: Lanes::splat(simd, MARGIN),
    }
}

/// All of the rims that may be as near to the ground as the last contact is, and whether that leaves out their upper
/// halves: a point that is higher above the highest ground around is not.
#[inline(always)]
fn whole_rims<S: Vector>(
    simd: S,
    ground: &Terrain,
    rims: &Rims<S>,
    last: [Lanes<S>; 2],
) -> (Stretch<S>, Mask<S>) {
    let (zero, unit) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let margin = Lanes::splat(simd, MARGIN);
    let contact = rims.point(last[0], last[1]);
    let (u, v) = (
        rims.centre[0] + contact.spoke[0],
        rims.centre[1] + contact.spoke[1],
    );
    let (column, row) = (floor(simd, u), floor(simd, v));
    let cell = cells(simd, ground, column, row);
    let (a, b) = (u - column, v - row);
    let height = cell.h00 + cell.along * a + (cell.across + cell.twist * a) * b;
    let gap = (rims.centre[2] + contact.spoke[2]) - height;
    let size = (rims.forward[2] * rims.forward[2] + rims.up[2] * rims.up[2]).sqrt();
    let inverse = unit.quotient(size);
    // The lowest point of the rim.
    let (cos, sin) = (rims.up[2] * inverse, -(rims.forward[2] * inverse));
    let [rear, front] = tops(simd, ground, rims);
    let mut stretch = Stretch {
        start: [-unit, zero],
        end: [unit, zero],
        margin,
    };
    let mut covers = zero.below(unit);
    // So far from the lowest point its height is what counts: cosine and sine of the angle.
    let near = ((rims.centre[2] - front - gap - margin - margin) * inverse).min(unit);
    let far = (unit - near * near).max(zero).sqrt();
    let end = [sin * near + cos * far, cos * near - sin * far];
    let cuts = zero.below(near) & zero.below(end[1]);
    stretch.end = [cuts.select(end[0], unit), cuts.select(end[1], zero)];
    covers = covers & cuts;
    let near = ((rims.centre[2] - rear - gap - margin - margin) * inverse).min(unit);
    let far = (unit - near * near).max(zero).sqrt();
    let start = [sin * near - cos * far, cos * near + sin * far];
    let cuts = zero.below(near) & zero.below(start[1]);
    stretch.start = [cuts.select(start[0], -unit), cuts.select(start[1], zero)];
    (stretch, covers & cuts)
}

/// The highest ground beside the rear and the front halves of the rims; infinity where it is not known.
#[inline(always)]
fn tops<S: Vector>(simd: S, ground: &Terrain, rims: &Rims<S>) -> [Lanes<S>; 2] {
    let zero = Lanes::splat(simd, 0.0);
    let [rows, columns] = ground.shape();
    let last = [columns as f64 - 2.0, rows as f64 - 2.0];
    let mut tops = [[f64::INFINITY; MOST]; 2];
    let mut boxes = [[[[0.0; MOST]; 2]; 2]; 2];
    let [[rear_low, rear_high], [front_low, front_high]] = &mut boxes;
    for k in 0..2 {
        let (h, u) = (rims.forward[k], rims.up[k].abs());
        // Of P(t) = h sin t - u cos t, with the cosine of either sign.
        let (low, high) = (h.min(zero) - u, h.max(zero) + u);
        rear_low[k] = spread(floor(simd, rims.centre[k] - high));
        rear_high[k] = spread(floor(simd, rims.centre[k] - low));
        front_low[k] = spread(floor(simd, rims.centre[k] + low));
        front_high[k] = spread(floor(simd, rims.centre[k] + high));
    }
    for (top, [low, high]) in tops.iter_mut().zip(&boxes) {
        for lane in 0..S::F64_LANES {
            let inside = (0..2).all(|k| low[k][lane] >= 0.0 && high[k][lane] <= last[k]);
            if inside {
                let ends = [low, high].map(|ends| [ends[0][lane] as usize, ends[1][lane] as usize]);
                top[lane] = match ground.known_pyramid() {
                    Some(pyramid) => pyramid.highest(ends[0], ends[1]),
                    None => ground.highest(ends[0], ends[1]),
                };
            }
        }
    }
    [
        Lanes::load(simd, S::as_simd_f64s(&tops[0]).0, 0),
        Lanes::load(simd, S::as_simd_f64s(&tops[1]).0, 0),
    ]
}
