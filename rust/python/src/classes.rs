//! Macros and functions that the Python classes share: attributes, `__repr__`, equality, hashing, pickling and
//! `replace`. rustfmt leaves what stands in their lists as it is: write it as rustfmt would.

use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

#[macro_use]
mod documentation;
#[macro_use]
mod parameter_lists;

/// Read-only attributes of a class: documentation, name, type and expression of each.
///
/// `getters! { Class, self, py: ... }` names the object and the token of the interpreter that the expressions use.
macro_rules! getters {
    ($class:ident, $this:ident, $py:ident: $($(#[$doc:meta])* $name:ident: $kind:ty = $value:expr;)*) => {
        #[pymethods]
        impl $class {
            $(
                $(#[$doc])*
                #[getter]
                #[allow(unused_variables)] // an expression need not name both
                fn $name<'py>(&$this, $py: Python<'py>) -> $kind {
                    $value
                }
            )*
        }
    };
}

/// A frozen class of results: its fields are its attributes, and pickle by them. Fields under `hidden` are not seen from
/// Python, and `repr` lists the attributes that `__repr__` shows.
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

        pickled_by_fields! { $class, this, py:
            ($($field: $kind = &this.$field,)* $($($hidden: $hidden_kind = &this.$hidden,)*)?)
            $class { $($field,)* $($($hidden,)*)? }
        }

        $(repr_of_attributes! { $class: $($name)* })?
    };
}

/// Pickling by fields: `pickled_by_fields! { Class, this, py: (field: Type = expression, ...) Class { field, ... } }` with the
/// expressions that read a field from `this`, and the one that makes the object from all of them.
macro_rules! pickled_by_fields {
    ($class:ident, $this:ident, $py:ident: ($($field:ident: $kind:ty = $value:expr,)*) $made:expr) => {
        #[pymethods]
        impl $class {
            /// The object with these fields, as `__reduce__` lists them.
            #[classmethod]
            #[allow(unused_variables)] // the expression need not name the interpreter
            fn _restore<'py>(
                _class: &Bound<'py, pyo3::types::PyType>,
                $py: Python<'py>,
                $($field: $kind,)*
            ) -> PyResult<Self> {
                Ok($made)
            }

            fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, pyo3::types::PyTuple>> {
                let ($py, $this) = (slf.py(), slf.get());
                let fields = [$(pyo3::IntoPyObjectExt::into_bound_py_any($value, $py)?,)*];
                crate::classes::restored_by(slf.as_any(), &fields)
            }
        }
    };
}

/// Copies of an object that takes in samples: `copied! { Class, |this, py| copy }`.
macro_rules! copied {
    ($class:ident, |$this:ident, $py:ident| $copy:expr) => {
        #[pymethods]
        impl $class {
            fn __copy__($this: &Bound<'_, Self>) -> PyResult<Self> {
                let ($py, $this) = ($this.py(), $this.get());
                $copy
            }

            fn __deepcopy__(slf: &Bound<'_, Self>, _memo: &Bound<'_, PyAny>) -> PyResult<Self> {
                Self::__copy__(slf)
            }
        }
    };
}

