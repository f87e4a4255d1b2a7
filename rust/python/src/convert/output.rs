//! Results on their way out: into fresh arrays or the caller's.

use numpy::npyffi::{NPY_ARRAY_WRITEABLE, PyArrayObject};
use numpy::{
    Element, PyArray1, PyArrayDescr, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyUntypedArray,
    PyUntypedArrayMethods, ndarray::IxDyn,
};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString, PyType};

use super::errors::{refuse, refuse_shape, refuse_type, shape_text, short_repr};
use super::memory::{self, BorrowedArray};
use super::numpy_module::{Array, numpy, ready};
use super::strided;

/// Set on arrays that warn when they are written to.
const WARN_ON_WRITE: i32 = 1 << 31;

/// The precision of a result, which is computed in `f64` either way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    Double,
    Single,
}

impl Precision {
    /// Reads `dtype=`, or takes that of the arrays to write to.
    pub fn read(
        py: Python<'_>,
        dtype: Option<&Bound<'_, PyAny>>,
        out: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Option<Self>> {
        let Some(dtype) = dtype else { return Ok(None) };
        let rule = "be float64 or float32";
        if !dtype.is_instance_of::<PyString>() && !dtype.is_instance_of::<PyType>() {
            strided::keep_read(py)?; // it may run code of the caller's
        }
        let known = numpy(py)?.call_method1(intern!(py, "dtype"), (dtype,));
        let known = known.map_err(|_| refuse("dtype", rule, short_repr(dtype)))?;
        let known = known.cast_into::<PyArrayDescr>()?;
        if out.is_some() {
            return Err(refuse("dtype", "be left out with out, which has its own", known));
        }
        match (known.kind(), known.itemsize(), known.is_native_byteorder()) {
            (b'f', 8, Some(true)) => Ok(Some(Self::Double)),
            (b'f', 4, Some(true)) => Ok(Some(Self::Single)),
            _ => Err(refuse("dtype", rule, known)),
        }
    }
}

/// `out=` and `dtype=` of a call.
pub type OutputOptions<'a, 'py> = (Option<&'a Bound<'py, PyAny>>, Option<&'a Bound<'py, PyAny>>);

/// A result on its way out: the caller's array, or a fresh one.
pub struct Output<'py> {
    /// The array that is returned.
    array: Bound<'py, PyUntypedArray>,
    /// The array that is written to instead, if the returned one is not contiguous or not of `f64`.
    beside: Option<Array<'py>>,
    data: *mut f64,
    count: usize,
    held: Option<BorrowedArray>,
}

impl<'py> Output<'py> {
    /// A fresh array of this shape.
    pub fn fresh(py: Python<'py>, shape: &[usize]) -> PyResult<Self> {
        Self::with(memory::fresh(py, shape)?.as_untyped().clone(), None, None)
    }

    /// An array, and the one that is written to instead; without one it is contiguous and of `f64`.
    fn with(
        array: Bound<'py, PyUntypedArray>,
        beside: Option<Array<'py>>,
        held: Option<BorrowedArray>,
    ) -> PyResult<Self> {
        let data = data(beside.as_ref().map_or(&array, |beside| beside.as_untyped()));
        Ok(Self { data, count: memory::count(array.shape())?, array, beside, held })
    }

    /// A result where `out=` says, or of the precision that `dtype=` says.
    pub fn asked(py: Python<'py>, (out, dtype): OutputOptions<'_, 'py>, shape: &[usize]) -> PyResult<Self> {
        let precision = Precision::read(py, dtype, out)?;
        Self::of(py, "out", out, precision, shape)
    }

    /// A result of either precision: the caller's `out`, which has its own, or a fresh array of what `dtype` says.
    pub fn of(
        py: Python<'py>,
        argument: &str,
        out: Option<&Bound<'py, PyAny>>,
        precision: Option<Precision>,
        shape: &[usize],
    ) -> PyResult<Self> {
        ready(py)?;
        if let Some(out) = out {
            return Self::into(py, argument, out, shape);
        }
        if precision != Some(Precision::Single) {
            return Self::fresh(py, shape);
        }
        memory::count(shape)?;
        let zeros = numpy(py)?.call_method1(intern!(py, "zeros"), (shape.to_vec(), "f"))?;
        Self::with(zeros.cast_into()?, Some(memory::fresh(py, shape)?), None)
    }

