//! A method in CPython's fastcall convention that stands before one of pyo3's.

use std::ffi::{CStr, c_int};
use std::ptr::null_mut;
use std::sync::atomic::{AtomicPtr, Ordering};

use pyo3::PyClass;
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

use super::arguments::Object;
use crate::convert::batches_at_work;

/// The calling convention: no tuple of arguments, no dict of keywords.
const FASTCALL: c_int = ffi::METH_FASTCALL | ffi::METH_KEYWORDS;

/// The quick way of a method with `N` parameters that it knows of.
pub trait Quick<const N: usize> {
    /// The class of the method.
    type Class: PyClass;

    /// Its one static description.
    fn method() -> &'static Method<N>;

    /// The answer to the usual arguments, or nothing, with nothing changed.
    fn call<'py>(this: Borrowed<'_, 'py, Self::Class>, arguments: Arguments<'_, 'py, N>) -> Answer<'py>;
}

/// The arguments of a quick method, in the order of its parameters; nothing for one that is left out or `None`.
pub type Arguments<'a, 'py, const N: usize> = [Option<Object<'a, 'py>>; N];

/// The answer of a quick method, or nothing.
pub type Answer<'py> = Option<Bound<'py, PyAny>>;

/// Makes a function the quick way of a method: type and number of parameters, class, name, names of the parameters, how
/// many of them may come by position, and the function.
macro_rules! fast_method {
    ($quick:ident<$count:literal>: $class:ty, $name:literal, $parameters:expr, $positional:literal, $call:ident) => {
        struct $quick;

        impl crate::fastcall::Quick<$count> for $quick {
            type Class = $class;

            fn method() -> &'static crate::fastcall::Method<$count> {
                static METHOD: crate::fastcall::Method<$count> =
                    crate::fastcall::Method::new($name, $parameters, $positional);
                &METHOD
            }

            #[inline(always)]
            fn call<'py>(this: Borrowed<'_, 'py, $class>, arguments: Arguments<'_, 'py, $count>) -> Answer<'py> {
                $call(this, arguments)
            }
        }
    };
}

/// The quick ways of a folder, each as [`fast_method`] has it, and the function that puts them before the methods.
macro_rules! fast_methods {
    ($($quick:ident<$count:literal>: $class:ty, $name:literal, $parameters:expr, $positional:literal, $call:ident;)*) => {
        $(fast_method!($quick<$count>: $class, $name, $parameters, $positional, $call);)*

        /// Puts the quick ways before the methods of the classes.
        pub fn install(py: Python<'_>) -> PyResult<()> {
            $(crate::fastcall::install::<$count, $quick>(py)?;)*
            Ok(())
        }
    };
}

/// Puts a function before methods that have no quick way, so that unknown keywords are refused with the nearest one.
macro_rules! checked_methods {
    ($py:expr, $class:ty: $($name:literal)*) => {$({
        fast_method!(General<0>: $class, $name, [], 0, unanswered);

        fn unanswered<'py>(_: Borrowed<'_, 'py, $class>, []: Arguments<'_, 'py, 0>) -> Answer<'py> {
            None
        }
        crate::fastcall::install::<0, General>($py)?;
    })*};
}

/// Name and parameters of a quick method, and the method behind it.
pub struct Method<const N: usize> {
    name: &'static CStr,
    parameters: [&'static CStr; N],
    positional: usize,
    /// The parameters' names as the compiler of Python code interns them: compared by address.
    interned: [AtomicPtr<ffi::PyObject>; N],
    general: PyOnceLock<ffi::PyCFunctionFastWithKeywords>,
}

impl<const N: usize> Method<N> {
    /// The first `positional` parameters may be given without their names.
    pub const fn new(name: &'static CStr, parameters: [&'static CStr; N], positional: usize) -> Self {
        Self {
            name,
            parameters,
            positional,
            interned: [const { AtomicPtr::new(null_mut()) }; N],
            general: PyOnceLock::new(),
        }
    }

