//! `six_wheel.Terrain`: ground as a regular grid of heights.

mod sources;

use std::sync::Arc;

use numpy::{PyArrayDescrMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::PyTypeInfo;
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyString, PyTuple};
use six_wheel_terrain::terrain::{Heights, Interpolation, Sample, Terrain as Core, normal};

use crate::arguments::shown;
use crate::classes::hash_of_numbers;
use crate::convert::{
    OrRaise, Output, OutputOptions, Rows, memory, pair, pair_or_one, read_array, refuse_shape, scalar_or_array, singles,
};
use crate::workers::{fill_rows, workers};

/// Ground as a regular grid of heights.
///
/// Node ``(row, column)`` lies at ``origin + R(yaw) (column dx, row dy)``: x grows with columns, y with
/// rows. Between nodes heights are bilinear. NaN is a height that nobody knows; neither it nor the outside is
/// ever guessed.
#[doc = section!(Parameters)]
/// heights : array_like, shape (rows, columns)
///     Heights [m], NaN where unknown. Single precision stays single precision.
///     Masked arrays are unknown where they are masked. A DataArray of xarray and a DataFrame of pandas have their
///     place by their coordinates, a table with columns x, y and z by those. Arrays of other sources carry no direction: a raster whose first row is the
///     northern one needs ``north_up=True``, z that counts downwards ``-z``, the matrix of a GridMap
///     ``matrix[::-1, ::-1].T``.
/// spacing : float or (float, float)
///     Between columns and between rows [m]; may be left out where heights have coordinates.
/// origin : (float, float), default (0.0, 0.0)
///     Place of node (0, 0) in the world [m]: the middle of a cell, not a corner of the map such as ``src.bounds[:2]``.
/// yaw : float, default 0.0
///     Angle from the x axis of the world to the rows, counter-clockwise [rad].
/// north_up : bool, default False
///     True if the first row is the northern one, as in images; `origin` stays the place of the south-western node.
/// nodata : float or sequence of float, optional
///     Numbers that stand for an unknown height; NaN if every number is a height.
/// unit : str or float, optional
///     Of the heights, as for `read`; default m.
#[doc = raises!(ValueError)]
///     If there are fewer than two rows or columns, a height is infinite or 1e15 m and more, the spacing is not
///     positive, or so small that it can only be in degrees, or some heights look like marks of unknown ones or like
///     a picture.
#[pyclass(frozen, module = "six_wheel")]
pub struct Terrain(pub Arc<Core>);

/// Heights of an array, and its number of columns.
fn read_heights(value: &Bound<'_, PyAny>) -> PyResult<(Heights, usize)> {
    let array = read_array("heights", value)?;
    let columns = columns(array.shape())?;
    if let Some(single) = singles("heights", &array)? {
        return Ok((Heights::Single(Arc::new(single)), columns));
    }
    let rows = Rows::read("heights", &array, columns)?;
    let heights = memory::gathered(rows.flat().iter().copied())?;
    Ok((Heights::Double(Arc::new(heights)), columns))
}

fn columns(shape: &[usize]) -> PyResult<usize> {
    match shape {
        [rows, columns] if *rows >= 2 && *columns >= 2 => Ok(*columns),
        _ => Err(refuse_shape("heights", "have at least two rows and two columns", shape)),
    }
}

/// Heights of this size may be marks of unknown ones [m].
const LARGE: f64 = 98.0;

/// Cells that are looked at for a first impression, and the slope from which on they are steep: 79 degrees.
const SAMPLED: usize = 32;
const STEEP: f64 = 5.0;

/// True unless it is an array of something else than floating-point numbers.
fn is_float(heights: &Bound<'_, PyAny>) -> bool {
    heights.cast::<PyUntypedArray>().map_or(true, |array| array.dtype().kind() == b'f')
}

/// True for arrays of numbers and lists, which have no place of their own.
fn is_plain(heights: &Bound<'_, PyAny>) -> bool {
    let is_array = heights.get_type().is(PyUntypedArray::type_object(heights.py()));
    is_array || heights.is_instance_of::<PyList>() || heights.is_instance_of::<PyTuple>()
}

