//! The underside of the body, and its exact clearance above the ground.

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

use crate::suspension::Dimensions;
use crate::suspension::Placed;
use crate::terrain::Terrain;
use six_wheel_numerics::error::{Error, bounded, numbers};

/// The point of a rectangle with the least clearance.
#[derive(Clone, Copy, Debug)]
pub(super) enum Lowest {
    /// A point inside the rectangle, above a node of the map.
    Node {
        /// Position on the rectangle [m].
        point: Vector3<f64>,
    },
    /// A point of an edge.
    Edge {
        /// Position on the rectangle [m].
        point: Vector3<f64>,
        /// Along the edge [m].
        way: Vector3<f64>,
        /// If the point is above a line of the grid, 0 for a line between columns, 1 for one between rows.
        line: Option<usize>,
    },
}

/// The underside of the body: a level rectangle of its frame, as far to the left as to the right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Belly {
    /// Rear and front edge [m].
    pub x: [f64; 2],
    /// Half its width [m].
    pub half_width: f64,
    /// Its height in the frame of the body [m].
    pub z: f64,
}

impl Belly {
    /// Fails unless it is a rectangle.
    #[inline]
    pub fn new(x: [f64; 2], half_width: f64, z: f64) -> Result<Self, Error> {
        let all = [x[0], x[1], half_width, z];
        bounded("belly", &all)?;
        if x[0] < x[1] && half_width > 0.0 {
            return Ok(Self { x, half_width, z });
        }
        let rule = "be rear and front edge in order, a positive half width and a height";
        Err(Error::value("belly", rule, numbers(&all)))
    }

    /// A default belly: between the rear and the front wheels, of three quarters of the distance to the rockers on each
    /// side, a quarter of a wheel's radius below the lower of the axes of rockers and bogies. (Perseverance: 0.60 m
    /// above the ground, the published clearance.)
    pub fn between_wheels(dimensions: &Dimensions) -> Self {
        let pivot = dimensions.rocker_pivot;
        let r = dimensions.wheel_radius;
        let (rear, front) = (dimensions.level_place(2)[0], dimensions.level_place(0)[0]);
        let middle = (rear + front) / 2.0;
        let half = ((front - rear).abs() / 2.0 - r).max(r / 2.0);
        Self {
            x: [middle - half, middle + half],
            half_width: 0.75 * pivot[1].abs().max(r),
            z: pivot[2] + dimensions.rocker_to_bogie[2].min(0.0) - r / 4.0,
        }
    }

    /// [`Self::clearance`] of a settled chain.
    #[inline]
    pub fn above(&self, ground: &Terrain, placed: &Placed<'_>) -> Option<f64> {
        self.clearance(ground, placed.origin, &placed.rotation)
    }

    /// Least vertical distance from the rectangle down to the ground [m], negative where the ground is above it.
    /// `origin` is the body's origin relative to node (0, 0) of the map. None where the rectangle leaves the map, is
    /// over unknown ground, or faces upwards.
    ///
    /// In a cell the ground less a plane is a saddle, whose maximum over any region is on the region's edge. So the
    /// least distance is above a node, or on an edge of the rectangle, along which the distance is a parabola in every
    /// cell.
    pub fn clearance(&self, ground: &Terrain, origin: Vector3<f64>, rotation: &Matrix3<f64>) -> Option<f64> {
        self.lowest(ground, origin, rotation).map(|(least, _)| least)
    }