    /// Sorts the arguments of a call, unless there is one that is not known, or one twice.
    ///
    /// # Safety
    ///
    /// As the interpreter calls: `count` arguments, then one for each of the `names`, a tuple or null.
    #[inline(always)]
    unsafe fn sort<'a, 'py>(
        &self,
        py: Python<'py>,
        arguments: *const *mut ffi::PyObject,
        count: usize,
        names: *mut ffi::PyObject,
    ) -> Option<Arguments<'a, 'py, N>> {
        if count > self.positional {
            return None;
        }
        let mut sorted = [None; N];
        // SAFETY: there are as many arguments, each alive for as long as the call lasts.
        let argument = |k: usize| unsafe { Object::from_ptr(py, *arguments.add(k)) };
        for (k, place) in sorted.iter_mut().enumerate().take(count) {
            *place = Some(argument(k));
        }
        if !names.is_null() {
            // SAFETY: a tuple, and items inside it.
            let named = unsafe { ffi::PyTuple_Size(names) }.cast_unsigned();
            for k in 0..named {
                // SAFETY: as above.
                let name = unsafe { ffi::PyTuple_GetItem(names, k.cast_signed()) };
                let known = |interned: &AtomicPtr<_>| interned.load(Ordering::Relaxed) == name;
                let place = &mut sorted[self.interned.iter().position(known)?];
                if place.is_some() {
                    return None;
                }
                *place = Some(argument(count + k));
            }
        }
        // SAFETY: only the address of the one `None` is taken.
        let none = unsafe { ffi::Py_None() };
        Some(sorted.map(|given| given.filter(|object| object.as_ptr() != none)))
    }
}

/// The function that the interpreter calls.
unsafe extern "C" fn entry<const N: usize, Q: Quick<N>>(
    this: *mut ffi::PyObject,
    arguments: *const *mut ffi::PyObject,
    count: ffi::Py_ssize_t,
    names: *mut ffi::PyObject,
) -> *mut ffi::PyObject {
    // SAFETY: the interpreter calls with its lock held.
    let py = unsafe { Python::assume_attached() };
    let method = Q::method();
    if !batches_at_work() {
        // SAFETY: passed on as they came.
        let sorted = unsafe { method.sort(py, arguments, count.cast_unsigned(), names) };
        // SAFETY: the descriptor in front of this function has checked that `this` is of its class.
        let this = unsafe { Borrowed::from_ptr(py, this).cast_unchecked::<Q::Class>() };
        if let Some(answer) = sorted.and_then(|sorted| Q::call(this, sorted)) {
            return answer.into_ptr();
        }
    }
    match method.general.get(py) {
        // SAFETY: a method of the same class in the same convention.
        Some(general) => {
            let answer = unsafe { general(this, arguments, count, names) };
            if answer.is_null() && !names.is_null() {
                // SAFETY: a tuple that outlives the call.
                let names = unsafe { Borrowed::from_ptr(py, names) };
                super::keywords::explain(&py.get_type::<Q::Class>(), method.name, &names);
            }
            answer
        }
        None => null_mut(),
    }
}

/// Puts the quick method before the one of the same name. Where pyo3's has another calling convention, it is
/// left alone.
pub fn install<const N: usize, Q: Quick<N>>(py: Python<'_>) -> PyResult<()> {
    let (method, class) = (Q::method(), py.get_type::<Q::Class>());
    let Some(behind) = definition(&class, method.name) else { return Ok(()) };
    // SAFETY: that the function is of this kind is what the flags say.
    let general = unsafe { behind.ml_meth.PyCFunctionFastWithKeywords };
    if method.general.set(py, general).is_err() {
        return Ok(()); // there already
    }
    for (interned, name) in method.interned.iter().zip(method.parameters) {
        // SAFETY: a string with an end; kept for as long as the process lives.
        let name = unsafe { ffi::PyUnicode_InternFromString(name.as_ptr()) };
        interned.store(name, Ordering::Relaxed);
    }
    let definition =
        ffi::PyMethodDef { ml_meth: ffi::PyMethodDefPointer { PyCFunctionFastWithKeywords: entry::<N, Q> }, ..behind };
    // The descriptor keeps the address: one definition per process and method.
    let definition = Box::leak(Box::new(definition));
    // SAFETY: a class and a definition that stays.
    let descriptor = unsafe {
        let descriptor = ffi::PyDescr_NewMethod(class.as_type_ptr(), definition);
        Bound::from_owned_ptr_or_err(py, descriptor)?
    };
    class.setattr(method.name.to_string_lossy().as_ref(), descriptor)
}

/// The definition that pyo3 has made of a method of this class, if it is called without tuples and dicts.
fn definition(class: &Bound<'_, pyo3::types::PyType>, name: &CStr) -> Option<ffi::PyMethodDef> {
    // SAFETY: the slot of a class made from a specification holds what that said: definitions up to one
    // without a name, or null.
    unsafe {
        let slot = ffi::PyType_GetSlot(class.as_type_ptr(), ffi::Py_tp_methods);
        let mut definition = slot.cast::<ffi::PyMethodDef>().cast_const();
        while !definition.is_null() && !(*definition).ml_name.is_null() {
            if CStr::from_ptr((*definition).ml_name) == name {
                return (*definition).ml_flags.eq(&FASTCALL).then(|| *definition);
            }
            definition = definition.add(1);
        }
    }
    None
}
