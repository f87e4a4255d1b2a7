//! `RockerBogie.planar`, `RockerBogie.icr_offset` and `RockerBogie.steer`.

use pyo3::prelude::*;
use six_wheel_kinematics::rover::Inputs;
use six_wheel_terrain::suspension::WHEELS;

use super::RockerBogie;
use super::chain::Joints;
use crate::batch::any_workers;
use crate::convert::{Output, Rows, Scalars, compute, given, joined, memory, named, scalar_or_array, together};
use crate::given;
use crate::rover::Rover;

/// What the wheels have to do for a forward speed and a yaw rate.
#[pyclass(frozen, get_all, module = "six_wheel")]
pub struct SteeringCommand {
    /// Steering angles, shape (..., steered wheels) [rad].
    steering: Py<PyAny>,
    /// Speeds of all wheels, shape (..., 6) [rad/s].
    wheel_speeds: Py<PyAny>,
    /// Distance of the centre of rotation to the left of the origin [m]; infinite driving straight, NaN at rest.
    turning_radius: Py<PyAny>,
    /// Speed at which each unsteered wheel slides to its left, shape (..., unsteered wheels) [m/s].
    scrub: Py<PyAny>,
}

#[pymethods]
impl SteeringCommand {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let text = |value: &Py<PyAny>| value.bind(py).repr().map(|repr| repr.to_string());
        Ok(format!(
            "SteeringCommand(steering={}, wheel_speeds={}, turning_radius={}, scrub={})",
            text(&self.steering)?,
            text(&self.wheel_speeds)?,
            text(&self.turning_radius)?,
            text(&self.scrub)?,
        ))
    }
}

#[pymethods]
impl RockerBogie {
    /// The rover seen from above: its wheels where the suspension puts their centres.
    ///
    /// Parameters
    /// ----------
    /// rho : float
    ///     Angle of the left rocker [rad]; the right one has ``-rho``.
    /// beta : array_like, shape (2,)
    ///     Angles of the left and the right bogie against their rockers [rad].
    ///
    /// Returns
    /// -------
    /// Rover
    ///     With the origin of R; wheels front_left, front_right, middle_left, middle_right, rear_left, rear_right.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an angle is not finite or a shape does not fit.
    fn planar(&self, py: Python<'_>, rho: &Bound<'_, PyAny>, beta: &Bound<'_, PyAny>) -> PyResult<Rover> {
        let (rho, beta) = Joints::read_one(rho, beta)?;
        Rover::named(py, self.0.planar(rho, beta))
    }

