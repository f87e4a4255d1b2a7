//! `out=` of calls with several results.

use pyo3::prelude::*;
use pyo3::types::PyTuple;

use super::{Output, refuse};

/// The arrays of `out=`: the results in their order, as many as there are; the others are fresh, as are those that are None.
pub struct Out<'py, const N: usize> {
    arrays: [Option<Bound<'py, PyAny>>; N],
    /// Whether it is one array and no tuple.
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

    /// Whether anything is written that was there before.
    pub fn is_given(&self) -> bool {
        self.arrays.iter().any(Option::is_some)
    }

    /// Where result `k` goes. `fails`: the call may yet fail, and the caller's array is written only when it has not.
    pub fn result(&self, py: Python<'py>, k: usize, shape: &[usize], fails: bool) -> PyResult<Output<'py>> {
        let argument = match self.alone {
            true => "out".to_owned(),
            false => format!("out[{k}]"),
        };
        let output = Output::of(py, &argument, self.arrays[k].as_ref(), None, shape)?;
        match fails && self.arrays[k].is_some() {
            true => output.beside(),
            false => Ok(output),
        }
    }

    /// Result `k`, finished: a number where it has no axes and the caller has no array for it.
    pub fn finish(&self, k: usize, output: Output<'py>) -> PyResult<Py<PyAny>> {
        let result = output.finish_number(self.arrays[k].as_ref())?;
        Ok(result.unbind())
    }
}
