//! The bounds of many poses, as many at a time as a register holds; the same to the bit at every level.

use pulp::Simd;

use super::boxes::Patch;
use super::plan::{BoundStatus, BoundsConstants, COUNT, TILT};
use super::stand::Under;
use crate::interval::Interval;
use crate::pyramid::{Boxes, Pyramid, nothing};
use crate::suspension::lanes::{MOST, all, columns};
use six_wheel_kinematics::se2::angles::sin_cos_any;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::level::Kernel;
use six_wheel_numerics::simd::polynomials::ROUND;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::threads::workers::Workers;

/// Widening of the intervals [m, rad]: more than the rounding errors of the kernel and of a settled pose.
const ROUNDING: f64 = 1e-9;

/// Poses that are bounded with one set of constants before the next: their numbers stay in the first-level cache.
const BLOCK: usize = 256;

/// Positions from which on neighbouring doubles are further apart than the size of a wheel [m].
const FAR: f64 = 1e15;

/// The ground, with the error of its heights.
#[derive(Clone, Copy, Debug)]
pub struct Ground<'a> {
    /// Extremes of its heights.
    pub pyramid: &'a Pyramid,
    /// Largest difference between the true heights and those of the map [m].
    pub error: f64,
}

/// Ranges of yaw and position about every pose.
#[derive(Clone, Copy, Debug)]
pub struct Margins<'a> {
    /// Range of yaw to either side, per row or once [rad].
    pub yaw: &'a [f64],
    /// Largest distance of the position, per row or once [m].
    pub position: &'a [f64],
}

impl Margins<'_> {
    fn at(self, k: usize) -> [f64; 2] {
        [self.yaw, self.position].map(|values| if values.len() == 1 { values[0] } else { values[k] })
    }
}

/// The bounds of every pose `[x, y, yaw]` of finite numbers. Writes for each of the quantities a block of intervals, a
/// row per pose, and a status for every row; intervals of other statuses than bounded are NaN. Poses whose wheels may
/// leave the boxes of one set of constants are bounded with the next. Fails only if it is interrupted.
pub fn bounds(
    plans: &[BoundsConstants],
    ground: Ground<'_>,
    poses: &[[f64; 3]],
    margins: Margins<'_>,
    blocks: [&mut [[f64; 2]]; COUNT],
    statuses: &mut [BoundStatus],
    workers: Workers,
) -> Result<(), Error> {
    let workers = workers.here();
    let share = workers.share(poses.len());
    let mut blocks = blocks.map(|block| block.chunks_mut(share));
    let jobs = statuses.chunks_mut(share).enumerate().map(|(k, statuses)| BoundsRange {
        plans,
        ground,
        poses: &poses[k * share..][..statuses.len()],
        margins,
        first: k * share,
        blocks: blocks.each_mut().map(|block| block.next().unwrap_or_default()),
        statuses,
    });
    workers.for_each(jobs, |job| {
        workers.level.run_any(job);
        Ok(())
    })
}

/// Poses of one thread.
struct BoundsRange<'a> {
    plans: &'a [BoundsConstants],
    ground: Ground<'a>,
    poses: &'a [[f64; 3]],
    margins: Margins<'a>,
    /// Row of the first one among all.
    first: usize,
    blocks: [&'a mut [[f64; 2]]; COUNT],
    statuses: &'a mut [BoundStatus],
}

impl Kernel for BoundsRange<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(mut self, simd: S) {
        for first in (0..self.poses.len()).step_by(BLOCK) {
            let mut rows: [usize; BLOCK] = std::array::from_fn(|k| first + k);
            let mut count = BLOCK.min(self.poses.len() - first);
            for plan in self.plans {
                for some in rows[..count].chunks(S::F64_LANES) {
                    self.bound_rows(simd, plan, some);
                }
                let mut left = 0;
                for k in 0..count {
                    if self.statuses[rows[k]] == BoundStatus::Beyond {
                        rows[left] = rows[k];
                        left += 1;
                    }
                }
                count = left;
            }
        }
    }
}

/// Largest distance that a point one metre from the origin moves over an interval of yaw [m].
fn chord(margin: f64) -> f64 {
    if margin == 0.0 { 0.0 } else { 2.0 * (0.5 * margin.min(std::f64::consts::PI)).sin() }
}

