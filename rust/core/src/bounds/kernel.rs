//! The bounds of many poses, as many at a time as a register holds; the same to the bit at every level.

use pulp::{Scalar, Simd};

use super::boxes::Patch;
use super::pyramid::{Cells, NOTHING, Pyramid, Span};
use super::side::{Lever, Side};
use super::{Knowledge, Plan, Room};
use crate::batch::machine::lanes::{Lanes, Mask};
use crate::batch::machine::level::Kernel;
use crate::batch::machine::polynomials::{LARGEST_ANGLE, angle, sin_cos};
use crate::batch::machine::vector::Vector;
use crate::batch::machine::workers;
use crate::batch::{Level, Workers};

/// Number of intervals of a pose.
const COUNT: usize = super::QUANTITIES.len();

/// Lanes of the widest level.
const MOST: usize = 8;

/// How much wider the intervals are made: more than the kernel and a settled pose can round [m, rad].
const ROUNDING: f64 = 1e-9;

/// Poses that are tried with one plan before the next: their numbers stay in the first-level cache.
const BLOCK: usize = 256;

/// Rounds of the contraction of tan(g); the fourth gained less than 1e-3 of the width.
const ROUNDS: usize = 3;

/// Positions from which on neighbouring doubles are further apart than a wheel is large.
const FAR: f64 = 1e15;

/// What the ground is known to be.
#[derive(Clone, Copy, Debug)]
pub struct Ground<'a> {
    /// Its extremes.
    pub pyramid: &'a Pyramid,
    /// How far the true heights may be from those of the map [m].
    pub error: f64,
}

/// What else than the pose itself is asked about.
#[derive(Clone, Copy, Debug)]
pub struct Margins<'a> {
    /// Yaw up to so much to either side, per row or once [rad].
    pub yaw: &'a [f64],
    /// Places up to so far away, per row or once [m].
    pub position: &'a [f64],
}

impl Margins<'_> {
    fn at(self, k: usize) -> [f64; 2] {
        [self.yaw, self.position].map(|values| {
            if values.len() == 1 {
                values[0]
            } else {
                values[k]
            }
        })
    }
}

/// The bounds of every pose `[x, y, yaw]`, finite. Writes for each of the quantities a block of intervals, a row
/// per pose, and the worth of every row; intervals that are not known are NaN. Poses whose wheels may leave the boxes
/// of a plan are tried with the next.
pub fn bounds(
    plans: &[Plan],
    ground: Ground<'_>,
    poses: &[[f64; 3]],
    margins: Margins<'_>,
    blocks: [&mut [[f64; 2]]; COUNT],
    worth: &mut [Knowledge],
    workers: Workers,
) {
    let workers = workers.here();
    let share = workers.share(poses.len());
    let mut blocks = blocks.map(|block| block.chunks_mut(share));
    let jobs = worth.chunks_mut(share).enumerate().map(|(k, worth)| Job {
        plans,
        ground,
        poses: &poses[k * share..][..worth.len()],
        margins,
        first: k * share,
        blocks: blocks
            .each_mut()
            .map(|block| block.next().unwrap_or_default()),
        worth,
    });
    // A job does not fail.
    let _ = workers::each(jobs, |job| {
        if workers.level == Level::Plain {
            job.work(Scalar::new());
        } else {
            workers.level.run(job);
        }
        Ok(())
    });
}

/// Poses that one thread takes.
struct Job<'a> {
    plans: &'a [Plan],
    ground: Ground<'a>,
    poses: &'a [[f64; 3]],
    margins: Margins<'a>,
    /// Row of the first one among all.
    first: usize,
    blocks: [&'a mut [[f64; 2]]; COUNT],
    worth: &'a mut [Knowledge],
}

impl Kernel for Job<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) {
        self.work(simd);
    }
}

/// A number per lane, on its way between registers and memory.
type Column = [f64; MOST];

#[inline(always)]
fn load<S: Simd>(simd: S, column: &Column) -> Lanes<S> {
    Lanes::load(simd, S::as_simd_f64s(&column[..S::F64_LANES]).0, 0)
}

#[inline(always)]
fn store<S: Simd>(lanes: Lanes<S>, column: &mut Column) {
    lanes.store(S::as_mut_simd_f64s(&mut column[..S::F64_LANES]).0, 0);
}

