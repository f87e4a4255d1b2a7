//! One number, or one for each row.

use numpy::{PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyFloat;
use six_wheel_kinematics::geometry::Steps;

use super::array::read_array;
use super::broadcast::Broadcast;
use super::errors::{check_finite, refuse_shape, shape_text};
use super::input::contiguous;
use super::memory::{Memory, repeated};

/// One number, or one per row.
pub struct Scalars<'py> {
    one: f64,
    each: Option<Memory<'py>>,
    /// The shape: empty for one number.
    pub shape: Vec<usize>,
}

impl<'py> Scalars<'py> {
    /// Reads a number or an array of numbers.
    pub fn read(argument: &str, value: &Bound<'py, PyAny>) -> PyResult<Self> {
        if let Ok(float) = value.cast::<PyFloat>() {
            return Ok(Self { one: float.value(), each: None, shape: Vec::new() });
        }
        Self::of(argument, &read_array(argument, value)?)
    }

    /// Reads a finite number or an array of finite numbers.
    pub fn read_finite(argument: &'static str, value: &Bound<'py, PyAny>) -> PyResult<Self> {
        let scalars = Self::read(argument, value)?;
        scalars.check_finite(argument).map(|()| scalars)
    }

    /// The numbers of an array of real ones.
    fn of(argument: &str, array: &Bound<'py, PyUntypedArray>) -> PyResult<Self> {
        let shape = array.shape().to_vec();
        let memory = contiguous(argument, array)?;
        let (one, each) = match memory.numbers() {
            [one] if shape.is_empty() => (*one, None),
            _ => (0.0, Some(memory)),
        };
        Ok(Self { one, each, shape })
    }

    /// The numbers as durations.
    pub fn steps(&self) -> Steps<'_> {
        match &self.each {
            None => Steps::Constant(self.one),
            Some(each) => Steps::Each(each.numbers()),
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
            Some(each) => each.numbers(),
        }
    }

    /// Fails unless every number is finite.
    pub fn check_finite(&self, argument: &'static str) -> PyResult<()> {
        check_finite(argument, self.flat(), 1, &self.shape, |_| false)
    }

    /// Fails unless it has this shape.
    pub fn fit_exactly(&self, argument: &str, shape: &[usize]) -> PyResult<()> {
        if self.shape == shape {
            return Ok(());
        }
        Err(refuse_shape(argument, &format!("have shape {}", shape_text(shape)), &self.shape))
    }

    /// Fails unless it is one number, or one for each row.
    pub fn fit(&mut self, argument: &str, count: usize) -> PyResult<()> {
        if self.shape.is_empty() || self.shape == [count] {
            return Ok(());
        }
        if self.shape == [1] {
            return self.spread(argument, &[count]);
        }
        Err(refuse_shape(argument, &self.rule(&[count]), &self.shape))
    }
}

impl Broadcast for Scalars<'_> {
    fn leading(&self) -> &[usize] {
        &self.shape
    }

    fn shape_over(&self, leading: &[usize]) -> Vec<usize> {
        leading.to_vec()
    }

    fn rule(&self, leading: &[usize]) -> String {
        format!("be one number or have shape {}", shape_text(leading))
    }

    /// One number stays one.
    fn spread(&mut self, argument: &str, leading: &[usize]) -> PyResult<()> {
        if let Some(each) = &self.each {
            *self = Self::of(argument, &repeated(&each.source(&self.shape)?, &self.shape, leading)?)?;
        }
        Ok(())
    }
}
