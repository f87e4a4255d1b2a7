//! Ground as a regular grid of heights: heights, gradients and normals, and unknown cells.
//!
//! Node `(row, column)` is at `origin + R(yaw) [column dx, row dy]`, so that x increases with columns and y with rows.
//! Between nodes heights are bilinear, the surface of all contacts; samples may be bicubic. NaN is an unknown height.
//! Unknown heights and points off the map are never estimated: both are values of [`Sample`].

mod cell;
mod spline;

pub use cell::Cell;

use std::sync::{Arc, OnceLock};

use nalgebra::Vector3;

use self::spline::{catmull_rom, four};
pub use crate::heights::Heights;
use crate::pyramid::Pyramid;
use six_wheel_kinematics::geometry::GridPlacement;
use six_wheel_numerics::error::{Error, number, numbers};
use six_wheel_numerics::threads::workers::IsInterrupted;

/// Spacings below this are not in metres: an arc second of a map in degrees is 2.8e-4 [m].
const SMALLEST_SPACING: f64 = 1e-3;

/// Heights from this on [m] are refused: neighbouring doubles are further apart than the size of a wheel.
const LARGEST_HEIGHT: f64 = 1e15;

/// Interpolation of heights between nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// From the four corners of the cell: continuous, with creases along the lines of the grid.
    Bilinear,
    /// From sixteen nodes (Catmull-Rom): with continuous slopes. Beyond its edge the grid is extrapolated linearly.
    Bicubic,
}

named_values! { Interpolation as "method": "bilinear" => Bilinear, "bicubic" => Bicubic }

/// Height and gradient of the ground at a point, if they are known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sample {
    /// Height [m] and its derivatives by x and y of the world [1].
    Known {
        /// Height [m].
        height: f64,
        /// Derivatives by x and y.
        gradient: [f64; 2],
    },
    /// A height that the interpolation needs is NaN.
    Unknown,
    /// Not on the map.
    Outside,
}

/// A regular grid of heights. Immutable; clones share the heights.
#[derive(Clone, Debug)]
pub struct Terrain {
    heights: Heights,
    rows: usize,
    columns: usize,
    placement: GridPlacement,
    /// Largest absolute height [m].
    largest: f64,
    /// Extremes of windows, made at the first call of [`Self::pyramid`].
    pyramid: OnceLock<Arc<Pyramid>>,
}

impl PartialEq for Terrain {
    /// Heights are compared bit by bit, so that unknown ones are equal too; zeros of either sign are equal.
    fn eq(&self, other: &Self) -> bool {
        let same = |k| {
            let (a, b) = (self.heights.at(k), other.heights.at(k));
            a == b || a.is_nan() && b.is_nan()
        };
        self.shape() == other.shape() && self.placement == other.placement && (0..self.heights.len()).all(same)
    }
}

impl Terrain {
    /// A grid of `columns` heights per row. Fails unless there are at least two rows and columns, every height is below
    /// 1e15 m or NaN, and the placement is valid.
    #[inline]
    pub fn new(heights: Heights, columns: usize, spacing: [f64; 2], origin: [f64; 2], yaw: f64) -> Result<Self, Error> {
        let rows = heights.len().checked_div(columns).unwrap_or(0);
        if rows < 2 || columns < 2 || rows * columns != heights.len() {
            let rule = "have at least two rows and two columns";
            let shape = format!("shape ({rows}, {columns})");
            return Err(Error::value("heights", rule, shape));
        }
        let largest = heights.largest();
        if let Some(k) =
            (0..heights.len()).find(|&k| largest >= LARGEST_HEIGHT && heights.at(k).abs() >= LARGEST_HEIGHT)
        {
            let place = format!("heights[{}, {}]", k / columns, k % columns);
            let rule = if heights.at(k).is_infinite() { "be finite" } else { "be below 1e15 m" };
            return Err(Error::value(place, format!("{rule}, or nan where unknown"), number(heights.at(k))));
        }
        let placement = GridPlacement::new(spacing, origin, yaw)?;
        if spacing.iter().any(|step| *step < SMALLEST_SPACING) {
            let rule = "be at least 0.001 m (a map in degrees has to be projected to metres first)";
            return Err(Error::value("spacing", rule, numbers(&spacing)));
        }
        let reach = spacing[0] * columns as f64 + spacing[1] * rows as f64;
        if reach + origin[0].abs() + origin[1].abs() >= 1e15 {
            // Neighbouring doubles would be further apart than the size of a wheel.
            return Err(Error::value("spacing", "make a map whose coordinates have digits", numbers(&spacing)));
        }
        Ok(Self { heights, rows, columns, placement, largest, pyramid: OnceLock::new() })
    }

    /// The heights, row after row.
    pub fn heights(&self) -> &Heights {
        &self.heights
    }

    /// Largest absolute value of a known height [m].
    pub fn largest_height(&self) -> f64 {
        self.largest
    }

