//! Rows of numbers on their way in: whatever `numpy.asarray` takes, as slices of `f64`.

use std::fmt::Display;

use numpy::{PyArrayDescrMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyFloat;
use six_wheel_kinematics::geometry::Steps;

use super::array::{read_array, three_numbers};
use super::broadcast::Broadcast;
use super::errors::{check_finite, refuse, refuse_shape, shape_text};
use super::memory::{self, Memory, repeated};
use super::numpy_module::numpy;

pub(super) enum Data<'py> {
    One(f64),
    Three([f64; 3]),
    Array(Memory<'py>),
    Owned(Vec<f64>),
}

/// Rows of numbers, one after the other: leading axes are samples, the last axis has meaning.
pub struct Rows<'py> {
    pub(super) data: Data<'py>,
    /// Lengths of the leading axes.
    pub leading: Vec<usize>,
    /// Length of the last axis; None where a row is one number, which has no axis of its own.
    pub(super) last: Option<usize>,
}

impl<'py> Rows<'py> {
    /// Reads whatever `numpy.asarray` takes. Three floats in a tuple or list never become an array.
    pub fn read(argument: &str, value: &Bound<'py, PyAny>, width: usize) -> PyResult<Self> {
        if width == 3
            && let Some(three) = three_numbers(value)
        {
            return Ok(Self { data: Data::Three(three), leading: Vec::new(), last: Some(width) });
        }
        Self::of(argument, &read_array(argument, value)?, Some(width))
    }

    /// The rows of an array of real numbers.
    pub(super) fn of(argument: &str, array: &Bound<'py, PyUntypedArray>, last: Option<usize>) -> PyResult<Self> {
        let leading = last.map_or_else(|| Ok(array.shape().to_vec()), |width| leading(argument, array, width))?;
        Ok(Self { data: Data::Array(contiguous(argument, array)?), leading, last })
    }

    /// Reads a number or an array of numbers, one a row.
    pub fn read_numbers(argument: &str, value: &Bound<'py, PyAny>) -> PyResult<Self> {
        let one = |number| Self { data: Data::One(number), leading: Vec::new(), last: None };
        if let Ok(float) = value.cast::<PyFloat>() {
            return Ok(one(float.value()));
        }
        let numbers = Self::of(argument, &read_array(argument, value)?, None)?;
        // The only number of an array is copied: the array may be written to.
        Ok(match (numbers.leading.as_slice(), numbers.flat()) {
            ([], [number]) => one(*number),
            _ => numbers,
        })
    }

    /// Reads a finite number or an array of finite numbers, one a row.
    pub fn read_finite_numbers(argument: &'static str, value: &Bound<'py, PyAny>) -> PyResult<Self> {
        let numbers = Self::read_numbers(argument, value)?;
        numbers.check_finite(argument).map(|()| numbers)
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
        let rows = Self::of(argument, &array, Some(width))?;
        rows.check_finite(argument).map(|()| rows)
    }

    /// Numbers of a row.
    pub fn width(&self) -> usize {
        self.last.unwrap_or(1)
    }

    /// Reads an optional argument.
    pub fn read_optional(argument: &str, value: Option<&Bound<'py, PyAny>>, width: usize) -> PyResult<Option<Self>> {
        value.map(|value| Self::read(argument, value, width)).transpose()
    }

    /// Reads a table: one leading axis.
    pub fn read_table(argument: &str, value: &Bound<'py, PyAny>, width: usize) -> PyResult<Self> {
        let rows = Self::read(argument, value, width)?;
        if rows.leading.len() == 1 { Ok(rows) } else { Err(rows.refuse_shape(argument, format!("(n, {width})"))) }
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
        self.shape_over(&self.leading)
    }

    /// Fails unless every number is finite.
    pub fn check_finite(&self, argument: &'static str) -> PyResult<()> {
        self.check_finite_where(argument, |_| false)
    }

