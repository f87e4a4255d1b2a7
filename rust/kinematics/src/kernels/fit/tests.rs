//! Registers against the plain core.

use crate::admissible::tests::Numbers;
use crate::batch;
use crate::estimate::{Method, Unseen};
use crate::geometry::Twist;
use crate::rover::{Inputs, Rover};
use crate::table::Log;
use crate::table::row_mut;
use six_wheel_numerics::error::Error;

/// Results of a batch.
struct Found {
    twists: Vec<[f64; 3]>,
    ranks: Vec<i64>,
    sigmas: Vec<f64>,
    residual: Vec<f64>,
    weights: Vec<f64>,
}

/// All rows of a log at one level.
fn fit_all(rover: &Rover, log: Log<'_>, method: Method, level: batch::Level) -> (Result<(), Error>, Found) {
    let count = log.speeds.len() / rover.wheels().len();
    let mut found = Found {
        twists: vec![[0.0; 3]; count],
        ranks: vec![0; count],
        sigmas: vec![0.0; count],
        residual: vec![0.0; log.speeds.len()],
        weights: vec![0.0; log.speeds.len()],
    };
    let fits = batch::Fits {
        twists: &mut found.twists,
        ranks: &mut found.ranks,
        sigmas: &mut found.sigmas,
        residual: &mut found.residual,
        weights: &mut found.weights,
    };
    let workers = batch::Workers { level, ..batch::Workers::PLAIN };
    let done = batch::fit(rover, log, method, Unseen::Refuse, fits, workers);
    (done, found)
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
        let (done, fits) = fit_all(&rover, log, method, batch::Level::best());
        let [mut slips, mut says] = [vec![0.0; wheels], vec![0.0; wheels]];
        for k in 0..count {
            let measured = log.row(&rover, k);
            let expected = match rover.fit(measured, method, Unseen::Refuse, &mut slips, &mut says) {
                Ok(expected) => expected,
                Err(error) => {
                    assert_eq!(done, Err(error.at_row(k)));
                    break;
                }
            };
            let row = k * wheels..(k + 1) * wheels;
            let size = 1e-12 * speeds[row.clone()].iter().fold(1.0, |most: f64, v| most.max(v.abs()));
            let near = |a: f64, b: f64| (a - b).abs() <= size / expected.sigma_min.min(1.0);
            let (a, b): ([f64; 3], [f64; 3]) = (fits.twists[k], expected.twist.into());
            assert!(a.into_iter().zip(b).all(|(a, b)| near(a, b)), "{a:?} {expected:?} {rover:?}");
            assert_eq!(fits.ranks[k], expected.rank as i64);
            assert!((fits.sigmas[k] - expected.sigma_min).abs() <= 1e-13);
            assert_eq!(fits.weights[row.clone()], says);
            assert!(fits.residual[row].iter().zip(&slips).all(|(a, b)| near(*a, *b)));
        }
    }
    Ok(())
}

/// Rounds end when no weight changes by more than 1e-12, after one more or less where that is a matter of rounding: the
/// weights are as near as that, and what follows from them within a small multiple.
#[test]
fn robust_fits_of_registers_are_those_of_the_plain_core() -> Result<(), Error> {
    let mut numbers = Numbers(6);
    let mut fitted = 0;
    for round in 0..300 {
        let rover = numbers.rover()?;
        // Of so many, those that take long are more than a block.
        let count = if round % 50 == 0 { 1500 } else { 67 };
        let (joints, wheels) = (rover.steered().len(), rover.wheels().len());
        let (mut steering, mut speeds) = (vec![0.0; count * joints], vec![0.0; count * wheels]);
        for k in 0..count {
            let twist = Twist { vx: numbers.between(-1.0, 1.0), vy: 0.0, omega: numbers.between(-1.0, 1.0) };
            let (steering, speeds) = (row_mut(&mut steering, joints, k), row_mut(&mut speeds, wheels, k));
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
        let log = Log { steering: &steering, speeds: &speeds, steering_rates: None };
        for level in batch::Level::available() {
            let method = Method::Robust;
            let (done, fits) = fit_all(&rover, log, method, level);
            let [mut slips, mut says] = [vec![0.0; wheels], vec![0.0; wheels]];
            for k in 0..count {
                let measured = log.row(&rover, k);
                let expected = match rover.fit(measured, method, Unseen::Refuse, &mut slips, &mut says) {
                    Ok(expected) => expected,
                    Err(error) => {
                        assert_eq!(done, Err(error.at_row(k)));
                        break;
                    }
                };
                let row = k * wheels..(k + 1) * wheels;
                let largest = speeds[row.clone()].iter().fold(1.0, |most: f64, v| most.max(v.abs()));
                let weight = 1e-10 / expected.sigma_min.powi(2).min(1.0);
                let near = |a: f64, b: f64| (a - b).abs() <= weight * largest;
                let (a, b): ([f64; 3], [f64; 3]) = (fits.twists[k], expected.twist.into());
                assert!(a.into_iter().zip(b).all(|(a, b)| near(a, b)), "{k} {level:?} {a:?} {expected:?} {rover:?}");
                assert_eq!(fits.ranks[k], expected.rank as i64);
                assert!((fits.sigmas[k] - expected.sigma_min).abs() <= weight);
                let says = says.iter().zip(&fits.weights[row.clone()]);
                assert!(says.into_iter().all(|(a, b)| (a - b).abs() <= weight));
                let slips = slips.iter().zip(&fits.residual[row]);
                assert!(slips.into_iter().all(|(a, b)| near(*a, *b)));
                fitted += 1;
            }
        }
    }
    assert!(fitted > 10_000);
    Ok(())
}
