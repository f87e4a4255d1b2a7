//! Rows of numbers on their way in: whatever `numpy.asarray` takes, as slices of `f64`.

use numpy::{PyArrayDescrMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::intern;
use pyo3::prelude::*;
use six_wheel_kinematics::table::Table;

use super::array::{read_array, three_numbers};
use super::broadcast::{Broadcast, joined};
use super::errors::{check_finite, refuse, refuse_shape, shape_text};
use super::memory::{self, BorrowedArray, Memory, repeated};
use super::numpy_module::numpy;
use super::strided::Strided;

/// Numbers from which an array in another form is read block by block.
const MANY: usize = 1 << 15;

enum Data<'py> {
    Three([f64; 3]),
    Array(Memory<'py>),
    Owned(Vec<f64>),
}

/// Rows of numbers, one after the other: leading axes are samples, the last axis has meaning.
pub struct Rows<'py> {
    data: Data<'py>,
    /// Lengths of the leading axes.
    pub leading: Vec<usize>,
    width: usize,
}

impl<'py> Rows<'py> {
    /// Reads whatever `numpy.asarray` takes. Three floats in a tuple or list never become an array.
    pub fn read(argument: &str, value: &Bound<'py, PyAny>, width: usize) -> PyResult<Self> {
        if width == 3
            && let Some(three) = three_numbers(value)
        {
            return Ok(Self { data: Data::Three(three), leading: Vec::new(), width });
        }
        Self::of(argument, &read_array(argument, value)?, width)
    }

    /// The rows of an array of real numbers.
    fn of(argument: &str, array: &Bound<'py, PyUntypedArray>, width: usize) -> PyResult<Self> {
        let leading = leading(argument, array, width)?;
        Ok(Self { data: Data::Array(contiguous(argument, array)?), leading, width })
    }

    /// Reads finite rows.
    pub fn read_finite(argument: &'static str, value: &Bound<'py, PyAny>, width: usize) -> PyResult<Self> {
        let rows = Self::read(argument, value, width)?;
        rows.check_finite(argument).map(|()| rows)
    }

    /// Reads finite rows of one of two widths; `rule` has both.
    pub fn read_finite_either(
        argument: &'static str,
        value: &Bound<'py, PyAny>,
        widths: [usize; 2],
        rule: &str,
    ) -> PyResult<Self> {
        let array = read_array(argument, value)?;
        let Some(width) = widths.into_iter().find(|width| array.shape().last() == Some(width)) else {
            return Err(refuse_shape(argument, rule, array.shape()));
        };
        let rows = Self::of(argument, &array, width)?;
        rows.check_finite(argument).map(|()| rows)
    }

    /// Numbers of a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Reads an optional argument.
    pub fn read_optional(argument: &str, value: Option<&Bound<'py, PyAny>>, width: usize) -> PyResult<Option<Self>> {
        value.map(|value| Self::read(argument, value, width)).transpose()
    }

    /// Reads a table: one leading axis.
    pub fn read_table(argument: &str, value: &Bound<'py, PyAny>, width: usize) -> PyResult<Self> {
        let rows = Self::read(argument, value, width)?;
        if rows.leading.len() == 1 { Ok(rows) } else { Err(rows.refuse_shape(argument, &format!("(n, {width})"))) }
    }

    /// Reads rows with these leading axes.
    pub fn read_over(argument: &str, value: &Bound<'py, PyAny>, width: usize, leading: &[usize]) -> PyResult<Self> {
        let rows = Self::read(argument, value, width)?;
        rows.check_leading(argument, leading).map(|()| rows)
    }

    /// Reads one row.
    pub fn read_one(argument: &str, value: &Bound<'py, PyAny>, width: usize) -> PyResult<Self> {
        Self::read_over(argument, value, width, &[])
    }

    /// Reads an optional argument that has one row per row of another one.
    pub fn read_beside(
        argument: &str,
        value: Option<&Bound<'py, PyAny>>,
        width: usize,
        leading: &[usize],
    ) -> PyResult<Option<Self>> {
        value.map(|value| Self::read_over(argument, value, width, leading)).transpose()
    }

    /// Reads finite rows with these leading axes.
    pub fn read_finite_over(
        argument: &'static str,
        value: &Bound<'py, PyAny>,
        width: usize,
        leading: &[usize],
    ) -> PyResult<Self> {
        let rows = Self::read_over(argument, value, width, leading)?;
        rows.check_finite(argument).map(|()| rows)
    }

    /// Reads an optional argument of finite numbers that has one row per row of another one.
    pub fn read_finite_beside(
        argument: &'static str,
        value: Option<&Bound<'py, PyAny>>,
        width: usize,
        leading: &[usize],
    ) -> PyResult<Option<Self>> {
        value.map(|value| Self::read_finite_over(argument, value, width, leading)).transpose()
    }

