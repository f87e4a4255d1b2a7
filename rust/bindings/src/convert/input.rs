//! Arguments on their way in: whatever `numpy.asarray` takes, as slices of `f64`.

use std::cell::OnceCell;

use numpy::{
    PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyFloat, PyInt, PyList, PyTuple};
use six_wheel_core::batch::{Durations, Table};
use six_wheel_core::error::finite;
use six_wheel_core::geometry::Steps;

use super::strided::Strided;
use super::{ArgumentTypeError, Array, joined, numpy, raise, refuse, shape_text};

/// Rows of numbers: leading axes are samples, the last axis has meaning.
pub struct Rows<'py> {
    data: Data<'py>,
    /// Lengths of the leading axes.
    pub leading: Vec<usize>,
    width: usize,
    /// The caller's array, if it came as one.
    pub source: Option<Bound<'py, PyUntypedArray>>,
}

enum Data<'py> {
    Three([f64; 3]),
    Array(Numbers<'py>),
    Owned(Vec<f64>),
}

/// The numbers of an array.
enum Numbers<'py> {
    /// As the kernels take them.
    Borrowed(PyReadonlyArrayDyn<'py, f64>),
    /// To be read a block at a time, or all at once where that is asked for.
    Strided {
        strided: Strided,
        all: OnceCell<Vec<f64>>,
        /// Keeps the memory.
        _array: Bound<'py, PyUntypedArray>,
        _borrow: Option<PyReadonlyArrayDyn<'py, f64>>,
    },
}

/// Numbers from which an array in another form is read block by block.
const MANY: usize = 1 << 15;

impl Numbers<'_> {
    fn shape(&self) -> &[usize] {
        match self {
            Self::Borrowed(array) => array.shape(),
            Self::Strided { _array, .. } => _array.shape(),
        }
    }

    /// All of them, row after row.
    fn flat(&self) -> &[f64] {
        match self {
            // Contiguity was established on reading: an empty slice cannot come of it.
            Self::Borrowed(array) => array.as_slice().unwrap_or_default(),
            Self::Strided { strided, all, .. } => all.get_or_init(|| strided.all()),
        }
    }

    fn table(&self) -> Table<'_> {
        match self {
            Self::Strided { strided, .. } => Table::Read(strided),
            Self::Borrowed(_) => Table::Flat(self.flat()),
        }
    }
}

impl<'py> Rows<'py> {
    /// Reads whatever `numpy.asarray` takes. Three floats in a tuple or list never become an array.
    pub fn read(argument: &str, value: &Bound<'py, PyAny>, width: usize) -> PyResult<Self> {
        if width == 3
            && let Some(three) = three_numbers(value)
        {
            return Ok(Self {
                data: Data::Three(three),
                leading: Vec::new(),
                width,
                source: None,
            });
        }
        let array = read_array(argument, value)?;
        let Some((last, leading)) = array.shape().split_last() else {
            return Err(refuse(
                argument,
                &format!("have shape (..., {width})"),
                "a number",
            ));
        };
        if *last != width {
            let got = format!("shape {}", shape_text(array.shape()));
            return Err(refuse(
                argument,
                &format!("have shape (..., {width})"),
                &got,
            ));
        }
        let leading = leading.to_vec();
        let source = value.cast::<PyUntypedArray>().ok().cloned();
        Ok(Self {
            data: Data::Array(array),
            leading,
            width,
            source,
        })
    }

    /// Reads a table: one leading axis.
    pub fn read_table(argument: &str, value: &Bound<'py, PyAny>, width: usize) -> PyResult<Self> {
        let rows = Self::read(argument, value, width)?;
        if rows.leading.len() == 1 {
            return Ok(rows);
        }
        let got = format!("shape {}", shape_text(&rows.shape()));
        Err(refuse(argument, &format!("have shape (n, {width})"), &got))
    }

    /// Reads an optional argument that has one row per row of another one.
    pub fn read_beside(
        argument: &str,
        value: Option<&Bound<'py, PyAny>>,
        width: usize,
        leading: &[usize],
    ) -> PyResult<Option<Self>> {
        let Some(value) = value else { return Ok(None) };
        let rows = Self::read(argument, value, width)?;
        rows.check_leading(argument, leading)?;
        Ok(Some(rows))
    }

