//! `six_wheel.Fit`, a twist with everything the wheels say about it, and `Rover.fit`.

use std::str::FromStr;

use pyo3::prelude::*;
use pyo3::types::PyString;
use six_wheel_core::{Fit as CoreFit, Method, Twist, batch};

use crate::convert::{Output, compute, joined, nested, raise, scalar_or_array};
use crate::kinematics::unseen;
use crate::rover::Rover;

/// Twist fitted to the readings of all wheels, with what speaks for and against it.
#[pyclass(frozen, module = "six_wheel")]
pub struct Fit {
    /// ``[vx, vy, omega]`` in body axes, shape (..., 3) [m/s, m/s, rad/s].
    #[pyo3(get)]
    pub twist: Py<PyAny>,
    /// Speed at which each wheel contradicts the twist, shape (..., wheels) [m/s].
    #[pyo3(get)]
    pub residual: Py<PyAny>,
    /// Independent directions of the twist that the readings determine: 3 if all.
    #[pyo3(get)]
    pub rank: Py<PyAny>,
    /// Smallest singular value of the stacked, weighted rows of the wheel equation.
    #[pyo3(get)]
    pub sigma_min: Py<PyAny>,
    /// Say of each wheel, shape (..., wheels), 0 to 1.
    #[pyo3(get)]
    pub weights: Py<PyAny>,
    rover: Py<Rover>,
    /// Index of the wheel with the largest residual, row after row. Their names are made when somebody asks.
    worst: Vec<u8>,
    leading: Vec<usize>,
}

#[pymethods]
impl Fit {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let text = |value: &Py<PyAny>| value.bind(py).repr().map(|repr| repr.to_string());
        Ok(format!(
            "Fit(twist={}, residual={}, rank={}, sigma_min={}, weights={}, worst_wheel={})",
            text(&self.twist)?,
            text(&self.residual)?,
            text(&self.rank)?,
            text(&self.sigma_min)?,
            text(&self.weights)?,
            self.worst_wheel(py)?.repr()?,
        ))
    }

    /// Name of the wheel with the largest residual; nested lists of names for a batch.
    #[getter]
    fn worst_wheel<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let wheels = self.rover.get().core.wheels();
        let names: Vec<_> = (wheels.iter())
            .map(|wheel| PyString::new(py, &wheel.name).into_any())
            .collect();
        let worst = self.worst.iter().map(|&i| names[usize::from(i)].clone());
        nested(py, worst.collect(), &self.leading)
    }
}

/// Index of the largest number.
fn largest(numbers: &[f64]) -> u8 {
    let numbers = numbers.iter().zip(0..);
    let largest = numbers.max_by(|a, b| a.0.total_cmp(b.0));
    largest.map_or(0, |(_, i)| i)
}

#[pymethods]
impl Rover {
    /// The twist with residual and weight of every wheel: the slip, and the cheapest fault detector.
    ///
    /// Parameters
    /// ----------
    /// steering : array_like, shape (..., steered wheels)
    ///     Steering angles [rad]; None for a rover that does not steer.
    /// speeds : array_like, shape (..., wheels)
    ///     Wheel speeds [rad/s]; NaN where a passive wheel has no encoder.
    /// method : {'least_squares', 'middle_wheels', 'robust'}
    ///     All wheels alike; the unsteered wheels alone; or re-weighted so that a wheel that disagrees with
    ///     the others loses its say (Geman-McClure weights, graduated).
    /// steering_rates : array_like, shape (..., steered wheels), optional
    ///     Rates of the steering angles [rad/s], default 0; they matter to wheels with scrub or trail.
    /// allow_underdetermined : bool
    ///     Take a motion that no wheel sees to be zero instead of raising.
    ///
    /// Returns
    /// -------
    /// Fit
    ///     `twist`, `residual` [m/s], `rank`, `sigma_min`, `weights`, `worst_wheel`.
    ///
    /// Raises
    /// ------
    /// UnderdeterminedError
    ///     If the wheels that count do not determine the twist.
    /// ValueError
    ///     If a value is not finite, a shape does not fit or the method is unknown.
    #[pyo3(signature = (steering, speeds, *, method="least_squares", steering_rates=None, allow_underdetermined=false))]
    fn fit<'py>(
        slf: &Bound<'py, Self>,
        py: Python<'py>,
        steering: &Bound<'py, PyAny>,
        speeds: &Bound<'py, PyAny>,
        method: &str,
        steering_rates: Option<&Bound<'py, PyAny>>,
        allow_underdetermined: bool,
    ) -> PyResult<Fit> {
        let this = slf.get();
        let method = Method::from_str(method).map_err(|error| raise(error, &[]))?;
        let readings = this.read_log(steering, speeds, steering_rates)?;
        let leading = readings.speeds.leading.as_slice();
        let output = |width| Output::new(py, "out", None, &joined(leading, width), &[]);
        let (mut twist, mut residual) = (output(3)?, output(this.count())?);
        let mut weights = output(this.count())?;
        let none = CoreFit {
            twist: Twist::ZERO,
            rank: 0,
            sigma_min: 0.0,
        };
        let mut fits = vec![none; readings.speeds.count()];
        let unseen = unseen(allow_underdetermined);
        let (log, slips, says) = (readings.log(), residual.flat(), weights.flat());
        compute(py, fits.len(), || {
            batch::fit(&this.core, log, method, unseen, &mut fits, slips, says)
        })
        .map_err(|error| raise(error, leading))?;
        for (fit, target) in fits.iter().zip(twist.triples()) {
            *target = fit.twist.into();
        }
        let worst = slips.chunks(this.count()).map(largest).collect();
        let ranks = fits.iter().map(|fit| fit.rank as i64);
        let sigmas = fits.iter().map(|fit| fit.sigma_min);
        Ok(Fit {
            rank: scalar_or_array(py, ranks.collect(), leading)?,
            sigma_min: scalar_or_array(py, sigmas.collect(), leading)?,
            rover: slf.clone().unbind(),
            worst,
            leading: leading.to_vec(),
            twist: twist.finish()?.into_any().unbind(),
            residual: residual.finish()?.into_any().unbind(),
            weights: weights.finish()?.into_any().unbind(),
        })
    }
}
