//! Cost of a position: a grid of costs, interpolated between its cells.

use six_wheel_kinematics::geometry::GridPlacement;
use six_wheel_numerics::error::{Error, number, numbers};

/// Costs on a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Costmap {
    values: Vec<f32>,
    rows: usize,
    columns: usize,
    placement: GridPlacement,
    lethal: Option<f64>,
    outside: Option<f64>,
}

/// Largest number of rows and of columns: their indices are exact in single precision.
const MOST: usize = 1 << 22;

getters! {
    Costmap:
    /// Costs, row after row.
    values: &[f32];
    /// Placement of the cells in the world.
    placement: &GridPlacement;
    /// Cost from which on a position is lethal.
    lethal: Option<f64>;
    /// Cost of every position beyond the map; without it that of the nearest position on it.
    outside: Option<f64>;
}

impl Costmap {
    /// Fails unless there are two rows and columns at least, and every number is finite.
    pub fn new(
        values: Vec<f32>,
        [rows, columns]: [usize; 2],
        placement: GridPlacement,
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
        Ok(Self { values, rows, columns, placement, lethal, outside })
    }

    /// Rows and columns.
    pub fn shape(&self) -> [usize; 2] {
        [self.rows, self.columns]
    }

    /// The cost of the cell nearest to a position.
    pub(crate) fn nearest(&self, [x, y]: [f64; 2]) -> f64 {
        let [column, row] = self.placement.grid_from_world(x, y);
        let index = |cells: f64, count: usize| cells.round().clamp(0.0, (count - 1) as f64) as usize;
        f64::from(self.values[index(row, self.rows) * self.columns + index(column, self.columns)])
    }

    /// Fails unless the position is on the map.
    pub fn check_holds(&self, [x, y, _]: [f64; 3]) -> Result<(), Error> {
        let [row, column] = self.shape().map(|count| count - 1);
        if self.placement.place_on_grid([x, y], [column, row]).is_some() {
            return Ok(());
        }
        let ([x0, y0], [x1, y1]) = (self.placement.origin(), self.placement.world_from_grid(column as f64, row as f64));
        let rule = match self.placement.yaw() {
            0.0 => format!("lie on the costmap (x {x0:?} to {x1:?} m, y {y0:?} to {y1:?} m)"),
            yaw => format!("lie on the costmap (from ({x0:?}, {y0:?}) to ({x1:?}, {y1:?}) m, turned by {yaw:?} rad)"),
        };
        Err(Error::value("state.pose", rule, numbers(&[x, y])))
    }
}