impl Terrain {
    /// Asks for the ground at every row, and writes what `width` numbers it gives; NaN where nothing is known.
    fn ask<'py>(
        &self,
        py: Python<'py>,
        xy: &Bound<'py, PyAny>,
        method: &str,
        width: usize,
        asked: OutputOptions<'_, 'py>,
        threads: Option<i64>,
        answer: impl Fn(f64, [f64; 2], &mut [f64]) + Sync + Send,
    ) -> PyResult<Bound<'py, PyAny>> {
        let workers = workers(threads, None)?;
        let method: Interpolation = method.parse().or_raise(&[])?;
        let rows = Rows::read("xy", xy, 2)?;
        let mut shape = rows.leading.clone();
        if width > 1 {
            shape.push(width);
        }
        let mut output = Output::asked(py, asked, &shape)?;
        let (points, target, ground) = (rows.pairs(), output.flat(), &*self.0);
        fill_rows(py, workers, points.len(), &rows.leading, [(target, width)], |row, [target]| {
            let [x, y] = points[row];
            match ground.sample(x, y, method) {
                Sample::Known { height, gradient } => answer(height, gradient, target),
                Sample::Unknown | Sample::Outside => target.fill(f64::NAN),
            }
            Ok(())
        })?;
        output.finish_number(asked.0)
    }

    /// The arguments that make this very ground, its heights checked.
    fn keywords<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (spacing, origin) = (self.spacing(py), self.origin(py));
        let (yaw, nodata, unit) = (self.0.placement().yaw(), f64::NAN, "m");
        Ok(dict!(py, heights = self.heights(py)?, spacing, origin, yaw, nodata, unit))
    }

    fn from_arguments(
        heights: &Bound<'_, PyAny>,
        spacing: &Bound<'_, PyAny>,
        origin: Option<&Bound<'_, PyAny>>,
        yaw: f64,
    ) -> PyResult<Self> {
        let (heights, columns) = read_heights(heights)?;
        let spacing = pair_or_one("spacing", spacing)?.unwrap_or_else(|one| [one; 2]);
        let origin = origin.map_or(Ok([0.0; 2]), |origin| pair("origin", origin))?;
        let core = Core::new(heights, columns, spacing, origin, yaw);
        core.map(|core| Self(Arc::new(core))).or_raise(&[])
    }

    /// True if heights may be implausible, marks of unknown ones or of another unit: large, or steep in many of some
    /// cells.
    fn may_be_implausible(&self) -> bool {
        let ([rows, columns], [dx, dy]) = (self.0.shape(), self.0.placement().spacing());
        let steep = (0..SAMPLED).filter(|k| {
            // Spread over rows and columns by the golden ratio.
            let share = (0.618_033_988_749_894_9 * *k as f64).fract();
            let place = [(share * (columns - 1) as f64) as usize, k * (rows - 1) / SAMPLED];
            let cell = self.0.cell(place[0], place[1]);
            (cell.along / dx).hypot(cell.across / dy) > STEEP
        });
        self.0.largest_height() >= LARGE || steep.count() > SAMPLED / 4
    }
}

argument_kind! { Terrain: "a Terrain", |value| match value.is_instance_of::<PyString>() {
    true => format!("sw.Terrain.read({})", shown(value)),
    false => "sw.Terrain(heights, spacing=...)".into(),
} }

getters! { Terrain, self, py:
    /// Number of rows and of columns.
    shape: (usize, usize) = self.0.shape().into();
    /// Between columns and between rows [m].
    spacing: (f64, f64) = self.0.placement().spacing().into();
    /// Place of node (0, 0) in the world [m].
    origin: (f64, f64) = self.0.placement().origin().into();
    /// Angle from the x axis of the world to the rows, counter-clockwise [rad].
    yaw: f64 = self.0.placement().yaw();
    /// The heights [m], shape (rows, columns), as a fresh array.
    heights: PyResult<Bound<'py, PyAny>> = {
        let shape = &self.0.shape();
        Ok(match self.0.heights() {
            Heights::Single(heights) => memory::array(py, heights, shape)?.into_any(),
            Heights::Double(heights) => memory::array(py, heights, shape)?.into_any(),
        })
    };
}

equal_by!(Terrain: 0);
replaceable!(Terrain);
pickled_by_keywords!(Terrain: keywords);

