//! Arguments of a batch in the caller's memory: rows that the kernels take directly, or rows that are read a block at a
//! time.

use std::fmt;
use std::ops::Range;

use crate::estimate::Readings;
use crate::geometry::{Steps, wrong_steps};
use crate::rover_data::{Inputs, OptionalInputs, RoverData};
use six_wheel_numerics::error::Error;
use six_wheel_numerics::sizes;

/// Rows of numbers.
#[derive(Clone, Copy)]
pub enum Table<'a> {
    /// Row after row.
    Flat(&'a [f64]),
    /// In any other order or type, to be read.
    Read(&'a dyn Source),
}

/// An array that can be read as rows of numbers, by several threads at once.
pub trait Source: Sync {
    /// Fills `target` with the numbers from number `first` on.
    fn read(&self, first: usize, target: &mut [f64]);
}

impl fmt::Debug for Table<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flat(values) => f.debug_tuple("Flat").field(&values.len()).finish(),
            Self::Read(_) => f.write_str("Read"),
        }
    }
}

impl<'a> Table<'a> {
    /// True if it has to be read.
    pub(crate) fn is_read(self) -> bool {
        matches!(self, Self::Read(_))
    }

    /// Rows of `width` numbers.
    pub fn rows<'b>(self, rows: Range<usize>, width: usize, buffer: &'b mut Vec<f64>) -> &'b [f64]
    where
        'a: 'b,
    {
        self.get(rows.start * width, rows.end * width, buffer)
    }

    /// The numbers from `first` to `end`; they are in the buffer if they have to be read.
    pub fn get<'b>(self, first: usize, end: usize, buffer: &'b mut Vec<f64>) -> &'b [f64]
    where
        'a: 'b,
    {
        match self {
            Self::Flat(values) => &values[first..end],
            Self::Read(source) => {
                buffer.resize(end - first, 0.0);
                source.read(first, buffer);
                buffer
            }
        }
    }
}

impl<'a> From<&'a [f64]> for Table<'a> {
    fn from(values: &'a [f64]) -> Self {
        Self::Flat(values)
    }
}

impl<'a, const N: usize> From<&'a [[f64; N]]> for Table<'a> {
    fn from(rows: &'a [[f64; N]]) -> Self {
        Self::Flat(rows.as_flattened())
    }
}

impl<'a, const N: usize, const M: usize> From<&'a [[f64; N]; M]> for Table<'a> {
    fn from(rows: &'a [[f64; N]; M]) -> Self {
        Self::Flat(rows.as_flattened())
    }
}

impl<'a, const N: usize> From<&'a Vec<[f64; N]>> for Table<'a> {
    fn from(rows: &'a Vec<[f64; N]>) -> Self {
        Self::Flat(rows.as_flattened())
    }
}

/// [`Inputs`] of a batch.
pub type InputTables<'a> = OptionalInputs<Table<'a>>;

impl<'a> From<Inputs<'a>> for InputTables<'a> {
    fn from(inputs: Inputs<'a>) -> Self {
        Self {
            previous: inputs.previous.map(Table::Flat),
            previous_speeds: inputs.previous_speeds.map(Table::Flat),
            steering_rates: inputs.steering_rates.map(Table::Flat),
        }
    }
}

/// Readings of many instants, row after row.
pub type Log<'a> = Readings<&'a [f64]>;

impl<'a> From<Log<'a>> for Readings<Table<'a>> {
    fn from(log: Log<'a>) -> Self {
        Self {
            steering: Table::Flat(log.steering),
            speeds: Table::Flat(log.speeds),
            steering_rates: log.steering_rates.map(Table::Flat),
        }
    }
}

/// [`Steps`] that may have to be read.
#[derive(Clone, Copy, Debug)]
pub enum Durations<'a> {
    /// Every step takes the same time [s].
    Constant(f64),
    /// The number of durations, one per step [s].
    Each(Table<'a>, usize),
}

impl<'a> From<Steps<'a>> for Durations<'a> {
    fn from(steps: Steps<'a>) -> Self {
        match steps {
            Steps::Constant(dt) => Self::Constant(dt),
            Steps::Each(dts) => Self::Each(Table::Flat(dts), dts.len()),
        }
    }
}

impl<'a> Durations<'a> {
    /// The durations from step `first` to `end`.
    pub fn get<'b>(self, first: usize, end: usize, buffer: &'b mut Vec<f64>) -> Steps<'b>
    where
        'a: 'b,
    {
        match self {
            Self::Constant(dt) => Steps::Constant(dt),
            Self::Each(table, _) => Steps::Each(table.get(first, end, buffer)),
        }
    }

    /// [`Steps::check`]; returns the longest duration [s].
    pub fn check(self, count: usize, block: usize) -> Result<f64, Error> {
        let (table, length) = match self {
            Self::Each(table, length) if length == count => (table, length),
            Self::Each(_, length) => return Err(wrong_steps(count, length)),
            Self::Constant(dt) => return Steps::Constant(dt).check(count).map(|()| dt),
        };
        let mut buffer = Vec::new();
        let mut longest = 0.0_f64;
        for first in (0..length).step_by(block) {
            let end = length.min(first + block);
            let dts = table.get(first, end, &mut buffer);
            longest = longest.max(match sizes::longest(dts) {
                Some(here) => here,
                None => {
                    Steps::Each(dts).check(dts.len()).map_err(|error| error.below(first))?;
                    dts.iter().copied().fold(0.0, f64::max)
                }
            });
        }
        Ok(longest)
    }
}

impl<'a> Inputs<'a> {
    /// The inputs of one row of a batch.
    pub fn row(&self, rover: &RoverData, k: usize) -> Self {
        let (joints, wheels) = (rover.steered().len(), rover.wheels().len());
        let at = |values: Option<&'a [f64]>, width| values.map(|values| row(values, width, k));
        Self {
            previous: at(self.previous, joints),
            previous_speeds: at(self.previous_speeds, wheels),
            steering_rates: at(self.steering_rates, joints),
        }
    }
}

impl<'a> Log<'a> {
    /// The readings of these rows.
    pub fn rows(&self, rover: &RoverData, rows: Range<usize>) -> Self {
        let (joints, wheels) = (rover.steered().len(), rover.wheels().len());
        let of = |values: &'a [f64], width| &values[rows.start * width..rows.end * width];
        Self {
            steering: of(self.steering, joints),
            speeds: of(self.speeds, wheels),
            steering_rates: self.steering_rates.map(|rates| of(rates, joints)),
        }
    }

    /// The readings of one row.
    pub fn row(&self, rover: &RoverData, k: usize) -> Self {
        self.rows(rover, k..k + 1)
    }
}

pub(crate) fn row(values: &[f64], width: usize, k: usize) -> &[f64] {
    &values[k * width..(k + 1) * width]
}

pub(crate) fn row_mut(values: &mut [f64], width: usize, k: usize) -> &mut [f64] {
    &mut values[k * width..(k + 1) * width]
}
