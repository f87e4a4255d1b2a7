//! Numbers out of the objects a caller hands over, by looking at exact types.

use std::cell::UnsafeCell;
use std::mem::MaybeUninit;
use std::ops::Deref;

use pyo3::PyClass;
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::pyclass::boolean_struct::True;

/// An argument, borrowed from the caller for the call.
pub type Object<'a, 'py> = Borrowed<'a, 'py, PyAny>;

/// A `float`, something derived from it, such as NumPy's `float64`, or an `int` that fits.
#[inline(always)]
pub fn float(object: Object<'_, '_>) -> Option<f64> {
    // SAFETY: live objects of the types the functions are for; none of them runs Python code.
    unsafe { number(object.as_ptr()) }
}

/// The contents of an object that Python cannot change. They are overwritten only while nobody else has the object.
pub struct Renewed<T>(UnsafeCell<T>);

// SAFETY: it is written through the only reference to the object there is, so nobody reads meanwhile.
unsafe impl<T: Send + Sync> Sync for Renewed<T> {}

impl<T> Renewed<T> {
    pub const fn new(value: T) -> Self {
        Self(UnsafeCell::new(value))
    }

    /// To write to, if there is no other reference to the object than this one.
    #[inline(always)]
    pub fn of<'a, C>(object: &'a mut Py<C>, _: Python<'a>, part: fn(&C) -> &Self) -> Option<&'a mut T>
    where
        C: PyClass<Frozen = True> + Sync,
    {
        // SAFETY: a live object, and the interpreter's lock is held, so that no reference is made meanwhile; who has none
        // looks at nothing inside.
        unsafe {
            let is_alone = ffi::Py_REFCNT(object.as_ptr()) == 1;
            is_alone.then(|| &mut *part(object.get()).0.get())
        }
    }
}

impl<T> Deref for Renewed<T> {
    type Target = T;

    #[inline(always)]
    fn deref(&self) -> &T {
        // SAFETY: whoever looks has a reference to the object, so that nothing is written.
        unsafe { &*self.0.get() }
    }
}

/// The numbers of a tuple or list of just as many, put into these places. `Some(None)` if it is neither.
#[inline(always)]
pub(super) fn sequence<'a>(object: Object<'_, '_>, places: &'a mut [MaybeUninit<f64>]) -> Option<Option<&'a [f64]>> {
    let object = object.as_ptr();
    let count = places.len().cast_signed();
    // SAFETY: a live tuple or list, items inside it, and nothing in between that could change it.
    unsafe {
        let class = ffi::Py_TYPE(object);
        if class == &raw mut ffi::PyTuple_Type {
            if ffi::PyTuple_Size(object) != count {
                return None;
            }
            for (k, place) in places.iter_mut().enumerate() {
                place.write(number(ffi::PyTuple_GetItem(object, k.cast_signed()))?);
            }
        } else if class == &raw mut ffi::PyList_Type {
            if ffi::PyList_Size(object) != count {
                return None;
            }
            for (k, place) in places.iter_mut().enumerate() {
                place.write(number(ffi::PyList_GetItem(object, k.cast_signed()))?);
            }
        } else {
            return Some(None);
        }
    }
    // SAFETY: every place has been written.
    Some(Some(unsafe { &*(&raw const *places as *const [f64]) }))
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
        (ffi::PyType_IsSubtype(class, &raw mut ffi::PyFloat_Type) != 0).then(|| ffi::PyFloat_AsDouble(object))
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
