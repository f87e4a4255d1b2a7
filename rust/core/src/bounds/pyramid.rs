//! Lowest and highest ground over boxes of cells, from windows that are known beforehand.
//!
//! Level `k` holds, for every cell, the extremes over the square window of `2^k` cells that begins there. Between
//! its nodes a bilinear surface stays between them, so a window's extremes are those of its nodes; single
//! precision, rounded outwards, halves the memory. Any box is covered by four windows of its own size, or by some
//! more where it is long.

use super::stand::all;
use crate::batch::machine::lanes::Lanes;
use crate::batch::machine::vector::Vector;
use crate::error::{Error, ErrorKind};
use crate::terrain::Terrain;
use crate::wheels::Direction;

/// Windows up to 32 cells wide.
const LEVELS: u32 = 6;

/// Lowest height and minus the highest one: both grow outwards by the same operation.
type Extremes = [f32; 2];

/// Where a height in the window is not known.
const UNKNOWN: Extremes = [f32::NEG_INFINITY; 2];

/// Extremes of the ground in windows of a map.
#[derive(Clone, Debug)]
pub struct Pyramid {
    /// Cells along x and along y.
    cells: [usize; 2],
    spacing: [f64; 2],
    origin: [f64; 2],
    turn: Direction,
    /// Level after level the cells, row after row.
    windows: Box<[Extremes]>,
}

/// Boxes of cells, both ends included, a box in every lane.
#[derive(Clone, Copy)]
pub(super) struct Boxes<S: Vector> {
    pub first: [Lanes<S>; 2],
    pub last: [Lanes<S>; 2],
}

impl Pyramid {
    /// Takes memory for `8 LEVELS` bytes per cell, which may not be there, and a few milliseconds per 10^5 cells.
    pub fn new(ground: &Terrain) -> Result<Self, Error> {
        let [rows, columns] = ground.shape();
        let cells = [columns - 1, rows - 1];
        let heights = ground.heights();
        let corners = |k: usize| {
            let (row, column) = (k / cells[0], k % cells[0]);
            let k = row * columns + column;
            let nodes = [k, k + 1, k + columns, k + columns + 1].map(|k| heights.at(k));
            if nodes.iter().any(|height| height.is_nan()) {
                return UNKNOWN;
            }
            let [low, minus_high] = nodes
                .iter()
                .fold([f64::INFINITY; 2], |[low, minus_high], h| {
                    [low.min(*h), minus_high.min(-*h)]
                });
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
        windows.extend((0..count).map(corners));
        for level in 1..LEVELS {
            let step = 1 << (level - 1);
            let below = windows.len() - count;
            // Beside the last rows and columns a window holds what there is.
            for row in 0..cells[1] {
                let next = (row + step).min(cells[1] - 1);
                let [row, next] = [row, next].map(|row| below + row * cells[0]);
                for column in 0..cells[0] {
                    let across = (column + step).min(cells[0] - 1);
                    let [a, b, c, d] = [row + column, row + across, next + column, next + across]
                        .map(|k| windows[k]);
                    windows.push(least(least(a, b), least(c, d)));
                }
            }
        }
        Ok(Self {
            cells,
            spacing: ground.spacing(),
            origin: ground.origin(),
            turn: ground.turn(),
            windows: windows.into(),
        })
    }

    /// Number of cells along x and along y.
    pub(super) fn cells(&self) -> [usize; 2] {
        self.cells
    }

    pub(super) fn spacing(&self) -> [f64; 2] {
        self.spacing
    }

    pub(super) fn origin(&self) -> [f64; 2] {
        self.origin
    }

    pub(super) fn turn(&self) -> Direction {
        self.turn
    }

    /// Extremes over boxes of cells on the map, whole numbers with their ends in order, and of what is in `span`: as
    /// [`Vector::gather_pairs`] has them.
    ///
    /// Whichever windows cover a box and nothing else, its extremes are the same to the bit.
    #[inline(always)]
    pub(super) fn spans<S: Vector>(&self, boxes: Boxes<S>, span: Lanes<S>) -> Lanes<S> {
        let simd = span.simd();
        let one = all(simd, 1.0);
        let ([x, y], [x_last, y_last]) = (boxes.first, boxes.last);
        let (width, height) = ((x_last - x) + one, (y_last - y) + one);
        let (short, long) = (width.min(height), width.max(height));
        // The largest windows that are in the box, and where their level begins.
        let (mut size, mut level) = (one, all(simd, 0.0));
        let count = all(simd, (self.cells[0] * self.cells[1]) as f64);
        for k in 1..LEVELS {
            let larger = all(simd, f64::from(1 << k));
            let fits = larger.at_most(short);
            size = fits.select(larger, size);
            level = fits.select(level + count, level);
        }
        let columns = all(simd, self.cells[0] as f64);
        let end = [(x_last + one) - size, (y_last + one) - size];
        let [first, last] = [y.mul_add(columns, level), end[1].mul_add(columns, level)];
        let (a, b) = (self.at(first + x), self.at(first + end[0]));
        let (c, d) = (self.at(last + x), self.at(last + end[0]));
        let mut span = span
            .least_pairs(a.least_pairs(b))
            .least_pairs(c.least_pairs(d));
        if !(size + size).below(long).any() {
            return span;
        }
        let mut row = y;
        loop {
            let mut column = x;
            let first = row.mul_add(columns, level);
            loop {
                span = span.least_pairs(self.at(first + column));
                if !column.below(end[0]).any() {
                    break;
                }
                column = (column + size).min(end[0]);
            }
            if !row.below(end[1]).any() {
                return span;
            }
            row = (row + size).min(end[1]);
        }
    }

    #[inline(always)]
    fn at<S: Vector>(&self, place: Lanes<S>) -> Lanes<S> {
        place.gather_pairs(&self.windows)
    }
}

impl Pyramid {
    /// Highest height over a box of cells on the map, both ends included [m]; infinity where one is not known.
    #[inline(always)]
    pub(crate) fn highest(&self, first: [usize; 2], last: [usize; 2]) -> f64 {
        let (width, height) = (last[0] - first[0] + 1, last[1] - first[1] + 1);
        let level = width.min(height).ilog2().min(LEVELS - 1);
        let size = 1_usize << level;
        let table = &self.windows[level as usize * self.cells[0] * self.cells[1]..];
        let end = [last[0] + 1 - size, last[1] + 1 - size];
        let mut span = NOTHING;
        let mut row = first[1];
        loop {
            let mut column = first[0];
            loop {
                let window = table.get(row * self.cells[0] + column);
                span = least(span, window.copied().unwrap_or(UNKNOWN));
                if column == end[0] {
                    break;
                }
                column = (column + size).min(end[0]);
            }
            if row == end[1] {
                return -f64::from(span[1]);
            }
            row = (row + size).min(end[1]);
        }
    }
}

/// Nothing yet.
const NOTHING: Extremes = [f32::INFINITY; 2];

/// What [`Pyramid::spans`] starts with: nothing yet.
#[inline(always)]
pub(super) fn nothing<S: Vector>(simd: S) -> Lanes<S> {
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
    if f64::from(near) > height {
        near.next_down()
    } else {
        near
    }
}
