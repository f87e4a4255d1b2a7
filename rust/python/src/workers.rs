//! The options `threads=` and `level=` of batches, and the default of the former.

use std::sync::atomic::{AtomicUsize, Ordering};

use pyo3::prelude::*;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::level::Level;
use six_wheel_numerics::threads::workers::Workers;

use crate::convert::{OrRaise, compute_rows, is_interrupted, refuse};

/// Threads of a call that does not say. It is here and not in the core, and changes no result.
static DEFAULT_THREADS: AtomicUsize = AtomicUsize::new(1);

/// The threads and the level of a call. The level does not depend on the number of rows: no result depends on the rows
/// beside it.
pub fn workers(threads: Option<i64>, level: Option<&str>) -> PyResult<Workers> {
    let threads = threads.map_or_else(|| Ok(DEFAULT_THREADS.load(Ordering::Relaxed)), count)?;
    let level = match level {
        Some(name) => name.parse().or_raise(&[])?,
        None => Level::best(),
    };
    Ok(Workers { level, threads, fresh: false, is_interrupted })
}

/// Fills every row of some outputs, each given with its width: `fill` gets the number of a row and its part of each
/// output. The first error is raised with its row as an index into these leading axes.
pub fn fill_rows<T: Send, const N: usize>(
    py: Python<'_>,
    workers: Workers,
    rows: usize,
    leading: &[usize],
    outputs: [(&mut [T], usize); N],
    fill: impl Fn(usize, [&mut [T]; N]) -> Result<(), Error> + Sync + Send,
) -> PyResult<()> {
    compute_rows(py, rows, leading, || workers.rows(rows, outputs, fill))
}

fn count(threads: i64) -> PyResult<usize> {
    let positive = usize::try_from(threads).ok().filter(|count| *count > 0);
    positive.ok_or_else(|| refuse("threads", "be at least 1", threads))
}

/// SIMD levels this machine has, the best last: what `level=` takes.
#[doc = returns!("list of str")]
///     Some of ``"scalar"`` (row by row), ``"neon"``, ``"avx2"`` and ``"avx512"``.
#[pyfunction]
pub fn simd_levels() -> Vec<&'static str> {
    Level::available().into_iter().map(Level::name).collect()
}

/// Threads of a batch that does not say how many: 1 until `set_default_threads` is called.
#[doc = returns!("int": "Threads at most; batches under 20000 rows are worked through by the calling thread alone.")]
#[pyfunction]
pub fn default_threads() -> usize {
    DEFAULT_THREADS.load(Ordering::Relaxed)
}

/// Sets the threads of batches that do not say how many. Results do not depend on it, bit for bit.
#[doc = section!(Parameters)]
/// threads : int
///     At least 1.
#[doc = raises!("If there are none.")]
#[pyfunction]
pub fn set_default_threads(threads: i64) -> PyResult<()> {
    DEFAULT_THREADS.store(count(threads)?, Ordering::Relaxed);
    Ok(())
}
