//! Wheels to twist: the rows of the wheels at one instant, their normal equations and the inverse of these. Sums over the
//! readings are those of [`crate::kernels`].

pub(crate) mod gradients;
mod readings;
pub mod sensitivity;

use nalgebra::{Matrix3, Vector3};

pub use self::readings::{Fit, Measured, Method, Reading, Readings, Unseen};
use crate::geometry::Direction;
use crate::rover_data::{MAX_WHEELS, Mount, RoverData};
use crate::wheels::Pivot;
use six_wheel_numerics::error::{Error, ErrorKind, finite, numbers};
use six_wheel_numerics::jacobi::{Jacobi, triangle};

/// Singular values below this share of the largest are zero.
const RANK_TOLERANCE: f64 = 1e-9;

/// A pivot of the normal equations above this share of their trace determines a direction.
const PIVOT_TOLERANCE: f64 = 1e-13;

/// A component of a motion below this share of the largest one is rounding, and shown as 0.
const VANISHED: f64 = 1e-12;

/// Residual up to which a robust fit takes slip for noise: the larger of this share of the root mean square rim speed
/// and this many times the median residual.
pub(crate) const NOISE: f64 = 0.01;
pub(crate) const MEDIANS: f64 = 3.0;

/// A robust fit has converged when no weight changes by more than this, and stops after this many rounds.
pub(crate) const SETTLED: f64 = 1e-12;
pub(crate) const ROUNDS: usize = 100;

/// Index of the first of the largest residuals; None where every residual is 0 or NaN.
pub fn worst_wheel(residuals: &[f64]) -> Option<usize> {
    let largest = residuals.iter().copied().fold(0.0, f64::max);
    residuals.iter().position(|residual| *residual == largest && largest > 0.0)
}

impl RoverData {
    /// Fails unless every reading is finite, except speeds of wheels without a motor, and small enough for a finite
    /// twist.
    pub(crate) fn check_readings(&self, measured: Measured<'_>) -> Result<(), Error> {
        finite("steering", measured.steering)?;
        let rates = measured.steering_rates.unwrap_or_default();
        finite("steering_rates", rates)?;
        for (wheel, speed) in self.wheels().iter().zip(measured.speeds) {
            if !(speed.is_finite() || speed.is_nan() && !wheel.driven) {
                return Err(Error::value("wheel_speeds", "be finite", numbers(measured.speeds)));
            }
        }
        let largest = |values: &[f64]| values.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let bound = largest(measured.speeds) + largest(rates);
        if (bound * self.reading_bound).is_finite() {
            Ok(())
        } else {
            Err(Error::value("wheel_speeds", "be small enough for a finite twist", numbers(measured.speeds)))
        }
    }

    /// The solution of the normal equations, where it does not depend on the steering angles: a steered
    /// wheel without scrub and trail measures its pivot's whole velocity, whichever way it points.
    pub(crate) fn constant_solution(&self) -> Option<Matrix3<f64>> {
        let centred = |&i: &usize| self.wheels()[i].is_centred();
        if !self.steered().iter().all(centred) {
            return None;
        }
        let zeros = [0.0; MAX_WHEELS];
        let mut readings = [Reading::NONE; MAX_WHEELS];
        let at_rest = Measured { steering: &zeros, speeds: &zeros, steering_rates: None };
        let readings = self.read(at_rest, &mut readings);
        self.solution(self.normal(readings, |_| 1.0), Unseen::Refuse).ok()
    }

    /// The weights of the wheels before any residual is known.
    pub(crate) fn initial_weights(&self, method: Method, weights: &mut [f64]) -> Result<(), Error> {
        weights.fill(1.0);
        if method == Method::MiddleWheels {
            for (weight, wheel) in weights.iter_mut().zip(self.wheels()) {
                *weight = if wheel.pivot == Pivot::Fixed { 1.0 } else { 0.0 };
            }
            if weights.iter().all(|weight| *weight == 0.0) {
                let rule = "be another one for a rover without unsteered wheels";
                return Err(Error::value("method", rule, "'middle_wheels'"));
            }
        }
        Ok(())
    }

    /// Writes the two rows of every wheel at these readings, with their right-hand sides.
    pub fn read<'r>(&self, measured: Measured<'_>, readings: &'r mut [Reading]) -> &'r [Reading] {
        let mut joint = 0;
        let wheels = self.wheels().iter().zip(&self.mounts).zip(measured.speeds);
        for (((wheel, mount), speed), reading) in wheels.zip(readings.iter_mut()) {
            let mut rate = 0.0;
            let rows = match *mount {
                Mount::Fixed(rows) => rows,
                Mount::Castor(_) => continue,
                Mount::Steered(..) => {
                    rate = measured.steering_rates.map_or(0.0, |rates| rates[joint]);
                    let angle = wheel.heading + measured.steering[joint];
                    joint += 1;
                    wheel.rows(Direction::from(angle))
                }
            };
            reading.side_slip = rows.side_slip;
            reading.slipped = wheel.trail * rate;
            if speed.is_finite() {
                reading.rolling = rows.rolling;
                reading.rolled = wheel.radius * speed + wheel.scrub * rate;
            } else {
                reading.rolling = Vector3::zeros();
                reading.rolled = 0.0;
            }
        }
        &readings[..self.wheels().len()]
    }

