//! Results on their way out: into fresh arrays or the caller's.

use std::ops::Range;

use numpy::ndarray::IxDyn;
use numpy::{
    Element, PyArray1, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyReadwriteArrayDyn,
    PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyList;

use super::{ArgumentTypeError, Array, Rows, numpy, refuse, shape_text};

/// A result on its way out: the caller's array, or a fresh one.
pub struct Output<'py> {
    array: Array<'py>,
    buffer: PyReadwriteArrayDyn<'py, f64>,
    copy: bool,
}

impl<'py> Output<'py> {
    /// The caller's `out`, checked, or a fresh array of this shape.
    pub fn new(
        py: Python<'py>,
        argument: &str,
        out: Option<&Bound<'py, PyAny>>,
        shape: &[usize],
        inputs: &[Option<&Rows<'py>>],
    ) -> PyResult<Self> {
        let fresh = || PyArrayDyn::<f64>::zeros(py, IxDyn(shape), false);
        let Some(out) = out else {
            let array = fresh();
            let buffer = array.readwrite();
            return Ok(Self {
                array,
                buffer,
                copy: false,
            });
        };
        let rule = || {
            format!(
                "be a writeable float64 array of shape {}",
                shape_text(shape)
            )
        };
        let array = out.cast::<PyArrayDyn<f64>>().map_err(|_| {
            let got = out.getattr("dtype").map_or_else(
                |_| out.get_type().to_string(),
                |dtype| format!("an array of dtype {dtype}"),
            );
            ArgumentTypeError::new_err(format!("{argument} must {}, got {got}", rule()))
        })?;
        if array.shape() != shape {
            return Err(refuse(
                argument,
                &rule(),
                &format!("shape {}", shape_text(array.shape())),
            ));
        }
        for source in inputs
            .iter()
            .flatten()
            .filter_map(|rows| rows.source.as_ref())
        {
            disjoint(argument, array.as_untyped(), source, "the input")?;
        }
        let copy = !(array.is_c_contiguous() && array.is_aligned());
        let target = if copy { fresh() } else { array.clone() };
        let read_only = |_| refuse(argument, &rule(), "a read-only array or one in use");
        let buffer = target.try_readwrite().map_err(read_only)?;
        if copy
            && !out
                .getattr("flags")?
                .getattr("writeable")?
                .extract::<bool>()?
        {
            return Err(refuse(argument, &rule(), "a read-only array"));
        }
        Ok(Self {
            array: array.clone(),
            buffer,
            copy,
        })
    }

    /// Where to write, row after row.
    pub fn flat(&mut self) -> &mut [f64] {
        // Fresh or checked in `new`: contiguous either way.
        self.buffer.as_slice_mut().unwrap_or_default()
    }

    /// Where to write, as triples.
    pub fn triples(&mut self) -> &mut [[f64; 3]] {
        self.flat().as_chunks_mut().0
    }

    /// The array to return.
    pub fn finish(self) -> PyResult<Array<'py>> {
        if self.copy {
            self.buffer.copy_to(&self.array)?;
        }
        Ok(self.array)
    }
}

/// Fails if two arrays share memory.
pub fn disjoint(
    argument: &str,
    array: &Bound<'_, PyUntypedArray>,
    other: &Bound<'_, PyUntypedArray>,
    name: &str,
) -> PyResult<()> {
    let (first, second) = (extent(array), extent(other));
    if first.end <= second.start || second.end <= first.start {
        return Ok(());
    }
    // Interleaved views need a closer look.
    let py = array.py();
    let shares = numpy(py)?.call_method1(intern!(py, "shares_memory"), (array, other))?;
    if shares.extract()? {
        let rule = format!("not overlap {name}");
        return Err(refuse(argument, &rule, "shared memory"));
    }
    Ok(())
}

/// The addresses between which the elements of an array lie.
fn extent(array: &Bound<'_, PyUntypedArray>) -> Range<usize> {
    // SAFETY: a live array object has a valid header; only the address is read, not what is there.
    let data = unsafe { (*array.as_array_ptr()).fields.data } as usize;
    if array.is_empty() {
        return data..data;
    }
    let (mut low, mut high) = (data, data + array.dtype().itemsize());
    for (length, stride) in array.shape().iter().zip(array.strides()) {
        let reach = (length - 1) * stride.unsigned_abs();
        if *stride < 0 {
            low -= reach;
        } else {
            high += reach;
        }
    }
    low..high
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

/// Items in nested lists of this shape; the only item itself if the shape is empty.
pub fn nested<'py>(
    py: Python<'py>,
    items: Vec<Bound<'py, PyAny>>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    let Some((_, inner)) = shape.split_first() else {
        return items
            .into_iter()
            .next()
            .ok_or_else(|| refuse("fit", "have a row", "none"));
    };
    let size = inner.iter().product::<usize>().max(1);
    let groups: Vec<_> = items
        .chunks(size)
        .map(|group| nested(py, group.to_vec(), inner))
        .collect::<PyResult<_>>()?;
    Ok(PyList::new(py, groups)?.into_any())
}
