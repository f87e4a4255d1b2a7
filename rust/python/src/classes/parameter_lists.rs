//! Macros of methods and functions, each with its list of parameters. rustfmt leaves the lists as they are: write them as
//! it would, filled.

/// Methods of a class, each with its parameters as Python lists them.
///
/// `fn name[receiver](parameters) as "(...)" -> Result { ... }`: in brackets stands what is no parameter in Python; after
/// `as` the signature that Python shows, where defaults are not shown as they are. A parameter is
///
/// - `name` or `name=None`: any object, of which nothing is read;
/// - `name: Type` or `name: Type = default`: a type with [`FromArgument`](crate::arguments::FromArgument), read under its
///   name by the function of that name in `arguments`;
/// - `name: native Type` or `name: native Type = default`: a type that pyo3 reads;
/// - `*`, `/`, `*name` and `**name`, as in Python;
/// - `**` at the end: keywords that are not in the list are refused with the nearest name, after them values that are too
///   many without keywords, and all that is missing; it needs the signature after `as`. Not for methods with a fast path: pyo3 gives what takes any keyword another calling convention.
macro_rules! methods {
    ($class:ident: $($items:tt)*) => {
        listed! { [$class] $($items)* }
    };
}

/// Functions of the module, as [`methods`] lists those of a class.
macro_rules! functions {
    ($($items:tt)*) => {
        listed! { [] $($items)* }
    };
}

