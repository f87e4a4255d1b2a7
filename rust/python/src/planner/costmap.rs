//! `six_wheel.Costmap`: the cost of every place.

use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use six_wheel_kinematics::geometry::GridPlacement;
use six_wheel_planner::Costmap as Core;

use crate::convert::{OrRaise, not_rectangular, pair, pair_or_one, refuse_shape, refuse_type};

/// Costs on a grid, for a planner.
///
/// The cost of cell ``[row, column]`` is that at ``origin + R(yaw) (column dx, row dy)``: x grows with the columns, y with
/// the rows. In between it is linear along each axis of the grid.
#[doc = section!(Parameters)]
/// values : array_like, shape (rows, columns)
///     Costs, kept in single precision.
/// spacing : float or array_like, shape (2,)
///     Distance between cells, along x and along y [m].
/// origin : array_like, shape (2,)
///     Place of cell ``[0, 0]`` [m].
/// yaw : float, default 0.0
///     Angle of the rows against the x axis of the world, counter-clockwise [rad].
/// lethal : float, optional
///     Cost from which on a place is forbidden.
/// outside : float, optional
///     Cost of every place beyond the map; default that of the nearest place on it.
/// frame : str, optional
///     Name of the frame the map is in.
#[doc = raises!("If a cost is not finite (it is named), or there are less than two rows or columns.")]
#[pyclass(frozen, module = "six_wheel")]
pub struct Costmap {
    pub core: Core,
    /// Name of the frame the map is in, or None.
    #[pyo3(get)]
    pub frame: Option<String>,
}

argument_kind! { Costmap: "a Costmap", |_| "sw.Costmap(costs, spacing=...)".into() }

getters! { Costmap, self, py:
    /// Distance between cells, along x and along y [m].
    spacing: (f64, f64) = self.core.placement().spacing().into();
    /// Place of cell ``[0, 0]`` [m].
    origin: (f64, f64) = self.core.placement().origin().into();
    /// Angle of the rows against the x axis of the world, counter-clockwise [rad].
    yaw: f64 = self.core.placement().yaw();
    /// Cost from which on a place is forbidden, or None.
    lethal: Option<f64> = self.core.lethal();
    /// Cost of every place beyond the map, or None.
    outside: Option<f64> = self.core.outside();
    /// Costs, shape (rows, columns), float32; a copy.
    values: PyResult<Bound<'py, PyAny>> = {
        let array = numpy::PyArray1::from_slice(py, self.core.values());
        array.call_method1("reshape", (self.core.shape(),))
    };
}

replaceable!(Costmap);
pickled_by_keywords!(Costmap: keywords);

impl Costmap {
    fn keywords<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (spacing, origin, yaw, lethal) = (self.spacing(py), self.origin(py), self.yaw(py), self.lethal(py));
        let (values, outside, frame) = (self.values(py)?, self.outside(py), &self.frame);
        Ok(dict!(py, values, spacing, origin, yaw, lethal, outside, frame))
    }
}

