//! Results on their way out: into fresh arrays or the caller's.

use numpy::npyffi::{NPY_ARRAY_WRITEABLE, PyArrayObject};
use numpy::{Element, PyArray1, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods, ndarray::IxDyn};
use pyo3::prelude::*;

use super::memory::{self, Held};
use super::{ArgumentTypeError, Array, refuse, shape_text};

/// Set on arrays that warn when they are written to.
const WARN_ON_WRITE: i32 = 1 << 31;

/// A result on its way out: the caller's array, or a fresh one.
pub struct Output<'py> {
    /// What is returned.
    array: Array<'py>,
    /// What is written to instead, where that is not contiguous.
    beside: Option<Array<'py>>,
    data: *mut f64,
    count: usize,
    _held: Option<Held>,
}

impl<'py> Output<'py> {
    /// A fresh array of this shape.
    pub fn fresh(py: Python<'py>, shape: &[usize]) -> PyResult<Self> {
        let array = memory::zeros(py, shape)?;
        Ok(Self {
            data: data(&array),
            count: memory::count(shape)?,
            array,
            beside: None,
            _held: None,
        })
    }

    /// The caller's `out`, checked, or a fresh array of this shape. Every argument that is read has to be read
    /// before: what is in use is not written to.
    pub fn new(
        py: Python<'py>,
        argument: &str,
        out: Option<&Bound<'py, PyAny>>,
        shape: &[usize],
    ) -> PyResult<Self> {
        let Some(out) = out else {
            return Self::fresh(py, shape);
        };
        let rule = || {
            format!(
                "be a writeable float64 array of shape {}",
                shape_text(shape)
            )
        };
        let array = out.cast::<PyArrayDyn<f64>>().map_err(|_| {
            let got = match out.cast::<numpy::PyUntypedArray>() {
                Ok(array) => format!("an array of dtype {}", array.dtype()),
                Err(_) => out.get_type().to_string(),
            };
            ArgumentTypeError::new_err(format!("{argument} must {}, got {got}", rule()))
        })?;
        if array.shape() != shape {
            let got = format!("shape {}", shape_text(array.shape()));
            return Err(refuse(argument, &rule(), &got));
        }
        // SAFETY: a live array object has a valid header.
        let flags = unsafe { (*array.as_array_ptr().cast::<PyArrayObject>()).fields.flags };
        if flags & (NPY_ARRAY_WRITEABLE | WARN_ON_WRITE) != NPY_ARRAY_WRITEABLE {
            return Err(refuse(argument, &rule(), "a read-only array or one in use"));
        }
        if !memory::places(array.as_untyped()).are_apart() {
            return Err(refuse(argument, "not overlap itself", "shared memory"));
        }
        let held = memory::write(argument, &rule(), array.as_untyped())?;
        let is_flat = array.is_c_contiguous() && array.is_aligned();
        let beside = (!is_flat).then(|| memory::zeros(py, shape)).transpose()?;
        Ok(Self {
            data: data(beside.as_ref().unwrap_or(array)),
            count: memory::count(shape)?,
            array: array.clone(),
            beside,
            _held: Some(held),
        })
    }

    /// Where to write, row after row.
    pub fn flat(&mut self) -> &mut [f64] {
        if self.count == 0 {
            return &mut [];
        }
        // SAFETY: so many aligned numbers were there when the array was checked or made; it is held, and with it its
        // memory. No other kernel reads or writes there (`memory`).
        unsafe { std::slice::from_raw_parts_mut(self.data, self.count) }
    }

    /// Where to write, as triples.
    pub fn triples(&mut self) -> &mut [[f64; 3]] {
        self.flat().as_chunks_mut().0
    }

    /// The array to return.
    pub fn finish(self) -> PyResult<Array<'py>> {
        if let Some(beside) = &self.beside {
            beside.copy_to(&self.array)?;
        }
        Ok(self.array)
    }
}

/// Where the numbers of an array begin.
fn data(array: &Array<'_>) -> *mut f64 {
    // SAFETY: a live array object has a valid header; only the address is taken here.
    unsafe { (*array.as_array_ptr().cast::<PyArrayObject>()).fields.data }.cast()
}

/// One value as a Python scalar, many as an array of this shape.
pub fn scalar_or_array<T: Element>(
    py: Python<'_>,
    values: Vec<T>,
    shape: &[usize],
) -> PyResult<Py<PyAny>> {
    let array = PyArray1::from_vec(py, values).reshape(IxDyn(shape))?;
    let result = if shape.is_empty() {
        array.call_method0("item")?
    } else {
        array.into_any()
    };
    Ok(result.unbind())
}
