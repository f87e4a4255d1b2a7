//! `Suspension.traction`.

use pyo3::prelude::*;
use pyo3::types::PyFloat;
use six_wheel_ground_motion::{Drives, Driving, Lift, Turns, traction_rows};
use six_wheel_terrain::suspension::MAX_WHEELS;

use super::results::{Columns, array};
use crate::convert::{Out, Rows, compute_rows, joined, memory, refuse, scalar_or_array, together};
use crate::suspension::Suspension;
use crate::workers::workers;

/// Wheels over ground that nobody has mapped.
#[pyclass(frozen, module = "six_wheel")]
pub struct Traction(pub(super) Columns<5, TractionRow>);

/// The numbers of one row.
#[derive(Default)]
pub struct TractionRow {
    pub wheels: usize,
    pub steered: usize,
    pub speeds: [f64; MAX_WHEELS],
    pub steering: [f64; MAX_WHEELS],
    pub contact_angles: [f64; MAX_WHEELS],
    pub lifted: [bool; MAX_WHEELS],
    pub vertical: f64,
}

getters! { Traction, self, py:
    /// Speed of every wheel against the link that carries it, shape (..., wheels) [rad/s].
    wheel_speeds: PyResult<Py<PyAny>> = self.0.get(py, 0, |one| array(py, &one.speeds[..one.wheels]));
    /// Steering angles, shape (..., steered wheels) [rad].
    steering: PyResult<Py<PyAny>> = self.0.get(py, 1, |one| array(py, &one.steering[..one.steered]));
    /// Angle at which every wheel touches the ground, positive towards the front, shape (..., wheels) [rad].
    contact_angles: PyResult<Py<PyAny>> = self.0.get(py, 2, |one| array(py, &one.contact_angles[..one.wheels]));
    /// True if the joints lift or drop the wheel as no ground would, shape (..., wheels) of bool.
    lifted: PyResult<Py<PyAny>> = self.0.get(py, 3, |one| array(py, &one.lifted[..one.wheels]));
    /// Vertical speed of the body's origin in its axes, shape (...) [m/s].
    vertical_speed: PyResult<Py<PyAny>> = self.0.get(py, 4, |one| Ok(PyFloat::new(py, one.vertical).into_any().unbind()));
}

repr_of_attributes! { Traction: wheel_speeds steering }

pickled_by_fields! { Traction, this, py:
    (columns: [Py<PyAny>; 5] = [
        this.wheel_speeds(py)?, this.steering(py)?, this.contact_angles(py)?, this.lifted(py)?, this.vertical_speed(py)?,
    ],)
    Self(Columns::Batch(columns))
}

/// True and the curvature, or false and the yaw rate: one of them is given.
fn read_turn<'py>(
    curvature: Option<&Bound<'py, PyAny>>,
    yaw_rate: Option<&Bound<'py, PyAny>>,
) -> PyResult<(bool, Rows<'py>)> {
    match (curvature, yaw_rate) {
        (Some(curvature), None) => Ok((true, Rows::read_numbers("curvature", curvature)?.finite()?)),
        (None, Some(yaw_rate)) => Ok((false, Rows::read_numbers("yaw_rate", yaw_rate)?.finite()?)),
        (Some(_), Some(_)) => Err(refuse("curvature", "be None where yaw_rate is given", "both")),
        (None, None) => Err(refuse("curvature", "be given, or yaw_rate", "neither")),
    }
}

/// Thresholds from which a wheel counts as lifted, neither below 0.
fn read_lift(angle: f64, speed: f64) -> PyResult<Lift> {
    for (name, value) in [("lift_angle", angle), ("lift_speed", speed)] {
        if value.is_nan() || value < 0.0 {
            return Err(refuse(name, "be a number not below 0", value));
        }
    }
    Ok(Lift { angle: angle.min(std::f64::consts::FRAC_PI_2), speed })
}

