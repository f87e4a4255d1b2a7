//! NumPy's arrays, looked at through their C structure, and made by NumPy.

use std::ffi::c_char;
use std::marker::PhantomData;
use std::mem::MaybeUninit;
use std::ptr::{NonNull, null_mut};

use numpy::npyffi::{
    NPY_ARRAY_ALIGNED, NPY_ARRAY_C_CONTIGUOUS, NPY_ARRAY_WRITEABLE, NPY_TYPES, NpyTypes, PY_ARRAY_API, PyArray_Descr,
    PyArrayObject, get_type_object,
};
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyBool;
use six_wheel_kinematics::rover::MAX_WHEELS;
use six_wheel_numerics::inline_always;

use super::arguments::{Object, sequence};
use crate::convert::is_ready;

/// Set on arrays that warn when they are written to: not for the quick way.
const WARN_ON_WRITE: i32 = 1 << 31;

/// The two objects of NumPy that everything is compared with.
#[derive(Clone, Copy)]
struct Numpy {
    array: NonNull<ffi::PyTypeObject>,
    float64: NonNull<PyArray_Descr>,
}

// SAFETY: addresses of objects that live as long as the process; used with the interpreter's lock held.
unsafe impl Send for Numpy {}
// SAFETY: as above.
unsafe impl Sync for Numpy {}

impl Numpy {
    #[inline(always)]
    fn get(py: Python<'_>) -> Option<Self> {
        static NUMPY: PyOnceLock<Option<Numpy>> = PyOnceLock::new();
        match NUMPY.get(py) {
            Some(numpy) => *numpy,
            // The general way loads it, and raises what that raises.
            None if !is_ready(py) => None,
            None => *NUMPY.get_or_init(py, || Self::find(py)),
        }
    }

    #[cold]
    fn find(py: Python<'_>) -> Option<Self> {
        // SAFETY: NumPy is ready; the reference to the type description is kept for good.
        unsafe {
            let array = get_type_object(py, NpyTypes::PyArray_Type);
            let float64 = PY_ARRAY_API.PyArray_DescrFromType(py, NPY_TYPES::NPY_DOUBLE as i32);
            Some(Self { array: NonNull::new(array)?, float64: NonNull::new(float64)? })
        }
    }
}

/// One row of numbers in an array of the caller's: float64, one axis, contiguous, aligned.
#[derive(Clone, Copy)]
pub struct Row<'a> {
    data: NonNull<f64>,
    length: usize,
    object: *mut ffi::PyObject,
    alive: PhantomData<&'a PyArrayObject>,
}

#[inline_always]
impl<'a> Row<'a> {
    /// To read from: an array of just this length, and not of a derived class.
    pub fn read(object: Object<'a, '_>, length: usize) -> Option<Self> {
        Self::with(object, length, NPY_ARRAY_C_CONTIGUOUS | NPY_ARRAY_ALIGNED)
    }

    /// To write to.
    pub fn target(object: Object<'a, '_>, length: usize) -> Option<Self> {
        let flags = NPY_ARRAY_C_CONTIGUOUS | NPY_ARRAY_ALIGNED | NPY_ARRAY_WRITEABLE;
        Self::with(object, length, flags)
    }

    fn with(object: Object<'a, '_>, length: usize, flags: i32) -> Option<Self> {
        let numpy = Numpy::get(object.py())?;
        let object = object.as_ptr();
        // SAFETY: an object of exactly this type has this structure, and one axis has a length.
        unsafe {
            if ffi::Py_TYPE(object) != numpy.array.as_ptr() {
                return None;
            }
            let fields = &(*object.cast::<PyArrayObject>()).fields;
            if fields.nd != 1
                || usize::try_from(*fields.dimensions) != Ok(length)
                || fields.flags & (flags | WARN_ON_WRITE) != flags
                || !is_float64(numpy, fields.descr)
            {
                return None;
            }
            Some(Self { data: NonNull::new(fields.data.cast())?, length, object, alive: PhantomData })
        }
    }

    /// True for the same array object.
    pub fn is(self, other: Self) -> bool {
        self.object == other.object
    }

    /// True if the two share memory.
    pub fn overlaps(self, other: Self) -> bool {
        let start = |row: Self| row.data.as_ptr() as usize;
        let end = |row: Self| start(row) + row.length * size_of::<f64>();
        start(self) < end(other) && start(other) < end(self)
    }

    /// The numbers.
    ///
    /// # Safety
    ///
    /// Until the last use of the slice nothing writes to the array, and no Python code runs.
    pub unsafe fn numbers(self) -> &'a [f64] {
        // SAFETY: so many aligned numbers are there; the rest is for the caller to see to.
        unsafe { std::slice::from_raw_parts(self.data.as_ptr(), self.length) }
    }

    /// The numbers, to be written.
    ///
    /// # Safety
    ///
    /// Until the last use of the slice nothing else reads or writes the array, and no Python code runs.
    pub unsafe fn numbers_mut(self) -> &'a mut [f64] {
        // SAFETY: as above, and the array is writeable.
        unsafe { std::slice::from_raw_parts_mut(self.data.as_ptr(), self.length) }
    }
}

