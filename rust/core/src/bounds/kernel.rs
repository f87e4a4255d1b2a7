//! The bounds of many poses, as many at a time as a register holds; the same to the bit at every level.

use pulp::{Scalar, Simd};

use super::boxes::Patch;
use super::pyramid::{Cells, NOTHING, Pyramid, Span};
use super::stand::{COUNT, Interval, all};
use super::{Knowledge, Plan};
use crate::batch::machine::lanes::Lanes;
use crate::batch::machine::level::Kernel;
use crate::batch::machine::polynomials::{LARGEST_ANGLE, sin_cos};
use crate::batch::machine::vector::Vector;
use crate::batch::{Level, Workers};

/// Lanes of the widest level.
const MOST: usize = 8;

/// How much wider the intervals are made: more than the kernel and a settled pose can round [m, rad].
const ROUNDING: f64 = 1e-9;

/// Poses that are tried with one plan before the next: their numbers stay in the first-level cache.
const BLOCK: usize = 256;

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
    let _ = workers.each(jobs, |job| {
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

/// How far a point one metre from the origin goes over an interval of yaw [m].
fn chord(margin: f64) -> f64 {
    if margin == 0.0 {
        0.0
    } else {
        2.0 * (0.5 * margin.min(std::f64::consts::PI)).sin()
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
            let chord = chord(yaw_margin);
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
        let (intervals, checks) = plan.stand(simd, &seen.wheels, seen.under);
        let mut table = [[[0.0; MOST]; 2]; COUNT];
        for k in 0..COUNT {
            store(intervals[k][0], &mut table[k][0]);
            store(intervals[k][1], &mut table[k][1]);
        }
        for (mask, says) in checks {
            let mut column = [0.0; MOST];
            store(mask.select(all(simd, 1.0), all(simd, 0.0)), &mut column);
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
        let turn = pyramid.turn();
        let (turned_cos, turned_sin) = (all(simd, turn.cos), all(simd, turn.sin));
        let (sin, cos) = sin_cos(simd, load(simd, &columns[2]));
        let (cos, sin) = (
            turned_cos * cos + turned_sin * sin,
            turned_cos * sin - turned_sin * cos,
        );
        let [x0, y0] = pyramid.origin();
        let (x, y) = (
            load(simd, &columns[0]) - all(simd, x0),
            load(simd, &columns[1]) - all(simd, y0),
        );
        let [dx, dy] = pyramid.spacing();
        let per_metre = [all(simd, 1.0 / dx), all(simd, 1.0 / dy)];
        let [columns_of_map, rows] = pyramid.cells();
        Self {
            cos,
            sin,
            along: cos.abs(),
            across: sin.abs(),
            origin: [
                (turned_cos * x + turned_sin * y) * per_metre[0],
                (turned_cos * y - turned_sin * x) * per_metre[1],
            ],
            per_metre,
            cells: [columns_of_map as f64, rows as f64],
            chord: load(simd, &columns[3]),
            margin: load(simd, &columns[4]),
            simd,
        }
    }

    /// The ground in a patch; lanes whose patch leaves the map say so.
    #[inline(always)]
    fn look(
        &self,
        pyramid: &Pyramid,
        patch: &Patch,
        spans: &mut [[f32; 2]; MOST],
        worth: &mut [Knowledge; MOST],
    ) {
        let simd = self.simd;
        let (cx, cy) = (all(simd, patch.centre[0]), all(simd, patch.centre[1]));
        let (hx, hy) = (all(simd, patch.half[0]), all(simd, patch.half[1]));
        let margin = self.chord.mul_add(all(simd, patch.reach), self.margin);
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
        let zero = all(simd, 0.0);
        let (mut lowest, mut beyond) = (zero, zero);
        for axis in 0..2 {
            let (low, high) = (middle[axis] - half[axis], middle[axis] + half[axis]);
            lowest = lowest.min(low);
            beyond = beyond.max(high - all(simd, self.cells[axis]));
            // Rounded to the nearest whole number, which goes into the lowest bits; on a line of the grid either
            // cell has it.
            let (last, less) = (all(simd, self.cells[axis] - 1.0), all(simd, 0.5));
            let shift = all(simd, WHOLE);
            store((low - less).max(zero).min(last) + shift, &mut ends[axis][0]);
            store(
                (high - less).max(zero).min(last) + shift,
                &mut ends[axis][1],
            );
        }
        let on_map = zero.at_most(lowest) & beyond.at_most(zero);
        store(on_map.select(all(simd, 1.0), zero), &mut inside);
        for lane in 0..S::F64_LANES {
            if inside[lane] == 0.0 {
                worth[lane] = Knowledge::OffMap;
            } else {
                let cells = Cells {
                    first: [whole(ends[0][0][lane]), whole(ends[1][0][lane])],
                    last: [whole(ends[0][1][lane]), whole(ends[1][1][lane])],
                };
                pyramid.span(cells, &mut spans[lane]);
            }
        }
    }

    /// Lowest and highest ground in patches; lanes with an unknown height say so.
    #[inline(always)]
    fn extremes(
        &self,
        ground: Ground<'_>,
        patches: &[Patch],
        worth: &mut [Knowledge; MOST],
    ) -> Interval<S> {
        let mut spans = [NOTHING; MOST];
        for patch in patches {
            self.look(ground.pyramid, patch, &mut spans, worth);
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
        let error = all(self.simd, ground.error);
        [
            load(self.simd, &low) - error,
            load(self.simd, &high) + error,
        ]
    }
}

/// `2^52`: added to a number, its whole part is in the lowest bits.
const WHOLE: f64 = 4_503_599_627_370_496.0;

#[inline(always)]
fn whole(shifted: f64) -> usize {
    (shifted.to_bits() & 0xffff_ffff) as usize
}

/// The ground under the rover.
struct Seen<S: Simd> {
    /// Lowest and highest under each wheel, left and right, front to rear, less the mean of all [m].
    wheels: [[Interval<S>; 3]; 2],
    under: Under<S>,
}

/// The ground under the body, less the mean of that under the wheels, and that mean [m].
#[derive(Clone, Copy)]
pub(super) struct Under<S: Simd> {
    pub mean: Lanes<S>,
    /// Highest under the belly, lowest under its middle.
    pub summit: Lanes<S>,
    pub floor: Lanes<S>,
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
        let mut wheels = [[[all(simd, 0.0); 2]; 3]; 2];
        let mut sum = all(simd, 0.0);
        for (side, patches) in wheels.iter_mut().zip(&plan.wheels) {
            for (wheel, patches) in side.iter_mut().zip(patches) {
                *wheel = place.extremes(ground, patches, worth);
                sum = sum + wheel[0] + wheel[1];
            }
        }
        let [_, summit] = place.extremes(ground, &plan.belly, worth);
        let [floor, _] = place.extremes(ground, std::slice::from_ref(&plan.middle), worth);
        let mean = sum * all(simd, 1.0 / 12.0);
        for side in &mut wheels {
            for span in side {
                *span = [span[0] - mean, span[1] - mean];
            }
        }
        let under = Under {
            mean,
            summit: summit - mean,
            floor: floor - mean,
        };
        Self { wheels, under }
    }
}