/// [`copied`], and the refusal to pickle it: `copied_by! { Class, remedy, |this, py| copy }`.
macro_rules! copied_by {
    ($class:ident, $remedy:literal, |$this:ident, $py:ident| $copy:expr) => {
        copied! { $class, |$this, $py| $copy }

        #[pymethods]
        impl $class {
            fn __reduce__(&self) -> PyResult<()> {
                let words = concat!(stringify!($class), " takes in samples and does not pickle: ", $remedy);
                Err(pyo3::exceptions::PyTypeError::new_err(words))
            }
        }
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
            #[doc = section!(Parameters)]
            /// **changes
            ///     Arguments of the constructor; None leaves one out, so that it has its default. What was not
            ///     given stays so, and what is not named stays as it is.
            #[doc = raises!(TypeError: "If the constructor has no such argument; the message lists those it has.")]
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

/// A dict of Python: `dict!(py, name = value, ...)`, a name alone with the variable of that name.
macro_rules! dict {
    ($py:expr, $($name:ident $(= $value:expr)?),+) => {{
        let dict = pyo3::types::PyDict::new($py);
        $(dict.set_item(stringify!($name), dict!(@ $name $(= $value)?))?;)+
        dict
    }};
    (@ $name:ident) => { $name };
    (@ $name:ident = $value:expr) => { $value };
}

/// A value of the core in which these fields are as they were given, if they were.
macro_rules! with_given {
    ($usual:expr, $($field:ident)*) => {{
        let mut value = $usual;
        $(if let Some(given) = $field {
            value.$field = given;
        })*
        value
    }};
}

/// Fields of a value by their names, in an array of pairs.
macro_rules! by_name {
    ($value:expr, $($field:ident)*) => { [$((stringify!($field), $value.$field)),*] };
}

/// Pickling by the constructor of a class and its method for the keywords that make the value again.
macro_rules! pickled_by_keywords {
    ($class:ident: $keywords:ident) => {
        #[pymethods]
        impl $class {
            fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, pyo3::types::PyTuple>> {
                let py = slf.py();
                crate::classes::reduce(slf.as_any(), &pyo3::types::PyTuple::empty(py), &slf.get().$keywords(py)?)
            }
        }
    };
}

/// Representation, hash, equality, pickling and `replace` of a class that wraps a value of the core made of numbers. Its
/// method `numbers` lists them by name, None for one that is left out; others may list those to pickle and name the call.
macro_rules! value_of_numbers {
    ($class:ident) => {
        value_of_numbers! { $class: numbers, |_value| stringify!($class) }
    };
    ($class:ident: $given:ident, |$value:ident| $call:expr) => {
        #[pymethods]
        impl $class {
            fn __repr__(&self) -> String {
                crate::classes::repr_of_numbers((|$value: &Self| $call)(self), self.numbers())
            }

            fn __hash__(&self) -> u64 {
                crate::classes::hash_of_numbers(self.numbers().into_iter().filter_map(|(_, number)| number))
            }
        }

        impl $class {
            fn keywords<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, pyo3::types::PyDict>> {
                pyo3::types::IntoPyDict::into_py_dict(self.$given(), py)
            }
        }

        equal_by!($class: 0);
        pickled_by_keywords!($class: keywords);
        replaceable!($class);
    };
}

/// `Class(name=value, ...)` of numbers by name.
pub fn repr_of_numbers<'a>(class: &str, numbers: impl IntoIterator<Item = (&'a str, Option<f64>)>) -> String {
    let text = |(name, number): (&str, Option<f64>)| match number {
        None => format!("{name}=None"),
        Some(number) if number.is_infinite() => format!("{name}=float('inf')"),
        Some(number) => format!("{name}={number:?}"),
    };
    format!("{class}({})", numbers.into_iter().map(text).collect::<Vec<_>>().join(", "))
}

/// `Class(name=value, ...)` with these attributes of an object, in one short line.
pub fn repr_of_attributes(class: &str, object: &Bound<'_, PyAny>, names: &[&str]) -> PyResult<String> {
    let py = object.py();
    let attributes = PyDict::new(py);
    for name in names {
        attributes.set_item(name, object.getattr(*name)?)?;
    }
    let module = py.import("six_wheel.kinematics.objects.short_text")?;
    module.getattr(intern!(py, "short_repr"))?.call1((class, attributes))?.extract()
}

/// The text of a representation, cut to the longest that there is.
pub fn cut(text: String) -> String {
    const LONGEST: usize = 120;
    if text.chars().count() <= LONGEST {
        return text;
    }
    text.chars().take(LONGEST - 5).chain(" ...)".chars()).collect()
}

/// `call(value, ..., name=value, ...)` with the representations of these arguments.
pub fn repr_of_call<'py>(
    call: &str,
    arguments: impl IntoIterator<Item = Bound<'py, PyAny>>,
    keywords: &Bound<'py, PyDict>,
) -> PyResult<String> {
    let positional = arguments.into_iter().map(|value| Ok(value.repr()?.to_string()));
    let named = keywords.iter().map(|(name, value)| Ok(format!("{name}={}", value.repr()?)));
    Ok(format!("{call}({})", positional.chain(named).collect::<PyResult<Vec<_>>>()?.join(", ")))
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

/// The result of `__reduce__` by which pickle calls `_restore` of the class with these fields.
pub fn restored_by<'py>(object: &Bound<'py, PyAny>, fields: &[Bound<'py, PyAny>]) -> PyResult<Bound<'py, PyTuple>> {
    let py = object.py();
    let restore = object.get_type().getattr(intern!(py, "_restore"))?;
    (restore, PyTuple::new(py, fields)?).into_pyobject(py)
}

/// The value with some arguments of the call that makes it given anew: by that call, which `__reduce__` has.
pub fn replaced<'py>(value: &Bound<'py, PyAny>, changes: Option<&Bound<'py, PyDict>>) -> PyResult<Bound<'py, PyAny>> {
    value.py().import("six_wheel.kinematics.rover_edit")?.call_method("replace", (value,), changes)
}
