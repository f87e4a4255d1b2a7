//! Numbers out of the objects a caller hands over, by looking at exact types.

use pyo3::ffi;
use pyo3::prelude::*;

use super::arrays::Row;

/// An argument, borrowed from the caller for the call.
pub type Object<'a, 'py> = Borrowed<'a, 'py, PyAny>;

/// A `float`, something derived from it, such as NumPy's `float64`, or an `int` that fits.
#[inline(always)]
pub fn float(object: Object<'_, '_>) -> Option<f64> {
    // SAFETY: live objects of the types the functions are for; none of them runs Python code.
    unsafe { number(object.as_ptr()) }
}

/// Whether there is no other reference to an object than this one.
#[inline(always)]
pub fn is_held_once<T>(object: &Py<T>, _py: Python<'_>) -> bool {
    // SAFETY: a live object, and the interpreter's lock is held.
    unsafe { ffi::Py_REFCNT(object.as_ptr()) == 1 }
}

/// Three numbers in a tuple, a list or an array.
#[inline(always)]
pub fn three(object: Object<'_, '_>) -> Option<[f64; 3]> {
    let mut numbers = [0.0; 3];
    if sequence(object, &mut numbers)? {
        return Some(numbers);
    }
    // SAFETY: the numbers are copied at once.
    unsafe { Row::read(object, 3)?.numbers() }.try_into().ok()
}

/// Fills in the numbers of a tuple or list of just as many. `Some(false)` if it is neither.
#[inline(always)]
pub(super) fn sequence(object: Object<'_, '_>, numbers: &mut [f64]) -> Option<bool> {
    let object = object.as_ptr();
    let count = numbers.len().cast_signed();
    // SAFETY: a live tuple or list, items inside it, and nothing in between that could change it.
    unsafe {
        let class = ffi::Py_TYPE(object);
        if class == &raw mut ffi::PyTuple_Type {
            if ffi::PyTuple_Size(object) != count {
                return None;
            }
            for (k, target) in numbers.iter_mut().enumerate() {
                *target = number(ffi::PyTuple_GetItem(object, k.cast_signed()))?;
            }
        } else if class == &raw mut ffi::PyList_Type {
            if ffi::PyList_Size(object) != count {
                return None;
            }
            for (k, target) in numbers.iter_mut().enumerate() {
                *target = number(ffi::PyList_GetItem(object, k.cast_signed()))?;
            }
        } else {
            return Some(false);
        }
    }
    Some(true)
}

/// # Safety
///
/// A live object.
#[inline(always)]
unsafe fn number(object: *mut ffi::PyObject) -> Option<f64> {
    // SAFETY: each function gets an object of its type.
    unsafe {
        let class = ffi::Py_TYPE(object);
        if class == &raw mut ffi::PyFloat_Type {
            return Some(ffi::PyFloat_AsDouble(object));
        }
        if class == &raw mut ffi::PyLong_Type {
            let value = ffi::PyLong_AsDouble(object);
            if value == -1.0 && !ffi::PyErr_Occurred().is_null() {
                ffi::PyErr_Clear(); // too large; the general way says so
                return None;
            }
            return Some(value);
        }
        (ffi::PyType_IsSubtype(class, &raw mut ffi::PyFloat_Type) != 0)
            .then(|| ffi::PyFloat_AsDouble(object))
    }
}

/// The items of a tuple of two.
#[inline(always)]
pub fn two<'a, 'py>(object: Object<'a, 'py>) -> Option<[Object<'a, 'py>; 2]> {
    let (py, object) = (object.py(), object.as_ptr());
    // SAFETY: a live tuple, which holds its items for as long as it lives itself.
    unsafe {
        if ffi::Py_TYPE(object) != &raw mut ffi::PyTuple_Type || ffi::PyTuple_Size(object) != 2 {
            return None;
        }
        let item = |k| Object::from_ptr(py, ffi::PyTuple_GetItem(object, k));
        Some([item(0), item(1)])
    }
}
