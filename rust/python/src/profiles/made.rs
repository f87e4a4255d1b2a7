//! The call that made a profile or transition: it prints, compares, hashes and pickles by it.

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::classes::repr_of_call;

/// A function of `six_wheel.kinematics.profiles` and its arguments.
pub struct ConstructorCall {
    pub maker: &'static str,
    pub arguments: Py<PyTuple>,
    /// The keywords that are not the default ones.
    pub keywords: Py<PyDict>,
}

/// A class or function of `six_wheel.kinematics.profiles`.
pub fn class<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("six_wheel.kinematics.profiles")?.getattr(name)
}

impl ConstructorCall {
    /// The call, to be pasted back.
    pub fn repr(&self, py: Python<'_>) -> PyResult<String> {
        let call = format!("profiles.{}", self.maker);
        repr_of_call(&call, self.arguments.bind(py), self.keywords.bind(py))
    }

    pub fn equals(&self, py: Python<'_>, other: &Self) -> PyResult<bool> {
        Ok(self.maker == other.maker
            && self.arguments.bind(py).eq(other.arguments.bind(py))?
            && self.keywords.bind(py).eq(other.keywords.bind(py))?)
    }

    pub fn hash(&self, py: Python<'_>) -> PyResult<isize> {
        self.arguments.bind(py).hash()
    }

    /// The result of `__reduce__`: the call again.
    pub fn reduce<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let maker = class(py, self.maker)?;
        let partial = py.import("functools")?.call_method("partial", (maker,), Some(self.keywords.bind(py)))?;
        (partial, &self.arguments).into_pyobject(py)
    }
}

/// Equality, hash, pickling and `replace` by the call that made an object.
macro_rules! known_by_its_call {
    ($class: ident) => {
        #[pymethods]
        impl $class {
            fn __eq__(&self, py: Python<'_>, other: &Bound<'_, PyAny>) -> PyResult<bool> {
                match other.cast::<Self>() {
                    Ok(other) => self.made.equals(py, &other.get().made),
                    Err(_) => Ok(false),
                }
            }

            fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
                self.made.hash(py)
            }

            fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, pyo3::types::PyTuple>> {
                self.made.reduce(py)
            }
        }

        replaceable!($class);
    };
}
pub(super) use known_by_its_call;

/// Representation by that call.
macro_rules! printed_by_its_call {
    ($class: ident) => {
        #[pymethods]
        impl $class {
            fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
                self.made.repr(py)
            }
        }
    };
}
pub(super) use printed_by_its_call;
