//! `six_wheel.TwistFit`, a twist with everything the wheels say about it, and `Rover.fit`.

use numpy::{PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;
use six_wheel_kinematics::batch;
use six_wheel_kinematics::estimate::{Method, worst_wheel};

use super::Rover;
use super::kinematics::unseen;
use crate::convert::{OrRaise, Results, compute_rows, joined, memory, scalar_or_array};
use crate::workers::workers;

result_class! {
    /// Twist fitted to the readings of all wheels, with what speaks for and against it.
    pub struct TwistFit {
        /// ``[vx, vy, omega]`` in body axes, shape (..., 3) [m/s, m/s, rad/s].
        twist: Py<PyAny>,
        /// Speed at which each wheel contradicts the twist, shape (..., wheels) [m/s].
        residuals: Py<PyAny>,
        /// Independent directions of the twist that the readings determine: 3 if all.
        rank: Py<PyAny>,
        /// Smallest singular value of the stacked, weighted rows of the wheel equation.
        sigma_min: Py<PyAny>,
        /// Say of each wheel, shape (..., wheels), 0 to 1.
        weights: Py<PyAny>,
        /// The rover.
        rover: Py<Rover>,
    }
    hidden {
        leading: Vec<usize>,
    }
    repr { twist residuals rank sigma_min weights worst_wheel }
}

getters! { TwistFit, self, py:
    /// Name of the wheel with the largest residual, None where there is none; nested lists of them for a batch.
    worst_wheel: PyResult<Py<PyAny>> = {
        let rover = self.rover.get();
        let residuals = self.residuals.bind(py).cast::<PyArrayDyn<f64>>()?.try_readonly()?;
        let wheels = residuals.as_slice()?.chunks_exact(rover.count());
        rover.names_of(
            py,
            memory::gathered(wheels.map(|slid| worst_wheel(slid).map_or(-1, |wheel| wheel as i64)))?,
            &self.leading,
        )
    };
}

impl Rover {
    /// Names of wheels, None for -1, in nested lists of this shape.
    fn names_of(&self, py: Python<'_>, wheels: Vec<i64>, shape: &[usize]) -> PyResult<Py<PyAny>> {
        let names = self.core.wheels().iter().map(|wheel| Some(wheel.name.as_str()));
        let names: Vec<Option<&str>> = names.chain([None]).collect();
        if let ([], &[wheel]) = (shape, wheels.as_slice()) {
            let name = usize::try_from(wheel).ok().and_then(|wheel| names[wheel]);
            return Ok(name.into_pyobject(py)?.unbind());
        }
        let index = scalar_or_array(py, wheels, shape)?;
        let numpy = py.import("numpy")?;
        let names = numpy.call_method1("array", (names, "O"))?;
        Ok(names.get_item(index)?.call_method0("tolist")?.unbind())
    }
}

methods! { Rover:
    /// The twist with residual and weight of every wheel: the slip, and the cheapest fault detector.
    #[doc = section!(Parameters: wheel_readings)]
    /// method : {'least_squares', 'middle_wheels', 'robust'}
    ///     All wheels alike; the unsteered wheels alone; or re-weighted so that a wheel that disagrees with
    ///     the others loses its say (Geman-McClure weights, graduated).
    #[doc = parameters!(steering_rates)]
    /// allow_underdetermined : bool
    ///     Take a motion that no wheel sees to be zero instead of raising.
    #[doc = parameters!(threads)]
    #[doc = returns!("TwistFit": "`twist`, `residuals` [m/s], `rank`, `sigma_min`, `weights`, `worst_wheel`.")]
    #[doc = raises!(
        UnderdeterminedError: "If the wheels that count do not determine the twist.",
        ValueError: "If a value is not finite, a shape does not fit or the method is unknown."
    )]
    fn fit[slf: &Bound<'py, Self>, py: Python<'py>](steering, wheel_speeds, *, method: &str = "least_squares",
        steering_rates=None, allow_underdetermined: bool = false, threads: Option<i64> = None) -> PyResult<TwistFit> {
        let workers = workers(threads, None)?;
        let this = slf.get();
        let method = method.parse::<Method>().or_raise(&[])?;
        let readings = this.read_log(steering, wheel_speeds, steering_rates)?.flat()?;
        let leading = readings.speeds.leading.as_slice();
        let widths = [3, this.count(), this.count()];
        let mut results = Results::fresh(py, widths.map(|width| joined(leading, width)))?;
        let [twists, residuals, weights] = results.flat();
        let count = readings.speeds.count();
        let (mut ranks, mut sigmas) = (memory::filled(0, count)?, memory::filled(0.0, count)?);
        let unseen = unseen(allow_underdetermined);
        let log = readings.log();
        let fits =
            batch::Fits { twists: twists.as_chunks_mut().0, ranks: &mut ranks, sigmas: &mut sigmas, residual: residuals, weights };
        compute_rows(py, count, leading, || batch::fit(&this.core, log, method, unseen, fits, workers))?;
        let [twist, residuals, weights] = results.finish_arrays()?;
        let (rank, sigma_min) = (scalar_or_array(py, ranks, leading)?, scalar_or_array(py, sigmas, leading)?);
        Ok(TwistFit {
            twist,
            residuals,
            rank,
            sigma_min,
            weights,
            rover: slf.clone().unbind(),
            leading: leading.to_vec(),
        })
    }
}
