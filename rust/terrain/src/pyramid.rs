//! Lowest and highest ground over boxes of cells, from the extremes of windows.
//!
//! Level `k` holds, for every cell, the extremes over the square window of `2^k` cells that begins there. A bilinear
//! surface is between the heights of its nodes, so that a window's extremes are those of its nodes; single precision,
//! rounded outwards, halves the memory. Any box is covered by four windows, or by some more if it is long.

use crate::heights::Heights;
use crate::suspension::lanes::all;
use six_wheel_kinematics::geometry::GridPlacement;
use six_wheel_numerics::error::{Error, ErrorKind};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::{Vector, ZEROTH};
use six_wheel_numerics::threads::workers::IsInterrupted;

/// Windows up to 32 cells wide.
const LEVELS: u32 = 6;

/// Lowest height and minus the highest one [m], so that both are minima.
type Extremes = [f32; 2];

/// Extremes of a window with an unknown height.
const UNKNOWN: Extremes = [f32::NEG_INFINITY; 2];

/// Extremes of the ground in windows of a map.
#[derive(Clone, Debug)]
pub struct Pyramid {
    /// Cells along x and along y.
    cells: [usize; 2],
    placement: GridPlacement,
    /// Level after level the cells, row after row.
    windows: Box<[Extremes]>,
}

/// Boxes of cells, both ends included, a box in every lane.
pub struct Boxes<S: Vector> {
    /// Lowest column and row.
    pub first: [Lanes<S>; 2],
    /// Highest column and row.
    pub last: [Lanes<S>; 2],
    /// True in the lanes that count.
    pub on_map: Mask<S>,
}

impl Pyramid {
    /// The extremes of these heights, in `8 LEVELS` bytes per cell and a few milliseconds per 10^5 cells. Fails if
    /// there is not enough memory.
    #[inline]
    pub fn new(
        heights: &Heights,
        [rows, columns]: [usize; 2],
        placement: GridPlacement,
        is_interrupted: IsInterrupted,
    ) -> Result<Self, Error> {
        let cells = [columns - 1, rows - 1];
        let corners = |k: usize| {
            let (row, column) = (k / cells[0], k % cells[0]);
            let k = row * columns + column;
            let nodes = [k, k + 1, k + columns, k + columns + 1].map(|k| heights.at(k));
            if nodes.iter().any(|height| height.is_nan()) {
                return UNKNOWN;
            }
            let [low, minus_high] =
                nodes.iter().fold([f64::INFINITY; 2], |[low, minus_high], h| [low.min(*h), minus_high.min(-*h)]);
            [rounded_down(low), rounded_down(minus_high)]
        };
        let count = cells[0] * cells[1];
        let mut windows: Vec<Extremes> = Vec::new();
        let all = count.saturating_mul(LEVELS as usize);
        windows.try_reserve_exact(all).map_err(|_| {
            let heights = format!("{rows} x {columns} heights");
            let rule = "leave memory for the extremes of its windows";
            Error::value("ground", rule, heights).of_kind(ErrorKind::Memory)
        })?;
        for row in 0..cells[1] {
            if row > 0 && is_interrupted() {
                return Err(Error::interrupted());
            }
            windows.extend((row * cells[0]..(row + 1) * cells[0]).map(corners));
        }
        for level in 1..LEVELS {
            let step = 1 << (level - 1);
            let below = windows.len() - count;
            // At the last rows and columns windows are cut at the edge of the map.
            for row in 0..cells[1] {
                if is_interrupted() {
                    return Err(Error::interrupted());
                }
                let next = (row + step).min(cells[1] - 1);
                let [row, next] = [row, next].map(|row| below + row * cells[0]);
                for column in 0..cells[0] {
                    let across = (column + step).min(cells[0] - 1);
                    let [a, b, c, d] = [row + column, row + across, next + column, next + across].map(|k| windows[k]);
                    windows.push(least(least(a, b), least(c, d)));
                }
            }
        }
        Ok(Self { cells, placement, windows: windows.into() })
    }

    /// Number of cells along x and along y.
    pub(super) fn cells(&self) -> [usize; 2] {
        self.cells
    }

    pub(super) fn placement(&self) -> &GridPlacement {
        &self.placement
    }

    /// Extremes over boxes of cells by four windows, each at least half as long as the box; those of boxes that are
    /// longer than wide include some cells beside their long sides. False for boxes that are longer than two windows.
    ///
    /// # Safety
    ///
    /// Ends are whole numbers, in order, of cells of the map.
    #[inline(always)]
    pub(crate) unsafe fn around<S: Vector>(
        &self,
        [[x, y], [x_last, y_last]]: [[Lanes<S>; 2]; 2],
    ) -> (Lanes<S>, Mask<S>) {
        let simd = x.simd();
        let one = all(simd, 1.0);
        let long = (x_last - x).max(y_last - y);
        // The smallest power of two that is at least half the box.
        let most = all(simd, f64::from(1 << (LEVELS - 1)));
        let size = long.max(one).power().min(most);
        let fits = long.lt(size + size);
        let count = all(simd, (self.cells[0] * self.cells[1]) as f64);
        let level = size.exponent().mul_add(count, all(simd, ZEROTH));
        let columns = all(simd, self.cells[0] as f64);
        let end = [((x_last + one) - size).max(x), ((y_last + one) - size).max(y)];
        let (first, last) = (y.mul_add(columns, level), end[1].mul_add(columns, level));
        // SAFETY: the windows begin at cells between the ends of the box.
        (unsafe { self.corners([x, end[0]], [first, last]) }, fits)
    }