    /// Lengths of all axes.
    pub fn shape(&self) -> Vec<usize> {
        joined(&self.leading, self.width)
    }

    /// Fails unless every number is finite.
    pub fn check_finite(&self, argument: &'static str) -> PyResult<()> {
        self.check_finite_where(argument, |_| false)
    }

    /// Fails unless every number is finite; a row that has no answer may also be NaN throughout.
    pub fn check_finite_where(&self, argument: &'static str, has_no_answer: impl Fn(usize) -> bool) -> PyResult<()> {
        check_finite(argument, self.flat(), self.width, &self.leading, has_no_answer)
    }

    /// All numbers, row after row.
    pub fn flat(&self) -> &[f64] {
        match &self.data {
            Data::Three(three) => three,
            Data::Array(memory) => memory.numbers(),
            Data::Owned(values) => values,
        }
    }

    /// All numbers as triples.
    pub fn triples(&self) -> &[[f64; 3]] {
        self.flat().as_chunks().0
    }

    /// Fails unless it has these leading axes.
    pub fn check_leading(&self, argument: &str, leading: &[usize]) -> PyResult<()> {
        let refused = || self.refuse_shape(argument, &shape_text(&joined(leading, self.width)));
        if self.leading == leading { Ok(()) } else { Err(refused()) }
    }

    /// The error of rows in another shape than those that are wanted.
    pub fn refuse_shape(&self, argument: &str, wanted: &str) -> PyErr {
        refuse_shape(argument, &format!("have shape {wanted}"), &self.shape())
    }

    /// All numbers as pairs.
    pub fn pairs(&self) -> &[[f64; 2]] {
        self.flat().as_chunks().0
    }

    /// Number of rows.
    pub fn count(&self) -> usize {
        self.leading.iter().product()
    }

    /// True for one row, false for a batch.
    pub fn is_single(&self) -> bool {
        self.leading.is_empty()
    }
}

/// Reads a point: three finite numbers.
pub fn read_point(argument: &'static str, value: &Bound<'_, PyAny>) -> PyResult<[f64; 3]> {
    Rows::read_finite_over(argument, value, 3, &[]).map(|point| point.triples()[0])
}

/// Reads exactly `N` numbers.
pub fn numbers<const COUNT: usize>(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<[f64; COUNT]> {
    let row = Rows::read_one(argument, value, COUNT)?;
    Ok(std::array::from_fn(|place| row.flat()[place]))
}

impl Broadcast for Rows<'_> {
    fn leading(&self) -> &[usize] {
        &self.leading
    }

    fn shape_over(&self, leading: &[usize]) -> Vec<usize> {
        joined(leading, self.width)
    }

    fn spread(&mut self, argument: &str, leading: &[usize]) -> PyResult<()> {
        let shape = joined(leading, self.width);
        if let Data::Array(memory) = &self.data {
            let was = joined(&self.leading, self.width);
            let wide = repeated(&memory.source(&was)?, &was, &shape)?;
            *self = Self::of(argument, &wide, self.width)?;
            return Ok(());
        }
        // A value that is no array is one row.
        let row = self.flat();
        let mut all = memory::room(memory::count(&shape)?)?;
        for _ in 0..leading.iter().product() {
            all.extend_from_slice(row);
        }
        self.data = Data::Owned(all);
        self.leading = leading.to_vec();
        Ok(())
    }
}

/// Rows that need not be one after the other: those of a large array in another form are read block by block.
pub enum Blocks<'py> {
    /// As the kernels take them.
    Flat(Rows<'py>),
    /// To be read a block at a time.
    Strided {
        strided: Strided,
        leading: Vec<usize>,
        width: usize,
        /// Keeps the memory.
        array: Bound<'py, PyUntypedArray>,
        held: BorrowedArray,
    },
}

impl<'py> Blocks<'py> {
    /// As [`Rows::read`].
    pub fn read(argument: &str, value: &Bound<'py, PyAny>, width: usize) -> PyResult<Self> {
        if width == 3 && three_numbers(value).is_some() {
            return Rows::read(argument, value, width).map(Self::Flat);
        }
        Self::of(argument, &read_array(argument, value)?, width)
    }

    /// Reads an optional argument.
    /// One number stays one.
    pub fn read_optional(argument: &str, value: Option<&Bound<'py, PyAny>>, width: usize) -> PyResult<Option<Self>> {
        value.map(|value| Self::read(argument, value, width)).transpose()
    }

    fn of(argument: &str, array: &Bound<'py, PyUntypedArray>, width: usize) -> PyResult<Self> {
        if array.len() >= MANY
            && !is_flat(array)
            && let Some(strided) = Strided::of(array)
        {
            return Ok(Self::Strided {
                strided,
                leading: leading(argument, array, width)?,
                width,
                array: array.clone(),
                held: memory::read(argument, array)?,
            });
        }
        Rows::of(argument, array, width).map(Self::Flat)
    }

