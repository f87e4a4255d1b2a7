//! `RockerBogie.icr_offset` and `RockerBogie.steer`.

use pyo3::prelude::*;
use six_wheel_kinematics::rover::Inputs;
use six_wheel_terrain::suspension::WHEELS;

use super::chain::rocker_and_bogies;
use super::rocker_bogie::RockerBogie;
use crate::convert::{Output, Results, Rows, joined, together};
use crate::workers::{fill_rows, workers};

result_class! {
    /// Steering angles and wheel speeds for a forward speed and a yaw rate.
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
    repr { steering wheel_speeds turning_radius scrub }
}

methods! { RockerBogie:
    /// Distance behind the origin of the centre of rotation with the least scrub [m]: x_R of the papers.
    ///
    /// That is a turn about a point of the line ``x = -icr_offset``. The line moves with the suspension.
    #[doc = section!(Parameters: rocker_joints, out "(...)", dtype, threads)]
    #[doc = returns!("float or ndarray, shape (...)": "Mean of the unsteered wheels' x, negated [m].")]
    #[doc = raises!("If an angle is not finite or a shape does not fit.")]
    fn icr_offset[&self, py: Python<'py>](joints, *, out=None, dtype=None, threads: Option<i64> = None)
    -> PyResult<Bound<'py, PyAny>> {
        let workers = workers(threads, None)?;
        let joints = Rows::read("joints", joints, 3)?;
        let rows = joints.triples();
        let mut offsets = Output::asked(py, (out, dtype), &joints.leading)?;
        if out.is_some() {
            offsets = offsets.beside()?; // a row may be refused after others
        }
        let targets = [(offsets.flat(), 1)];
        fill_rows(py, workers, rows.len(), &joints.leading, targets, |k, [target]| {
            let (rho, beta) = rocker_and_bogies(rows[k]);
            target[0] = self.0.icr_offset(rho, beta).map_err(|error| error.at_row(k))?;
            Ok(())
        })?;
        offsets.finish_number(out)
    }

    /// Steering angles and wheel speeds for a forward speed and a yaw rate, and the scrub of the unsteered wheels.
    ///
    /// The point of the line of `icr_offset` abreast of the origin moves straight ahead: this is
    /// ``planar(joints).inverse((speed, 0, yaw_rate), centre=(-icr_offset, 0))``.
    #[doc = section!(Parameters)]
    /// speed : float or array_like, shape (...)
    ///     Forward speed of the origin of R [m/s].
    /// yaw_rate : float or array_like, shape (...)
    ///     Counter-clockwise [rad/s].
    #[doc = parameters!(rocker_joints)]
    /// previous : array_like, shape (..., steered wheels), optional
    ///     Present steering angles [rad], default 0; a wheel whose pivot rests holds them.
    /// previous_wheel_speeds : array_like, shape (..., 6), optional
    ///     Present wheel speeds [rad/s]: which way round wheels go on that could go either way.
    #[doc = parameters!(threads)]
    #[doc = returns!("SteeringCommand")]
    ///     `steering` [rad], `wheel_speeds` [rad/s], `turning_radius` [m], `scrub` [m/s].
    #[doc = raises!(
        InfeasibleMotionError: "If a wheel would steer past its limit.",
        ValueError: "If a value is not finite or a shape does not fit."
    )]
    ///
    /// Source: M. Tarokh, G. McDermott, S. Hayati, J. Hung, Kinematic modeling of a high mobility Mars rover,
    /// ICRA 1999.
    fn steer[&self, py: Python<'py>](speed, yaw_rate, joints, *, previous=None, previous_wheel_speeds=None,
        threads: Option<i64> = None) -> PyResult<SteeringCommand> {
        let workers = workers(threads, None)?;
        let steered = self.steered().len();
        let mut joints = Rows::read("joints", joints, 3)?;
        let mut speeds = Rows::read_numbers("speed", speed)?.finite()?;
        let mut yaw_rates = Rows::read_numbers("yaw_rate", yaw_rate)?.finite()?;
        let mut previous = Rows::read_optional("previous", previous, steered)?;
        let mut rolling = Rows::read_optional("previous_wheel_speeds", previous_wheel_speeds, WHEELS.len())?;
        let leading = together([&mut joints, &mut speeds, &mut yaw_rates, &mut previous, &mut rolling])?;
        let (previous, rolling) = (previous.as_ref().map(Rows::flat), rolling.as_ref().map(Rows::flat));
        let (forward, yaw_rates, rows) = (speeds.steps(), yaw_rates.steps(), joints.triples());
        let unsteered = WHEELS.len() - steered;
        let [a, b, c] = [steered, WHEELS.len(), unsteered].map(|width| joined(&leading, width));
        let mut results = Results::fresh(py, [a, b, c, leading.clone()])?;
        let [steering, wheel_speeds, scrub, radii] = results.flat();
        let targets = [(steering, steered), (wheel_speeds, WHEELS.len()), (scrub, unsteered), (radii, 1)];
        fill_rows(py, workers, rows.len(), &leading, targets, |k, [angles, speeds, scrubs, radius]| {
            let (rho, beta) = rocker_and_bogies(rows[k]);
            let row = |width: usize| k * width..(k + 1) * width;
            let inputs = Inputs {
                previous: previous.map(|angles| &angles[row(steered)]),
                previous_speeds: rolling.map(|speeds| &speeds[row(WHEELS.len())]),
                steering_rates: None,
            };
            let command = self.0.steer(forward.get(k), yaw_rates.get(k), rho, beta, inputs).map_err(|error| error.at_row(k))?;
            angles.copy_from_slice(&command.steering);
            speeds.copy_from_slice(&command.wheel_speeds);
            scrubs.copy_from_slice(&command.scrub);
            radius[0] = command.turning_radius;
            Ok(())
        })?;
        let [steering, wheel_speeds, scrub, turning_radius] = results.finish()?;
        Ok(SteeringCommand { steering, wheel_speeds, turning_radius, scrub })
    }
}
