//! Rows of numbers on their way in: whatever `numpy.asarray` takes, as slices of `f64`.

use std::borrow::Cow;
use std::fmt::Display;

use numpy::{PyArrayDescrMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyFloat;
use six_wheel_kinematics::geometry::Steps;
use six_wheel_numerics::error::{Error, LARGEST, bounded};
use six_wheel_numerics::sizes::are_below;

use super::array::{read_array, three_numbers};
use super::broadcast::Broadcast;
use super::errors::{OrRaise, refuse, refuse_shape, shape_text};
use super::memory::{self, Memory, repeated};
use super::numpy_module::numpy;

/// The name of an argument.
pub type Name = Cow<'static, str>;

pub(super) enum Data<'py> {
    One(f64),
    Three([f64; 3]),
    Array(Memory<'py>),
    Owned(Vec<f64>),
}

/// Rows of numbers, one after the other: leading axes are samples, the last axis has meaning.
pub struct Rows<'py> {
    pub(super) argument: Name,
    pub(super) data: Data<'py>,
    /// Lengths of the leading axes.
    pub leading: Vec<usize>,
    /// Length of the last axis; None where a row is one number, which has no axis of its own.
    pub(super) last: Option<usize>,
}

impl<'py> Rows<'py> {
    /// Reads whatever `numpy.asarray` takes. Three floats in a tuple or list never become an array.
    pub fn read(argument: impl Into<Name>, value: &Bound<'py, PyAny>, width: usize) -> PyResult<Self> {
        let argument = argument.into();
        if width == 3
            && let Some(three) = three_numbers(value)
        {
            return Ok(Self { argument, data: Data::Three(three), leading: Vec::new(), last: Some(width) });
        }
        let array = read_array(&argument, value)?;
        Self::of(argument, &array, Some(width))
    }

    /// The rows of an array of real numbers.
    pub(super) fn of(argument: Name, array: &Bound<'py, PyUntypedArray>, last: Option<usize>) -> PyResult<Self> {
        let leading = last.map_or_else(|| Ok(array.shape().to_vec()), |width| leading(&argument, array, width))?;
        Ok(Self { data: Data::Array(contiguous(&argument, array)?), argument, leading, last })
    }

    /// Reads a number or an array of numbers, one a row.
    pub fn read_numbers(argument: impl Into<Name>, value: &Bound<'py, PyAny>) -> PyResult<Self> {
        let argument = argument.into();
        if let Ok(float) = value.cast::<PyFloat>() {
            return Ok(Self::number(argument, float.value()));
        }
        let array = read_array(&argument, value)?;
        let mut numbers = Self::of(argument, &array, None)?;
        // The only number of an array is copied: the array may be written to.
        if let ([], &[number]) = (numbers.leading.as_slice(), numbers.flat()) {
            numbers.data = Data::One(number);
        }
        Ok(numbers)
    }

    /// One number.
    pub fn number(argument: impl Into<Name>, number: f64) -> Self {
        Self { argument: argument.into(), data: Data::One(number), leading: Vec::new(), last: None }
    }

    /// Reads rows of one of two widths; `rule` has both.
    pub fn read_either(
        argument: &'static str,
        value: &Bound<'py, PyAny>,
        widths: [usize; 2],
        rule: &str,
    ) -> PyResult<Self> {
        let array = read_array(argument, value)?;
        let Some(width) = widths.into_iter().find(|width| array.shape().last() == Some(width)) else {
            return Err(refuse_shape(argument, rule, array.shape()));
        };
        Self::of(argument.into(), &array, Some(width))
    }

    /// Reads an optional argument.
    pub fn read_optional(
        argument: &'static str,
        value: Option<&Bound<'py, PyAny>>,
        width: usize,
    ) -> PyResult<Option<Self>> {
        value.map(|value| Self::read(argument, value, width)).transpose()
    }

    /// Reads an optional argument that has one row per row of another one.
    pub fn read_beside(
        argument: &'static str,
        value: Option<&Bound<'py, PyAny>>,
        width: usize,
        leading: &[usize],
    ) -> PyResult<Option<Self>> {
        value.map(|value| Self::read(argument, value, width)?.over(leading)).transpose()
    }

    /// These rows; fails unless every number is finite.
    pub fn finite(self) -> PyResult<Self> {
        self.check_finite_where(|_| false).map(|()| self)
    }

    /// Fails unless every number is finite and smaller than [`LARGEST`]; a row that has no answer may also be NaN
    /// throughout.
    pub fn check_finite_where(&self, has_no_answer: impl Fn(usize) -> bool) -> PyResult<()> {
        if are_below(self.flat(), LARGEST) {
            return Ok(());
        }
        let named = |error: Error| Error { argument: self.argument.clone(), ..error };
        for (row, values) in self.flat().chunks_exact(self.width().max(1)).enumerate() {
            if !(values.iter().all(|value| value.is_nan()) && has_no_answer(row)) {
                bounded("", values).map_err(|error| named(error).at_row(row)).or_raise(&self.leading)?;
            }
        }
        Ok(())
    }

    /// These rows; fails unless they have these leading axes.
    pub fn over(self, leading: &[usize]) -> PyResult<Self> {
        if self.leading == leading { Ok(self) } else { Err(self.refuse_shape(shape_text(&self.shape_over(leading)))) }
    }

    /// These rows; fails unless they have one leading axis.
    pub fn table(self) -> PyResult<Self> {
        if self.leading.len() == 1 { Ok(self) } else { Err(self.refuse_shape(format!("(n, {})", self.width()))) }
    }

    /// The error of rows in another shape than those that are wanted.
    pub fn refuse_shape(&self, wanted: impl Display) -> PyErr {
        refuse_shape(&self.argument, format!("have shape {wanted}"), &self.shape())
    }

    /// Numbers of a row.
    pub fn width(&self) -> usize {
        self.last.unwrap_or(1)
    }

    /// Lengths of all axes.
    pub fn shape(&self) -> Vec<usize> {
        self.shape_over(&self.leading)
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
    pub fn fit(&mut self, count: usize) -> PyResult<()> {
        match self.leading.as_slice() {
            [] => Ok(()),
            [1] => self.spread(&[count]),
            _ if self.leading == [count] => Ok(()),
            _ => Err(refuse_shape(&self.argument, self.rule(&[count]), &self.leading)),
        }
    }

    /// All numbers as triples.
    pub fn triples(&self) -> &[[f64; 3]] {
        self.flat().as_chunks().0
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
    Ok(Rows::read(argument, value, 3)?.over(&[])?.finite()?.triples()[0])
}

/// Reads exactly `N` numbers.
pub fn numbers<const COUNT: usize>(argument: &'static str, value: &Bound<'_, PyAny>) -> PyResult<[f64; COUNT]> {
    let row = Rows::read(argument, value, COUNT)?.over(&[])?;
    Ok(std::array::from_fn(|place| row.flat()[place]))
}

impl Broadcast for Rows<'_> {
    fn argument(&self) -> &str {
        &self.argument
    }

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
    fn spread(&mut self, leading: &[usize]) -> PyResult<()> {
        let shape = self.shape_over(leading);
        if let Data::One(_) = self.data {
            return Ok(());
        }
        if let Data::Array(memory) = &self.data {
            let wide = repeated(&memory.source(&self.shape())?, &self.shape(), &shape)?;
            *self = Self::of(self.argument.clone(), &wide, self.last)?;
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
