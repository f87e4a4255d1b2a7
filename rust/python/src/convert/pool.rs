//! Memory of results that are gone, kept for the next ones. Fresh pages cost up to half of a batch call, since the C
//! library gives them back to the system between calls whose results are several arrays.
//!
//! NumPy asks for it by the handler that an array of results is made with, and gives it back by the same one: such an
//! array owns its memory like any other. At most `KEPT` bytes are kept, and none where there is no memory left.

use std::alloc::{Layout, alloc_zeroed, dealloc};
use std::ffi::{CStr, c_char, c_void};
use std::ops::RangeInclusive;
use std::ptr::{self, NonNull, null_mut};
use std::sync::{Mutex, MutexGuard, PoisonError};

use pyo3::exceptions::PyImportError;
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

/// Sizes of arrays for which the pool is faster [bytes]: smaller ones are left to the C library; for larger ones the time of
/// the call is much longer than that of fresh pages.
const SIZES: RangeInclusive<usize> = 1 << 16..=1 << 24;

/// Upper bound of the memory that is kept [bytes].
const KEPT: usize = 1 << 25;

/// A line of the cache: where the numbers begin, with room before them for how many bytes there are.
const LINE: usize = 64;

/// Memory for `capacity` bytes, from the second line of what was allocated.
struct OutputBuffer {
    data: NonNull<u8>,
    capacity: usize,
}

// SAFETY: memory that nobody else refers to.
unsafe impl Send for OutputBuffer {}

impl OutputBuffer {
    fn layout(capacity: usize) -> Option<Layout> {
        Layout::from_size_align(capacity.checked_add(LINE)?, LINE).ok()
    }

    /// Zeros, fresh from the system.
    fn new(capacity: usize) -> Option<Self> {
        let layout = Self::layout(capacity)?;
        // SAFETY: the layout has a line at least. The capacity is noted in that first line, which is aligned for it.
        unsafe {
            let start = NonNull::new(alloc_zeroed(layout))?;
            start.cast::<usize>().write(capacity);
            let data = start.add(LINE);
            Some(Self { data, capacity })
        }
    }

    /// Hands the memory over.
    fn into_data(self) -> *mut u8 {
        let data = self.data.as_ptr();
        std::mem::forget(self);
        data
    }

    /// Takes memory back.
    ///
    /// # Safety
    /// The address came from `into_data`, and nobody uses it any more.
    unsafe fn from_data(data: *mut u8) -> Option<Self> {
        let data = NonNull::new(data)?;
        // SAFETY: the line before it begins with the capacity.
        let capacity = unsafe { data.sub(LINE).cast::<usize>().read() };
        Some(Self { data, capacity })
    }
}

impl Drop for OutputBuffer {
    fn drop(&mut self) {
        if let Some(layout) = Self::layout(self.capacity) {
            // SAFETY: allocated with this layout, a line before the data.
            unsafe { dealloc(self.data.sub(LINE).as_ptr(), layout) }
        }
    }
}

/// Rooms that wait, the oldest first.
static WAITING: Mutex<Vec<OutputBuffer>> = Mutex::new(Vec::new());

fn waiting() -> MutexGuard<'static, Vec<OutputBuffer>> {
    WAITING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The room that fits best and wastes less than a quarter, with what was written there, or a new one of zeros.
fn take(size: usize) -> Option<OutputBuffer> {
    let mut rooms = waiting();
    let fits = size..=size.saturating_add(size / 4);
    let best = rooms
        .iter()
        .enumerate()
        .filter(|(_, room)| fits.contains(&room.capacity))
        .min_by_key(|(_, room)| room.capacity)
        .map(|(k, _)| k);
    if let Some(best) = best {
        return Some(rooms.remove(best));
    }
    OutputBuffer::new(size).or_else(|| {
        rooms.clear();
        OutputBuffer::new(size)
    })
}

/// Keeps a room, and drops the oldest beyond `KEPT`.
fn keep(room: OutputBuffer) {
    let mut rooms = waiting();
    // A room that cannot be noted is given back, and so is one that an array grew to.
    if !SIZES.contains(&room.capacity) || rooms.try_reserve(1).is_err() {
        return;
    }
    rooms.push(room);
    while rooms.iter().map(|room| room.capacity).sum::<usize>() > KEPT {
        rooms.remove(0);
    }
}

extern "C" fn malloc(_: *mut c_void, size: usize) -> *mut c_void {
    take(size).map_or(null_mut(), |room| room.into_data().cast())
}

extern "C" fn calloc(context: *mut c_void, count: usize, size: usize) -> *mut c_void {
    let Some(size) = count.checked_mul(size) else { return null_mut() };
    let data = malloc(context, size);
    if !data.is_null() {
        // SAFETY: so many bytes are there.
        unsafe { ptr::write_bytes(data.cast::<u8>(), 0, size) };
    }
    data
}