    fn width(&self) -> usize {
        match self {
            Self::Flat(rows) => rows.width,
            Self::Strided { width, .. } => *width,
        }
    }

    /// Lengths of all axes.
    pub fn shape(&self) -> Vec<usize> {
        joined(self.leading(), self.width())
    }

    /// Number of rows.
    pub fn count(&self) -> usize {
        self.leading().iter().product()
    }

    /// All numbers, for the batches.
    pub fn table(&self) -> Table<'_> {
        match self {
            Self::Flat(rows) => Table::Flat(rows.flat()),
            Self::Strided { strided, held, .. } => held.kept().map_or(Table::Read(strided), Table::Flat),
        }
    }

    /// All of them one after the other, in a copy where they are not.
    pub fn flat(self, argument: &str) -> PyResult<Rows<'py>> {
        match self {
            Self::Flat(rows) => Ok(rows),
            Self::Strided { ref array, ref held, width, .. } => {
                Rows::of(argument, &held.source(array, &self.shape())?, width)
            }
        }
    }

    /// The array as it was read, if one is.
    fn source(&self) -> Option<PyResult<Bound<'py, PyUntypedArray>>> {
        match self {
            Self::Flat(Rows { data: Data::Array(memory), .. }) => Some(memory.source(&self.shape())),
            Self::Strided { array, held, .. } => Some(held.source(array, &self.shape())),
            Self::Flat(_) => None,
        }
    }

    /// The array that is read, if one is.
    fn array(&self) -> Option<&Bound<'py, PyUntypedArray>> {
        match self {
            Self::Flat(Rows { data: Data::Array(memory), .. }) => Some(memory.array()),
            Self::Strided { array, .. } => Some(array),
            Self::Flat(_) => None,
        }
    }

    /// Lets go of the caller's array by copying it, so that the array may also be written to.
    pub fn release_if(&mut self, written: &Bound<'py, PyAny>) -> PyResult<()> {
        if !self.array().is_some_and(|array| array.is(written)) {
            return Ok(());
        }
        let numbers = match self {
            Self::Flat(rows) => memory::gathered(rows.flat().iter().copied())?,
            Self::Strided { strided, held, .. } => match held.kept() {
                Some(kept) => memory::gathered(kept.iter().copied())?,
                None => strided.all()?,
            },
        };
        *self = Self::Flat(Rows { data: Data::Owned(numbers), leading: self.leading().to_vec(), width: self.width() });
        Ok(())
    }
}

impl Broadcast for Blocks<'_> {
    fn leading(&self) -> &[usize] {
        match self {
            Self::Flat(rows) => &rows.leading,
            Self::Strided { leading, .. } => leading,
        }
    }

    fn shape_over(&self, leading: &[usize]) -> Vec<usize> {
        joined(leading, self.width())
    }

    fn spread(&mut self, argument: &str, leading: &[usize]) -> PyResult<()> {
        if let Some(array) = self.source() {
            let wide = repeated(&array?, &self.shape(), &self.shape_over(leading))?;
            *self = Self::of(argument, &wide, self.width())?;
        } else if let Self::Flat(rows) = self {
            rows.spread(argument, leading)?;
        }
        Ok(())
    }
}

/// Lengths of the axes before the last one, which has this width.
fn leading(argument: &str, array: &Bound<'_, PyUntypedArray>, width: usize) -> PyResult<Vec<usize>> {
    let rule = || format!("have shape (..., {width})");
    match array.shape().split_last() {
        Some((last, leading)) if *last == width => Ok(leading.to_vec()),
        Some(_) => Err(refuse_shape(argument, &rule(), array.shape())),
        None => Err(refuse(argument, &rule(), "a number")),
    }
}

/// True for an array that is C-contiguous, aligned and of native `f64`.
fn is_flat(array: &Bound<'_, PyUntypedArray>) -> bool {
    let dtype = array.dtype();
    (dtype.kind(), dtype.itemsize()) == (b'f', size_of::<f64>())
        && dtype.is_native_byteorder() != Some(false)
        && array.is_c_contiguous()
        && array.is_aligned()
}

/// C-contiguous, aligned and of native `f64`: the memory of the array itself where it is that already, a copy
/// otherwise. What is copied is in use too: whether a result may go there does not depend on how it is laid out.
pub(super) fn contiguous<'py>(argument: &str, array: &Bound<'py, PyUntypedArray>) -> PyResult<Memory<'py>> {
    let py = array.py();
    let held = memory::read(argument, array)?;
    let array = if is_flat(array) {
        array.clone()
    } else {
        memory::count(array.shape())?;
        numpy(py)?.call_method1(intern!(py, "require"), (array, "d", ["C", "A"]))?.cast_into()?
    };
    Memory::new(array, held)
}
