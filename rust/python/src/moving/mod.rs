//! Motion of a suspension on the ground it stands on: `inverse`, `forward`, `slip`, and `traction` without a map.

mod motion;
mod quick;
mod results;
mod slip;
mod stand;
mod traction;

pub use quick::install;
pub use results::{GroundCommand, GroundMotion};
pub use slip::{BodySlip, WheelSlip, body_slip};
pub use traction::Traction;

use numpy::Element;
use pyo3::prelude::*;

use crate::convert::{Output, memory};

fn done(array: Output<'_>) -> PyResult<Py<PyAny>> {
    Ok(array.finish_any()?.into_any().unbind())
}

/// The array of one call's numbers.
fn array<T: Element + Copy>(py: Python<'_>, values: &[T]) -> PyResult<Py<PyAny>> {
    let array = memory::array(py, values, &[values.len()])?;
    Ok(array.into_any().unbind())
}