    /// Into the caller's array of `f64` or `f32`, checked. Every argument that is read has to be read before: what is in use
    /// is not written to.
    fn into(py: Python<'py>, argument: &str, out: &Bound<'py, PyAny>, shape: &[usize]) -> PyResult<Self> {
        let rule = || rule(shape);
        let flat = out.cast::<PyArrayDyn<f64>>().ok();
        let array = match out.cast::<PyUntypedArray>() {
            Ok(array) if flat.is_some() || out.cast::<PyArrayDyn<f32>>().is_ok() => array,
            Ok(array) => return Err(refuse_type(argument, rule(), format!("an array of dtype {}", array.dtype()))),
            Err(_) => return Err(refuse_type(argument, rule(), out.get_type())),
        };
        if array.shape() != shape {
            return Err(refuse_shape(argument, rule(), array.shape()));
        }
        // SAFETY: a live array object has a valid header.
        let flags = unsafe { (*array.as_array_ptr().cast::<PyArrayObject>()).fields.flags };
        if flags & (NPY_ARRAY_WRITEABLE | WARN_ON_WRITE) != NPY_ARRAY_WRITEABLE {
            return Err(refuse(argument, rule(), "a read-only array or one in use"));
        }
        if !memory::places(array).are_apart() {
            return Err(refuse(argument, "not overlap itself", "shared memory"));
        }
        let held = memory::write(argument, rule, array)?;
        let is_flat = flat.is_some_and(|array| array.is_c_contiguous() && array.is_aligned());
        let beside = if is_flat { None } else { Some(memory::fresh(py, shape)?) };
        Self::with(array.clone(), beside, Some(held))
    }

    /// True if the caller does not see what a failing call has written: a fresh array, or one beside the caller's.
    pub fn is_unseen(&self) -> bool {
        self.beside.is_some() || self.held.is_none()
    }

    /// Written to the caller's array only when it is finished.
    pub fn beside(mut self) -> PyResult<Self> {
        if self.beside.is_none() {
            let beside = memory::fresh(self.array.py(), self.array.shape())?;
            self.data = data(beside.as_untyped());
            self.beside = Some(beside);
        }
        Ok(self)
    }

    /// The memory to write to, row after row.
    pub fn flat(&mut self) -> &mut [f64] {
        if self.count == 0 {
            return &mut [];
        }
        // SAFETY: so many aligned numbers were there when the array was checked or made; it is held, and with it its
        // memory. No other kernel reads or writes there (`memory`).
        unsafe { std::slice::from_raw_parts_mut(self.data, self.count) }
    }

    /// The memory to write to, as triples.
    pub fn triples(&mut self) -> &mut [[f64; 3]] {
        self.flat().as_chunks_mut().0
    }

    /// The array to return, of whatever precision.
    pub fn finish_any(self) -> PyResult<Bound<'py, PyUntypedArray>> {
        let Some(beside) = &self.beside else { return Ok(self.array) };
        let py = beside.py();
        let copied = |module: &Bound<'py, PyModule>| {
            let keywords = PyDict::new(py);
            keywords.set_item(intern!(py, "casting"), intern!(py, "same_kind"))?;
            module.call_method(intern!(py, "copyto"), (&self.array, beside), Some(&keywords))
        };
        copied(numpy(py)?)?;
        Ok(self.array)
    }

    /// The array to return, or the only number that it holds where the caller has no array for it.
    pub fn finish_number(self, out: Option<&Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
        let array = self.finish_any()?;
        if array.ndim() == 0 && out.is_none() {
            return array.call_method0(intern!(array.py(), "item"));
        }
        Ok(array.into_any())
    }

    /// The array to return, as an object of any type.
    pub fn finish_object(self) -> PyResult<Py<PyAny>> {
        Ok(self.finish_any()?.into_any().unbind())
    }

    /// The array to return, which is of `f64`.
    pub fn finish(self) -> PyResult<Array<'py>> {
        Ok(self.finish_any()?.cast_into()?)
    }
}

fn rule(shape: &[usize]) -> String {
    format!("be a writeable float64 array of shape {}", shape_text(shape))
}

/// The address of the first number of an array.
fn data(array: &Bound<'_, PyUntypedArray>) -> *mut f64 {
    // SAFETY: a live array object has a valid header; only the address is taken here.
    unsafe { (*array.as_array_ptr().cast::<PyArrayObject>()).fields.data }.cast()
}

/// One value as a Python scalar, many as an array of this shape.
pub fn scalar_or_array<T: Element>(py: Python<'_>, values: Vec<T>, shape: &[usize]) -> PyResult<Py<PyAny>> {
    let array = PyArray1::from_vec(py, values).reshape(IxDyn(shape))?;
    let result = if shape.is_empty() { array.call_method0("item")? } else { array.into_any() };
    Ok(result.unbind())
}
