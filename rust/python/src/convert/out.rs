//! `out=` of calls with several results.

use pyo3::prelude::*;
use pyo3::types::PyTuple;

use super::errors::refuse;
use super::output::{Output, Precision};

/// The arrays of `out=`: the results in their order, as many as there are; the others are fresh, as are those that are None.
pub struct Out<'py, const N: usize> {
    arrays: [Option<Bound<'py, PyAny>>; N],
    /// True for one array instead of a tuple.
    alone: bool,
}

impl<'py, const N: usize> Out<'py, N> {
    fn fresh() -> Self {
        Self { arrays: [const { None }; N], alone: false }
    }

    /// Of results with these names, one array instead of a tuple being the first of them: where that one is what is asked for.
    pub fn read_or_first(out: Option<&Bound<'py, PyAny>>, names: [&str; N]) -> PyResult<Self> {
        match out {
            Some(array) if !array.is_instance_of::<PyTuple>() => {
                let mut read = Self::fresh();
                read.arrays[0] = Some(array.clone());
                read.alone = true;
                Ok(read)
            }
            _ => Self::read(out, names),
        }
    }

    /// Of results with these names.
    pub fn read(out: Option<&Bound<'py, PyAny>>, names: [&str; N]) -> PyResult<Self> {
        let mut read = Self::fresh();
        let Some(out) = out else { return Ok(read) };
        let wrong = |rule: &str, got: &str| {
            let rule = format!("{rule} for ({}) or the first of these", names.join(", "));
            refuse("out", &rule, got)
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

    /// True if the caller has an array for any result.
    pub fn is_given(&self) -> bool {
        self.arrays.iter().any(Option::is_some)
    }

    /// The results, of these shapes. `fails`: the call may yet fail, and the caller's arrays are written only when it has
    /// not.
    pub fn results(self, py: Python<'py>, shapes: [Vec<usize>; N], fails: bool) -> PyResult<Results<'py, N>> {
        let mut k = 0;
        let outputs = try_map(shapes, |shape| {
            let argument = if self.alone { "out".to_owned() } else { format!("out[{k}]") };
            let array = self.arrays[k].as_ref();
            k += 1;
            let output = Output::of(py, &argument, array, None, &shape)?;
            if fails && array.is_some() { output.beside() } else { Ok(output) }
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
        let outputs = try_map(shapes, |shape| Output::fresh(py, &shape))?;
        Ok(Self { outputs, arrays: [const { None }; N] })
    }

    /// Results in the arrays of a tuple, those that are None fresh; by these names in errors.
    pub fn named(
        py: Python<'py>,
        arrays: [Option<Bound<'py, PyAny>>; N],
        names: [&str; N],
        precision: Option<Precision>,
        shapes: [Vec<usize>; N],
    ) -> PyResult<Self> {
        let mut given = names.into_iter().zip(&arrays);
        let outputs = try_map(shapes, |shape| {
            let (name, array) = given.next().unwrap_or(("out", &None));
            Output::of(py, name, array.as_ref(), precision, &shape)
        })?;
        Ok(Self { outputs, arrays })
    }

    /// The memory to write to, row after row.
    pub fn flat(&mut self) -> [&mut [f64]; N] {
        self.outputs.each_mut().map(Output::flat)
    }

    /// The arrays to return.
    pub fn finish_arrays(self) -> PyResult<[Py<PyAny>; N]> {
        try_map(self.outputs, Output::finish_object)
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

/// The arrays of an `out=` that has to be a tuple of just so many; none if it is left out.
pub fn out_tuple<'py, const N: usize>(
    out: Option<&Bound<'py, PyAny>>,
    rule: &str,
) -> PyResult<[Option<Bound<'py, PyAny>>; N]> {
    let Some(out) = out else { return Ok([const { None }; N]) };
    match out.cast::<PyTuple>().ok().filter(|tuple| tuple.len() == N) {
        Some(tuple) => Ok(std::array::from_fn(|k| tuple.get_item(k).ok())),
        None => Err(refuse("out", rule, &out.get_type().name()?.to_string())),
    }
}
