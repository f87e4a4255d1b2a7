//! Motion of a suspension on the ground it stands on: `inverse`, `forward`, `slip`, and `traction` without a map.

mod motion;
mod slip;
mod stand;
mod traction;

pub use motion::{GroundCommand, GroundMotion};
pub use slip::{BodySlip, WheelSlip, body_slip};
pub use traction::Traction;

use pyo3::prelude::*;

use crate::convert::{Output, Rows, joined};

/// A fresh array of rows, filled by the caller.
fn fresh<'py>(py: Python<'py>, leading: &[usize], width: usize) -> PyResult<Output<'py>> {
    Output::fresh(py, &joined(leading, width))
}

/// The row of an optional argument.
fn row<'a>(rows: Option<&'a Rows<'_>>, k: usize, width: usize) -> Option<&'a [f64]> {
    rows.map(|rows| &rows.flat()[k * width..][..width])
}

fn done(array: Output<'_>) -> PyResult<Py<PyAny>> {
    Ok(array.finish()?.into_any().unbind())
}
