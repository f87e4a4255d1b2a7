//! `RockerBogie.planar`, `RockerBogie.icr_offset` and `RockerBogie.steer`.

use pyo3::prelude::*;
use six_wheel_core::Inputs;
use six_wheel_core::suspension::{self as core, WHEELS};

use super::RockerBogie;
use super::chain::Joints;
use crate::convert::{Output, Rows, Scalars, compute, joined, scalar_or_array};
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
    fn planar(
        &self,
        py: Python<'_>,
        rho: &Bound<'_, PyAny>,
        beta: &Bound<'_, PyAny>,
    ) -> PyResult<Rover> {
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
    fn icr_offset(
        &self,
        py: Python<'_>,
        rho: &Bound<'_, PyAny>,
        beta: &Bound<'_, PyAny>,
    ) -> PyResult<Py<PyAny>> {
        let joints = Joints::read(rho, beta)?;
        let rows: Vec<_> = (0..joints.beta.count()).map(|k| joints.row(k)).collect();
        let offset = |(k, &(rho, beta)): (usize, &(f64, [f64; 2]))| {
            let offset = self.0.icr_offset(rho, beta);
            offset.map_err(|error| error.at_row(k))
        };
        let offsets = compute(py, rows.len(), || {
            rows.iter()
                .enumerate()
                .map(offset)
                .collect::<Result<_, _>>()
        })
        .map_err(|error| joints.raise(error))?;
        scalar_or_array(py, offsets, &joints.beta.leading)
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
    #[pyo3(signature = (speed, yaw_rate, rho, beta, *, previous=None, previous_speeds=None))]
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
    ) -> PyResult<SteeringCommand> {
        let joints = Joints::read(rho, beta)?;
        let (leading, steered) = (joints.beta.leading.as_slice(), self.steered().len());
        let read = |argument: &'static str, value| {
            let scalars = Scalars::read(argument, value)?;
            scalars.fit(argument, leading)?;
            scalars.check_finite(argument)?;
            PyResult::Ok(scalars)
        };
        let (speeds, yaw_rates) = (read("speed", speed)?, read("yaw_rate", yaw_rate)?);
        let previous = Rows::read_beside("previous", previous, steered, leading)?;
        let rolling = Rows::read_beside("previous_speeds", previous_speeds, WHEELS.len(), leading)?;
        let (previous, rolling) = (
            previous.as_ref().map(Rows::flat),
            rolling.as_ref().map(Rows::flat),
        );
        let motions: Vec<_> = (0..joints.beta.count())
            .map(|k| (speeds.at(k), yaw_rates.at(k), joints.row(k)))
            .collect();
        let steer = |(k, &(speed, yaw_rate, (rho, beta))): (usize, &_)| {
            let inputs = Inputs {
                previous: previous.map(|angles| &angles[k * steered..][..steered]),
                previous_speeds: rolling.map(|speeds| &speeds[k * WHEELS.len()..][..WHEELS.len()]),
                steering_rates: None,
            };
            let command = self.0.steer(speed, yaw_rate, rho, beta, inputs);
            command.map_err(|error| error.at_row(k))
        };
        let commands: Vec<core::SteeringCommand> = compute(py, motions.len(), || {
            motions
                .iter()
                .enumerate()
                .map(steer)
                .collect::<Result<_, _>>()
        })
        .map_err(|error| joints.raise(error))?;
        let write = |width, row: fn(&core::SteeringCommand) -> &[f64]| {
            let mut array = Output::new(py, "out", None, &joined(leading, width), &[])?;
            for (target, command) in array.flat().chunks_exact_mut(width.max(1)).zip(&commands) {
                target.copy_from_slice(row(command));
            }
            PyResult::Ok(array.finish()?.into_any().unbind())
        };
        let radii = commands.iter().map(|command| command.turning_radius);
        Ok(SteeringCommand {
            turning_radius: scalar_or_array(py, radii.collect(), leading)?,
            steering: write(steered, |command| &command.steering)?,
            wheel_speeds: write(WHEELS.len(), |command| &command.wheel_speeds)?,
            scrub: write(WHEELS.len() - steered, |command| &command.scrub)?,
        })
    }
}
