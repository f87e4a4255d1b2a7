//! Overlap of arrays. Every array that a call reads or writes is registered by its addresses until the call is done, so
//! that no kernel writes where itself or another one reads.
//!
//! Arrays that were read keep their numbers: NumPy does not resize an array with weak references, and before code of the caller's
//! runs, which may write to it, the numbers are copied ([`keep`]).
//!
//! Asked and changed with the interpreter's lock held only, like the memory of NumPy itself.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::{self, ThreadId};

use numpy::npyffi::{PY_ARRAY_API, PyArray_Descr, PyArrayObject, npy_intp};
use numpy::{PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::{PyMemoryError, PyValueError};
use pyo3::ffi::PyObject;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyWeakrefReference;
use six_wheel_numerics::places::Places;

use super::errors::{refuse, shape_text};
use super::numpy_module::{Array, numpy, ready};
use super::pool;

/// An array in use.
struct Entry {
    number: u64,
    places: Places,
    /// Keeps the memory from becoming another array's.
    array: Py<PyUntypedArray>,
    /// Keeps it from being resized.
    _pin: Py<PyWeakrefReference>,
    /// The numbers as they were read, where code of the caller's has run since.
    kept: Option<Vec<f64>>,
    /// The argument it is, if it is written to.
    written: Option<String>,
    thread: ThreadId,
}

struct BorrowTable {
    all: Vec<Entry>,
    next: u64,
}

static ENTRIES: Mutex<BorrowTable> = Mutex::new(BorrowTable { all: Vec::new(), next: 0 });

/// Number of entries whose numbers are kept.
static KEPT: AtomicUsize = AtomicUsize::new(0);

fn entries() -> MutexGuard<'static, BorrowTable> {
    ENTRIES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Forgets what other threads are at: after a fork there are none.
pub fn forget() {
    let others = std::mem::take(&mut entries().all);
    KEPT.store(0, Ordering::Relaxed);
    drop(others); // without the lock: the last reference to an array may run code
}

/// An array in use, for as long as this lives.
pub struct BorrowedArray(u64);

impl BorrowedArray {
    /// The numbers as they were read, where code of the caller's has run since.
    pub fn kept(&self) -> Option<&[f64]> {
        if KEPT.load(Ordering::Relaxed) == 0 {
            return None;
        }
        let entries = entries();
        let kept = entries.all.iter().find(|entry| entry.number == self.0)?.kept.as_deref()?;
        // SAFETY: what is kept stays where it is until this is dropped: an entry moves, its vector does not change.
        Some(unsafe { std::slice::from_raw_parts(kept.as_ptr(), kept.len()) })
    }

    /// The array as it was read, which had this shape.
    pub fn source<'py>(
        &self,
        array: &Bound<'py, PyUntypedArray>,
        shape: &[usize],
    ) -> PyResult<Bound<'py, PyUntypedArray>> {
        match self.kept() {
            None => Ok(array.clone()),
            Some(kept) => Ok(self::array(array.py(), kept, shape)?.as_untyped().clone()),
        }
    }
}

impl Drop for BorrowedArray {
    fn drop(&mut self) {
        let mut entries = entries();
        let place = entries.all.iter().position(|entry| entry.number == self.0);
        let entry = place.map(|place| entries.all.swap_remove(place));
        drop(entries);
        if entry.as_ref().is_some_and(|entry| entry.kept.is_some()) {
            KEPT.fetch_sub(1, Ordering::Relaxed);
        }
        drop(entry); // without the lock, as above
    }
}

/// The numbers of an array that is C-contiguous, aligned and of native `f64`, as they were when it was read:
/// whatever becomes of the array object, they stay where they are.
pub(super) struct Memory<'py> {
    data: *const f64,
    count: usize,
    pub(super) array: Bound<'py, PyUntypedArray>,
    pub(super) held: BorrowedArray,
}

impl<'py> Memory<'py> {
    /// Those of such an array, which is held.
    pub(super) fn new(array: Bound<'py, PyUntypedArray>, held: BorrowedArray) -> PyResult<Self> {
        let count = count(array.shape())?;
        // SAFETY: a live array object has a valid header; only the address is taken here.
        let data = unsafe { (*array.as_array_ptr().cast::<PyArrayObject>()).fields.data };
        Ok(Self { data: data.cast_const().cast(), count, array, held })
    }

