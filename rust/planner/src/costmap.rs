//! Cost of a position: a grid of costs, interpolated between its cells.

use six_wheel_numerics::error::{Error, number, numbers};

/// Costs on a grid: those of cell `[row, column]` at `origin + (column, row) * spacing`.
#[derive(Clone, Debug, PartialEq)]
pub struct Costmap {
    values: Vec<f32>,
    rows: usize,
    columns: usize,
    spacing: [f64; 2],
    origin: [f64; 2],
    lethal: Option<f64>,
    outside: Option<f64>,
}

/// Rows and columns at most: their numbers are exact in single precision.
const MOST: usize = 1 << 22;

impl Costmap {
    /// Fails unless there are two rows and columns at least, and every number is finite.
    pub fn new(
        values: Vec<f32>,
        [rows, columns]: [usize; 2],
        spacing: [f64; 2],
        origin: [f64; 2],
        lethal: Option<f64>,
        outside: Option<f64>,
    ) -> Result<Self, Error> {
        if rows.min(columns) < 2 || rows.max(columns) > MOST {
            let rule = format!("have 2 to {MOST} rows and columns");
            return Err(Error::value("values", rule, format!("shape ({rows}, {columns})")));
        }
        if rows * columns > i32::MAX as usize {
            let rule = format!("hold {} cells at most", i32::MAX);
            return Err(Error::value("values", rule, (rows * columns).to_string()));
        }
        if let Some(place) = values.iter().position(|value| !value.is_finite()) {
            let cell = format!("values[{}, {}]", place / columns, place % columns);
            return Err(Error::value(cell, "be finite", number(values[place].into())));
        }
        for (argument, value) in [("lethal", lethal), ("outside", outside)] {
            if let Some(value) = value.filter(|value| !value.is_finite()) {
                return Err(Error::value(argument, "be finite", number(value)));
            }
        }
        if !spacing.iter().all(|value| value.is_finite() && *value > 0.0) {
            return Err(Error::value("spacing", "be finite and positive", numbers(&spacing)));
        }
        six_wheel_numerics::error::finite("origin", &origin)?;
        Ok(Self { values, rows, columns, spacing, origin, lethal, outside })
    }

    /// Costs, row after row.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Rows and columns.
    pub fn shape(&self) -> [usize; 2] {
        [self.rows, self.columns]
    }

    /// Distance between cells along x and y [m].
    pub fn spacing(&self) -> [f64; 2] {
        self.spacing
    }

    /// Position of the first cell [m].
    pub fn origin(&self) -> [f64; 2] {
        self.origin
    }

    /// Cost from which on a place is forbidden.
    pub fn lethal(&self) -> Option<f64> {
        self.lethal
    }

    /// Cost of every place beyond the map; without it that of the nearest place on it.
    pub fn outside(&self) -> Option<f64> {
        self.outside
    }

    /// The place of the last cell [m].
    pub fn end(&self) -> [f64; 2] {
        [
            self.origin[0] + (self.columns - 1) as f64 * self.spacing[0],
            self.origin[1] + (self.rows - 1) as f64 * self.spacing[1],
        ]
    }

    /// The cost of the cell next to a place.
    pub(crate) fn nearest(&self, place: [f64; 2]) -> f64 {
        let index = |axis: usize, count: usize| {
            let cells = (place[axis] - self.origin[axis]) / self.spacing[axis];
            cells.round().clamp(0.0, (count - 1) as f64) as usize
        };
        f64::from(self.values[index(1, self.rows) * self.columns + index(0, self.columns)])
    }

    /// Fails unless the place is on the map.
    pub fn check_holds(&self, [x, y, _]: [f64; 3]) -> Result<(), Error> {
        let ([x0, y0], [x1, y1]) = (self.origin, self.end());
        if (x0..=x1).contains(&x) && (y0..=y1).contains(&y) {
            return Ok(());
        }
        let rule = format!("lie on the costmap (x {x0:?} to {x1:?} m, y {y0:?} to {y1:?} m)");
        Err(Error::value("state.pose", rule, numbers(&[x, y])))
    }
}