    /// Fails unless every number is finite; a row that has no answer may also be NaN throughout.
    pub fn check_finite_where(&self, argument: &'static str, has_no_answer: impl Fn(usize) -> bool) -> PyResult<()> {
        check_finite(argument, self.flat(), self.width(), &self.leading, has_no_answer)
    }

    /// All numbers, row after row.
    pub fn flat(&self) -> &[f64] {
        match &self.data {
            Data::One(number) => std::slice::from_ref(number),
            Data::Three(three) => three,
            Data::Array(memory) => memory.numbers(),
            Data::Owned(values) => values,
        }
    }

    /// The numbers as durations: one for all rows, or one each.
    pub fn steps(&self) -> Steps<'_> {
        match &self.data {
            Data::One(number) => Steps::Constant(*number),
            _ => Steps::Each(self.flat()),
        }
    }

    /// Fails unless it is one number, or one for each of so many rows.
    pub fn fit(&mut self, argument: &str, count: usize) -> PyResult<()> {
        match self.leading.as_slice() {
            [] => Ok(()),
            [1] => self.spread(argument, &[count]),
            _ if self.leading == [count] => Ok(()),
            _ => Err(refuse_shape(argument, self.rule(&[count]), &self.leading)),
        }
    }

    /// All numbers as triples.
    pub fn triples(&self) -> &[[f64; 3]] {
        self.flat().as_chunks().0
    }

    /// Fails unless it has these leading axes.
    pub fn check_leading(&self, argument: &str, leading: &[usize]) -> PyResult<()> {
        let refused = || self.refuse_shape(argument, shape_text(&self.shape_over(leading)));
        if self.leading == leading { Ok(()) } else { Err(refused()) }
    }

    /// The error of rows in another shape than those that are wanted.
    pub fn refuse_shape(&self, argument: &str, wanted: impl Display) -> PyErr {
        refuse_shape(argument, format!("have shape {wanted}"), &self.shape())
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
        leading.iter().copied().chain(self.last).collect()
    }

    fn rule(&self, leading: &[usize]) -> String {
        let number = if self.last.is_none() { "be one number or " } else { "" };
        format!("{number}have shape {}", shape_text(&self.shape_over(leading)))
    }

    /// One number stays one.
    fn spread(&mut self, argument: &str, leading: &[usize]) -> PyResult<()> {
        let shape = self.shape_over(leading);
        if let Data::One(_) = self.data {
            return Ok(());
        }
        if let Data::Array(memory) = &self.data {
            let wide = repeated(&memory.source(&self.shape())?, &self.shape(), &shape)?;
            *self = Self::of(argument, &wide, self.last)?;
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

/// Lengths of the axes before the last one, which has this width.
pub(super) fn leading(argument: &str, array: &Bound<'_, PyUntypedArray>, width: usize) -> PyResult<Vec<usize>> {
    let rule = || format!("have shape (..., {width})");
    match array.shape().split_last() {
        Some((last, leading)) if *last == width => Ok(leading.to_vec()),
        Some(_) => Err(refuse_shape(argument, rule(), array.shape())),
        None => Err(refuse(argument, rule(), "a number")),
    }
}

/// True for an array that is C-contiguous, aligned and of native `f64`.
pub(super) fn is_flat(array: &Bound<'_, PyUntypedArray>) -> bool {
    let dtype = array.dtype();
    (dtype.kind(), dtype.itemsize()) == (b'f', size_of::<f64>())
        && dtype.is_native_byteorder() != Some(false)
        && array.is_c_contiguous()
        && array.is_aligned()
}

/// C-contiguous, aligned and of native `f64`: the memory of the array itself where it is that already, a copy
/// otherwise. What is copied is in use too: whether a result may go there does not depend on how it is laid out.
fn contiguous<'py>(argument: &str, array: &Bound<'py, PyUntypedArray>) -> PyResult<Memory<'py>> {
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
