//! `six_wheel.MarginJacobian`: derivatives of what settled poses mean.

use pyo3::prelude::*;
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_terrain::bounds;

use super::stand::Stand;
use crate::convert::{Results, joined};
use crate::workers::fill_rows;

result_class! {
    /// Derivatives of margins by x, y and yaw, or by the dimensions of a rocker-bogie in the order of `SettledPose.by_dimension`, with
    /// belly and centre of mass as they are. NaN where the rover does not stand, and of a tilt of 0.
    pub struct MarginJacobian {
        /// Of `Stability.tip_over_angle`, shape (..., 3) or (..., 16).
        tip_over_angle: Py<PyAny>,
        /// Of `Stability.clearance`, shape (..., 3) or (..., 16).
        clearance: Py<PyAny>,
        /// Of `Stability.joint_margins`, shape (..., joints, 3) or (..., joints, 16).
        joint_margins: Py<PyAny>,
        /// Of `Stability.tilt`, shape (..., 3) or (..., 16).
        tilt: Py<PyAny>,
    }
    repr { tip_over_angle clearance joint_margins tilt }
}

/// By `N` numbers, row after row; None for a row without.
pub fn slopes<const N: usize>(
    py: Python<'_>,
    stand: &Stand,
    workers: Workers,
    of: impl Fn(usize) -> Option<bounds::MarginSlopes<N>> + Sync + Send,
) -> PyResult<Py<MarginJacobian>> {
    let joints = stand.suspension.get().chain.joints().len();
    let one = joined(&stand.leading, N);
    let shapes = [one.clone(), one.clone(), joined(&joined(&stand.leading, joints), N), one];
    let mut results = Results::fresh(py, shapes)?;
    let [tipping, clear, turns, tilts] = results.flat();
    let count = stand.stands.len();
    let rows = [(tipping, N), (clear, N), (turns, joints * N), (tilts, N)];
    fill_rows(py, workers, count, &stand.leading, rows, |k, [tipping, clear, turns, tilts]| {
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
    })?;
    let [tip_over_angle, clearance, joint_margins, tilt] = results.finish_arrays()?;
    Py::new(py, MarginJacobian { tip_over_angle, clearance, joint_margins, tilt })
}
