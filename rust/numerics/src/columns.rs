//! Transposition between rows of the caller's arrays and the columns that the kernels take, one block at a time.

use pulp::Simd;

use crate::simd::lanes::Lanes;
use crate::simd::vector::Vector;

/// Rows of a block. Its columns fit into the first-level cache for rovers of up to about ten wheels.
pub const BLOCK: usize = 64;

/// Columns of the largest rover: steering angles and speeds of 64 wheels, and three further numbers of each.
const MAX_COLUMNS: usize = 5 * 64;

/// Columns of a square of registers.
const TILE: usize = 8;

/// One number per row of a block.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub struct Column(pub [f64; BLOCK]);

impl Default for Column {
    fn default() -> Self {
        Self::ZERO
    }
}

#[inline_always]
impl Column {
    /// All zero.
    pub const ZERO: Self = Self([0.0; BLOCK]);

    /// Register `k` of it.
    pub fn load<S: Simd>(&self, simd: S, k: usize) -> Lanes<S> {
        Lanes::load(simd, S::as_simd_f64s(&self.0).0, k)
    }

    /// Writes register `k` of it.
    pub fn store<S: Simd>(&mut self, k: usize, lanes: Lanes<S>) {
        lanes.store(S::as_mut_simd_f64s(&mut self.0).0, k);
    }
}

/// Register `k` of each of these columns.
#[inline(always)]
pub fn load<S: Simd, const N: usize>(simd: S, columns: &[Column; N], k: usize) -> [Lanes<S>; N] {
    let mut lanes = [Lanes::splat(simd, 0.0); N];
    for (lanes, column) in lanes.iter_mut().zip(columns) {
        *lanes = column.load(simd, k);
    }
    lanes
}

/// Writes register `k` of each of these columns.
#[inline(always)]
pub fn store<S: Simd, const N: usize>(lanes: [Lanes<S>; N], columns: &mut [Column; N], k: usize) {
    for (lanes, column) in lanes.into_iter().zip(columns) {
        column.store(k, lanes);
    }
}

/// Columns of a rover of up to eight wheels: steering angles and speeds; the same with optional inputs.
const FEW: usize = 16;
const SOME: usize = 32;

/// Calls `work` with `count` columns of zeros on the stack. Most rovers need few, and zeroing those of the largest
/// takes as long as some hundred rows.
pub fn with_columns<T>(count: usize, work: impl FnOnce(&mut [Column]) -> T) -> T {
    if count == 0 {
        work(&mut [])
    } else if count <= FEW {
        work(&mut [Column::ZERO; FEW][..count])
    } else if count <= SOME {
        with_stack::<T, SOME>(count, work)
    } else {
        with_stack::<T, { MAX_COLUMNS }>(count, work)
    }
}

#[inline(never)] // for its large frame
fn with_stack<T, const N: usize>(count: usize, work: impl FnOnce(&mut [Column]) -> T) -> T {
    work(&mut [Column::ZERO; N][..count])
}

/// Registers of rows into one register per column, group by group. A macro, because a closure might not be inlined.
macro_rules! to_columns_groups {
    ($S: ident, $rows: ident, $columns: ident, $width: literal, |$group: ident| $deinterleaved: expr) => {{
        let groups = $S::as_simd_f64s($rows).0.as_chunks::<$width>().0;
        for (k, $group) in groups.iter().enumerate() {
            let $group = *$group;
            let registers = $deinterleaved;
            for j in 0..$width {
                $S::as_mut_simd_f64s(&mut $columns[j].0).0[k] = registers[j];
            }
        }
    }};
}

/// One register per column into registers of rows, group by group.
macro_rules! to_rows_groups {
    ($S: ident, $columns: ident, $rows: ident, $width: literal, |$group: ident| $interleaved: expr) => {{
        let groups = $S::as_mut_simd_f64s($rows).0.as_chunks_mut::<$width>().0;
        for (k, rows) in groups.iter_mut().enumerate() {
            let mut $group = [$S::as_simd_f64s(&$columns[0].0).0[k]; $width];
            for j in 1..$width {
                $group[j] = $S::as_simd_f64s(&$columns[j].0).0[k];
            }
            *rows = $interleaved;
        }
    }};
}

/// Splits rows into columns. Rows that are missing become zero.
#[inline(always)]
pub fn transpose_to_columns<S: Vector>(simd: S, rows: &[f64], columns: &mut [Column]) {
    let width = columns.len();
    let whole = rows.len() == width * BLOCK;
    match width {
        3 if whole => to_columns_groups!(S, rows, columns, 3, |group| simd.deinterleave3(group)),
        4 if whole => to_columns_groups!(S, rows, columns, 4, |group| deinterleave4(simd, group)),
        6 if whole => to_columns_groups!(S, rows, columns, 6, |group| deinterleave6(simd, group)),
        8 if whole => to_columns_groups!(S, rows, columns, 8, |group| deinterleave8(simd, group)),
        _ => to_columns_singly(rows, columns),
    }
}