/// Native float64: NumPy's own description of it, or an equal one, as unpickled arrays have.
///
/// # Safety
///
/// The description of a live array.
#[inline(always)]
unsafe fn is_float64(numpy: Numpy, description: *mut PyArray_Descr) -> bool {
    // SAFETY: every description begins with these fields.
    description == numpy.float64.as_ptr()
        || unsafe {
            let fields = &(*description).fields;
            fields.type_num == NPY_TYPES::NPY_DOUBLE as i32 && fields.byteorder == b'=' as c_char
        }
}

/// Three numbers in a tuple, a list or an array.
#[inline(always)]
pub fn three(object: Object<'_, '_>) -> Option<[f64; 3]> {
    let mut numbers = [MaybeUninit::uninit(); 3];
    if let Some(numbers) = sequence(object, &mut numbers)? {
        return (*numbers).try_into().ok();
    }
    // SAFETY: the numbers are copied at once.
    unsafe { Row::read(object, 3)?.numbers() }.try_into().ok()
}

/// Room for the numbers of one row that have to be copied, or come in a tuple or list.
pub struct Numbers([MaybeUninit<f64>; MAX_WHEELS]);

#[inline_always]
impl Numbers {
    /// With nothing in it.
    pub const fn new() -> Self {
        Self([MaybeUninit::uninit(); MAX_WHEELS])
    }

    /// So many numbers out of an array, which is not copied, a tuple or a list.
    ///
    /// # Safety
    ///
    /// Until the last use of the slice nothing writes to the array, and no Python code runs.
    pub unsafe fn read<'a>(&'a mut self, object: Object<'a, '_>, length: usize) -> Option<&'a [f64]> {
        if let Some(row) = Row::read(object, length) {
            // SAFETY: for the caller to see to.
            return Some(unsafe { row.numbers() });
        }
        sequence(object, self.0.get_mut(..length)?)?
    }

    /// A copy of a row, which may then be written to.
    pub fn copy(&mut self, row: Row<'_>) -> Option<&[f64]> {
        let start = self.0.get_mut(..row.length)?.as_mut_ptr().cast::<f64>();
        // SAFETY: so many numbers are in the array and fit in here; what is read back has been written.
        unsafe {
            std::ptr::copy_nonoverlapping(row.data.as_ptr(), start, row.length);
            Some(std::slice::from_raw_parts(start, row.length))
        }
    }
}

/// A new array with one axis of this length, and the numbers in it, not yet set: they have to be before any
/// Python code runs.
#[inline(always)]
pub fn fresh<'py>(py: Python<'py>, length: usize) -> Option<(Bound<'py, PyAny>, Row<'py>)> {
    let numpy = Numpy::get(py)?;
    let mut shape = [length.cast_signed()];
    // SAFETY: NumPy takes over one reference to the description, and returns a new array or null.
    let array = unsafe {
        ffi::Py_INCREF(numpy.float64.as_ptr().cast());
        let array = PY_ARRAY_API.PyArray_NewFromDescr(
            py,
            numpy.array.as_ptr(),
            numpy.float64.as_ptr(),
            1,
            shape.as_mut_ptr(),
            null_mut(),
            null_mut(),
            0,
            null_mut(),
        );
        let Some(array) = Bound::from_owned_ptr_or_opt(py, array) else {
            ffi::PyErr_Clear(); // no memory; the general way says so
            return None;
        };
        array
    };
    // SAFETY: an array that NumPy has just made.
    let data = unsafe { (*array.as_ptr().cast::<PyArrayObject>()).fields.data };
    let row = Row { data: NonNull::new(data.cast())?, length, object: array.as_ptr(), alive: PhantomData };
    Some((array, row))
}

/// A tuple of two.
#[inline(always)]
pub fn pair<'py>(py: Python<'py>, first: Bound<'py, PyAny>, second: Bound<'py, PyAny>) -> Option<Bound<'py, PyAny>> {
    // SAFETY: a new tuple, whose two places take over a reference each.
    unsafe {
        let Some(tuple) = Bound::from_owned_ptr_or_opt(py, ffi::PyTuple_New(2)) else {
            ffi::PyErr_Clear();
            return None;
        };
        ffi::PyTuple_SetItem(tuple.as_ptr(), 0, first.into_ptr());
        ffi::PyTuple_SetItem(tuple.as_ptr(), 1, second.into_ptr());
        Some(tuple)
    }
}

/// `True` or `False`.
#[inline(always)]
pub fn truth(py: Python<'_>, value: bool) -> Bound<'_, PyAny> {
    PyBool::new(py, value).to_owned().into_any()
}
