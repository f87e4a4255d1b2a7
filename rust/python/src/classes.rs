//! Macros and functions that the Python classes share: attributes, `__repr__`, equality, hashing, pickling and `replace`.

use std::fmt::Write;

use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

/// Read-only attributes of a class: documentation, name, type and expression of each.
///
/// `getters! { Class, this, py: ... }` names the object and the token of the interpreter that the expressions use.
macro_rules! getters {
    ($class:ident, $this:ident, $py:ident: $($(#[$doc:meta])* $name:ident: $kind:ty = $value:expr;)*) => {
        #[pymethods]
        impl $class {
            $(
                $(#[$doc])*
                #[getter]
                fn $name<'py>(&self, $py: Python<'py>) -> $kind {
                    #[allow(unused_variables)] // an expression need not name both
                    let ($this, $py) = (self, $py);
                    $value
                }
            )*
        }
    };
}

/// A frozen class of results: its fields are its attributes. Fields under `hidden` are not seen from Python, and
/// `repr` lists the attributes that `__repr__` shows.
macro_rules! result_class {
    (
        $(#[$doc:meta])*
        pub struct $class:ident { $($(#[$field_doc:meta])* $field:ident: $kind:ty,)* }
        $(hidden { $($hidden:ident: $hidden_kind:ty,)* })?
        $(repr { $($name:ident)* })?
    ) => {
        $(#[$doc])*
        #[pyclass(frozen, module = "six_wheel")]
        pub struct $class {
            $($(#[$field_doc])* #[pyo3(get)] pub $field: $kind,)*
            $($(pub $hidden: $hidden_kind,)*)?
        }

        $(repr_of_attributes! { $class: $($name)* })?
    };
}

/// `Class(name=value, ...)` as `__repr__`, with the representations of these attributes.
macro_rules! repr_of_attributes {
    ($class:ident: $($name:ident)*) => {
        #[pymethods]
        impl $class {
            fn __repr__(slf: &Bound<'_, Self>) -> PyResult<String> {
                crate::classes::repr_of_attributes(stringify!($class), slf.as_any(), &[$(stringify!($name)),*])
            }
        }
    };
}

/// `==` of a class that wraps a value of the core.
macro_rules! equal_by {
    ($class:ident: $field:tt) => {
        #[pymethods]
        impl $class {
            fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
                other.cast::<Self>().is_ok_and(|other| other.get().$field == self.$field)
            }
        }
    };
}

/// `replace` of an immutable value, and `__replace__` for `copy.replace`.
macro_rules! replaceable {
    ($class:ident) => {
        #[pymethods]
        impl $class {
            /// The same with some arguments of its constructor given anew.
            ///
            /// Parameters
            /// ----------
            /// **changes
            ///     Arguments of the constructor; None leaves one out, so that it has its default. What was not
            ///     given stays so, and what is not named stays as it is.
            ///
            /// Raises
            /// ------
            /// TypeError
            ///     If the constructor has no such argument; the message lists those it has.
            /// ValueError
            ///     If the constructor refuses the arguments.
            #[pyo3(signature = (**changes))]
            fn replace<'py>(
                slf: &Bound<'py, Self>,
                changes: Option<&Bound<'py, pyo3::types::PyDict>>,
            ) -> PyResult<Bound<'py, PyAny>> {
                crate::classes::replaced(slf.as_any(), changes)
            }

            /// `replace`, for `copy.replace`.
            #[pyo3(signature = (**changes))]
            fn __replace__<'py>(
                slf: &Bound<'py, Self>,
                changes: Option<&Bound<'py, pyo3::types::PyDict>>,
            ) -> PyResult<Bound<'py, PyAny>> {
                crate::classes::replaced(slf.as_any(), changes)
            }
        }
    };
}

/// `Class(name=value, ...)` with the representations of these attributes of an object.
pub fn repr_of_attributes(class: &str, object: &Bound<'_, PyAny>, names: &[&str]) -> PyResult<String> {
    let attributes = PyDict::new(object.py());
    for name in names {
        attributes.set_item(name, object.getattr(*name)?)?;
    }
    repr_of_call(class, &attributes)
}

/// `call(name=value, ...)` with the representations of these arguments.
pub fn repr_of_call(call: &str, keywords: &Bound<'_, PyDict>) -> PyResult<String> {
    let mut text = format!("{call}(");
    for (k, (name, value)) in keywords.iter().enumerate() {
        let comma = if k == 0 { "" } else { ", " };
        let _ = write!(text, "{comma}{name}={}", value.repr()?); // a String takes all that is written
    }
    Ok(text + ")")
}

/// A hash of numbers that is the same for zeros of either sign.
pub fn hash_of_numbers(numbers: impl IntoIterator<Item = f64>) -> u64 {
    let add = |hash: u64, number: f64| hash.wrapping_mul(31).wrapping_add((number + 0.0).to_bits());
    numbers.into_iter().fold(0, add)
}

/// The result of `__reduce__` by which pickle calls the class again with these arguments.
pub fn reduce<'py>(
    object: &Bound<'py, PyAny>,
    arguments: &Bound<'py, PyTuple>,
    keywords: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyTuple>> {
    let py = object.py();
    let rebuild = py.import("copyreg")?.getattr(intern!(py, "__newobj_ex__"))?;
    let call = (object.get_type(), arguments, keywords);
    (rebuild, call).into_pyobject(py)
}

/// The value with some arguments of the call that makes it given anew: by that call, which `__reduce__` has.
pub fn replaced<'py>(value: &Bound<'py, PyAny>, changes: Option<&Bound<'py, PyDict>>) -> PyResult<Bound<'py, PyAny>> {
    let module = value.py().import("six_wheel.kinematics.rover_edit")?;
    module.call_method(intern!(value.py(), "replace"), (value,), changes)
}
