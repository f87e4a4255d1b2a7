//! The fast path of single calls, as a control loop makes them a thousand times a second: without the general machinery
//! of arguments and arrays.
//!
//! A fast method stands before a method that pyo3 has made. It sees the arguments first, as the interpreter hands them
//! over. It answers the usual ones; everything else, errors included, goes to the method behind it with the same
//! arguments. To give a class one:
//!
//! 1. Write the general method under `#[pymethods]`, with docstring, signature and errors.
//! 2. `Update<2>: Odometry, c"update", [c"speeds", c"dt"], 2, update;` in the `fast_methods!` of its folder (of the names, the
//!    first two may come by position), and the function `update`, which returns `None` for all it does not know. It sees
//!    `None` for a parameter that is left out or is Python's `None`. Of `this`, take `get()`, and of what it shares
//!    `try_lock(py)?`.
//! 3. Read with [`float`], [`three`], [`Row::read`] and [`Row::target`]; answer with [`fresh`], [`pair`] or an
//!    argument itself. Nothing may be changed before it is sure that the answer is `Some`.
//! 4. `lib.rs` calls `install` of the folder, which `fast_methods!` makes, after `add_class`.
//!
//! # Risks
//!
//! Unsafe code of the bindings stands here, in `convert` and in `state_lock`. Each risk has a condition that rules it out:
//!
//! - *A data race with another Python thread.* The interpreter's lock is held from the first line of a call to the last.
//!   The module declares that it needs the lock (`gil_used = true`), and does not load in an interpreter without it.
//! - *Memory that is freed or moved while it is read.* No Python code runs in between: only exact types and arrays are looked
//!   into, and reading a `float`, `int`, tuple or list calls nothing. So no array is resized or freed, and no list changes.
//! - *A data race with a kernel of this library that runs without the lock.* Such kernels are counted in
//!   [`crate::convert::compute`]. While there is one, every call takes the general way, which asks `convert::memory` who uses
//!   what. No reference into an array outlives a fast call.
//! - *Two references to the same memory, one of them to write.* Arrays that are written to must overlap neither each other
//!   nor what is read; [`Row::overlaps`] is asked before the first write.
//! - *A half written result.* Nothing is changed before the answer is sure to be `Some`.
//! - *Another layout of NumPy's arrays.* Their C structure is read as `numpy::npyffi` declares it, which is part of NumPy's
//!   stable ABI.
//! - *Another calling convention.* `install` replaces a method only if pyo3 has made it with `METH_FASTCALL |
//!   METH_KEYWORDS`; otherwise the general method stays.

mod arguments;
mod arrays;
pub mod keywords;
#[macro_use]
mod method;

pub use arguments::{Object, Renewed, float, two};
pub use arrays::{Numbers, Row, fresh, pair, three, truth};
pub use method::{Answer, Arguments, Method, Quick, install};