impl Job<'_> {
    #[inline(always)]
    fn work<S: Simd>(mut self, simd: S) {
        for first in (0..self.poses.len()).step_by(BLOCK) {
            let mut rows: [usize; BLOCK] = std::array::from_fn(|k| first + k);
            let mut count = BLOCK.min(self.poses.len() - first);
            for plan in self.plans {
                for some in rows[..count].chunks(S::F64_LANES) {
                    self.some(simd, plan, some);
                }
                let mut left = 0;
                for k in 0..count {
                    if self.worth[rows[k]] == Knowledge::Beyond {
                        rows[left] = rows[k];
                        left += 1;
                    }
                }
                count = left;
            }
        }
    }

    /// The poses of as many rows as there are lanes, or fewer.
    #[inline(always)]
    fn some<S: Simd>(&mut self, simd: S, plan: &Plan, rows: &[usize]) {
        let mut columns = [[0.0; MOST]; 5];
        let mut worth = [Knowledge::Bounded; MOST];
        for lane in 0..S::F64_LANES {
            let k = rows[lane.min(rows.len() - 1)];
            let [x, y, yaw] = self.poses[k];
            let near = x.abs() < FAR && y.abs() < FAR;
            if !near {
                worth[lane] = Knowledge::OffMap;
            }
            let [yaw_margin, position_margin] = self.margins.at(self.first + k);
            let turned = if yaw.abs() > LARGEST_ANGLE {
                yaw % std::f64::consts::TAU
            } else {
                yaw
            };
            let row = [
                if near { x } else { 0.0 },
                if near { y } else { 0.0 },
                turned,
            ];
            let chord = 2.0 * (0.5 * yaw_margin.min(std::f64::consts::PI)).sin();
            for (column, value) in
                columns
                    .iter_mut()
                    .zip([row[0], row[1], row[2], chord, position_margin])
            {
                column[lane] = value;
            }
        }
        let place = Place::new(simd, self.ground.pyramid, &columns);
        let seen = Seen::new(simd, plan, self.ground, &place, &mut worth);
        let (intervals, checks) = plan.stand(simd, &seen);
        let mut table = [[[0.0; MOST]; 2]; COUNT];
        for (interval, columns) in intervals.into_iter().zip(&mut table) {
            for (end, column) in interval.into_iter().zip(columns) {
                store(end, column);
            }
        }
        for (mask, says) in checks {
            let mut column = [0.0; MOST];
            store(
                mask.select(Lanes::splat(simd, 1.0), Lanes::splat(simd, 0.0)),
                &mut column,
            );
            for (worth, holds) in worth.iter_mut().zip(column) {
                if holds == 0.0 && *worth == Knowledge::Bounded {
                    *worth = says;
                }
            }
        }
        for (lane, &row) in rows.iter().enumerate() {
            let bounded = worth[lane] == Knowledge::Bounded;
            self.worth[row] = worth[lane];
            for (block, [low, high]) in self.blocks.iter_mut().zip(&table) {
                block[row] = if bounded {
                    [low[lane] - ROUNDING, high[lane] + ROUNDING]
                } else {
                    [f64::NAN; 2]
                };
            }
        }
    }
}

/// Where the poses are, in cells of the map.
struct Place<S: Simd> {
    /// Cosine and sine of the heading against the map's rows, and their sizes.
    cos: Lanes<S>,
    sin: Lanes<S>,
    along: Lanes<S>,
    across: Lanes<S>,
    origin: [Lanes<S>; 2],
    /// Cells per metre.
    per_metre: [Lanes<S>; 2],
    /// Number of cells.
    cells: [f64; 2],
    /// How far a point one metre from the origin goes over the interval of yaw [m], and all points go [m].
    chord: Lanes<S>,
    margin: Lanes<S>,
    simd: S,
}

impl<S: Simd> Place<S> {
    #[inline(always)]
    fn new(simd: S, pyramid: &Pyramid, columns: &[Column; 5]) -> Self {
        let [x, y, yaw, chord, margin] = columns.each_ref().map(|column| load(simd, column));
        let all = |value| Lanes::splat(simd, value);
        let turn = pyramid.turn();
        let (turned_cos, turned_sin) = (all(turn.cos), all(turn.sin));
        let grid_axes = |x: Lanes<S>, y: Lanes<S>| {
            [
                turned_cos * x + turned_sin * y,
                turned_cos * y - turned_sin * x,
            ]
        };
        let (sin, cos) = sin_cos(simd, yaw);
        let [cos, sin] = grid_axes(cos, sin);
        let [x0, y0] = pyramid.origin().map(all);
        let per_metre = pyramid.spacing().map(|spacing| all(1.0 / spacing));
        let [u, v] = grid_axes(x - x0, y - y0);
        Self {
            cos,
            sin,
            along: cos.abs(),
            across: sin.abs(),
            origin: [u * per_metre[0], v * per_metre[1]],
            per_metre,
            cells: pyramid.cells().map(|cells| cells as f64),
            chord,
            margin,
            simd,
        }
    }

