//! Lowest and highest ground over boxes of cells, from windows that are known beforehand.
//!
//! Level `k` holds, for every cell, the extremes over the square window of `2^k` cells that begins there. Between
//! its nodes a bilinear surface stays between them, so a window's extremes are those of its nodes; single
//! precision, rounded outwards, halves the memory. Any box is covered by four windows of its own size, or by some
//! more where it is long.

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
    /// Per level the cells, row after row.
    levels: Vec<Box<[Extremes]>>,
}

/// What a box of cells holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    /// Lowest height [m]; minus infinity where one is not known.
    pub lowest: f64,
    /// Highest height [m]; infinity where one is not known.
    pub highest: f64,
}

/// A box of cells, both ends included.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cells {
    pub first: [usize; 2],
    pub last: [usize; 2],
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
        let room = || {
            let mut windows = Vec::new();
            windows.try_reserve_exact(count).map_err(|_| {
                let heights = format!("{rows} x {columns} heights");
                let rule = "leave memory for the extremes of its windows";
                Error::value("ground", rule, heights).of_kind(ErrorKind::Memory)
            })?;
            Ok(windows)
        };
        let mut lowest = room()?;
        lowest.extend((0..count).map(corners));
        let mut levels: Vec<Box<[Extremes]>> = vec![lowest.into()];
        for level in 1..LEVELS {
            let step = 1 << (level - 1);
            let below = &levels[level as usize - 1];
            // Beside the last rows and columns a window holds what there is.
            let mut windows = room()?;
            for row in 0..cells[1] {
                let next = (row + step).min(cells[1] - 1);
                let [row, next] = [row, next].map(|row| &below[row * cells[0]..][..cells[0]]);
                for column in 0..cells[0] {
                    let across = (column + step).min(cells[0] - 1);
                    let lower = least(row[column], row[across]);
                    windows.push(least(lower, least(next[column], next[across])));
                }
            }
            levels.push(windows.into());
        }
        Ok(Self {
            cells,
            spacing: ground.spacing(),
            origin: ground.origin(),
            turn: ground.turn(),
            levels,
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

    /// Extremes over a box of cells on the map, its ends in order.
    #[inline(always)]
    pub(super) fn span(&self, Cells { first, last }: Cells, span: &mut Extremes) {
        let (width, height) = (last[0] - first[0] + 1, last[1] - first[1] + 1);
        let level = width.min(height).ilog2().min(LEVELS - 1);
        let size = 1_usize << level;
        let table = &self.levels[level as usize];
        let end = [last[0] + 1 - size, last[1] + 1 - size];
        let mut row = first[1];
        loop {
            let mut column = first[0];
            loop {
                let window = table.get(row * self.cells[0] + column);
                *span = least(*span, window.copied().unwrap_or(UNKNOWN));
                if column == end[0] {
                    break;
                }
                column = (column + size).min(end[0]);
            }
            if row == end[1] {
                break;
            }
            row = (row + size).min(end[1]);
        }
    }
}

impl From<Extremes> for Span {
    fn from([lowest, minus_highest]: Extremes) -> Self {
        Self {
            lowest: f64::from(lowest),
            highest: -f64::from(minus_highest),
        }
    }
}

/// What [`Pyramid::span`] starts with: nothing yet.
pub(super) const NOTHING: Extremes = [f32::INFINITY; 2];

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
