//! `Rover.inverse` and `Rover.forward`.

mod quick;

use pyo3::prelude::*;
use pyo3::types::PyTuple;
use six_wheel_core::batch::{self, Beside, Log, Table, Workers};
use six_wheel_core::{Twist, Unseen};

use crate::batch::any_workers;
use crate::convert::{Array, Output, Rows, compute, disjoint, joined, raise, refuse};
use crate::rover::Rover;

pub use quick::install;

/// What a log holds, as read from Python.
pub struct Readings<'py> {
    steering: Option<Rows<'py>>,
    pub speeds: Rows<'py>,
    rates: Option<Rows<'py>>,
}

impl Readings<'_> {
    /// All of it, for the batches.
    fn tables(&self) -> batch::Readings<'_> {
        batch::Readings {
            steering: self.steering.as_ref().map_or(Table::Flat(&[]), Rows::table),
            speeds: self.speeds.table(),
            steering_rates: self.rates.as_ref().map(Rows::table),
        }
    }

    /// All of it, as the core takes it.
    pub fn log(&self) -> Log<'_> {
        Log {
            steering: self.steering.as_ref().map_or(&[], Rows::flat),
            speeds: self.speeds.flat(),
            steering_rates: self.rates.as_ref().map(Rows::flat),
        }
    }
}

/// What the option says about motions that no reading sees.
pub fn unseen(allow_underdetermined: bool) -> Unseen {
    if allow_underdetermined {
        Unseen::Zero
    } else {
        Unseen::Refuse
    }
}

impl Rover {
    /// Reads steering angles, speeds and steering rates of equal leading axes.
    pub fn read_log<'py>(
        &self,
        steering: &Bound<'py, PyAny>,
        speeds: &Bound<'py, PyAny>,
        steering_rates: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Readings<'py>> {
        let speeds = Rows::read("speeds", speeds, self.count())?;
        let given = (!steering.is_none()).then_some(steering);
        let steering = Rows::read_beside("steering", given, self.joints(), &speeds.leading)?;
        if steering.is_none() && self.joints() > 0 {
            return Err(refuse(
                "steering",
                "hold the angles of the steered wheels",
                "None",
            ));
        }
        let rates = Rows::read_beside(
            "steering_rates",
            steering_rates,
            self.joints(),
            &speeds.leading,
        )?;
        Ok(Readings {
            steering,
            speeds,
            rates,
        })
    }
}