    /// The ground in a patch; lanes whose patch leaves the map, or holds an unknown height, say so.
    #[inline(always)]
    fn look(
        &self,
        pyramid: &Pyramid,
        patch: &Patch,
        spans: &mut [[f32; 2]; MOST],
        worth: &mut [Knowledge; MOST],
    ) {
        let all = |value| Lanes::splat(self.simd, value);
        let ([cx, cy], [hx, hy]) = (patch.centre.map(all), patch.half.map(all));
        let reach =
            all(patch.centre[0].hypot(patch.centre[1]) + patch.half[0].hypot(patch.half[1]));
        let margin = self.chord.mul_add(reach, self.margin);
        let middle = [
            (self.cos * cx - self.sin * cy).mul_add(self.per_metre[0], self.origin[0]),
            (self.sin * cx + self.cos * cy).mul_add(self.per_metre[1], self.origin[1]),
        ];
        let half = [
            (self.along * hx + self.across * hy + margin) * self.per_metre[0],
            (self.across * hx + self.along * hy + margin) * self.per_metre[1],
        ];
        let mut ends = [[[0.0; MOST]; 2]; 2];
        let mut inside = [0.0; MOST];
        let zero = all(0.0);
        let (mut lowest, mut beyond) = (zero, zero);
        for axis in 0..2 {
            let (low, high) = (middle[axis] - half[axis], middle[axis] + half[axis]);
            lowest = lowest.min(low);
            beyond = beyond.max(high - all(self.cells[axis]));
            // Rounded to the nearest whole number, which goes into the lowest bits; on a line of the grid either cell
            // has it.
            let last = all(self.cells[axis] - 1.0);
            let shift = all(WHOLE);
            store(
                (low - all(0.5)).max(zero).min(last) + shift,
                &mut ends[axis][0],
            );
            store(
                (high - all(0.5)).max(zero).min(last) + shift,
                &mut ends[axis][1],
            );
        }
        let on_map = zero.at_most(lowest) & beyond.at_most(zero);
        store(on_map.select(all(1.0), zero), &mut inside);
        for lane in 0..S::F64_LANES {
            let end =
                |axis: usize, end: usize| (ends[axis][end][lane].to_bits() & 0xffff_ffff) as usize;
            let cells = Cells {
                first: [end(0, 0), end(1, 0)],
                last: [end(0, 1), end(1, 1)],
            };
            if inside[lane] == 0.0 {
                worth[lane] = Knowledge::OffMap;
            } else {
                pyramid.span(cells, &mut spans[lane]);
            }
        }
    }
}

/// `2^52`: added to a number, its whole part is in the lowest bits.
const WHOLE: f64 = 4_503_599_627_370_496.0;

/// The ground under the rover.
struct Seen<S: Simd> {
    /// Lowest and highest under each wheel, left and right, front to rear, less the mean of all [m].
    wheels: [[[Lanes<S>; 2]; 3]; 2],
    mean: Lanes<S>,
    /// Highest under the belly, lowest under its middle [m].
    summit: Lanes<S>,
    floor: Lanes<S>,
}

