//! Least squares of one row whose equations are no constants of the rover: wheels with scrub or trail in a fit, gaps in the
//! readings, motion that no reading determines, readings of extreme sizes. The formulas are those of many rows.

use nalgebra::{Matrix3, Vector3};

use super::robust::{ByMinors, IrlsIterations, MOST, NormalSolver, RobustWheel};
use super::wheel_rows::RowPair;
use crate::estimate::{Fit, Measured, Method, NOISE, Reading, Unseen};
use crate::geometry::Twist;
use crate::rover_data::{MAX_WHEELS, RoverData};
use crate::wheels::{Pivot, Wheel};
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::level::{Kernel, Level};
use six_wheel_numerics::simd::vec3::row_times as dot;
use six_wheel_numerics::simd::vector::Vector;

impl RoverData {
    /// The twist of one row by its own equations, where they are no constants of the rover.
    #[cold]
    pub(crate) fn forward_rarely(&self, measured: Measured<'_>, unseen: Unseen) -> Result<Twist, Error> {
        self.check_readings(measured)?;
        let mut readings = [Reading::NONE; MAX_WHEELS];
        let readings = self.read(measured, &mut readings);
        self.estimate(readings, measured, Method::LeastSquares, unseen, &mut [1.0; MAX_WHEELS], &mut [])
    }

    /// [`Self::forward_rarely`] with residual [m/s] and weight of every wheel, rank and smallest singular value.
    pub(crate) fn fit_rarely(
        &self,
        measured: Measured<'_>,
        (method, unseen): (Method, Unseen),
        residual: &mut [f64],
        weights: &mut [f64],
    ) -> Result<Fit, Error> {
        self.check_readings(measured)?;
        let mut readings = [Reading::NONE; MAX_WHEELS];
        let readings = self.read(measured, &mut readings);
        let twist = self.estimate(readings, measured, method, unseen, weights, residual)?;
        let (rank, sigma_min) = self.singular_values(readings, weights);
        Ok(Fit { twist, rank, sigma_min })
    }

    /// The twist of these rows of the wheels by any method; writes the weights of the wheels, and their residuals [m/s]
    /// as far as the slice goes.
    pub fn estimate(
        &self,
        readings: &[Reading],
        measured: Measured<'_>,
        method: Method,
        unseen: Unseen,
        weights: &mut [f64],
        residual: &mut [f64],
    ) -> Result<Twist, Error> {
        self.initial_weights(method, weights)?;
        let solution = match method {
            Method::MiddleWheels => self.solution(self.normal(readings, |i| weights[i]), unseen)?,
            Method::LeastSquares | Method::Robust => self.solution_for(readings, measured, unseen)?,
        };
        let robust = (method == Method::Robust).then_some((measured.speeds, unseen));
        Level::Scalar.run_any(RowFit { rover: self, readings, solution: &solution, weights, residual, robust })
    }
}

/// Fit of one row.
struct RowFit<'a> {
    rover: &'a RoverData,
    /// Rows of the wheels.
    readings: &'a [Reading],
    /// Inverse of the normal equations with the weights.
    solution: &'a Matrix3<f64>,
    /// Weight of each wheel; robust fits replace it.
    weights: &'a mut [f64],
    /// Output of the residuals [m/s]; may be empty.
    residual: &'a mut [f64],
    /// Speeds of the wheels [rad/s] and the treatment of undetermined motion, if the fit is robust.
    robust: Option<(&'a [f64], Unseen)>,
}

/// Equations of the wheels of one row.
struct Equations<S: Vector> {
    count: usize,
    rows: [RowPair; MAX_WHEELS],
    readings: [[Lanes<S>; 2]; MAX_WHEELS],
}

impl Kernel for RowFit<'_> {
    type Output = Result<Twist, Error>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Self::Output {
        let splat = |number| Lanes::splat(simd, number);
        let zero = splat(0.0);
        let scale = scale_of(self.readings);
        let mut equations = Equations {
            count: self.readings.len(),
            rows: [RowPair::default(); MAX_WHEELS],
            readings: [[zero; 2]; MAX_WHEELS],
        };
        let mut right = [zero; 3];
        for (i, (reading, weight)) in self.readings.iter().zip(&*self.weights).enumerate() {
            let rows = [reading.rolling, reading.side_slip].map(|row| self.rover.row_about_centre(&row).into());
            equations.rows[i] = RowPair(rows);
            equations.readings[i] = [splat(reading.rolled * scale), splat(reading.slipped * scale)];
            let moment = equations.rows[i].moment(simd, equations.readings[i]);
            for (sum, part) in right.iter_mut().zip(moment) {
                *sum = splat(*weight).mul_add(part, *sum);
            }
        }
        let mut unknowns = product(simd, self.solution, right);
        if let Some((speeds, unseen)) = self.robust {
            let least = least_noise(self.rover, speeds, scale);
            let (start, weights) = ((unknowns, splat(least * least)), &mut *self.weights);
            unknowns = match equations.count <= MOST {
                true => equations.solve_robust::<MOST>(simd, (self.rover, unseen), start, weights)?,
                false => equations.solve_robust::<MAX_WHEELS>(simd, (self.rover, unseen), start, weights)?,
            };
        }
        for (i, residual) in self.residual.iter_mut().enumerate() {
            let square = equations.rows[i].square(simd, equations.readings[i], unknowns);
            *residual = square.sqrt().last(simd) / scale;
        }
        let [x, y, z] = unknowns;
        let unknowns = Vector3::new(x.last(simd), y.last(simd), z.last(simd));
        Ok((self.rover.twist_at_origin(&unknowns) / scale).into())
    }
}

