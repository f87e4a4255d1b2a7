//! Motion of a suspension on the ground it stands on: `inverse`, `forward`, `slip`, and `traction` without a map.

mod motion;
mod quick;
mod slip;
mod stand;
mod traction;

pub use motion::{GroundCommand, GroundMotion};
pub use quick::install;
pub use slip::{BodySlip, WheelSlip, body_slip};
pub use traction::Traction;

use pyo3::prelude::*;

use crate::convert::{Output, joined};

/// A fresh array of rows, filled by the caller.
fn fresh<'py>(py: Python<'py>, leading: &[usize], width: usize) -> PyResult<Output<'py>> {
    Output::fresh(py, &joined(leading, width))
}

fn done(array: Output<'_>) -> PyResult<Py<PyAny>> {
    Ok(array.finish()?.into_any().unbind())
}