impl<S: Simd> Seen<S> {
    #[inline(always)]
    fn new(
        simd: S,
        plan: &Plan,
        ground: Ground<'_>,
        place: &Place<S>,
        worth: &mut [Knowledge; MOST],
    ) -> Self {
        let pyramid = ground.pyramid;
        let error = Lanes::splat(simd, ground.error);
        let look = |patches: &[Patch], worth: &mut [Knowledge; MOST]| {
            let mut spans = [NOTHING; MOST];
            for patch in patches {
                place.look(pyramid, patch, &mut spans, worth);
            }
            let (mut low, mut high) = ([0.0; MOST], [0.0; MOST]);
            for lane in 0..S::F64_LANES {
                let Span { lowest, highest } = spans[lane].into();
                if lowest <= highest && lowest > f64::NEG_INFINITY {
                    (low[lane], high[lane]) = (lowest, highest);
                } else if worth[lane] == Knowledge::Bounded {
                    worth[lane] = Knowledge::UnknownCells;
                }
            }
            [load(simd, &low) - error, load(simd, &high) + error]
        };
        let mut wheels = [[[Lanes::splat(simd, 0.0); 2]; 3]; 2];
        for pair in 0..3 {
            for side in 0..2 {
                wheels[side][pair] = look(&plan.wheels[side][pair], worth);
            }
        }
        let [_, summit] = look(&plan.belly, worth);
        let [floor, _] = look(&[plan.middle], worth);
        let mut sum = Lanes::splat(simd, 0.0);
        for [low, high] in wheels.as_flattened() {
            sum = sum + *low + *high;
        }
        let mean = sum * Lanes::splat(simd, 1.0 / 12.0);
        let wheels = wheels.map(|side| side.map(|span| span.map(|end| end - mean)));
        Self {
            wheels,
            mean,
            summit: summit - mean,
            floor: floor - mean,
        }
    }
}

type Interval<S> = [Lanes<S>; 2];

/// An interval times one that is positive.
#[inline(always)]
fn times<S: Simd>([low, high]: Interval<S>, [least, most]: Interval<S>) -> Interval<S> {
    [
        (low * least).min(low * most),
        (high * least).max(high * most),
    ]
}

/// The even, in 0 to the sides rising or falling function of which these are the values at the ends: its interval,
/// with its value at 0 where 0 is inside.
#[inline(always)]
fn even<S: Simd>([low, high]: Interval<S>, [a, b]: Interval<S>, middle: Lanes<S>) -> Interval<S> {
    let around = (low * high).below(Lanes::splat(low.simd(), 0.0));
    let (least, most) = (a.min(b), a.max(b));
    [
        around.select(least.min(middle), least),
        around.select(most.max(middle), most),
    ]
}

/// Arc sine, of numbers beyond 1 that of 1.
#[inline(always)]
fn asin<S: Simd>(x: Lanes<S>) -> Lanes<S> {
    let (simd, one) = (x.simd(), Lanes::splat(x.simd(), 1.0));
    let size = x.abs().min(one);
    let cos = (one - size) * (one + size);
    angle(simd, cos.sqrt(), size).flip(x.sign())
}

/// One side, with its height and both its angles.
struct Raised<S: Simd> {
    /// Height of D, less what lateral places add [m].
    axis: Interval<S>,
    /// Sines `sin(phi - t)` of the bogie and of the rocker.
    bogie: Interval<S>,
    rocker: Interval<S>,
    /// Heights of B where the bogie is turned least and most [m].
    turned: Interval<S>,
    /// Whether all extremes are at corners.
    sure: Mask<S>,
}

impl Lever {
    /// Height of the axis under a support at this height, `sin` the sine of phi - t.
    #[inline(always)]
    fn below<S: Simd>(&self, support: Lanes<S>, sin: Lanes<S>) -> Lanes<S> {
        let all = |value| Lanes::splat(sin.simd(), value);
        let cos = (all(1.0) - sin * sin).max(all(0.0)).sqrt();
        support - (all(self.off) * cos + all(self.along) * sin)
    }

    #[inline(always)]
    fn allows<S: Simd>(&self, [low, high]: Interval<S>) -> Mask<S> {
        let [least, most] = self.range.map(|end| Lanes::splat(low.simd(), end));
        least.at_most(low) & high.at_most(most)
    }
}