    /// Lengths of all axes.
    pub fn shape(&self) -> Vec<usize> {
        joined(&self.leading, self.width)
    }

    /// Fails unless every number is finite.
    pub fn check_finite(&self, argument: &'static str) -> PyResult<()> {
        check_finite(argument, self.flat(), self.width, &self.leading)
    }

    /// All numbers, row after row.
    pub fn flat(&self) -> &[f64] {
        match &self.data {
            Data::Three(three) => three,
            Data::Array(numbers) => numbers.flat(),
            Data::Owned(values) => values,
        }
    }

    /// All numbers, for the batches: those of a large array in another form are read block by block.
    pub fn table(&self) -> Table<'_> {
        match &self.data {
            Data::Array(numbers) => numbers.table(),
            _ => Table::Flat(self.flat()),
        }
    }

    /// All numbers as triples.
    pub fn triples(&self) -> &[[f64; 3]] {
        self.flat().as_chunks().0
    }

    /// Fails unless it has these leading axes.
    pub fn check_leading(&self, argument: &str, leading: &[usize]) -> PyResult<()> {
        if self.leading == leading {
            return Ok(());
        }
        let rule = format!("have shape {}", shape_text(&joined(leading, self.width)));
        Err(refuse(
            argument,
            &rule,
            &format!("shape {}", shape_text(&self.shape())),
        ))
    }

    /// All numbers as pairs.
    pub fn pairs(&self) -> &[[f64; 2]] {
        self.flat().as_chunks().0
    }

    /// Other triples in place of these.
    pub fn mapped(self, map: impl Fn(usize, [f64; 3]) -> [f64; 3]) -> Self {
        let rows = self.triples().iter().enumerate();
        let mapped = rows.flat_map(|(k, row)| map(k, *row)).collect();
        Self {
            data: Data::Owned(mapped),
            ..self
        }
    }

    /// Number of rows.
    pub fn count(&self) -> usize {
        self.leading.iter().product()
    }

    /// Whether it is one row, not a batch.
    pub fn is_single(&self) -> bool {
        self.leading.is_empty()
    }

    /// Lets go of the caller's array by copying it, so that the array may also be written to.
    pub fn release_if(&mut self, array: &Bound<'py, PyAny>) {
        if self.source.as_ref().is_some_and(|source| source.is(array)) {
            self.data = Data::Owned(self.flat().to_vec());
            self.source = None;
        }
    }
}

/// One number, or one per row.
pub struct Scalars<'py> {
    one: f64,
    each: Option<Numbers<'py>>,
    /// The shape: empty for one number.
    pub shape: Vec<usize>,
}

impl<'py> Scalars<'py> {
    /// Reads a number or an array of numbers.
    pub fn read(argument: &str, value: &Bound<'py, PyAny>) -> PyResult<Self> {
        if let Ok(float) = value.cast::<PyFloat>() {
            return Ok(Self {
                one: float.value(),
                each: None,
                shape: Vec::new(),
            });
        }
        let array = read_array(argument, value)?;
        let shape = array.shape().to_vec();
        let one = match shape.is_empty() {
            true => array.flat().first().copied().unwrap_or_default(),
            false => 0.0,
        };
        let each = (!shape.is_empty()).then_some(array);
        Ok(Self { one, each, shape })
    }

    /// The numbers as durations.
    pub fn steps(&self) -> Steps<'_> {
        match &self.each {
            None => Steps::Constant(self.one),
            Some(each) => Steps::Each(each.flat()),
        }
    }

    /// The numbers as durations, for the batches.
    pub fn durations(&self) -> Durations<'_> {
        match &self.each {
            None => Durations::Constant(self.one),
            Some(each) => Durations::Each(each.table(), self.shape.iter().product()),
        }
    }

    /// The number of a row.
    pub fn at(&self, row: usize) -> f64 {
        self.steps().get(row)
    }

    /// All numbers.
    pub fn flat(&self) -> &[f64] {
        match &self.each {
            None => std::slice::from_ref(&self.one),
            Some(each) => each.flat(),
        }
    }

    /// Fails unless every number is finite.
    pub fn check_finite(&self, argument: &'static str) -> PyResult<()> {
        check_finite(argument, self.flat(), 1, &self.shape)
    }

    /// Fails unless it has this shape.
    pub fn fit_exactly(&self, argument: &str, shape: &[usize]) -> PyResult<()> {
        if self.shape == shape {
            return Ok(());
        }
        let got = format!("shape {}", shape_text(&self.shape));
        Err(refuse(
            argument,
            &format!("have shape {}", shape_text(shape)),
            &got,
        ))
    }

    /// Fails unless it is one number or has this shape.
    pub fn fit(&self, argument: &str, shape: &[usize]) -> PyResult<()> {
        if self.shape.is_empty() || self.shape == shape {
            return Ok(());
        }
        let rule = format!("be one number or have shape {}", shape_text(shape));
        Err(refuse(
            argument,
            &rule,
            &format!("shape {}", shape_text(&self.shape)),
        ))
    }
}