    /// [`Self::clearance`] and its point.
    pub(super) fn lowest(
        &self,
        ground: &Terrain,
        origin: Vector3<f64>,
        rotation: &Matrix3<f64>,
    ) -> Option<(f64, Lowest)> {
        let corner = |x: f64, y: f64| origin + rotation * Vector3::new(x, y, self.z);
        let ([rear, front], w) = (self.x, self.half_width);
        let corners = [corner(rear, -w), corner(front, -w), corner(front, w), corner(rear, w)];
        let places = corners.map(|corner| Vector2::from(ground.placement().grid_from_offset(corner.x, corner.y)));
        if !places.iter().all(|place| ground.on_grid(place.x, place.y)) {
            return None;
        }
        // Columns and rows to the rectangle's own axes, each 0 to 1 on it.
        let axes = Matrix2::from_columns(&[places[1] - places[0], places[3] - places[0]]);
        let facing_down = rotation[(2, 2)] > 0.0;
        let inverse = axes.try_inverse().filter(|_| facing_down)?;
        let [side, end] = [corners[1] - corners[0], corners[3] - corners[0]];
        let mut least: Option<(f64, Lowest)> = None;
        let lower = |least: &Option<(f64, Lowest)>, gap: f64| least.is_none_or(|(known, _)| gap < known);
        let [mut low, mut high] = [places[0]; 2];
        for place in &places {
            (low, high) = (low.inf(place), high.sup(place));
        }
        let columns = ground.shape()[1];
        for row in low.y.ceil() as usize..=high.y.floor() as usize {
            for column in low.x.ceil() as usize..=high.x.floor() as usize {
                let at = inverse * (Vector2::new(column as f64, row as f64) - places[0]);
                if at.min() < 0.0 || at.max() > 1.0 {
                    continue;
                }
                let plate = corners[0].z + side.z * at.x + end.z * at.y;
                let height = ground.heights().at(row * columns + column);
                if height.is_nan() {
                    return None;
                }
                if lower(&least, plate - height) {
                    let point = corners[0] + side * at.x + end * at.y;
                    least = Some((plate - height, Lowest::Node { point }));
                }
            }
        }
        for k in 0..4 {
            let next = (k + 1) % 4;
            let found = along(ground, [places[k], places[next]], [corners[k].z, corners[next].z])?;
            if lower(&least, found.gap) {
                let way = corners[next] - corners[k];
                let (point, line) = (corners[k] + way * found.share, found.line);
                least = Some((found.gap, Lowest::Edge { point, way, line }));
            }
        }
        least
    }
}

/// The point of a segment with the least distance from the ground.
#[derive(Clone, Copy)]
struct Place {
    /// Its vertical distance [m].
    gap: f64,
    /// Its position on the segment, 0 to 1.
    share: f64,
    /// See [`Lowest::Edge`].
    line: Option<usize>,
}

/// Least vertical distance of a segment, given in columns and rows and by the heights of its ends, from the ground.
fn along(ground: &Terrain, [from, to]: [Vector2<f64>; 2], heights: [f64; 2]) -> Option<Place> {
    let way = to - from;
    let [rows, columns] = ground.shape();
    let mut least = Place { gap: f64::INFINITY, share: 0.0, line: None };
    let mut take = |gap: f64, share: f64, line: Option<usize>| {
        if gap < least.gap {
            least = Place { gap, share, line };
        }
    };
    let (mut t, mut line) = (0.0, None);
    while t < 1.0 {
        // The piece up to the end of the cell.
        let at = from + way * t;
        let (mut end, mut next) = (1.0_f64, None);
        for axis in 0..2 {
            if way[axis] != 0.0 {
                let ahead = way[axis].signum();
                let place = if ahead > 0.0 { at[axis].floor() + 1.0 } else { at[axis].ceil() - 1.0 };
                let mut cross = (place - from[axis]) / way[axis];
                if cross <= t {
                    cross = (place + ahead - from[axis]) / way[axis];
                }
                let cross = cross.max(t + 1e-12);
                if cross < end {
                    (end, next) = (cross, Some(axis));
                }
            }
        }
        let middle = from + way * ((t + end) / 2.0);
        let column = (middle.x.max(0.0) as usize).min(columns - 2);
        let row = (middle.y.max(0.0) as usize).min(rows - 2);
        let cell = ground.cell(column, row);
        if !cell.is_known() {
            return None;
        }
        let gap = |t: f64| {
            let place = from + way * t;
            let ground = cell.height(place.x - column as f64, place.y - row as f64);
            heights[0] + (heights[1] - heights[0]) * t - ground
        };
        let (a, b, c) = (gap(t), gap((t + end) / 2.0), gap(end));
        take(a, t, line);
        take(c, end, next);
        let bend = a - 2.0 * b + c;
        if bend > 0.0 {
            // The minimum of the parabola through three values, in halves of the piece from its middle.
            let place = (a - c) / (2.0 * bend);
            if place.abs() < 1.0 {
                let share = t + (end - t) * 0.5 * (1.0 + place);
                take(b - 0.5 * place * (a - c) / 2.0, share, None);
            }
        }
        (t, line) = (end, next);
    }
    Some(least)
}