impl Side {
    /// From the reduced heights of the rocker's wheel and of the bogie's, ahead and behind.
    #[inline(always)]
    fn raise<S: Simd>(&self, [single, ahead, behind]: [Interval<S>; 3]) -> Raised<S> {
        let simd = single[0].simd();
        let (by_bogie, by_rocker) = (
            Lanes::splat(simd, self.bogie.inverse_length),
            Lanes::splat(simd, self.rocker.inverse_length),
        );
        let sine = |ahead: Lanes<S>, behind: Lanes<S>| (ahead - behind) * by_bogie;
        let bogie = [sine(ahead[0], behind[1]), sine(ahead[1], behind[0])];
        let joint = [0, 1].map(|end| self.bogie.below(ahead[end], sine(ahead[end], behind[end])));
        let tilt = |wheel: Lanes<S>, joint: Lanes<S>| {
            let rise = if self.in_front {
                joint - wheel
            } else {
                wheel - joint
            };
            rise * by_rocker
        };
        let opposed = [tilt(single[0], joint[1]), tilt(single[1], joint[0])];
        let rocker = if self.in_front {
            [opposed[1], opposed[0]]
        } else {
            opposed
        };
        let axis = [0, 1].map(|end| {
            self.rocker
                .below(single[end], tilt(single[end], joint[end]))
        });
        let turned = [
            self.bogie.below(ahead[1], bogie[1]),
            self.bogie.below(ahead[0], bogie[0]),
        ];
        Raised {
            axis,
            bogie,
            rocker,
            turned,
            sure: self.bogie.allows(bogie) & self.rocker.allows(rocker),
        }
    }

    /// Angles of the rocker and of the bogie against the plane, and of the bogie against the rocker.
    #[inline(always)]
    fn angles<S: Simd>(&self, raised: &Raised<S>, single: Interval<S>) -> [Interval<S>; 2] {
        let simd = single[0].simd();
        let all = |value| Lanes::splat(simd, value);
        let (phi_bogie, phi_rocker) = (all(self.bogie.phi), all(self.rocker.phi));
        let rocker = [
            phi_rocker - asin(raised.rocker[1]),
            phi_rocker - asin(raised.rocker[0]),
        ];
        let bogie = [
            phi_bogie - asin(raised.bogie[1]),
            phi_bogie - asin(raised.bogie[0]),
        ];
        if !self.coupled {
            return [rocker, [bogie[0] - rocker[1], bogie[1] - rocker[0]]];
        }
        // Least where the bogie is turned least and the rocker, with its wheel, most.
        let by_rocker = all(self.rocker.inverse_length);
        let [least, most] = [0, 1].map(|end| {
            let sine = if self.in_front {
                (raised.turned[end] - single[1 - end]) * by_rocker
            } else {
                (single[end] - raised.turned[end]) * by_rocker
            };
            bogie[end] - (phi_rocker - asin(sine))
        });
        [rocker, [least, most]]
    }
}