#[pymethods]
impl Rover {
    /// What every wheel has to do for the body to move with a twist: angles and speeds.
    ///
    /// Exact at every turning radius: straight, on the spot, with the centre of rotation between the wheels
    /// or under one of them. Of the equivalent angles of a wheel, half a turn apart, the one nearest to
    /// `previous` is taken; a wheel whose pivot rests holds `previous`.
    ///
    /// Parameters
    /// ----------
    /// twist : array_like, shape (..., 3)
    ///     ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s]. Three floats in a tuple or list are fastest.
    /// previous : array_like, shape (..., steered wheels), optional
    ///     Present steering angles [rad], default 0. One outside the range counts as its nearest end.
    /// steering_rates : array_like, shape (..., steered wheels), optional
    ///     Rates of the steering angles [rad/s], default 0; they matter to wheels with scrub or trail.
    /// centre : array_like, shape (2,) or (..., 2), optional
    ///     The point ``[x, y]`` whose velocity `twist` is [m], and about which the rover turns if that is
    ///     zero; default the origin.
    /// previous_speeds : array_like, shape (..., wheels), optional
    ///     Present wheel speeds [rad/s]. A wheel that would have to turn by about 90 degrees either way goes
    ///     with the others of its kind: the way they roll already, otherwise the shorter one for all.
    /// out : (ndarray, ndarray), optional
    ///     Where to write the results; they may be `previous` and `previous_speeds` themselves.
    /// threads : int, optional
    ///     Threads at most, default `default_threads()`; under 20000 rows it is one. No result depends on it.
    /// kernel : str, optional
    ///     One of `kernels()`, default the best: they agree to 4 ulp or 1e-14.
    ///
    /// Returns
    /// -------
    /// steering : ndarray, shape (..., steered wheels)
    ///     Steering angles [rad].
    /// speeds : ndarray, shape (..., wheels)
    ///     Wheel speeds [rad/s].
    ///
    /// Raises
    /// ------
    /// InfeasibleMotionError
    ///     If a wheel would slide sideways or steer past its range; the first bad row is named and nothing
    ///     is written. `project` finds a twist the rover can make.
    /// ValueError
    ///     If a value is not finite or a shape does not fit.
    ///
    /// Source: R. Siegwart, I. Nourbakhsh, D. Scaramuzza, Introduction to Autonomous Mobile Robots, 2nd ed., ch. 3.
    #[pyo3(signature = (twist, *, previous=None, steering_rates=None, centre=None, previous_speeds=None, out=None, threads=None, kernel=None))]
    #[allow(clippy::too_many_arguments)] // they are keywords
    pub fn inverse<'py>(
        &self,
        py: Python<'py>,
        twist: &Bound<'py, PyAny>,
        previous: Option<&Bound<'py, PyAny>>,
        steering_rates: Option<&Bound<'py, PyAny>>,
        centre: Option<&Bound<'py, PyAny>>,
        previous_speeds: Option<&Bound<'py, PyAny>>,
        out: Option<&Bound<'py, PyAny>>,
        threads: Option<i64>,
        kernel: Option<&str>,
    ) -> PyResult<(Array<'py>, Array<'py>)> {
        let mut twists = Rows::read("twist", twist, 3)?;
        if let Some(centre) = centre {
            let centres = Rows::read("centre", centre, 2)?;
            centres.check_finite("centre")?;
            if !centres.is_single() {
                centres.check_leading("centre", &twists.leading)?;
            }
            twists = twists.mapped(|k, row| {
                let pair = centres.pairs()[if centres.is_single() { 0 } else { k }];
                Twist::from(row).about(pair).into()
            });
        }
        let leading = twists.leading.as_slice();
        let mut previous = Rows::read_beside("previous", previous, self.joints(), leading)?;
        let beside = |argument, value, width| Rows::read_beside(argument, value, width, leading);
        let rates = beside("steering_rates", steering_rates, self.joints())?;
        let mut rolling = beside("previous_speeds", previous_speeds, self.count())?;
        let outputs = pair(out)?;
        for (input, out) in [&mut previous, &mut rolling].into_iter().zip(&outputs) {
            if let (Some(input), Some(out)) = (input, out) {
                input.release_if(out);
            }
        }
        if let [Some(first), Some(second)] = &outputs
            && let (Ok(first), Ok(second)) = (first.cast(), second.cast())
        {
            disjoint("out[0]", first, second, "out[1]")?;
        }
        let inputs = [
            Some(&twists),
            previous.as_ref(),
            rates.as_ref(),
            rolling.as_ref(),
        ];
        let [out_steering, out_speeds] = &outputs;
        let output = |argument, out: &Option<Bound<'py, PyAny>>, width| {
            Output::new(py, argument, out.as_ref(), &joined(leading, width), &inputs)
        };
        let mut steering = output("out[0]", out_steering, self.joints())?;
        let mut speeds = output("out[1]", out_speeds, self.count())?;
        let (rows, count) = (twists.table(), twists.count());
        let beside = Beside {
            previous: previous.as_ref().map(Rows::table),
            previous_speeds: rolling.as_ref().map(Rows::table),
            steering_rates: rates.as_ref().map(Rows::table),
        };
        let workers = Workers {
            fresh: out.is_none(),
            ..any_workers(threads, kernel)?
        };
        let (angles, rotations) = (steering.flat(), speeds.flat());
        compute(py, count, || {
            batch::inverse(&self.core, rows, beside, angles, rotations, workers)
        })
        .map_err(|error| raise(error, leading))?;
        Ok((steering.finish()?, speeds.finish()?))
    }

    /// The twist that angles and speeds of all wheels report, by least squares.
    ///
    /// Parameters
    /// ----------
    /// steering : array_like, shape (..., steered wheels)
    ///     Steering angles [rad]; None for a rover that does not steer.
    /// speeds : array_like, shape (..., wheels)
    ///     Wheel speeds [rad/s]; NaN where a passive wheel has no encoder.
    /// steering_rates : array_like, shape (..., steered wheels), optional
    ///     Rates of the steering angles [rad/s], default 0; they matter to wheels with scrub or trail.
    /// allow_underdetermined : bool
    ///     Take a motion that no wheel sees to be zero instead of raising.
    /// out : ndarray, shape (..., 3), optional
    ///     Where to write the result.
    /// threads : int, optional
    ///     Threads at most, default `default_threads()`; under 20000 rows it is one. No result depends on it.
    /// kernel : str, optional
    ///     One of `kernels()`, default the best: they agree to 4 ulp or 1e-14.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (..., 3)
    ///     ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s].
    ///
    /// Raises
    /// ------
    /// UnderdeterminedError
    ///     If the wheels do not determine the twist.
    /// ValueError
    ///     If a value is not finite or a shape does not fit.
    #[pyo3(signature = (steering, speeds, *, steering_rates=None, allow_underdetermined=false, out=None, threads=None, kernel=None))]
    #[allow(clippy::too_many_arguments)] // they are keywords
    fn forward<'py>(
        &self,
        py: Python<'py>,
        steering: &Bound<'py, PyAny>,
        speeds: &Bound<'py, PyAny>,
        steering_rates: Option<&Bound<'py, PyAny>>,
        allow_underdetermined: bool,
        out: Option<&Bound<'py, PyAny>>,
        threads: Option<i64>,
        kernel: Option<&str>,
    ) -> PyResult<Array<'py>> {
        let readings = self.read_log(steering, speeds, steering_rates)?;
        let leading = readings.speeds.leading.as_slice();
        let inputs = [
            Some(&readings.speeds),
            readings.steering.as_ref(),
            readings.rates.as_ref(),
        ];
        let mut twists = Output::new(py, "out", out, &joined(leading, 3), &inputs)?;
        let (tables, target) = (readings.tables(), twists.triples());
        let unseen = unseen(allow_underdetermined);
        let workers = Workers {
            fresh: out.is_none(),
            ..any_workers(threads, kernel)?
        };
        compute(py, target.len(), || {
            batch::forward(&self.core, tables, unseen, target, workers)
        })
        .map_err(|error| raise(error, leading))?;
        twists.finish()
    }
}

/// The two arrays of `out=`, if given.
fn pair<'py>(out: Option<&Bound<'py, PyAny>>) -> PyResult<[Option<Bound<'py, PyAny>>; 2]> {
    let Some(out) = out else {
        return Ok([None, None]);
    };
    let tuple = out.cast::<PyTuple>().ok().filter(|tuple| tuple.len() == 2);
    let Some(tuple) = tuple else {
        let got = out.get_type().name()?.to_string();
        return Err(refuse(
            "out",
            "be a pair of arrays (steering, speeds)",
            &got,
        ));
    };
    Ok([Some(tuple.get_item(0)?), Some(tuple.get_item(1)?)])
}
