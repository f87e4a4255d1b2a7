//! Arrays in any memory order and of any real dtype, read a few numbers at a time.
//!
//! It follows raw pointers into an array. It reads bytes, so nothing depends on alignment, and
//! it never leaves the extent that shape and strides span.

use numpy::{PyArrayDescrMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;
use six_wheel_kinematics::table::Source;

use super::memory;

/// The format of a number.
#[derive(Clone, Copy, Debug)]
enum Form {
    Float16,
    Float32,
    Float64,
    Int8,
    Int16,
    Int32,
    Int64,
    Uint8,
    Uint16,
    Uint32,
    Uint64,
}

/// The layout of the numbers of an array. Only good while the array is.
#[derive(Debug)]
pub struct Strided {
    data: *const u8,
    shape: Vec<usize>,
    strides: Vec<isize>,
    form: Form,
    /// True if the bytes are in the order of other machines.
    swapped: bool,
}

// SAFETY: it only reads, and nothing of it is tied to a thread. Whoever writes to the array meanwhile gets what
// NumPy itself gives: numbers half old, half new.
unsafe impl Send for Strided {}
// SAFETY: likewise.
unsafe impl Sync for Strided {}

impl Strided {
    /// Nothing for dtypes that NumPy has to convert. The array must outlive what is returned, and keep its
    /// memory: hold a reference to it.
    pub fn of(array: &Bound<'_, PyUntypedArray>) -> Option<Self> {
        let dtype = array.dtype();
        let form = match (dtype.kind(), dtype.itemsize()) {
            (b'f', 2) => Form::Float16,
            (b'f', 4) => Form::Float32,
            (b'f', 8) => Form::Float64,
            (b'i', 1) => Form::Int8,
            (b'i', 2) => Form::Int16,
            (b'i', 4) => Form::Int32,
            (b'i', 8) => Form::Int64,
            (b'u', 1) => Form::Uint8,
            (b'u', 2) => Form::Uint16,
            (b'u', 4) => Form::Uint32,
            (b'u', 8) => Form::Uint64,
            _ => return None,
        };
        // SAFETY: a live array object has a valid header; only the address is taken here.
        let data = unsafe { (*array.as_array_ptr()).fields.data }.cast_const().cast();
        Some(Self {
            data,
            shape: array.shape().to_vec(),
            strides: array.strides().to_vec(),
            form,
            swapped: dtype.is_native_byteorder() == Some(false),
        })
    }

    /// All numbers in C order.
    pub fn all(&self) -> PyResult<Vec<f64>> {
        let mut all = memory::filled(0.0, memory::count(&self.shape)?)?;
        self.read(0, &mut all);
        Ok(all)
    }

    /// Reads numbers of `N` bytes each.
    fn read_as<const N: usize>(&self, first: usize, target: &mut [f64], number: impl Fn([u8; N]) -> f64) {
        let Some((&width, outer)) = self.shape.split_last() else {
            return;
        };
        let size = outer.iter().product::<usize>() * width;
        if size < first || size - first < target.len() {
            return; // it would lead out of the array
        }
        let step = self.strides[outer.len()];
        // Rows along the last but one axis lie at one distance: only where they end is a place looked up.
        let (rows, line) = match outer.len().checked_sub(1) {
            Some(axis) => (outer[axis], self.strides[axis]),
            None => (1, 0),
        };
        let (mut index, mut target) = (first, target);
        while !target.is_empty() {
            let (mut row, mut column) = (index / width, index % width);
            let run = target.len().min((rows - row % rows) * width - column);
            let mut beginning = 0;
            for (length, stride) in outer.iter().zip(&self.strides).rev() {
                beginning += (row % length) as isize * stride;
                row /= length;
            }
            let (now, later) = target.split_at_mut(run);
            for value in now {
                let place = beginning + column as isize * step;
                // SAFETY: numbers `first` to `first + target.len()` are in the array, so along every axis the
                // index of this place is below the length. Bytes may lie at any address.
                let bytes = unsafe { self.data.offset(place).cast::<[u8; N]>().read() };
                *value = number(bytes);
                column += 1;
                if column == width {
                    column = 0;
                    beginning += line;
                }
            }
            index += run;
            target = later;
        }
    }
}

/// A float of 16 bits.
fn float16(bits: u16) -> f64 {
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023));
    let size = match exponent {
        0 => fraction * 2.0_f64.powi(-24),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1024.0 + fraction) * 2.0_f64.powi(exponent - 25),
    };
    if bits >> 15 == 1 { -size } else { size }
}

impl Source for Strided {
    fn read(&self, first: usize, target: &mut [f64]) {
        let swapped = self.swapped;
        macro_rules! read {
            ($number: ty, $into: expr) => {
                self.read_as(first, target, |mut bytes| {
                    if swapped {
                        bytes.reverse();
                    }
                    $into(<$number>::from_ne_bytes(bytes))
                })
            };
        }
        match self.form {
            Form::Float16 => read!(u16, float16),
            Form::Float32 => read!(f32, f64::from),
            Form::Float64 => read!(f64, f64::from),
            Form::Int8 => read!(i8, f64::from),
            Form::Int16 => read!(i16, f64::from),
            Form::Int32 => read!(i32, f64::from),
            Form::Int64 => read!(i64, |value| value as f64),
            Form::Uint8 => read!(u8, f64::from),
            Form::Uint16 => read!(u16, f64::from),
            Form::Uint32 => read!(u32, f64::from),
            Form::Uint64 => read!(u64, |value| value as f64),
        }
    }
}