methods! { Terrain:
    #[new]
    fn new[](heights, spacing=None, origin=None, yaw: Option<f64> = None, *, north_up=None, nodata=None, unit=None,
        **)
    as "(heights, spacing=None, origin=None, yaw=0.0, *, north_up=None, nodata=None, unit=None)" -> PyResult<Self> {
        let (py, yaw) = (heights.py(), yaw.unwrap_or_default());
        py.import("numpy")?; // its types are asked for below, which panics where loading it fails
        let arrays = || py.import("six_wheel.maps.arrays");
        let is_nan = |value: &Bound<'_, PyAny>| value.extract::<f64>().is_ok_and(f64::is_nan);
        let is_metre = |value: &Bound<'_, PyAny>| value.extract::<&str>().is_ok_and(|unit| unit == "m");
        let as_it_is = north_up.is_none() && nodata.is_none_or(is_nan) && unit.is_none_or(is_metre);
        if let Some(spacing) = spacing.filter(|_| as_it_is && is_plain(heights)) {
            let made = Self::from_arguments(heights, spacing, origin, yaw);
            if made.as_ref().is_err_and(|error| error.is_instance_of::<PyMemoryError>(py)) {
                return made; // heights that do not fit take long to look through
            }
            let is_settled = nodata.is_some() && unit.is_some();
            let may_be_implausible =
                |made: &Self| made.0.shape().contains(&3) || made.may_be_implausible() || !is_float(heights);
            let is_array = heights.cast::<PyUntypedArray>().is_ok();
            if !is_settled && made.as_ref().map_or(is_array, may_be_implausible) {
                let open = (heights, spacing, nodata.is_none(), unit.is_none());
                arrays()?.call_method1("check_plausibility", open)?;
            }
            return made;
        }
        let options = dict!(py, spacing, origin, north_up, nodata, unit);
        let grid = arrays()?.call_method("read", (heights, ), Some(&options))?;
        let (heights, spacing, origin): (Bound<'_, PyAny>, Bound<'_, PyAny>, Bound<'_, PyAny>) = grid.extract()?;
        Self::from_arguments(&heights, &spacing, Some(&origin), yaw)
    }

    /// Heights at points of the world.
    #[doc = section!(Parameters: points)]
    /// method : {'bilinear', 'bicubic'}
    ///     From the four corners of the cell, which is the surface that wheels stand on; or smoothly from
    ///     sixteen nodes.
    #[doc = parameters!(out "(...)", dtype, threads)]
    #[doc = returns!("float or ndarray, shape (...)")]
    ///     Heights [m]; NaN off the map and where a height that enters is unknown.
    #[doc = raises!("If a shape does not fit, or the method is not known.")]
    fn height_at[&self, py: Python<'py>](xy, *, method: &str = "bilinear", out=None, dtype=None,
        threads: Option<i64> = None) -> PyResult<Bound<'py, PyAny>> {
        self.ask(py, xy, method, 1, (out, dtype), threads, |height, _, target| {
            target[0] = height;
        })
    }

    /// Derivatives of the height by x and y.
    #[doc = section!(Parameters: points)]
    /// method : {'bilinear', 'bicubic'}
    ///     As for `height_at`. On a crease of the bilinear surface, those of the cell that comes after it.
    #[doc = parameters!(out "(..., 2)", dtype, threads)]
    #[doc = returns!("ndarray, shape (..., 2)")]
    ///     Slopes along x and y of the world; NaN off the map and where a height that enters is unknown.
    #[doc = raises!("If a shape does not fit, or the method is not known.")]
    fn gradient_at[&self, py: Python<'py>](xy, *, method: &str = "bilinear", out=None, dtype=None,
        threads: Option<i64> = None) -> PyResult<Bound<'py, PyAny>> {
        self.ask(py, xy, method, 2, (out, dtype), threads, |_, gradient, target| {
            target.copy_from_slice(&gradient);
        })
    }

    /// Unit normals of the ground, upwards.
    #[doc = section!(Parameters: points)]
    /// method : {'bilinear', 'bicubic'}
    ///     As for `gradient_at`.
    #[doc = parameters!(out "(..., 3)", dtype, threads)]
    #[doc = returns!("ndarray, shape (..., 3)")]
    ///     Normals in world axes; NaN off the map and where a height that enters is unknown.
    #[doc = raises!("If a shape does not fit, or the method is not known.")]
    fn normal_at[&self, py: Python<'py>](xy, *, method: &str = "bilinear", out=None, dtype=None,
        threads: Option<i64> = None) -> PyResult<Bound<'py, PyAny>> {
        self.ask(py, xy, method, 3, (out, dtype), threads, |_, gradient, target| {
            target.copy_from_slice(normal(gradient).as_slice());
        })
    }

    /// True for points on the map, its rim included; heights there may still be unknown.
    #[doc = section!(Parameters: points, threads)]
    #[doc = returns!("bool or ndarray, shape (...)")]
    #[doc = raises!("If a shape does not fit.")]
    fn contains[&self, py: Python<'py>](xy, *, threads: Option<i64> = None) -> PyResult<Py<PyAny>> {
        let workers = workers(threads, None)?;
        let rows = Rows::read("xy", xy, 2)?;
        let (points, ground) = (rows.pairs(), &*self.0);
        let mut inside = memory::filled(false, points.len())?;
        fill_rows(py, workers, points.len(), &rows.leading, [(&mut inside, 1)], |row, [target]| {
            let [x, y] = points[row];
            target[0] = ground.contains(x, y);
            Ok(())
        })?;
        scalar_or_array(py, inside, &rows.leading)
    }
}

#[pymethods]
impl Terrain {
    fn __repr__(&self) -> String {
        let ([rows, columns], [dx, dy], [x, y]) =
            (self.0.shape(), self.0.placement().spacing(), self.0.placement().origin());
        let turned = match self.0.placement().yaw() {
            0.0 => String::new(),
            yaw => format!(", yaw={yaw:?}"),
        };
        format!("Terrain(<{rows} x {columns} heights>, spacing=({dx:?}, {dy:?}), origin=({x:?}, {y:?}){turned})")
    }

    fn __hash__(&self) -> u64 {
        let place = self.0.placement();
        hash_of_numbers(place.spacing().into_iter().chain(place.origin()).chain([place.yaw()]))
    }
}