    /// The array as it was read, which had this shape.
    pub(super) fn source(&self, shape: &[usize]) -> PyResult<Bound<'py, PyUntypedArray>> {
        self.held.source(&self.array, shape)
    }

    pub(super) fn numbers(&self) -> &[f64] {
        if self.count == 0 {
            return &[];
        }
        if let Some(kept) = self.held.kept() {
            return kept;
        }
        // SAFETY: so many aligned numbers were there when the array was read; it is held, and with it its memory.
        // No kernel writes to it.
        unsafe { std::slice::from_raw_parts(self.data, self.count) }
    }
}

/// The conflict that keeps an array from being used.
struct BorrowError {
    /// True if this very call uses it already.
    own: bool,
    /// The argument as which it is written to.
    written: Option<String>,
}

/// Notes that an argument is read.
pub fn read(argument: &str, array: &Bound<'_, PyUntypedArray>) -> PyResult<BorrowedArray> {
    let (held, clash) = hold(array, None)?;
    match clash {
        None => Ok(held),
        Some(_) => Err(refuse(argument, "not be written to meanwhile", "an array in use as out=")),
    }
}

/// Notes that an argument is written to; the rule is told where somebody else uses it.
pub fn write(
    argument: &str,
    rule: impl FnOnce() -> String,
    array: &Bound<'_, PyUntypedArray>,
) -> PyResult<BorrowedArray> {
    let (held, clash) = hold(array, Some(argument))?;
    let Some(clash) = clash else { return Ok(held) };
    if !clash.own {
        return Err(refuse(argument, rule(), "a read-only array or one in use"));
    }
    // Fields of one tuple go by the name of the tuple.
    let tuple = |name: &str| name.split_once('.').map(|(tuple, _)| tuple.to_owned());
    let (argument, other) = match clash.written {
        None => (argument.to_owned(), "the input".to_owned()),
        Some(other) => match (tuple(argument), tuple(&other)) {
            (Some(mine), Some(theirs)) if mine == theirs => (mine, "itself".to_owned()),
            _ => (other, argument.to_owned()),
        },
    };
    Err(refuse(&argument, format!("not overlap {other}"), "shared memory"))
}

/// The addresses of the elements of an array.
pub fn places(array: &Bound<'_, PyUntypedArray>) -> Places {
    // SAFETY: a live array object has a valid header; only the address is read, not what is there.
    let data = unsafe { (*array.as_array_ptr()).fields.data } as usize;
    let axes = array.shape().iter().zip(array.strides());
    Places::new(data, axes.map(|(length, stride)| (*length, *stride)), array.dtype().itemsize())
}

/// Notes an array, and what stands against that: whoever writes to memory shares it with nobody. No Python code runs.
fn hold(array: &Bound<'_, PyUntypedArray>, written: Option<&str>) -> PyResult<(BorrowedArray, Option<BorrowError>)> {
    let pin = PyWeakrefReference::new(array.as_any())?.unbind();
    let (places, thread) = (places(array), thread::current().id());
    let mut entries = entries();
    let clash = entries
        .all
        .iter()
        .filter(|other| written.is_some() || other.written.is_some())
        .find(|other| other.places.share(&places))
        .map(|other| BorrowError { own: other.thread == thread, written: other.written.clone() });
    let number = entries.next;
    entries.next += 1;
    entries.all.push(Entry {
        number,
        places,
        array: array.clone().unbind(),
        _pin: pin,
        kept: None,
        written: written.map(str::to_owned),
        thread,
    });
    Ok((BorrowedArray(number), clash))
}

/// True if a call of this thread reads an array.
pub fn reads() -> bool {
    let here = thread::current().id();
    entries().all.iter().any(|entry| entry.thread == here && entry.written.is_none())
}

/// Keeps the numbers that this thread reads, before code of the caller's runs, which may change them; `numbers` copies
/// those of an array.
pub(super) fn keep<'py>(
    py: Python<'py>,
    numbers: impl Fn(&Bound<'py, PyUntypedArray>) -> PyResult<Option<Vec<f64>>>,
) -> PyResult<()> {
    let here = thread::current().id();
    let is_read = |entry: &&Entry| entry.thread == here && entry.written.is_none() && entry.kept.is_none();
    let read: Vec<_> =
        entries().all.iter().filter(is_read).map(|entry| (entry.number, entry.array.clone_ref(py))).collect();
    for (number, array) in read {
        // An array that NumPy has to convert is a copy already.
        let Some(numbers) = numbers(array.bind(py))? else { continue };
        if let Some(entry) = entries().all.iter_mut().find(|entry| entry.number == number) {
            entry.kept = Some(numbers);
            KEPT.fetch_add(1, Ordering::Relaxed);
        }
    }
    Ok(())
}