    /// Extremes over the four windows that begin in these columns and rows, the latter as places of their first cells.
    ///
    /// # Safety
    ///
    /// They begin at cells of the map.
    #[inline(always)]
    unsafe fn corners<S: Vector>(&self, [x, x_end]: [Lanes<S>; 2], [first, last]: [Lanes<S>; 2]) -> Lanes<S> {
        // SAFETY: as the caller promises.
        let (a, b, c, d) = unsafe {
            (
                (first + x).pairs(&self.windows),
                (first + x_end).pairs(&self.windows),
                (last + x).pairs(&self.windows),
                (last + x_end).pairs(&self.windows),
            )
        };
        a.least_pairs(b).least_pairs(c.least_pairs(d))
    }

    /// Highest height over a box of cells from the heights themselves [m], the same bits as [`Self::around`]; infinity
    /// where one is unknown, and for boxes that are longer than two windows.
    pub(crate) fn highest_around(
        heights: &Heights,
        [rows, columns]: [usize; 2],
        [first, last]: [[usize; 2]; 2],
    ) -> f64 {
        let long = (last[0] - first[0]).max(last[1] - first[1]).max(1);
        let size = (1_usize << long.ilog2()).min(1 << (LEVELS - 1));
        if long >= 2 * size {
            return f64::INFINITY;
        }
        // Windows as wide as they are high cover some cells beside a long box.
        let [end_x, end_y] =
            [(0, columns), (1, rows)].map(|(k, nodes)| last[k].max(first[k] + size - 1).min(nodes - 2));
        let mut top = f64::NEG_INFINITY;
        for row in first[1]..=end_y + 1 {
            for column in first[0]..=end_x + 1 {
                let height = heights.at(row * columns + column);
                if height.is_nan() {
                    return f64::INFINITY;
                }
                top = top.max(height);
            }
        }
        -f64::from(rounded_down(-top))
    }

    /// Extremes over boxes of cells and of those in `span`, in pairs as [`Vector::least_pairs`] has them.
    ///
    /// Any set of windows that covers exactly a box gives the same extremes, to the bit.
    ///
    /// # Safety
    ///
    /// Ends are whole numbers, in order, of cells of the map.
    #[inline(always)]
    pub unsafe fn spans<S: Vector>(&self, boxes: &Boxes<S>, span: Lanes<S>) -> Lanes<S> {
        let simd = span.simd();
        let one = all(simd, 1.0);
        let ([x, y], [x_last, y_last]) = (boxes.first, boxes.last);
        let (width, height) = ((x_last - x) + one, (y_last - y) + one);
        let (short, long) = (width.min(height), width.max(height));
        // The largest windows inside the box, and the index at which their level begins.
        let most = short.min(all(simd, f64::from(1 << (LEVELS - 1))));
        let size = most.power();
        let count = all(simd, (self.cells[0] * self.cells[1]) as f64);
        let level = most.exponent().mul_add(count, all(simd, ZEROTH));
        let columns = all(simd, self.cells[0] as f64);
        let end = [(x_last + one) - size, (y_last + one) - size];
        let (first, last) = (y.mul_add(columns, level), end[1].mul_add(columns, level));
        // SAFETY: the windows begin at cells between the ends of the box.
        let span = span.least_pairs(unsafe { self.corners([x, end[0]], [first, last]) });
        let longer = boxes.on_map & (size + size).lt(long);
        if !longer.any() {
            return span;
        }
        // One more in the middle of both long sides, unless more are needed.
        let wide = height.lt(width);
        let middle = [wide.select((x + size).min(end[0]), x), wide.select(y, (y + size).min(end[1]))];
        let other = [wide.select(middle[0], end[0]), wide.select(end[1], middle[1])];
        let [first, last] =
            [middle[1].mul_add(columns, level) + middle[0], other[1].mul_add(columns, level) + other[0]];
        // SAFETY: as above.
        let (a, b) = unsafe { (first.pairs(&self.windows), last.pairs(&self.windows)) };
        let span = span.least_pairs(a.least_pairs(b));
        let large = (size + size).lt(short) | ((size + size) + size).lt(long);
        if !(boxes.on_map & large).any() {
            return span;
        }
        let mut span = span;
        let mut row = y;
        loop {
            let mut column = x;
            let first = row.mul_add(columns, level);
            loop {
                // SAFETY: as above.
                span = span.least_pairs(unsafe { (first + column).pairs(&self.windows) });
                if !(boxes.on_map & column.lt(end[0])).any() {
                    break;
                }
                column = (column + size).min(end[0]);
            }
            if !(boxes.on_map & row.lt(end[1])).any() {
                return span;
            }
            row = (row + size).min(end[1]);
        }
    }
}

/// Initial value of [`Pyramid::spans`]: the extremes of no cell.
#[inline(always)]
pub fn nothing<S: Vector>(simd: S) -> Lanes<S> {
    let bits = u64::from(f32::INFINITY.to_bits());
    all(simd, f64::from_bits(bits | bits << 32))
}

#[inline(always)]
fn least(a: Extremes, b: Extremes) -> Extremes {
    // Compared, not `f32::min`: one instruction, and there is no NaN.
    let pick = |a: f32, b: f32| if a < b { a } else { b };
    [pick(a[0], b[0]), pick(a[1], b[1])]
}

/// The largest single that is not above a double.
fn rounded_down(height: f64) -> f32 {
    let near = height as f32;
    if f64::from(near) > height { near.next_down() } else { near }
}