impl BoundsRange<'_> {
    /// Bounds of the poses of these rows, one in every lane; there may be fewer rows than lanes.
    #[inline(always)]
    fn bound_rows<S: Vector>(&mut self, simd: S, plan: &BoundsConstants, rows: &[usize]) {
        let apart = rows.len() < S::F64_LANES || rows[rows.len() - 1] - rows[0] >= S::F64_LANES;
        let pose = if apart {
            columns(simd, |lane| self.poses[rows[lane.min(rows.len() - 1)]])
        } else {
            let poses = &self.poses[rows[0]..][..S::F64_LANES];
            Lanes::deinterleave3(simd, poses.as_flattened())
        };
        let (zero, far) = (all(simd, 0.0), all(simd, FAR));
        let near = pose[0].abs().lt(far) & pose[1].abs().lt(far);
        let [chord, margin] = self.displacements(simd, rows);
        let pose = [near.select(pose[0], zero), near.select(pose[1], zero), pose[2]];
        let place = GridPoses::new(simd, self.ground.pyramid, pose, [chord, margin]);
        let seen = Seen::new(simd, plan, self.ground, &place);
        let (intervals, checks) = plan.stand(simd, &seen.wheels, seen.under);
        // The first condition that does not hold gives the status: it is selected last.
        let mut status = code(simd, BoundStatus::Bounded);
        for (holds, violated) in checks.into_iter().rev() {
            status = holds.select(status, code(simd, violated));
        }
        status = seen.known.select(status, code(simd, BoundStatus::UnknownCells));
        status = (seen.on_map & near).select(status, code(simd, BoundStatus::OffMap));
        let bounded = status.lt(all(simd, 0.5));
        let (unknown, more) = (all(simd, f64::NAN), all(simd, ROUNDING));
        let mut codes = [0.0; MOST];
        status.copy_to_slice(&mut codes);
        let statuses = codes.map(|code| STATUSES[code as usize % STATUSES.len()]);
        for (row, status) in rows.iter().zip(statuses) {
            self.statuses[*row] = status;
        }
        let quantities = self.blocks.iter_mut().zip(intervals).enumerate();
        for (k, (block, [low, high])) in quantities {
            // The tilt is not negative.
            let least = if k == TILT { more } else { low };
            let interval = [bounded.select(low.max(least) - more, unknown), bounded.select(high + more, unknown)];
            if apart {
                let mut ends = [[0.0; 2]; MOST];
                Lanes::zip(interval, ends.as_flattened_mut());
                for (row, ends) in rows.iter().zip(ends) {
                    block[*row] = ends;
                }
            } else {
                let block = &mut block[rows[0]..][..S::F64_LANES];
                Lanes::zip(interval, block.as_flattened_mut());
            }
        }
    }

    /// Largest displacement of a point one metre from the origin over the interval of yaw, and that of all points over
    /// the range of positions [m].
    #[inline(always)]
    fn displacements<S: Vector>(&self, simd: S, rows: &[usize]) -> [Lanes<S>; 2] {
        let Margins { yaw, position } = self.margins;
        if let ([yaw], [position]) = (yaw, position) {
            return [all(simd, chord(*yaw)), all(simd, *position)];
        }
        columns(simd, |lane| {
            let [yaw, position] = self.margins.at(self.first + rows[lane.min(rows.len() - 1)]);
            [chord(yaw), position]
        })
    }
}

/// Statuses in the order of their numbers.
const STATUSES: [BoundStatus; 6] = [
    BoundStatus::Bounded,
    BoundStatus::OffMap,
    BoundStatus::UnknownCells,
    BoundStatus::Unsolved,
    BoundStatus::Beyond,
    BoundStatus::AtStop,
];

#[inline(always)]
fn code<S: Simd>(simd: S, status: BoundStatus) -> Lanes<S> {
    all(simd, f64::from(status as u8))
}

/// Poses in the axes of the map, in cells.
struct GridPoses<S: Vector> {
    origin: [Lanes<S>; 2],
    /// Cells along the map's rows and columns per metre forward, and per metre to the left.
    ahead: [Lanes<S>; 2],
    left: [Lanes<S>; 2],
    /// Largest distance that a point one metre from the origin moves over the interval of yaw, and that of all points,
    /// in cells.
    chord: [Lanes<S>; 2],
    margin: [Lanes<S>; 2],
    /// Number of cells.
    cells: [f64; 2],
    simd: S,
}

#[inline_always]
impl<S: Vector> GridPoses<S> {
    fn new(simd: S, pyramid: &Pyramid, [x, y, yaw]: [Lanes<S>; 3], [chord, margin]: [Lanes<S>; 2]) -> Self {
        let turn = pyramid.placement().turn();
        let (turned_cos, turned_sin) = (all(simd, turn.cos), all(simd, turn.sin));
        let (sin, cos) = sin_cos_any(simd, yaw);
        let (cos, sin) = (turned_cos * cos + turned_sin * sin, turned_cos * sin - turned_sin * cos);
        let [x0, y0] = pyramid.placement().origin();
        let (x, y) = (x - all(simd, x0), y - all(simd, y0));
        let [dx, dy] = pyramid.placement().spacing();
        let [across, along] = [all(simd, 1.0 / dx), all(simd, 1.0 / dy)];
        let [columns, rows] = pyramid.cells();
        Self {
            origin: [(turned_cos * x + turned_sin * y) * across, (turned_cos * y - turned_sin * x) * along],
            ahead: [cos * across, sin * along],
            left: [-sin * across, cos * along],
            chord: [chord * across, chord * along],
            margin: [margin * across, margin * along],
            cells: [columns as f64, rows as f64],
            simd,
        }
    }