impl Plan {
    /// Intervals of all quantities, and what has to hold for them to be bounds.
    #[inline(always)]
    fn stand<S: Simd>(
        &self,
        simd: S,
        seen: &Seen<S>,
    ) -> ([Interval<S>; COUNT], [(Mask<S>, Knowledge); 3]) {
        let all = |value| Lanes::splat(simd, value);
        let (zero, one, half) = (all(0.0), all(1.0), all(0.5));
        // tan(g), from 30 degrees to either side.
        let mut tan = [all(-0.577_350_269_189_625_8), all(0.577_350_269_189_625_8)];
        let mut reduced = [[[zero; 2]; 3]; 2];
        let mut sure = zero.at_most(one);
        for round in 0..=ROUNDS {
            let squares = tan.map(|tan| tan.mul_add(tan, one));
            let inverse_cos = even(tan, squares.map(Lanes::sqrt), one);
            for (side, right) in [false, true].into_iter().enumerate() {
                let rise = if right { tan } else { [-tan[1], -tan[0]] };
                for (role, pair) in self.roles.into_iter().enumerate() {
                    let scaled = times(seen.wheels[side][pair], inverse_cos);
                    let offset = all(self.offsets[pair]);
                    reduced[side][role] =
                        [0, 1].map(|end| rise[end].mul_add(offset, scaled[end] + all(self.radius)));
                }
            }
            if round == ROUNDS {
                break;
            }
            let [left, right] = reduced.map(|wheels| self.side.raise(wheels));
            let per_width = all(0.5 / self.lateral);
            let narrower = [
                tan[0].max((left.axis[0] - right.axis[1]) * per_width),
                tan[1].min((left.axis[1] - right.axis[0]) * per_width),
            ];
            let proved = left.sure & right.sure;
            let held = narrower[0].at_most(narrower[1]);
            // No inclination of up to 30 degrees has these heights: a steeper one may have.
            sure = sure & (held | !proved);
            let take = proved & held;
            tan = [0, 1].map(|end| take.select(narrower[end], tan[end]));
        }
        let sides = reduced.map(|wheels| self.side.raise(wheels));
        sure = sure & sides[0].sure & sides[1].sure;
        let [left, right] = [0, 1].map(|side| self.side.angles(&sides[side], reduced[side][0]));

        let inverse = tan.map(|tan| one.quotient(tan.mul_add(tan, one).sqrt()));
        let cos_side = even(tan, inverse, one);
        let sin_side = [0, 1].map(|end| tan[end] * inverse[end]);
        let slack = all(self.slack);
        let lean = [
            (left[0][0] + right[0][0]) * half - slack,
            (left[0][1] + right[0][1]) * half + slack,
        ];
        let rocker = [
            (left[0][0] - right[0][1]) * half - slack,
            (left[0][1] - right[0][0]) * half + slack,
        ];
        let ends = lean.map(|lean| sin_cos(simd, lean));
        let sin_lean = ends.map(|(sin, _)| sin);
        let cos_lean = even(lean, ends.map(|(_, cos)| cos), one);
        let sin_pitch = times(sin_lean, cos_side);
        let secant = even(
            sin_pitch,
            sin_pitch.map(|sin| one.quotient((one - sin * sin).max(all(1e-3)).sqrt())),
            one,
        );
        let sin_roll = times(sin_side, secant);
        let squares = |sines: Interval<S>| even(sines, sines.map(|sin| sin * sin), zero);
        let (a, b) = (squares(sin_side), squares(sin_lean));
        let tilt = [0, 1].map(|end| asin(((one - a[end]).mul_add(b[end], a[end])).sqrt()));

        let axis = [
            (sides[0].axis[0] + sides[1].axis[0]) * half,
            (sides[0].axis[1] + sides[1].axis[1]) * half,
        ];
        // Height of a point `ahead` of the axis of the rockers and so much `below` it, in the plane.
        let [pivot_x, _, pivot_z] = self.pivot;
        let point = |x: f64, z: f64| {
            let (behind, below) = (all(pivot_x - x), all(pivot_z - z));
            let swings = sin_lean.map(|sin| sin * behind);
            let drops = cos_lean.map(|cos| cos * below);
            let low = axis[0] + swings[0].min(swings[1]) - drops[0].max(drops[1]);
            let high = axis[1] + swings[0].max(swings[1]) - drops[0].min(drops[1]);
            times([low, high], cos_side)
        };
        let z = point(0.0, 0.0).map(|end| end + seen.mean);
        let plate = self.plate;
        let side_drop = all(plate.half_width) * sin_side[0].abs().max(sin_side[1].abs());
        let corners = plate.x.map(|x| point(x, plate.z)[0]);
        let middle = point((plate.x[0] + plate.x[1]) / 2.0, plate.z)[1];
        let clearance = [
            corners[0].min(corners[1]) - side_drop - seen.summit,
            middle - seen.floor,
        ];
        let roll = sin_roll.map(asin);
        let pitch = sin_pitch.map(asin);
        let turned = self.turned(rocker, [left[1], right[1]]);
        let drop = self.drop(&turned);
        let within = |interval: Interval<S>, largest: f64| {
            all(-largest).at_most(interval[0]) & interval[1].at_most(all(largest))
        };
        let boxed = self.boxed(&turned, sin_pitch, sin_roll)
            | within(roll, self.within.attitude)
                & within(pitch, self.within.attitude)
                & within(rocker, self.within.rocker)
                & within(left[1], self.within.bogie)
                & within(right[1], self.within.bogie);
        let inside = |interval: Interval<S>, [low, high]: [f64; 2]| {
            all(low).at_most(interval[0]) & interval[1].at_most(all(high))
        };
        let free = inside(rocker, self.rocker_limit)
            & inside(left[1], self.bogie_limit)
            & inside(right[1], self.bogie_limit);
        (
            [
                z, roll, pitch, tilt, clearance, rocker, left[1], right[1], drop,
            ],
            [
                (sure, Knowledge::Unsolved),
                (boxed, Knowledge::Beyond),
                (free, Knowledge::AtStop),
            ],
        )
    }

