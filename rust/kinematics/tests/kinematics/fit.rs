//! Rows fitted by constants of the rover, against the same rows by their own equations.

use six_wheel_kinematics::batch::{self, Fits};
use six_wheel_kinematics::estimate::{Fit, Measured, Method, Reading, Unseen};
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::{Inputs, MAX_WHEELS, Rover};
use six_wheel_kinematics::table::Log;
use six_wheel_numerics::error::Error;

use crate::random::Numbers;

/// Result of one row.
#[derive(Debug, PartialEq)]
struct FitRow {
    fit: Fit,
    residual: Vec<f64>,
    weights: Vec<f64>,
}

impl FitRow {
    fn new(wheels: usize, fit: impl FnOnce(&mut [f64], &mut [f64]) -> Result<Fit, Error>) -> Result<Self, Error> {
        let [mut residual, mut weights] = [vec![0.0; wheels], vec![0.0; wheels]];
        Ok(Self { fit: fit(&mut residual, &mut weights)?, residual, weights })
    }

    /// Asserts that two fits are the same up to these differences of speeds, and of weights and singular values.
    fn is_near(&self, other: &Self, speed: f64, weight: f64) {
        let near = |a: &[f64], b: &[f64], size: f64| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= size);
        let twists = [self.fit.twist, other.fit.twist].map(<[f64; 3]>::from);
        assert!(near(&twists[0], &twists[1], speed), "{self:?} {other:?}");
        assert!(near(&self.residual, &other.residual, speed), "{self:?} {other:?}");
        assert!(near(&self.weights, &other.weights, weight), "{self:?} {other:?}");
        assert!((self.fit.sigma_min - other.fit.sigma_min).abs() <= weight, "{self:?} {other:?}");
        assert_eq!(self.fit.rank, other.fit.rank);
    }
}

/// The fit of one row by its own equations.
fn fit_alone(
    rover: &Rover,
    measured: Measured<'_>,
    method: Method,
    residual: &mut [f64],
    weights: &mut [f64],
) -> Result<Fit, Error> {
    let mut readings = [Reading::NONE; MAX_WHEELS];
    let readings = rover.read(measured, &mut readings);
    let twist = rover.estimate(readings, measured, method, Unseen::Refuse, weights, residual)?;
    let (rank, sigma_min) = rover.singular_values(readings, weights);
    Ok(Fit { twist, rank, sigma_min })
}

/// Fits all rows of a log at one level; those of single calls have the same bits. Calls `compare` with every row, up to the first
/// that fails: its number, its fit, and the same by the row's own equations.
fn for_each_row(
    rover: &Rover,
    log: Log<'_>,
    method: Method,
    level: batch::Level,
    mut compare: impl FnMut(usize, FitRow, FitRow),
) {
    let (wheels, unseen) = (rover.wheels().len(), Unseen::Refuse);
    let count = log.speeds.len() / wheels;
    let [mut residual, mut weights] = [vec![0.0; count * wheels], vec![0.0; count * wheels]];
    let (mut twists, mut ranks, mut sigmas) = (vec![[0.0; 3]; count], vec![0; count], vec![0.0; count]);
    let workers = batch::Workers { level, ..batch::Workers::PLAIN };
    let fits = Fits {
        twists: &mut twists,
        ranks: &mut ranks,
        sigmas: &mut sigmas,
        residual: &mut residual,
        weights: &mut weights,
    };
    let done = batch::fit(rover, log, method, unseen, fits, workers);
    for k in 0..count {
        let measured = log.row(rover, k);
        let single = FitRow::new(wheels, |residual, weights| rover.fit(measured, method, unseen, residual, weights));
        let own = FitRow::new(wheels, |residual, weights| fit_alone(rover, measured, method, residual, weights));
        let (single, own) = match (single, own) {
            (Ok(single), Ok(own)) => (single, own),
            (single, own) => {
                assert_eq!(single, own);
                assert_eq!(done, single.map(drop).map_err(|error| error.at_row(k)));
                return;
            }
        };
        let row = k * wheels..(k + 1) * wheels;
        let (fit, residual, weights) = (
            Fit { twist: twists[k].into(), rank: ranks[k] as usize, sigma_min: sigmas[k] },
            residual[row.clone()].to_vec(),
            weights[row].to_vec(),
        );
        assert_eq!(FitRow { fit, residual, weights }, single);
        compare(k, single, own);
    }
}