methods! { Suspension:
    /// Wheel speeds over rough ground without a map of it, as a rover's traction control needs them.
    ///
    /// The rates of body and joints say how every wheel's centre moves. A wheel on the ground moves along its rim's
    /// tangent there: the direction is its contact angle, the length its rolling speed, less the turning of
    /// the link that carries it. The vertical speed of the body shows in no rate. It is the median over the
    /// wheels of the one at which a wheel would move along its link, or, where wheel speeds were measured,
    /// the one that fits them best. With all rates 0 and the joints at 0 this is the rover seen from above.
    #[doc = section!(Parameters)]
    /// speed : float or array_like, shape (...)
    ///     Commanded forward speed of the body [m/s].
    /// curvature : float or array_like, shape (...) or None
    ///     Commanded yaw rate per speed, positive to the left [1/m]. None with `yaw_rate`.
    /// angular_velocity : array_like, shape (..., 3)
    ///     Of the body about its own axes, from an IMU [rad/s]. The yaw rate is the commanded one: a rover that is
    ///     told to turn while it stands has to begin.
    /// joints : array_like, shape (..., joints)
    ///     Free angles: rho, beta_1, beta_2 of a rocker-bogie [rad].
    /// joint_rates : array_like, shape (..., joints)
    ///     Their rates [rad/s].
    /// yaw_rate : float or array_like, shape (...), optional
    ///     Commanded yaw rate [rad/s] instead of a curvature: turns on the spot have none.
    /// steering : array_like, shape (..., steered wheels), optional
    ///     Present steering angles [rad], default 0: a wheel whose pivot rests holds them.
    /// wheel_speeds : array_like, shape (..., wheels), optional
    ///     Measured speeds [rad/s], from which the vertical speed then comes.
    /// lift_angle, lift_speed : float, default 1.0 and 0.01
    ///     A wheel that moves across its link faster than `lift_speed` [m/s], and than a slope of `lift_angle` [rad]
    ///     would push it at the commanded speed, is flagged in `lifted`: a wheelie, or a fall.
    /// out : tuple of ndarray, optional
    ///     Arrays for wheel speeds, steering and contact angles, in this order, of the shapes of the result; what is
    ///     left out, or None, is fresh. Nothing is written by a call that fails.
    #[doc = parameters!(threads, level)]
    #[doc = returns!("Traction")]
    ///     `wheel_speeds` [rad/s], `steering` [rad], `contact_angles` [rad], `lifted`, `vertical_speed` [m/s].
    #[doc = raises!(
        InfeasibleMotionError: "If a wheel would steer past its limit.",
        ValueError: "If a number is not finite or a shape does not fit."
    )]
    ///
    /// Source: O. Toupet et al., Terrain-adaptive wheel speed control on the Curiosity Mars rover, JFR 37(5), 2020.
    fn traction[&self, py: Python<'py>](speed, curvature: native Option<&Bound<'py, PyAny>>, angular_velocity, joints,
        joint_rates, *, yaw_rate=None, steering=None, wheel_speeds=None, lift_angle: f64 = 1.0, lift_speed: f64 = 0.01,
        out=None, threads: Option<i64> = None, level: Option<&str> = None) -> PyResult<Traction> {
        let chain = &self.chain;
        let (wheels, free, steered) = (chain.wheels().len(), chain.joints().len(), chain.steering().len());
        let mut turning = Rows::read("angular_velocity", angular_velocity, 3)?.finite()?;
        let mut angles = Rows::read("joints", joints, free)?.finite()?;
        let mut rates = Rows::read("joint_rates", joint_rates, free)?.finite()?;
        let mut present = Rows::read_optional("steering", steering, steered)?.map(Rows::finite).transpose()?;
        let mut measured = Rows::read_optional("wheel_speeds", wheel_speeds, wheels)?.map(Rows::finite).transpose()?;
        let mut speed = Rows::read_numbers("speed", speed)?.finite()?;
        let (curved, mut turn) = read_turn(curvature, yaw_rate)?;
        let leading = together([&mut turning, &mut angles, &mut rates, &mut speed, &mut turn, &mut present, &mut measured])?;
        let count = turning.count();
        let lift = read_lift(lift_angle, lift_speed)?;
        let workers = workers(threads, level)?;
        let shapes = [wheels, steered, wheels].map(|width| joined(&leading, width));
        let mut results = Out::read(out, ["wheel_speeds", "steering", "contact_angles"])?.results(py, shapes, None, true)?;
        let mut lifted = memory::filled(false, count * wheels)?;
        let mut vertical = memory::filled(0.0, count)?;
        let driving = Driving {
            speed: speed.flat(),
            turning: if curved { Turns::Curvature(turn.flat()) } else { Turns::YawRate(turn.flat()) },
            angular_velocity: turning.triples(),
            joints: angles.flat(),
            joint_rates: rates.flat(),
            steering: present.as_ref().map(Rows::flat),
            wheel_speeds: measured.as_ref().map(Rows::flat),
            lift,
        };
        let [speeds, steers, contacts] = results.flat();
        let drives =
            Drives { steering: steers, speeds, contact_angles: contacts, lifted: &mut lifted, vertical: &mut vertical };
        compute_rows(py, count, &leading, || traction_rows(chain, &self.motion, &driving, drives, workers))?;
        let [speeds, steering, contacts] = results.finish_arrays()?;
        let lifted = scalar_or_array(py, lifted, &joined(&leading, wheels))?;
        let vertical_speed = scalar_or_array(py, vertical, &leading)?;
        Ok(Traction(Columns::Batch([speeds, steering, contacts, lifted, vertical_speed])))
    }
}