    /// Sines and cosines of the ends of the rockers' and the bogies' angles in the body, left and right.
    #[inline(always)]
    fn turned<S: Simd>(
        &self,
        rocker: Interval<S>,
        bogies: [Interval<S>; 2],
    ) -> [[Turned<S>; 2]; 2] {
        let simd = rocker[0].simd();
        let slack = Lanes::splat(simd, 2.0 * self.slack);
        let left = rocker.map(|end| sin_cos(simd, end));
        // What a bar turns the right rocker more or less than back only matters for the bogie it carries.
        let right = [(-left[1].0, left[1].1), (-left[0].0, left[0].1)];
        let carried = |rocker: Interval<S>, bogie: Interval<S>| {
            [rocker[0] + bogie[0] - slack, rocker[1] + bogie[1] + slack]
                .map(|end| sin_cos(simd, end))
        };
        [
            [left, carried(rocker, bogies[0])],
            [right, carried([-rocker[1], -rocker[0]], bogies[1])],
        ]
    }

    /// How far, in the body, the wheel that has come down most is below its place on level ground.
    #[inline(always)]
    fn drop<S: Simd>(&self, turned: &[[Turned<S>; 2]; 2]) -> Interval<S> {
        let simd = turned[0][0][0].0.simd();
        let all = |value| Lanes::splat(simd, value);
        let fall = |k: usize, ends: &Turned<S>| {
            let ([x, _, z], sag) = (self.vectors[k], all(self.sag[k]));
            let falls = ends.map(|(sin, cos)| all(z) - (all(z) * cos - all(x) * sin));
            [falls[0].min(falls[1]) - sag, falls[0].max(falls[1]) + sag]
        };
        let mut most = [all(f64::NEG_INFINITY); 2];
        for [rocker, carried] in turned {
            let joint = fall(1, rocker);
            for (k, carrier, from) in [
                (0, rocker, [all(0.0); 2]),
                (2, carried, joint),
                (3, carried, joint),
            ] {
                let own = fall(k, carrier);
                most = [0, 1].map(|end| most[end].max(own[end] + from[end]));
            }
        }
        let loose = all(self.looseness);
        [most[0] - loose, most[1] + loose]
    }

    /// Whether every wheel and the belly, seen from above, are in the boxes that were looked at.
    ///
    /// Stretched from level to what it is, the ground leads the rover from where all wheels are in their boxes to
    /// where it stands. It cannot leave them on the way while the bounds, which hold inside, say that it is inside.
    #[inline(always)]
    fn boxed<S: Simd>(
        &self,
        turned: &[[Turned<S>; 2]; 2],
        pitch: Interval<S>,
        roll: Interval<S>,
    ) -> Mask<S> {
        let simd = pitch[0].simd();
        let all = |value| Lanes::splat(simd, value);
        let one = all(1.0);
        // Largest sine, and largest 1 - cos.
        let largest = |sines: Interval<S>| {
            let sin = sines[0].abs().max(sines[1].abs());
            (sin, one - (one - sin * sin).max(all(0.0)).sqrt())
        };
        let (sin_pitch, sunk) = largest(pitch);
        let (sin_roll, leaned) = largest(roll);
        // How far a point of the body is seen from where it is seen when level, given how far it has moved in it.
        let seen = |room: &Room, dx: Lanes<S>, dz: Lanes<S>| {
            let [x, y, z] = room.place.map(all);
            let height = z + dz;
            let ahead = dx + x * sunk + sin_pitch * (y * sin_roll + height);
            let aside = y * leaned + (height + all(room.radius)) * sin_roll;
            ahead.at_most(all(room.room[0])) & aside.at_most(all(room.room[1]))
        };
        let mut fits = seen(&self.rooms[3], all(0.0), all(0.0));
        for [rocker, carried] in turned {
            // How far the end of a vector swings along and across.
            let swing = |k: usize, ends: &Turned<S>| {
                let [x, _, z] = self.vectors[k].map(|size| all(size.abs()));
                let sin = ends[0].0.abs().max(ends[1].0.abs());
                let less = one - ends[0].1.min(ends[1].1);
                [z * sin + x * less, x * sin + z * less]
            };
            let joint = swing(1, rocker);
            for (role, carrier, from) in [
                (0, rocker, [all(0.0); 2]),
                (1, carried, joint),
                (2, carried, joint),
            ] {
                let own = swing(if role == 0 { 0 } else { 1 + role }, carrier);
                let room = &self.rooms[self.roles[role]];
                fits = fits & seen(room, own[0] + from[0], own[1] + from[1]);
            }
        }
        fits
    }
}

/// Sine and cosine at both ends of an angle's interval.
type Turned<S> = [(Lanes<S>, Lanes<S>); 2];
