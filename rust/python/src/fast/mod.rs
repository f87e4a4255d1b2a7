//! The quick way for one call: what a control loop does a thousand times a second, without the general
//! machinery of arguments and arrays.
//!
//! A quick method stands before a method that pyo3 has made. It sees the arguments first, as the interpreter
//! hands them over; it answers the usual ones, and everything else, errors included, goes to the method behind
//! it with the very same arguments. How to give a class one:
//!
//! 1. Write the general method under `#[pymethods]`, with docstring, signature and errors.
//! 2. `struct Update; impl Quick<2> for Update`: the class, `Method::new(c"update", [c"speeds", c"dt"], 2)` (of the
//!    names, the first two may come by position), and `call`, which returns `None` for all it does not know.
//!    It sees `None` for a parameter that is not given or is Python's `None`. Of `this`, take `get()`, and of what it shares
//!    `try_lock(py)?`.
//! 3. Read with [`float`], [`three`], [`Row::read`] and [`Row::target`]; answer with [`fresh`], [`pair`] or an
//!    argument itself. Nothing may be changed before it is sure that the answer is `Some`.
//! 4. `fast::install::<2, Update>(module.py())?` in `lib.rs`, after `add_class`.
//!
//! # Why this is sound
//!
//! This is, beside `convert` and `shared`, the room of the project with `unsafe` code. What it relies on:
//!
//! - *The interpreter's lock.* It is held from the first line of a call to the last. The module declares that it needs it
//!   (`gil_used = true`), and does not load where there is none.
//! - *No Python code runs in between.* Only exact types and arrays are looked into; reading a `float`, `int`, tuple or list
//!   calls nothing. So no array can be resized or freed, and no list changed, while it is being read.
//! - *No other thread of ours is at work without the lock.* Batches let go of it and count themselves in
//!   [`crate::convert::compute`]; while there is one, every call takes the general way, which asks
//!   `convert::memory` who uses what. Otherwise no reference into an array outlives a call, and nobody need be asked.
//! - *Targets are alone.* Arrays that are written to overlap neither each other nor what is read.
//! - *The layout of NumPy's arrays*, as `numpy::npyffi` declares it, is part of NumPy's stable ABI.

mod arguments;
mod arrays;
mod method;

pub use arguments::{Object, Renewed, float, three, two};
pub use arrays::{Numbers, Row, fresh, pair, truth};
pub use method::{Method, Quick, install};