    /// Extremes of the ground in a patch and of those in `span`, and the lanes whose patch is on the map.
    fn patch_extremes(&self, pyramid: &Pyramid, patch: &Patch, span: Lanes<S>) -> (Lanes<S>, Mask<S>) {
        let simd = self.simd;
        let (cx, cy) = (all(simd, patch.centre[0]), all(simd, patch.centre[1]));
        let (hx, hy) = (all(simd, patch.half[0]), all(simd, patch.half[1]));
        let reach = all(simd, patch.reach);
        let (zero, less, round) = (all(simd, 0.0), all(simd, 0.5), all(simd, ROUND));
        let mut on_map = Mask::splat(simd, true);
        let [mut first, mut last] = [self.origin; 2];
        for axis in 0..2 {
            let (ahead, left) = (self.ahead[axis], self.left[axis]);
            let middle = ahead.mul_add(cx, left.mul_add(cy, self.origin[axis]));
            let margin = self.chord[axis].mul_add(reach, self.margin[axis]);
            let half = ahead.abs().mul_add(hx, left.abs().mul_add(hy, margin));
            let (low, high) = (middle - half, middle + half);
            on_map = on_map & zero.le(low) & high.le(all(simd, self.cells[axis]));
            // Rounded to the nearest whole number; a point on a line of the grid is in either cell.
            let end = all(simd, self.cells[axis] - 1.0);
            first[axis] = ((low - less).max(zero).min(end) + round) - round;
            last[axis] = ((high - less).max(zero).min(end) + round) - round;
        }
        let boxes = Boxes { first, last, on_map };
        // SAFETY: both ends, the second not below the first, are between 0 and the last cell.
        (unsafe { pyramid.spans(&boxes, span) }, on_map)
    }

    /// Lowest and highest ground in patches; clears the lanes of patches off the map or with unknown heights.
    fn extremes(&self, ground: Ground<'_>, patches: &[Patch], [on_map, known]: [&mut Mask<S>; 2]) -> Interval<S> {
        let simd = self.simd;
        let mut span = nothing(simd);
        for patch in patches {
            let (more, here) = self.patch_extremes(ground.pyramid, patch, span);
            span = more;
            *on_map = *on_map & here;
        }
        let [lowest, minus_highest] = span.deinterleave2();
        let (zero, error) = (all(simd, 0.0), all(simd, ground.error));
        let here = all(simd, f64::NEG_INFINITY).lt(lowest);
        *known = *known & here;
        [here.select(lowest, zero) - error, here.select(-minus_highest, zero) + error]
    }
}

/// The ground under the rover.
struct Seen<S: Vector> {
    /// Lowest and highest under each wheel, left and right, front to rear, less the mean of all [m].
    wheels: [[Interval<S>; 3]; 2],
    under: Under<S>,
    /// True if all of it is on the map, and if all its heights are known.
    on_map: Mask<S>,
    known: Mask<S>,
}

impl<S: Vector> Seen<S> {
    #[inline(always)]
    fn new(simd: S, plan: &BoundsConstants, ground: Ground<'_>, place: &GridPoses<S>) -> Self {
        let [mut on_map, mut known] = [Mask::splat(simd, true); 2];
        let mut wheels = [[[all(simd, 0.0); 2]; 3]; 2];
        let mut sum = all(simd, 0.0);
        for (side, patches) in wheels.iter_mut().zip(&plan.wheels) {
            for (wheel, patches) in side.iter_mut().zip(patches) {
                *wheel = place.extremes(ground, patches, [&mut on_map, &mut known]);
                sum = sum + wheel[0] + wheel[1];
            }
        }
        let [_, summit] = place.extremes(ground, &plan.belly, [&mut on_map, &mut known]);
        let middle = std::slice::from_ref(&plan.middle);
        let [floor, _] = place.extremes(ground, middle, [&mut on_map, &mut known]);
        let mean = sum * all(simd, 1.0 / 12.0);
        for end in wheels.as_flattened_mut().as_flattened_mut() {
            *end = *end - mean;
        }
        let under = Under { mean, summit: summit - mean, floor: floor - mean };
        Self { wheels, under, on_map, known }
    }
}