fn check_finite(
    argument: &'static str,
    values: &[f64],
    width: usize,
    leading: &[usize],
) -> PyResult<()> {
    for (row, values) in values.chunks_exact(width).enumerate() {
        finite(argument, values).map_err(|error| raise(error.at_row(row), leading))?;
    }
    Ok(())
}

/// Three floats or integers in a tuple or list.
fn three_numbers(value: &Bound<'_, PyAny>) -> Option<[f64; 3]> {
    let number = |item: &Bound<'_, PyAny>| {
        if let Ok(float) = item.cast::<PyFloat>() {
            Some(float.value())
        } else if item.is_instance_of::<PyInt>() && !item.is_instance_of::<PyBool>() {
            item.extract().ok()
        } else {
            None
        }
    };
    let items: [Bound<'_, PyAny>; 3] = if let Ok(tuple) = value.cast::<PyTuple>() {
        if tuple.len() != 3 {
            return None;
        }
        [
            tuple.get_item(0).ok()?,
            tuple.get_item(1).ok()?,
            tuple.get_item(2).ok()?,
        ]
    } else {
        let list = value.cast::<PyList>().ok().filter(|list| list.len() == 3)?;
        [
            list.get_item(0).ok()?,
            list.get_item(1).ok()?,
            list.get_item(2).ok()?,
        ]
    };
    Some([number(&items[0])?, number(&items[1])?, number(&items[2])?])
}

/// Native `f64`, C-contiguous and aligned: the caller's own memory where it is that already, read block by
/// block where it is large, a copy otherwise.
fn read_array<'py>(argument: &str, value: &Bound<'py, PyAny>) -> PyResult<Numbers<'py>> {
    if let Ok(array) = value.cast::<PyArrayDyn<f64>>()
        && array.is_c_contiguous()
        && array.is_aligned()
    {
        return borrow(argument, array).map(Numbers::Borrowed);
    }
    let numpy = numpy(value.py())?;
    let array = numpy
        .call_method1(intern!(value.py(), "asarray"), (value,))
        .map_err(|_| {
            let kind = value
                .get_type()
                .name()
                .map_or_else(|_| "an object".into(), |n| n.to_string());
            refuse(
                argument,
                "be numbers of one rectangular shape",
                &format!("a ragged {kind}"),
            )
        })?;
    let dtype = array.getattr(intern!(value.py(), "dtype"))?;
    let kind: char = dtype.getattr(intern!(value.py(), "kind"))?.extract()?;
    if !matches!(kind, 'f' | 'i' | 'u') {
        let message = format!("{argument} must be real numbers, got dtype {dtype}");
        return Err(ArgumentTypeError::new_err(message));
    }
    if value.is_instance_of::<PyUntypedArray>()
        && let Ok(large) = array.cast::<PyUntypedArray>()
        && large.len() >= MANY
        && let Some(strided) = Strided::of(large)
    {
        let floats = array.cast::<PyArrayDyn<f64>>().ok();
        return Ok(Numbers::Strided {
            strided,
            all: OnceCell::new(),
            _array: large.clone(),
            _borrow: floats.map(|array| borrow(argument, array)).transpose()?,
        });
    }
    let array = numpy
        .call_method1(intern!(value.py(), "require"), (array, "d", ["C", "A"]))
        .and_then(|array| Ok(array.cast_into::<PyArrayDyn<f64>>()?))?;
    borrow(argument, &array).map(Numbers::Borrowed)
}

fn borrow<'py>(argument: &str, array: &Array<'py>) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    let busy = |_| {
        refuse(
            argument,
            "not be written to meanwhile",
            "an array in use as out=",
        )
    };
    array.try_readonly().map_err(busy)
}