methods! { Costmap:
    #[new]
    fn new[py: Python<'py>](values, spacing, origin=None, yaw: Option<f64> = None, *, lethal: Option<f64> = None,
        outside: Option<f64> = None, frame: Option<String> = None, **)
    as "(values, spacing, origin=None, yaw=0.0, *, lethal=None, outside=None, frame=None)" -> PyResult<Self> {
        let numpy = py.import("numpy")?;
        let array = numpy.call_method1("asarray", (values,));
        let array = array.map_err(|error| not_rectangular("values", values, error))?;
        let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
        if !matches!(kind.as_str(), "f" | "i" | "u" | "b") {
            return Err(refuse_type("values", "be real numbers", format!("dtype {}", array.getattr("dtype")?)));
        }
        let array = numpy.call_method1("ascontiguousarray", (array, "f4"))?;
        let array = array.cast_into::<PyArrayDyn<f32>>()?;
        let shape = array.shape().to_vec();
        let [rows, columns] = shape[..] else {
            return Err(refuse_shape("values", "have shape (rows, columns)", &shape));
        };
        let spacing = pair_or_one("spacing", spacing)?.unwrap_or_else(|one| [one; 2]);
        let origin = origin.map_or(Ok([0.0; 2]), |origin| pair("origin", origin))?;
        let placement = GridPlacement::new(spacing, origin, yaw.unwrap_or_default()).or_raise(&[])?;
        let core = Core::new(array.to_vec()?, [rows, columns], placement, lethal, outside);
        Ok(Self { core: core.or_raise(&[])?, frame })
    }

    #[staticmethod]
    /// Costs of an occupancy grid, as nav2 and ROS have it.
    #[doc = section!(Parameters)]
    /// msg : nav_msgs/OccupancyGrid, or any object with ``info`` and ``data``
    ///     Occupancy in percent, -1 where nothing is known, row after row from the origin of the map.
    /// inflation : float, default 0.0
    ///     Distance from an obstacle over which the cost falls linearly from `lethal` to 0 [m]; only the obstacle is forbidden.
    /// unknown : float, default 0.5
    ///     Cost of a cell of which nothing is known, 0 to 1; from `lethal` on it is an obstacle.
    /// lethal : float, default 0.65
    ///     Cost from which on a place is forbidden: occupancy of 65 %, as nav2 has it.
    #[doc = returns!("Costmap": "Costs from 0 to 1, in the frame of the message.")]
    #[doc = raises!("If its size is not that of the data, its plane is tilted, or an argument makes no sense.")]
    fn from_occupancy_grid[py: Python<'py>](msg, *, inflation=None, unknown=None, lethal=None, **)
    as "(msg, *, inflation=0.0, unknown=0.5, lethal=0.65)" -> PyResult<Bound<'py, PyAny>> {
        made_by(py, "from_occupancy_grid", msg, [inflation, unknown, lethal])
    }

    #[staticmethod]
    /// Costs of a map as nav2 saves it: a YAML file beside its image.
    #[doc = section!(Parameters)]
    /// path : str or PathLike
    ///     The YAML file, with ``image``, ``resolution``, ``origin``, ``negate``, ``occupied_thresh`` and ``free_thresh``;
    ///     its image is a PGM, or whatever Pillow reads where it is installed.
    /// inflation, unknown, lethal : float, optional
    ///     Distance from an obstacle over which the cost falls [m], cost of an unknown cell, cost from which on a place is
    ///     forbidden (both 0 to 1), as for `from_occupancy_grid`; `lethal` by default the ``occupied_thresh`` of the file.
    #[doc = returns!("Costmap": "Costs from 0 to 1.")]
    #[doc = raises!(ValueError: "If the file is no such map.", OSError: "If a file cannot be read.")]
    fn read[py: Python<'py>](path, *, inflation=None, unknown=None, lethal=None, **)
    as "(path, *, inflation=0.0, unknown=0.5, lethal=None)" -> PyResult<Bound<'py, PyAny>> {
        made_by(py, "read_costmap", path, [inflation, unknown, lethal])
    }
}

/// A costmap by a function of `six_wheel.maps.costmaps`, without the arguments that were left out.
fn made_by<'py>(
    py: Python<'py>,
    function: &str,
    source: &Bound<'py, PyAny>,
    options: [Option<&Bound<'py, PyAny>>; 3],
) -> PyResult<Bound<'py, PyAny>> {
    let given = PyDict::new(py);
    for (name, value) in ["inflation", "unknown", "lethal"].into_iter().zip(options) {
        value.map_or(Ok(()), |value| given.set_item(name, value))?;
    }
    py.import("six_wheel.maps.costmaps")?.getattr(function)?.call((source,), Some(&given))
}

#[pymethods]
impl Costmap {
    fn __repr__(&self) -> String {
        let [rows, columns] = self.core.shape();
        let ([dx, dy], [x, y]) = (self.core.placement().spacing(), self.core.placement().origin());
        let turned = match self.core.placement().yaw() {
            0.0 => String::new(),
            yaw => format!(", yaw={yaw:?}"),
        };
        let frame = self.frame.as_ref().map_or_else(String::new, |frame| format!(", frame={frame:?}"));
        format!("Costmap(<{rows} x {columns}>, spacing=({dx:?}, {dy:?}), origin=({x:?}, {y:?}){turned}{frame})")
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| (&other.get().core, &other.get().frame) == (&self.core, &self.frame))
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        let shape: (usize, usize) = self.core.shape().into();
        (shape, self.spacing(py), self.origin(py), self.yaw(py), &self.frame).into_pyobject(py)?.hash()
    }
}
