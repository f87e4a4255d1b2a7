//! `six_wheel.MarginSlopes`: derivatives of what settled poses mean.

use pyo3::prelude::*;
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_terrain::bounds;

use crate::convert::{Output, compute, raise};
use crate::ground::Stand;

/// Derivatives of margins by x, y and yaw, or by the dimensions of a rocker-bogie in the order of `Stand.by_dimension`, with
/// belly and centre of mass as they are. NaN where the rover does not stand, and of a tilt of 0.
#[pyclass(frozen, get_all, module = "six_wheel")]
pub struct MarginSlopes {
    /// Of `Stability.tip_over_angle`, shape (..., 3) or (..., 16).
    tip_over_angle: Py<PyAny>,
    /// Of `Stability.clearance`, shape (..., 3) or (..., 16).
    clearance: Py<PyAny>,
    /// Of `Stability.joint_margins`, shape (..., joints, 3) or (..., joints, 16).
    joint_margins: Py<PyAny>,
    /// Of `Stability.tilt`, shape (..., 3) or (..., 16).
    tilt: Py<PyAny>,
}

#[pymethods]
impl MarginSlopes {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let text = |value: &Py<PyAny>| value.bind(py).repr().map(|repr| repr.to_string());
        Ok(format!(
            "MarginSlopes(tip_over_angle={}, clearance={}, joint_margins={}, tilt={})",
            text(&self.tip_over_angle)?,
            text(&self.clearance)?,
            text(&self.joint_margins)?,
            text(&self.tilt)?,
        ))
    }
}

/// By `N` numbers, row after row; None for a row without.
pub fn slopes<const N: usize>(
    py: Python<'_>,
    stand: &Stand,
    workers: Workers,
    of: impl Fn(usize) -> Option<bounds::MarginSlopes<N>> + Sync + Send,
) -> PyResult<Py<MarginSlopes>> {
    let joints = stand.suspension.get().chain.joints().len();
    let output = |last: &[usize]| {
        let shape: Vec<usize> = stand.leading.iter().chain(last).copied().collect();
        Output::fresh(py, &shape)
    };
    let mut outputs = [output(&[N])?, output(&[N])?, output(&[joints, N])?, output(&[N])?];
    let [tipping, clear, turns, tilts] = outputs.each_mut().map(|output| output.flat());
    let count = stand.stands.len();
    let rows = [(tipping, N), (clear, N), (turns, joints * N), (tilts, N)];
    compute(py, count, || {
        workers.rows(count, rows, |k, [tipping, clear, turns, tilts]| {
            let Some(found) = of(k) else {
                for row in [tipping, clear, turns, tilts] {
                    row.fill(f64::NAN);
                }
                return Ok(());
            };
            tipping.copy_from_slice(&found.tip_over_angle);
            clear.copy_from_slice(&found.clearance);
            tilts.copy_from_slice(&found.tilt);
            for (row, joint) in turns.chunks_exact_mut(N).zip(&found.joints) {
                row.copy_from_slice(joint);
            }
            Ok(())
        })
    })
    .map_err(|error| raise(error, &stand.leading))?;
    let [tipping, clear, turns, tilts] = outputs;
    let done = |output: Output<'_>| PyResult::Ok(output.finish()?.into_any().unbind());
    let slopes = MarginSlopes {
        tip_over_angle: done(tipping)?,
        clearance: done(clear)?,
        joint_margins: done(turns)?,
        tilt: done(tilts)?,
    };
    Py::new(py, slopes)
}