/// Writes columns as rows, as many as `rows` holds.
#[inline(always)]
pub fn transpose_to_rows<S: Vector>(simd: S, columns: &[Column], rows: &mut [f64]) {
    let width = columns.len();
    let whole = rows.len() == width * BLOCK;
    match width {
        3 if whole => to_rows_groups!(S, columns, rows, 3, |group| simd.interleave3(group)),
        4 if whole => to_rows_groups!(S, columns, rows, 4, |group| interleave4(simd, group)),
        6 if whole => to_rows_groups!(S, columns, rows, 6, |group| interleave6(simd, group)),
        _ => transpose_tiles_to_rows(simd, columns, rows),
    }
}

/// [`transpose_to_rows`] for any width, by squares of eight columns.
#[inline(always)]
pub fn transpose_tiles_to_rows<S: Vector>(simd: S, columns: &[Column], rows: &mut [f64]) {
    let (width, lanes) = (columns.len(), S::F64_LANES);
    for (k, rows) in rows.chunks_mut((width * lanes).max(1)).enumerate() {
        if width < TILE || rows.len() < width * lanes {
            for (row, values) in rows.chunks_exact_mut(width).enumerate() {
                for (value, column) in values.iter_mut().zip(columns) {
                    *value = column.0[k * lanes + row];
                }
            }
            continue;
        }
        // The last one overlaps the one before, and writes the same once more.
        for first in (0..width).step_by(TILE).map(|at| at.min(width - TILE)) {
            let mut tile = [S::as_simd_f64s(&columns[first].0).0[k]; TILE];
            for (register, column) in tile.iter_mut().zip(&columns[first..]) {
                *register = S::as_simd_f64s(&column.0).0[k];
            }
            for (j, register) in simd.transpose(tile).into_iter().enumerate() {
                let at = j % lanes * width + first + j / lanes * lanes;
                S::as_mut_simd_f64s(&mut rows[at..at + lanes]).0[0] = register;
            }
        }
    }
}

// Interleaving 2 m columns is zipping column j with column j + m, and then interleaving m pairs.

#[inline(always)]
fn interleave4<S: Vector>(simd: S, [a, b, c, d]: [S::f64s; 4]) -> [S::f64s; 4] {
    let ([a, c], [b, d]) = (simd.zip([a, c]), simd.zip([b, d]));
    let ([first, second], [third, fourth]) = (simd.zip([a, b]), simd.zip([c, d]));
    [first, second, third, fourth]
}

#[inline(always)]
fn deinterleave4<S: Vector>(simd: S, [first, second, third, fourth]: [S::f64s; 4]) -> [S::f64s; 4] {
    let ([a, b], [c, d]) = (simd.unzip([first, second]), simd.unzip([third, fourth]));
    let ([a, c], [b, d]) = (simd.unzip([a, c]), simd.unzip([b, d]));
    [a, b, c, d]
}

#[inline(always)]
fn interleave6<S: Vector>(simd: S, [a, b, c, d, e, f]: [S::f64s; 6]) -> [S::f64s; 6] {
    let ([a, d], [b, e], [c, f]) = (simd.zip([a, d]), simd.zip([b, e]), simd.zip([c, f]));
    let ([a, b, c], [d, e, f]) = (simd.interleave3([a, b, c]), simd.interleave3([d, e, f]));
    [a, b, c, d, e, f]
}

#[inline(always)]
fn deinterleave6<S: Vector>(simd: S, [a, b, c, d, e, f]: [S::f64s; 6]) -> [S::f64s; 6] {
    let ([a, b, c], [d, e, f]) = (simd.deinterleave3([a, b, c]), simd.deinterleave3([d, e, f]));
    let ([a, d], [b, e], [c, f]) = (simd.unzip([a, d]), simd.unzip([b, e]), simd.unzip([c, f]));
    [a, b, c, d, e, f]
}

#[inline(always)]
fn deinterleave8<S: Vector>(simd: S, [a, b, c, d, e, f, g, h]: [S::f64s; 8]) -> [S::f64s; 8] {
    let ([a, b, c, d], [e, f, g, h]) = (deinterleave4(simd, [a, b, c, d]), deinterleave4(simd, [e, f, g, h]));
    let ([a, e], [b, f]) = (simd.unzip([a, e]), simd.unzip([b, f]));
    let ([c, g], [d, h]) = (simd.unzip([c, g]), simd.unzip([d, h]));
    [a, b, c, d, e, f, g, h]
}

/// Number by number: widths without shuffles, and the last rows.
#[inline(always)]
fn to_columns_singly(rows: &[f64], columns: &mut [Column]) {
    let width = columns.len();
    for (j, column) in columns.iter_mut().enumerate() {
        *column = Column::ZERO;
        for (value, row) in column.0.iter_mut().zip(rows.chunks_exact(width)) {
            *value = row[j];
        }
    }
}