/// The number of elements of an array of this shape. `MemoryError` if no memory could hold them.
pub fn count(shape: &[usize]) -> PyResult<usize> {
    let bytes = shape.iter().try_fold(size_of::<f64>(), |bytes, length| bytes.checked_mul(*length));
    match bytes {
        Some(bytes) if bytes <= isize::MAX as usize => Ok(bytes / size_of::<f64>()),
        // Lengths beside a zero may be as large as they like.
        _ if shape.contains(&0) => Ok(0),
        _ => Err(none_for(shape)),
    }
}

/// `MemoryError` for an array of this shape.
pub fn none_for(shape: &[usize]) -> PyErr {
    let message = format!("no memory for an array of shape {}", shape_text(shape));
    PyMemoryError::new_err(message)
}

/// Memory for this number of values. `MemoryError` if there is none.
pub fn room<T>(count: usize) -> PyResult<Vec<T>> {
    let mut values = Vec::new();
    values.try_reserve_exact(count).map_err(|_| none_for(&[count]))?;
    Ok(values)
}

/// So many equal values.
pub fn filled<T: Clone>(value: T, count: usize) -> PyResult<Vec<T>> {
    let mut values = room(count)?;
    values.resize(count, value);
    Ok(values)
}

/// Values one after the other, as many as the iterator says it has. Fails where the handler of a signal has raised an
/// exception.
pub fn gathered<T>(mut values: impl ExactSizeIterator<Item = T>) -> PyResult<Vec<T>> {
    /// Values between two questions.
    const BLOCK: usize = 1 << 20;
    let mut all = room(values.len())?;
    while values.len() > BLOCK {
        all.extend(values.by_ref().take(BLOCK));
        Python::attach(|py| py.check_signals())?;
    }
    all.extend(values);
    Ok(all)
}

/// A new array of zeros, made by NumPy.
fn zeros<'py, T: numpy::Element>(py: Python<'py>, shape: &[usize]) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    // SAFETY: see `made`.
    made(py, shape, |number, lengths, dtype| unsafe { PY_ARRAY_API.PyArray_Zeros(py, number, lengths, dtype, 0) })
}

/// A new array for results, of whatever numbers: who asks for it fills it as a whole.
pub fn fresh<'py>(py: Python<'py>, shape: &[usize]) -> PyResult<Array<'py>> {
    ready(py)?;
    let Some(_pool) = pool::of(py, count(shape)? * size_of::<f64>())? else { return zeros(py, shape) };
    // SAFETY: see `made`. Memory of the pool has been written to, if only by zeros.
    made(py, shape, |number, lengths, dtype| unsafe { PY_ARRAY_API.PyArray_Empty(py, number, lengths, dtype, 0) })
}

/// An array of this shape by one of NumPy's functions, which take over the reference to the type and return a new array
/// of just this type and shape, or null with an exception set.
fn made<'py, T: numpy::Element>(
    py: Python<'py>,
    shape: &[usize],
    make: impl FnOnce(i32, *mut npy_intp, *mut PyArray_Descr) -> *mut PyObject,
) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    ready(py)?;
    count(shape)?;
    let mut lengths: Vec<npy_intp> = shape.iter().map(|length| length.cast_signed()).collect();
    let dtype = T::get_dtype(py).into_dtype_ptr();
    let array = make(lengths.len() as i32, lengths.as_mut_ptr(), dtype);
    // SAFETY: a new reference, or null with an exception set.
    Ok(unsafe { Bound::from_owned_ptr_or_err(py, array)? }.cast_into()?)
}

/// An array with these numbers.
pub fn array<'py, T: numpy::Element + Copy>(
    py: Python<'py>,
    values: &[T],
    shape: &[usize],
) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    let array = zeros::<T>(py, shape)?;
    debug_assert_eq!(count(shape)?, values.len());
    // SAFETY: a new contiguous array, known to nobody else.
    unsafe { numpy::PyArrayMethods::as_slice_mut(&array)? }.copy_from_slice(values);
    Ok(array)
}

/// A view of an array with more rows: axes of length 1, and those it has not got, repeat what there is. Whoever
/// has changed the shape of the array since it was read is told so.
pub(super) fn repeated<'py>(
    array: &Bound<'py, PyUntypedArray>,
    was: &[usize],
    shape: &[usize],
) -> PyResult<Bound<'py, PyUntypedArray>> {
    let py = array.py();
    count(shape)?;
    if array.shape() != was {
        return Err(PyValueError::new_err("the shape of an array must stay while it is read"));
    }
    let wide = numpy(py)?.call_method1(intern!(py, "broadcast_to"), (array, shape.to_vec()))?;
    Ok(wide.cast_into()?)
}