    /// A row of the twist as a row of the unknowns: the velocity of the centre of the pivots and the yaw rate times the
    /// size of the rover. Their normal equations are close to a multiple of the identity and lose no digits.
    #[inline]
    pub fn row_about_centre(&self, row: &Vector3<f64>) -> Vector3<f64> {
        let moment = row.z + row.x * self.centre.y - row.y * self.centre.x;
        Vector3::new(row.x, row.y, moment / self.size)
    }

    /// Normal equations `sum weight (a aᵀ + b bᵀ)` of the unknowns about the centre of the pivots.
    pub fn normal(&self, readings: &[Reading], weight: impl Fn(usize) -> f64) -> Matrix3<f64> {
        let mut normal = Matrix3::zeros();
        for (i, reading) in readings.iter().enumerate() {
            let (rolling, side_slip) =
                (self.row_about_centre(&reading.rolling), self.row_about_centre(&reading.side_slip));
            normal += (rolling * rolling.transpose() + side_slip * side_slip.transpose()) * weight(i);
        }
        normal
    }

    /// Matrix that maps the right-hand side of the normal equations to their solution.
    pub fn solution(&self, normal: Matrix3<f64>, unseen: Unseen) -> Result<Matrix3<f64>, Error> {
        let least = PIVOT_TOLERANCE * normal.trace();
        let determined = normal.cholesky().filter(|factor| {
            let diagonal = factor.l_dirty().diagonal();
            diagonal.iter().all(|pivot| pivot * pivot > least)
        });
        match (determined, unseen) {
            (Some(factor), _) => Ok(factor.inverse()),
            (None, Unseen::Zero) => Ok(Jacobi::new(&normal).inverse(least)),
            (None, Unseen::Refuse) => Err(self.underdetermined(normal)),
        }
    }

    /// The twist whose unknowns about the centre of the pivots these are.
    #[inline]
    pub fn twist_at_origin(&self, centred: &Vector3<f64>) -> Vector3<f64> {
        let omega = centred.z / self.size;
        Vector3::new(centred.x + omega * self.centre.y, centred.y - omega * self.centre.x, omega)
    }

    /// The inverse of the normal equations of the twist itself, from that about the centre of the pivots.
    pub fn inverse_at_origin(&self, solution: &Matrix3<f64>) -> Matrix3<f64> {
        let units = [Vector3::x(), Vector3::y(), Vector3::z()];
        let to_origin = Matrix3::from_columns(&units.map(|unit| self.twist_at_origin(&unit)));
        to_origin * solution * to_origin.transpose()
    }

    /// The solution of the normal equations, every wheel alike.
    pub fn solution_for(
        &self,
        readings: &[Reading],
        measured: Measured<'_>,
        unseen: Unseen,
    ) -> Result<Matrix3<f64>, Error> {
        match self.solution.filter(|_| measured.is_complete()) {
            Some(solution) => Ok(solution),
            None => self.solution(self.normal(readings, |_| 1.0), unseen),
        }
    }

    /// The error that names the motion that no reading determines.
    fn underdetermined(&self, normal: Matrix3<f64>) -> Error {
        let twist = self.twist_at_origin(&Jacobi::new(&normal).turn.column(2).into_owned());
        // For the text: the largest component is 1, and rounding is 0.
        let largest = twist[twist.iamax()];
        let twist: [f64; 3] = (twist / largest).map(|part| if part.abs() < VANISHED { 0.0 } else { part }).into();
        let rule = "determine the twist";
        let value = format!("no reading of the motion (vx, vy, omega) = {}", numbers(&twist));
        Error::value("wheels", rule, value).of_kind(ErrorKind::Underdetermined)
    }

    /// Rank and smallest singular value of the stacked rows.
    pub fn singular_values(&self, readings: &[Reading], weights: &[f64]) -> (usize, f64) {
        let rows = readings.iter().zip(weights).flat_map(|(reading, weight)| {
            let root = weight.sqrt();
            [reading.rolling * root, reading.side_slip * root]
        });
        let decomposed = Jacobi::new(&triangle(rows));
        let rank = decomposed.rank(RANK_TOLERANCE * decomposed.values.x);
        (rank, decomposed.values.z)
    }
}