extern "C" fn realloc(context: *mut c_void, data: *mut c_void, size: usize) -> *mut c_void {
    let new = malloc(context, size);
    // SAFETY: NumPy hands back what it got from here, and uses it no more unless this fails.
    if !new.is_null()
        && let Some(old) = unsafe { OutputBuffer::from_data(data.cast()) }
    {
        // SAFETY: both are there for that many bytes, and apart.
        unsafe { ptr::copy_nonoverlapping(old.data.as_ptr(), new.cast(), old.capacity.min(size)) };
        keep(old);
    }
    new
}

extern "C" fn free(_: *mut c_void, data: *mut c_void, _: usize) {
    // SAFETY: NumPy hands back what it got from here.
    if let Some(room) = unsafe { OutputBuffer::from_data(data.cast()) } {
        keep(room);
    }
}

/// NumPy's `PyDataMem_Handler`, version 1 (https://numpy.org/doc/stable/reference/c-api/data_memory.html).
#[repr(C)]
struct Handler {
    name: [c_char; 127],
    version: u8,
    context: *mut c_void,
    malloc: extern "C" fn(*mut c_void, usize) -> *mut c_void,
    calloc: extern "C" fn(*mut c_void, usize, usize) -> *mut c_void,
    realloc: extern "C" fn(*mut c_void, *mut c_void, usize) -> *mut c_void,
    free: extern "C" fn(*mut c_void, *mut c_void, usize),
}

// SAFETY: it is never written to.
unsafe impl Sync for Handler {}

const fn name(text: &[u8]) -> [c_char; 127] {
    let mut name = [0; 127];
    let mut k = 0;
    while k < text.len() {
        name[k] = text[k] as c_char;
        k += 1;
    }
    name
}

static HANDLER: Handler =
    Handler { name: name(b"six_wheel"), version: 1, context: null_mut(), malloc, calloc, realloc, free };

/// The name of the capsule that NumPy expects.
const MEM_HANDLER: &CStr = c"mem_handler";

/// Index of `PyDataMem_SetHandler` in NumPy's table of functions since 1.22; the `numpy` crate leaves it out.
const SET_HANDLER: usize = 304;

type SetHandler = unsafe extern "C" fn(*mut ffi::PyObject) -> *mut ffi::PyObject;

/// NumPy's function that changes handlers, and the capsule of ours.
struct Handlers {
    set: SetHandler,
    ours: Py<PyAny>,
}

impl Handlers {
    fn get(py: Python<'_>) -> PyResult<&'static Self> {
        static HANDLERS: PyOnceLock<Handlers> = PyOnceLock::new();
        HANDLERS.get_or_try_init(py, || {
            let module = py.import("numpy._core.multiarray").or_else(|_| py.import("numpy.core.multiarray"))?;
            let table = module.getattr("_ARRAY_API")?;
            // SAFETY: NumPy documents the capsule, that it has no name, and the order of its functions; the module is
            // never unloaded. The handler lives as long as the process.
            unsafe {
                let table = ffi::PyCapsule_GetPointer(table.as_ptr(), ptr::null());
                let table = NonNull::new(table.cast::<*const c_void>())
                    .ok_or_else(|| PyImportError::new_err("NumPy's table of functions is empty"))?;
                let set = table.add(SET_HANDLER).read();
                let handler = (&raw const HANDLER).cast_mut().cast();
                let ours = ffi::PyCapsule_New(handler, MEM_HANDLER.as_ptr(), None);
                Ok(Self {
                    set: std::mem::transmute::<*const c_void, SetHandler>(set),
                    ours: Bound::from_owned_ptr_or_err(py, ours)?.unbind(),
                })
            }
        })
    }

    /// Makes a handler that of the arrays to come. The one before.
    fn change<'py>(&self, handler: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        // SAFETY: a capsule of a handler; NumPy returns a new reference, or null with an exception set.
        unsafe { Bound::from_owned_ptr_or_err(handler.py(), (self.set)(handler.as_ptr())) }
    }
}

/// While this lives NumPy makes arrays of memory that was kept, and that is kept again when they are gone.
pub struct Pool<'py> {
    handlers: &'static Handlers,
    before: Bound<'py, PyAny>,
}

/// The pool for an array of this number of bytes; None for sizes at which it is not faster.
pub fn of(py: Python<'_>, size: usize) -> PyResult<Option<Pool<'_>>> {
    if !SIZES.contains(&size) {
        return Ok(None);
    }
    let handlers = Handlers::get(py)?;
    let before = handlers.change(handlers.ours.bind(py))?;
    Ok(Some(Pool { handlers, before }))
}

impl Drop for Pool<'_> {
    fn drop(&mut self) {
        // It fails where there is no memory for the change: then the handler stays, which serves any array.
        let _ = self.handlers.change(&self.before);
    }
}