    /// Lowest and highest heights in windows; made at the first call, from all heights. Fails if there is no memory
    /// for it, and where it is interrupted.
    pub fn pyramid(&self, is_interrupted: IsInterrupted) -> Result<&Pyramid, Error> {
        if let Some(made) = self.pyramid.get() {
            return Ok(made);
        }
        let made = Arc::new(Pyramid::new(&self.heights, self.shape(), self.placement, is_interrupted)?);
        Ok(self.pyramid.get_or_init(|| made))
    }

    /// The pyramid, if it has been made.
    #[inline(always)]
    pub(crate) fn known_pyramid(&self) -> Option<&Pyramid> {
        self.pyramid.get().map(|pyramid| &**pyramid)
    }

    /// Number of rows and of columns.
    pub fn shape(&self) -> [usize; 2] {
        [self.rows, self.columns]
    }

    /// Placement of the nodes in the world.
    #[inline]
    pub fn placement(&self) -> &GridPlacement {
        &self.placement
    }

    /// Heights of a cell's corners by its lowest column and row, which are at most the number of columns and rows
    /// less 2: there, a column on, a row on, both [m].
    #[inline]
    pub fn corners(&self, column: usize, row: usize) -> [f64; 4] {
        let k = row * self.columns + column;
        let places = [k, k + 1, k + self.columns, k + self.columns + 1];
        match &self.heights {
            Heights::Double(heights) => places.map(|k| heights[k]),
            Heights::Single(heights) => places.map(|k| f64::from(heights[k])),
        }
    }

    /// A cell by its lowest column and row, as for [`Self::corners`].
    #[inline]
    pub fn cell(&self, column: usize, row: usize) -> Cell {
        let [h00, h10, h01, h11] = self.corners(column, row);
        Cell { h00, along: h10 - h00, across: h01 - h00, twist: h11 - h10 - (h01 - h00) }
    }

    /// True if a point of the world is on the map, its edge included.
    #[inline]
    pub fn contains(&self, x: f64, y: f64) -> bool {
        self.placement.place_on_grid([x, y], [self.columns - 1, self.rows - 1]).is_some()
    }

    /// True if a point in columns and rows is on the map, its edge included. False for NaN.
    #[inline]
    pub fn on_grid(&self, u: f64, v: f64) -> bool {
        u >= 0.0 && v >= 0.0 && u <= (self.columns - 1) as f64 && v <= (self.rows - 1) as f64
    }

    /// Height and gradient of the ground at a point of the world [m].
    pub fn sample(&self, x: f64, y: f64, interpolation: Interpolation) -> Sample {
        let place = self.placement.place_on_grid([x, y], [self.columns - 1, self.rows - 1]);
        place.map_or(Sample::Outside, |place| self.sample_place(place, interpolation))
    }

    /// [`Self::sample`] at these distances from node (0, 0) along x and y of the world [m].
    pub fn sample_offset(&self, x: f64, y: f64, interpolation: Interpolation) -> Sample {
        let [u, v] = self.placement.grid_from_offset(x, y);
        if self.on_grid(u, v) { self.sample_place([u, v], interpolation) } else { Sample::Outside }
    }

    /// Height and gradient at a point of the grid in numbers of columns and rows.
    fn sample_place(&self, [u, v]: [f64; 2], interpolation: Interpolation) -> Sample {
        // The last line of nodes belongs to the last cell.
        let (i, j) = ((u as usize).min(self.columns - 2), (v as usize).min(self.rows - 2));
        let (a, b) = (u - i as f64, v - j as f64);
        let (height, slope) = match interpolation {
            Interpolation::Bilinear => {
                let cell = self.cell(i, j);
                (cell.height(a, b), cell.slope(a, b))
            }
            Interpolation::Bicubic => self.cubic([i, j], [a, b]),
        };
        if height.is_nan() {
            return Sample::Unknown;
        }
        let [dx, dy] = self.placement.spacing();
        let gradient = self.placement.world_axes([slope[0] / dx, slope[1] / dy]);
        Sample::Known { height, gradient }
    }

    /// Height and slope per cell from sixteen nodes.
    fn cubic(&self, [i, j]: [usize; 2], [a, b]: [f64; 2]) -> (f64, [f64; 2]) {
        let row = |j: usize| {
            let node = |i: usize| self.heights.at(j * self.columns + i);
            catmull_rom(four(node, i, self.columns), a)
        };
        let along = four(row, j, self.rows);
        let (height, across) = catmull_rom(along.map(|(height, _)| height), b);
        let (slope, _) = catmull_rom(along.map(|(_, slope)| slope), b);
        (height, [slope, across])
    }
}

/// Unit normal, upwards, of ground with this gradient.
#[inline]
pub fn normal([x, y]: [f64; 2]) -> Vector3<f64> {
    // Scaled, as the square of a steep gradient may overflow.
    let scale = x.abs().max(y.abs()).max(1.0);
    Vector3::new(-x / scale, -y / scale, 1.0 / scale).normalize()
}
