//! Rows of numbers that stay in the caller's memory, whatever its order.

use numpy::{PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;
use six_wheel_kinematics::table::Table;

use super::array::{read_array, three_numbers};
use super::broadcast::{Broadcast, joined};
use super::input::{Data, Name, Rows, is_flat, leading};
use super::memory::{self, BorrowedArray, repeated};
use super::strided::Strided;

/// Numbers from which an array in another form is read block by block.
const MANY: usize = 1 << 15;

/// Rows that need not be one after the other: those of a large array in another form are read block by block.
pub enum Blocks<'py> {
    /// As the kernels take them.
    Flat(Rows<'py>),
    /// To be read a block at a time.
    Strided {
        argument: Name,
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
    pub fn read(argument: &'static str, value: &Bound<'py, PyAny>, width: usize) -> PyResult<Self> {
        if width == 3 && three_numbers(value).is_some() {
            return Rows::read(argument, value, width).map(Self::Flat);
        }
        Self::of(argument.into(), &read_array(argument, value)?, width)
    }

    /// Reads an optional argument.
    pub fn read_optional(
        argument: &'static str,
        value: Option<&Bound<'py, PyAny>>,
        width: usize,
    ) -> PyResult<Option<Self>> {
        value.map(|value| Self::read(argument, value, width)).transpose()
    }

    fn of(argument: Name, array: &Bound<'py, PyUntypedArray>, width: usize) -> PyResult<Self> {
        if array.len() >= MANY
            && !is_flat(array)
            && let Some(strided) = Strided::of(array)
        {
            return Ok(Self::Strided {
                strided,
                leading: leading(&argument, array, width)?,
                width,
                array: array.clone(),
                held: memory::read(&argument, array)?,
                argument,
            });
        }
        Rows::of(argument, array, Some(width)).map(Self::Flat)
    }

    fn name(&self) -> &Name {
        match self {
            Self::Flat(Rows { argument, .. }) | Self::Strided { argument, .. } => argument,
        }
    }

    fn width(&self) -> usize {
        match self {
            Self::Flat(rows) => rows.width(),
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
    pub fn flat(self) -> PyResult<Rows<'py>> {
        match self {
            Self::Flat(rows) => Ok(rows),
            Self::Strided { ref argument, ref array, ref held, width, .. } => {
                Rows::of(argument.clone(), &held.source(array, &self.shape())?, Some(width))
            }
        }
    }

    /// The array that is read, if one is, and what holds it.
    fn array(&self) -> Option<(&Bound<'py, PyUntypedArray>, &BorrowedArray)> {
        match self {
            Self::Flat(Rows { data: Data::Array(memory), .. }) => Some((&memory.array, &memory.held)),
            Self::Strided { array, held, .. } => Some((array, held)),
            Self::Flat(_) => None,
        }
    }

    /// Lets go of the caller's array by copying it, so that the array may also be written to.
    pub fn release_if(&mut self, written: &Bound<'py, PyAny>) -> PyResult<()> {
        if !self.array().is_some_and(|(array, _)| array.is(written)) {
            return Ok(());
        }
        let numbers = match self {
            Self::Flat(rows) => memory::gathered(rows.flat().iter().copied())?,
            Self::Strided { strided, held, .. } => match held.kept() {
                Some(kept) => memory::gathered(kept.iter().copied())?,
                None => strided.all()?,
            },
        };
        let (argument, leading, last) = (self.name().clone(), self.leading().to_vec(), Some(self.width()));
        *self = Self::Flat(Rows { argument, data: Data::Owned(numbers), leading, last });
        Ok(())
    }
}

impl Broadcast for Blocks<'_> {
    fn argument(&self) -> &str {
        self.name()
    }

    fn leading(&self) -> &[usize] {
        match self {
            Self::Flat(rows) => &rows.leading,
            Self::Strided { leading, .. } => leading,
        }
    }

    fn shape_over(&self, leading: &[usize]) -> Vec<usize> {
        joined(leading, self.width())
    }

    fn spread(&mut self, leading: &[usize]) -> PyResult<()> {
        if let Some((array, held)) = self.array() {
            let wide = repeated(&held.source(array, &self.shape())?, &self.shape(), &self.shape_over(leading))?;
            *self = Self::of(self.name().clone(), &wide, self.width())?;
        } else if let Self::Flat(rows) = self {
            rows.spread(leading)?;
        }
        Ok(())
    }
}