/// The items of both lists, one by one.
macro_rules! listed {
    ($class:tt $(
        $(#[$attribute:meta])*
        $vis:vis fn $name:ident[$($head:tt)*]($($parameters:tt)*) $(as $shown:tt)? -> $result:ty { $($body:tt)* }
    )*) => {$(
        with_end! {
            ($class [$(#[$attribute])* $vis] $name [$($head)*] [$($shown)?] [$result] [$($body)*])
            [$($parameters)*] $($parameters)*
        }
    )*};
}

/// Looks for `**` at the end of a list: then keywords are checked before missing arguments, since an argument whose name
/// is misspelt is missing, too.
macro_rules! with_end {
    (([$($class:ident)?] $prefix:tt $name:ident $head:tt [$shown:tt] $result:tt $body:tt) $all:tt * *) => {
        with_parameters! {
            (
                [call (concat!($(stringify!($class), ".",)? stringify!($name))) $shown []]
                ([$($class)?] $prefix $name $head [$shown] $result $body) [] [] []
            )
            $all
        }
    };
    ($made:tt $all:tt) => { with_parameters! { ([] $made [] [] []) $all } };
    ($made:tt $all:tt $first:tt $($rest:tt)*) => { with_end! { $made $all $($rest)* } };
}

/// Reads a list of parameters from the left. What was read stands in front, in parentheses: the check of keywords, the
/// function, the signature of pyo3, the parameters of Rust and, where keywords are checked, what has no default with the
/// lines that read it.
macro_rules! with_parameters {
    ($read:tt [$($parameters:tt)+]) => { with_parameters! { $read $($parameters)+ } };
    ((
        [$call:ident $path:tt $shown:tt [$($excess:ident)?]] ($class:tt $prefix:tt $name:tt $head:tt $text:tt $result:tt [$($body:tt)*])
        [$($signature:tt)*] [$($typed:tt)*] [$(($required:ident $($line:tt)*))*]
    ) * *) => {
        with_parameters! {
            (
                [] ($class $prefix $name $head $text $result [
                    let $call = crate::fastcall::keywords::Call { name: $path, signature: $shown };
                    $call.check(unknown, &[$($excess)?], &[$((stringify!($required), &$required)),*])?;
                    $($($line)*)* $($body)*
                ])
                [$($signature)* **unknown,] [$($typed)* unknown: Option<&Bound<'py, pyo3::types::PyDict>>,] []
            )
            []
        }
    };
    (([$call:tt $path:tt $shown:tt []] $made:tt [$($signature:tt)*] [$($typed:tt)*] $required:tt) * $(, $($rest:tt)*)?) => {
        with_parameters! {
            (
                [$call $path $shown [excess]] $made [$($signature)* *excess,]
                [$($typed)* excess: &Bound<'py, pyo3::types::PyTuple>,] $required
            )
            [$($($rest)*)?]
        }
    };
    ($read:tt * $(, $($rest:tt)*)?) => { add_parameter! { $read (*,) () [$($($rest)*)?] } };
    ($read:tt / $(, $($rest:tt)*)?) => { add_parameter! { $read (/,) () [$($($rest)*)?] } };
    ($read:tt * * $name:ident $(, $($rest:tt)*)?) => {
        add_parameter! { $read (**$name,) ($name: Option<&Bound<'py, pyo3::types::PyDict>>,) [$($($rest)*)?] }
    };
    ($read:tt * $name:ident $(, $($rest:tt)*)?) => {
        add_parameter! { $read (*$name,) ($name: &Bound<'py, pyo3::types::PyTuple>,) [$($($rest)*)?] }
    };
    ($read:tt $name:ident = None $(, $($rest:tt)*)?) => {
        add_parameter! { $read ($name=None,) ($name: Option<&Bound<'py, PyAny>>,) [$($($rest)*)?] }
    };
    ($read:tt $name:ident: native $type:ty = $default:tt $(, $($rest:tt)*)?) => {
        add_parameter! { $read ($name = $default,) ($name: $type,) [$($($rest)*)?] }
    };
    ($read:tt $name:ident: native $type:ty $(, $($rest:tt)*)?) => {
        add_required! { $read $name ($name: $type,) (let $name: $type = $name.extract()?;) [$($($rest)*)?] }
    };
    ($read:tt $name:ident: $type:ty = $default:tt $(, $($rest:tt)*)?) => {
        add_parameter! {
            $read ($name = $default,) (#[pyo3(from_py_with = crate::arguments::$name)] $name: $type,) [$($($rest)*)?]
        }
    };
    ($read:tt $name:ident: $type:ty $(, $($rest:tt)*)?) => {
        add_required! {
            $read $name (#[pyo3(from_py_with = crate::arguments::$name)] $name: $type,)
            (let $name: $type = crate::arguments::$name($name)?;) [$($($rest)*)?]
        }
    };
    ($read:tt $name:ident $(, $($rest:tt)*)?) => {
        add_required! { $read $name ($name: &Bound<'py, PyAny>,) () [$($($rest)*)?] }
    };
    ((
        [] ([$class:ident] [$($prefix:tt)*] $name:ident [$($($head:tt)+)?] [$($shown:tt)?] [$result:ty] [$($body:tt)*])
        [$($signature:tt)*] [$($typed:tt)*] []
    ) []) => {
        #[pymethods]
        impl $class {
            #[pyo3(signature = ($($signature)*) $(, text_signature = $shown)?)]
            #[allow(clippy::extra_unused_lifetimes)] // a list need not name it
            $($prefix)*
            fn $name<'py>($($($head)+,)? $($typed)*) -> $result { $($body)* }
        }
    };
    ((
        [] ([] [$($attribute:tt)*] $name:ident [$($head:tt)*] [$($shown:tt)?] [$result:ty] [$($body:tt)*])
        [$($signature:tt)*] [$($typed:tt)*] []
    ) []) => {
        #[pyfunction]
        #[pyo3(signature = ($($signature)*) $(, text_signature = $shown)?)]
        $($attribute)*
        fn $name<'py>($($head)*, $($typed)*) -> $result { $($body)* }
    };
}

/// One more parameter: as pyo3 and as Rust has it.
macro_rules! add_parameter {
    (($checked:tt $made:tt [$($signature:tt)*] [$($typed:tt)*] $required:tt) ($($shown:tt)*) ($($rust:tt)*) $rest:tt) => {
        with_parameters! { ($checked $made [$($signature)* $($shown)*] [$($typed)* $($rust)*] $required) $rest }
    };
}

/// One more parameter without a default. Where keywords are checked, it is read after that.
macro_rules! add_required {
    (([] $($read:tt)*) $name:ident $rust:tt $line:tt $rest:tt) => {
        add_parameter! { ([] $($read)*) ($name,) $rust $rest }
    };
    (
        ([$call:tt $($check:tt)*] $made:tt [$($signature:tt)*] [$($typed:tt)*] [$($required:tt)*])
        $name:ident $rust:tt ($($line:tt)*) $rest:tt
    ) => {
        with_parameters! {
            (
                [$call $($check)*] $made [$($signature)* $name = crate::fastcall::keywords::Given(None),]
                [$($typed)* $name: crate::fastcall::keywords::Given<'py>,]
                [$($required)* ($name let $name = $call.required(stringify!($name), &$name)?; $($line)*)]
            )
            $rest
        }
    };
}