impl<S: Vector> Equations<S> {
    /// Iteratively reweighted least squares, from initial unknowns and the square of the least noise [m²/s²]. Writes
    /// the weights and returns the unknowns.
    #[inline(always)]
    fn solve_robust<const WHEELS: usize>(
        &self,
        simd: S,
        (rover, unseen): (&RoverData, Unseen),
        (unknowns, least): ([Lanes<S>; 3], Lanes<S>),
        weights: &mut [f64],
    ) -> Result<[Lanes<S>; 3], Error> {
        let mut wheels = [RobustWheel::default(); WHEELS];
        let mut readings = self.readings;
        for (wheel, rows) in wheels.iter_mut().zip(&self.rows[..self.count]) {
            *wheel = RobustWheel::new(*rows);
        }
        let wheels = &wheels[..self.count.min(WHEELS)];
        let readings = &mut readings[..wheels.len()];
        let start = IrlsIterations::<S, WHEELS>::new(simd, readings, unknowns, least);
        let mut rounds = start;
        rounds.iterate(simd, wheels, &mut ByMinors);
        if (!rounds.sure).any() {
            // A round had no solution by minors: all rounds again by factors of their normal equations.
            rounds = start;
            let mut solver = ByFactors { rover, unseen, error: None };
            rounds.iterate(simd, wheels, &mut solver);
            if let Some(error) = solver.error {
                return Err(error);
            }
        }
        for (weight, lanes) in weights.iter_mut().zip(rounds.weights) {
            *weight = lanes.last(simd);
        }
        Ok(rounds.unknowns)
    }
}

/// Solution by Cholesky factors of the normal equations, or by their pseudo-inverse where they do not determine the
/// twist.
struct ByFactors<'a> {
    rover: &'a RoverData,
    unseen: Unseen,
    error: Option<Error>,
}

impl<S: Vector> NormalSolver<S> for ByFactors<'_> {
    #[inline(always)]
    fn solve(&mut self, simd: S, normal: [Lanes<S>; 6], right: [Lanes<S>; 3]) -> ([Lanes<S>; 3], Mask<S>) {
        let mut numbers = [0.0; 6];
        for (number, lanes) in numbers.iter_mut().zip(normal) {
            *number = lanes.last(simd);
        }
        let [a, b, c, d, e, f] = numbers;
        match self.rover.solution(Matrix3::new(a, b, c, b, d, e, c, e, f), self.unseen) {
            Ok(solution) => (product(simd, &solution, right), Mask::splat(simd, true)),
            Err(error) => {
                self.error = Some(error);
                (right, Mask::splat(simd, false))
            }
        }
    }
}

/// `matrix · vector`
#[inline(always)]
fn product<S: Vector>(simd: S, matrix: &Matrix3<f64>, vector: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
    let mut product = vector;
    for (k, part) in product.iter_mut().enumerate() {
        *part = dot(simd, &[matrix[(k, 0)], matrix[(k, 1)], matrix[(k, 2)]], vector);
    }
    product
}

/// Least noise of a robust fit: a share of the root mean square rim speed, times the scale of the readings [m/s].
fn least_noise(rover: &RoverData, speeds: &[f64], scale: f64) -> f64 {
    let is_read = |(wheel, speed): &(&Wheel, &f64)| wheel.pivot != Pivot::Castor && speed.is_finite();
    let rim_speeds = rover.wheels().iter().zip(speeds).filter(is_read);
    let squares: f64 = rim_speeds.map(|(wheel, speed)| (wheel.radius * speed * scale).powi(2)).sum();
    NOISE * (squares / speeds.len() as f64).sqrt()
}

/// The power of two that scales the largest reading to between 1 and 2, so that squares neither overflow nor lose
/// digits. Twist and residuals are in proportion to the readings, weights are independent of their scale.
fn scale_of(readings: &[Reading]) -> f64 {
    let largest =
        readings.iter().fold(0.0, |most: f64, reading| most.max(reading.rolled.abs()).max(reading.slipped.abs()));
    let exponent = largest.to_bits() >> 52;
    let inverse = 2046_u64.saturating_sub(exponent).clamp(1, 2046);
    if exponent == 0 { 1.0 } else { f64::from_bits(inverse << 52) }
}