    /// How far behind the origin the unsteered wheels want the centre of rotation: x_R of the papers.
    ///
    /// Turning about a point of the line ``x = -icr_offset`` they scrub least. It moves with the suspension.
    ///
    /// Parameters
    /// ----------
    /// rho : float or array_like, shape (...)
    ///     Angle of the left rocker [rad]; the right one has ``-rho``.
    /// beta : array_like, shape (..., 2)
    ///     Angles of the left and the right bogie against their rockers [rad].
    /// out : ndarray, shape (...), optional
    ///     Where to write the result.
    /// dtype : dtype, optional
    ///     float32 for a result of single precision, default float64.
    /// threads : int, optional
    ///     Threads at most; default that of `set_default_threads`.
    ///
    /// Returns
    /// -------
    /// float or ndarray, shape (...)
    ///     Mean of the unsteered wheels' x, negated [m].
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If an angle is not finite or a shape does not fit.
    #[pyo3(signature = (rho, beta, *, out=None, dtype=None, threads=None))]
    fn icr_offset<'py>(
        &self,
        py: Python<'py>,
        rho: &Bound<'py, PyAny>,
        beta: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
        dtype: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = given::threads)] threads: Option<i64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let workers = any_workers(threads, None)?;
        let mut joints = Joints::read(rho, beta)?;
        together(joints.both())?;
        let rows = memory::gathered((0..joints.beta.count()).map(|k| joints.row(k)))?;
        let mut offsets = Output::asked(py, (out, dtype), &joints.beta.leading)?;
        if out.is_some() {
            offsets = offsets.beside()?; // a row may be refused after others
        }
        let targets = [(offsets.flat(), 1)];
        compute(py, rows.len(), || {
            workers.rows(rows.len(), targets, |k, [target]| {
                let (rho, beta) = rows[k];
                let offset = self.0.icr_offset(rho, beta);
                target[0] = offset.map_err(|error| error.at_row(k))?;
                Ok(())
            })
        })
        .map_err(|error| joints.raise(error))?;
        offsets.finish_number(out)
    }

    /// What the wheels have to do for a forward speed and a yaw rate, and how much the unsteered ones scrub.
    ///
    /// The point of the line of `icr_offset` abreast of the origin moves straight ahead: this is
    /// ``planar(rho, beta).inverse((speed, 0, yaw_rate), centre=(-icr_offset, 0))``.
    ///
    /// Parameters
    /// ----------
    /// speed : float or array_like, shape (...)
    ///     Forward speed of the origin of R [m/s].
    /// yaw_rate : float or array_like, shape (...)
    ///     Counter-clockwise [rad/s].
    /// rho : float or array_like, shape (...)
    ///     Angle of the left rocker [rad]; the right one has ``-rho``.
    /// beta : array_like, shape (..., 2)
    ///     Angles of the left and the right bogie against their rockers [rad].
    /// previous : array_like, shape (..., steered wheels), optional
    ///     Present steering angles [rad], default 0; a wheel whose pivot rests holds them.
    /// previous_speeds : array_like, shape (..., 6), optional
    ///     Present wheel speeds [rad/s]: which way round wheels go on that could go either way.
    /// threads : int, optional
    ///     Threads at most; default that of `set_default_threads`.
    ///
    /// Returns
    /// -------
    /// SteeringCommand
    ///     `steering` [rad], `wheel_speeds` [rad/s], `turning_radius` [m], `scrub` [m/s].
    ///
    /// Raises
    /// ------
    /// InfeasibleMotionError
    ///     If a wheel would steer past its limit.
    /// ValueError
    ///     If a value is not finite or a shape does not fit.
    ///
    /// Source: M. Tarokh, G. McDermott, S. Hayati, J. Hung, Kinematic modeling of a high mobility Mars rover,
    /// ICRA 1999.
    #[pyo3(signature = (speed, yaw_rate, rho, beta, *, previous=None, previous_speeds=None, threads=None))]
    #[allow(clippy::too_many_arguments)] // they are keywords
    fn steer<'py>(
        &self,
        py: Python<'py>,
        speed: &Bound<'py, PyAny>,
        yaw_rate: &Bound<'py, PyAny>,
        rho: &Bound<'py, PyAny>,
        beta: &Bound<'py, PyAny>,
        previous: Option<&Bound<'py, PyAny>>,
        previous_speeds: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = given::threads)] threads: Option<i64>,
    ) -> PyResult<SteeringCommand> {
        let workers = any_workers(threads, None)?;
        let steered = self.steered().len();
        let mut joints = Joints::read(rho, beta)?;
        let read = |argument: &'static str, value| {
            let scalars = Scalars::read(argument, value)?;
            scalars.check_finite(argument)?;
            PyResult::Ok(scalars)
        };
        let (mut speeds, mut yaw_rates) = (read("speed", speed)?, read("yaw_rate", yaw_rate)?);
        let optional = |argument, value: Option<&Bound<'py, PyAny>>, width| {
            value.map(|value| Rows::read(argument, value, width)).transpose()
        };
        let mut previous = optional("previous", previous, steered)?;
        let mut rolling = optional("previous_speeds", previous_speeds, WHEELS.len())?;
        let all = joints
            .both()
            .into_iter()
            .chain([named("speed", &mut speeds), named("yaw_rate", &mut yaw_rates)])
            .chain(given("previous", &mut previous))
            .chain(given("previous_speeds", &mut rolling));
        let leading = together(all)?;
        let (previous, rolling) = (previous.as_ref().map(Rows::flat), rolling.as_ref().map(Rows::flat));
        let motion = |k| (speeds.at(k), yaw_rates.at(k), joints.row(k));
        let motions = memory::gathered((0..joints.beta.count()).map(motion))?;
        let output = |width| Output::fresh(py, &joined(&leading, width));
        let (mut steering, mut wheel_speeds) = (output(steered)?, output(WHEELS.len())?);
        let unsteered = WHEELS.len() - steered;
        let mut scrub = output(unsteered)?;
        let mut radii = memory::filled(0.0, motions.len())?;
        let targets = [
            (steering.flat(), steered),
            (wheel_speeds.flat(), WHEELS.len()),
            (scrub.flat(), unsteered),
            (&mut radii[..], 1),
        ];
        compute(py, motions.len(), || {
            workers.rows(motions.len(), targets, |k, [angles, speeds, scrubs, radius]| {
                let (speed, yaw_rate, (rho, beta)) = motions[k];
                let row = |width: usize| k * width..(k + 1) * width;
                let inputs = Inputs {
                    previous: previous.map(|angles| &angles[row(steered)]),
                    previous_speeds: rolling.map(|speeds| &speeds[row(WHEELS.len())]),
                    steering_rates: None,
                };
                let command = self.0.steer(speed, yaw_rate, rho, beta, inputs);
                let command = command.map_err(|error| error.at_row(k))?;
                angles.copy_from_slice(&command.steering);
                speeds.copy_from_slice(&command.wheel_speeds);
                scrubs.copy_from_slice(&command.scrub);
                radius[0] = command.turning_radius;
                Ok(())
            })
        })
        .map_err(|error| joints.raise(error))?;
        let array = |output: Output<'py>| PyResult::Ok(output.finish()?.into_any().unbind());
        Ok(SteeringCommand {
            turning_radius: scalar_or_array(py, radii, &leading)?,
            steering: array(steering)?,
            wheel_speeds: array(wheel_speeds)?,
            scrub: array(scrub)?,
        })
    }
}
