//! `out=` of calls with several results.

use std::borrow::Cow;

use pyo3::prelude::*;
use pyo3::types::PyTuple;

use super::errors::refuse;
use super::numpy_module::AnyArray;
use super::output::{Output, Precision};

/// The arrays of `out=`: the results in their order, as many as there are; the others are fresh, as are those that are None.
pub struct Out<'py, const N: usize> {
    arrays: [Option<Bound<'py, PyAny>>; N],
    /// Names of the arrays in errors; None: `out[0]` and so on, or `out` for one array instead of a tuple.
    labels: Option<[&'static str; N]>,
    is_alone: bool,
}

impl<'py, const N: usize> Out<'py, N> {
    fn fresh() -> Self {
        Self { arrays: [const { None }; N], labels: None, is_alone: false }
    }

    /// Of results with these names, one array instead of a tuple being the first of them: where that one is what is asked for.
    pub fn read_or_first(out: Option<&Bound<'py, PyAny>>, names: [&str; N]) -> PyResult<Self> {
        match out {
            Some(array) if !array.is_instance_of::<PyTuple>() => {
                let mut read = Self { is_alone: true, ..Self::fresh() };
                read.arrays[0] = Some(array.clone());
                Ok(read)
            }
            _ => Self::read(out, names),
        }
    }

    /// Of a tuple that has to hold an array for every result, which have these labels.
    pub fn read_all(out: Option<&Bound<'py, PyAny>>, labels: [&'static str; N], rule: &str) -> PyResult<Self> {
        let mut read = Self { labels: Some(labels), ..Self::fresh() };
        let Some(out) = out else { return Ok(read) };
        let Some(tuple) = out.cast::<PyTuple>().ok().filter(|tuple| tuple.len() == N) else {
            return Err(refuse("out", rule, out.get_type().name()?));
        };
        read.arrays = std::array::from_fn(|k| tuple.get_item(k).ok());
        Ok(read)
    }

    /// Of results with these names.
    pub fn read(out: Option<&Bound<'py, PyAny>>, names: [&str; N]) -> PyResult<Self> {
        let mut read = Self::fresh();
        let Some(out) = out else { return Ok(read) };
        let wrong = |rule: &str, got: &str| {
            refuse("out", format!("{rule} for ({}) or the first of these", names.join(", ")), got)
        };
        let Ok(tuple) = out.cast::<PyTuple>() else {
            let got = out.get_type().name()?.to_string();
            return Err(wrong("be a tuple of arrays", &got));
        };
        if tuple.is_empty() || tuple.len() > N {
            return Err(wrong("be arrays", &format!("{} of them", tuple.len())));
        }
        for (array, item) in read.arrays.iter_mut().zip(tuple.iter()) {
            *array = (!item.is_none()).then_some(item);
        }
        Ok(read)
    }

    /// The caller's array for a result.
    pub fn array(&self, k: usize) -> Option<&Bound<'py, PyAny>> {
        self.arrays[k].as_ref()
    }

    /// True if the caller has an array for any result.
    pub fn is_given(&self) -> bool {
        self.arrays.iter().any(Option::is_some)
    }

    fn label(&self, k: usize) -> Cow<'static, str> {
        match self.labels {
            Some(labels) => labels[k].into(),
            None if self.is_alone => "out".into(),
            None => format!("out[{k}]").into(),
        }
    }

    /// The results, of these shapes and of this precision where an array is fresh. `fails`: the call may yet fail, and the
    /// caller's arrays are written only when it has not.
    pub fn results(
        self,
        py: Python<'py>,
        shapes: [Vec<usize>; N],
        precision: Option<Precision>,
        fails: bool,
    ) -> PyResult<Results<'py, N>> {
        let mut k = 0..N;
        let outputs = try_map(shapes, |shape| {
            let k = k.next().unwrap_or_default();
            let output = Output::of(py, &self.label(k), self.array(k), precision, &shape)?;
            if fails && self.array(k).is_some() { output.beside() } else { Ok(output) }
        })?;
        Ok(Results { outputs, arrays: self.arrays })
    }
}

/// The results of a call on their way out: fresh arrays or those of `out=`.
pub struct Results<'py, const N: usize> {
    outputs: [Output<'py>; N],
    arrays: [Option<Bound<'py, PyAny>>; N],
}

impl<'py, const N: usize> Results<'py, N> {
    /// Fresh arrays of these shapes.
    pub fn fresh(py: Python<'py>, shapes: [Vec<usize>; N]) -> PyResult<Self> {
        Out::fresh().results(py, shapes, None, false)
    }

    /// True if the caller does not see what a failing call has written.
    pub fn are_unseen(&self) -> bool {
        self.outputs.iter().all(Output::is_unseen)
    }

    /// The memory to write to, row after row.
    pub fn flat(&mut self) -> [&mut [f64]; N] {
        self.outputs.each_mut().map(Output::flat)
    }

    /// The arrays to return.
    pub fn finish_arrays(self) -> PyResult<[Py<PyAny>; N]> {
        try_map(self.outputs, Output::finish_object)
    }

    /// The same, of any precision.
    pub fn finish_any(self) -> PyResult<[AnyArray<'py>; N]> {
        try_map(self.outputs, Output::finish_any)
    }

    /// The arrays to return, and a number for each that has no axes and for which the caller has no array.
    pub fn finish(self) -> PyResult<[Py<PyAny>; N]> {
        let mut arrays = self.arrays.iter();
        try_map(self.outputs, |output| {
            let array = arrays.next().and_then(Option::as_ref);
            output.finish_number(array).map(Bound::unbind)
        })
    }
}

/// An array of the same length, or the first error.
fn try_map<T, U, const N: usize>(values: [T; N], map: impl FnMut(T) -> PyResult<U>) -> PyResult<[U; N]> {
    let mapped: Vec<U> = values.into_iter().map(map).collect::<PyResult<_>>()?;
    mapped.try_into().map_err(|_| refuse("out", "hold every result", "fewer"))
}
