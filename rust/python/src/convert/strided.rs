//! Arrays in any memory order and of any real dtype, read a few numbers at a time.
//!
//! It follows raw pointers into an array. It reads bytes, so nothing depends on alignment, and
//! it never leaves the extent that shape and strides span.

use numpy::{PyArrayDescrMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;
use six_wheel_kinematics::table::Source;

use super::memory;

/// Numbers `first` and on of an array, read into a slice.
type Reader = fn(&Strided, usize, &mut [f64]);

/// The layout of the numbers of an array. Only good while the array is.
#[derive(Debug)]
pub struct Strided {
    data: *const u8,
    shape: Vec<usize>,
    strides: Vec<isize>,
    reader: Reader,
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
        macro_rules! number {
            ($number:ty) => {
                |array, first, target| array.read_as(first, target, |bytes| <$number>::from_ne_bytes(bytes) as f64)
            };
        }
        let reader: Reader = match (dtype.kind(), dtype.itemsize()) {
            (b'f', 2) => {
                |array, first, target| array.read_as(first, target, |bytes| float16(u16::from_ne_bytes(bytes)))
            }
            (b'f', 4) => number!(f32),
            (b'f', 8) => number!(f64),
            (b'i', 1) => number!(i8),
            (b'i', 2) => number!(i16),
            (b'i', 4) => number!(i32),
            (b'i', 8) => number!(i64),
            (b'u', 1) => number!(u8),
            (b'u', 2) => number!(u16),
            (b'u', 4) => number!(u32),
            (b'u', 8) => number!(u64),
            _ => return None,
        };
        // SAFETY: a live array object has a valid header; only the address is taken here.
        let data = unsafe { (*array.as_array_ptr()).fields.data }.cast_const().cast();
        Some(Self {
            data,
            shape: array.shape().to_vec(),
            strides: array.strides().to_vec(),
            reader,
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
        let (mut index, mut target, swapped) = (first, target, self.swapped);
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
                let mut bytes = unsafe { self.data.offset(place).cast::<[u8; N]>().read() };
                if swapped {
                    bytes.reverse();
                }
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
        (self.reader)(self, first, target);
    }
}

/// Keeps the numbers that this thread reads, before code of the caller's runs, which may change them.
pub(super) fn keep_read(py: Python<'_>) -> PyResult<()> {
    memory::keep(py, |array| Strided::of(array).map(|strided| strided.all()).transpose())
}