/// The largest speed of a row, at least 1 [rad/s].
fn largest_speed(rover: &Rover, log: Log<'_>, k: usize) -> f64 {
    log.row(rover, k).speeds.iter().fold(1.0, |most: f64, speed| most.max(speed.abs()))
}

#[test]
fn fits_of_many_rows_are_those_of_single_ones() -> Result<(), Error> {
    let mut numbers = Numbers(5);
    for round in 0..200 {
        let rover = numbers.rover()?;
        let (joints, wheels, count) = (rover.steered().len(), rover.wheels().len(), 131);
        let method = [Method::LeastSquares, Method::MiddleWheels][round % 2];
        let mut some = |n: usize| -> Vec<f64> { (0..n).map(|_| numbers.between(-3.0, 3.0)).collect() };
        let (steering, mut speeds) = (some(count * joints), some(count * wheels));
        speeds[5 * wheels] = 1e150;
        let log = Log { steering: &steering, speeds: &speeds, steering_rates: None };
        for_each_row(&rover, log, method, batch::Level::best(), |k, fit, own| {
            let speed = 1e-12 * largest_speed(&rover, log, k) / own.fit.sigma_min.min(1.0);
            fit.is_near(&own, speed, 1e-13);
        });
    }
    Ok(())
}

/// Rounds end when no weight changes by more than 1e-12, after one more or less where that is a matter of rounding: the
/// weights are as near as that, and what follows from them within a small multiple.
#[test]
fn robust_fits_of_registers_are_those_of_rows() -> Result<(), Error> {
    let mut numbers = Numbers(6);
    let mut fitted = 0;
    for round in 0..300 {
        let rover = numbers.rover()?;
        // Of so many, those that take long are more than a block.
        let count = if round % 50 == 0 { 1500 } else { 67 };
        let (steering, speeds) = noisy_log(&mut numbers, &rover, count);
        let log = Log { steering: &steering, speeds: &speeds, steering_rates: None };
        for level in batch::Level::available() {
            for_each_row(&rover, log, Method::Robust, level, |k, fit, own| {
                let weight = 1e-10 / own.fit.sigma_min.powi(2).min(1.0);
                fit.is_near(&own, weight * largest_speed(&rover, log, k), weight);
                fitted += 1;
            });
        }
    }
    assert!(fitted > 10_000);
    Ok(())
}

/// Readings of random motions with noise, some with a wheel that slips, some at rest, one beyond squares.
fn noisy_log(numbers: &mut Numbers, rover: &Rover, count: usize) -> (Vec<f64>, Vec<f64>) {
    let (joints, wheels) = (rover.steered().len(), rover.wheels().len());
    let (mut steering, mut speeds) = (vec![0.0; count * joints], vec![0.0; count * wheels]);
    for k in 0..count {
        let twist = Twist { vx: numbers.between(-1.0, 1.0), vy: 0.0, omega: numbers.between(-1.0, 1.0) };
        let steering = &mut steering[k * joints..(k + 1) * joints];
        let speeds = &mut speeds[k * wheels..(k + 1) * wheels];
        rover.solve(twist, Inputs::default(), steering, speeds);
        for angle in steering.iter_mut() {
            *angle += numbers.between(-0.01, 0.01);
        }
        for speed in speeds.iter_mut() {
            *speed += numbers.between(-0.05, 0.05);
        }
        if k % 3 == 0 {
            speeds[k % wheels] += numbers.between(1.0, 6.0);
        }
        if k % 16 == 15 {
            speeds.fill(0.0);
        }
    }
    speeds[5 * wheels] = 1e130;
    (steering, speeds)
}
