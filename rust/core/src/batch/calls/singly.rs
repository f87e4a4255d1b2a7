//! Calls that go through the plain core row by row.

use crate::admissible::Keep;
use crate::batch::machine::table::{Log, row_mut};
use crate::error::{Error, ErrorKind};
use crate::estimate::sensitivity::{Linearised, Quantity};
use crate::estimate::{Fit, Method, Unseen};
use crate::geometry::Twist;
use crate::rover::Rover;

/// [`Rover::fit`] of every row of a log.
pub fn fit(
    rover: &Rover,
    log: Log<'_>,
    method: Method,
    unseen: Unseen,
    fits: &mut [Fit],
    residual: &mut [f64],
    weights: &mut [f64],
) -> Result<(), Error> {
    let wheels = rover.wheels().len();
    for (k, fit) in fits.iter_mut().enumerate() {
        let (residual, weights) = (row_mut(residual, wheels, k), row_mut(weights, wheels, k));
        *fit = rover
            .fit(log.row(rover, k), method, unseen, residual, weights)
            .map_err(|error| error.at_row(k))?;
    }
    Ok(())
}

/// Whether the rover can make each twist. Fails where one is not finite.
pub fn admissible(rover: &Rover, twists: &[[f64; 3]]) -> Result<Vec<bool>, Error> {
    let answer = |(k, twist): (usize, &[f64; 3])| match rover.check(Twist::from(*twist), None) {
        Ok(()) => Ok(true),
        Err(error) if error.kind == ErrorKind::Infeasible => Ok(false),
        Err(error) => Err(error.at_row(k)),
    };
    twists.iter().enumerate().map(answer).collect()
}

/// [`Rover::project`] of every twist.
pub fn project(
    rover: &Rover,
    twists: &[[f64; 3]],
    keep: Keep,
    projected: &mut [[f64; 3]],
) -> Result<(), Error> {
    for (k, (twist, projected)) in twists.iter().zip(projected).enumerate() {
        let found = rover.project(Twist::from(*twist), keep);
        *projected = found.map_err(|error| error.at_row(k))?.into();
    }
    Ok(())
}

/// The twist of every row of a log and its derivatives. A target takes `3 x wheels` numbers per row, or `3 x
/// steered wheels` for quantities of the steering.
pub fn sensitivity(
    rover: &Rover,
    log: Log<'_>,
    twists: &mut [[f64; 3]],
    targets: &mut [(Quantity, &mut [f64])],
) -> Result<(), Error> {
    let wheels: Vec<usize> = (0..rover.wheels().len()).collect();
    for (k, twist) in twists.iter_mut().enumerate() {
        let differentiate = |linearised: &Linearised<'_>| {
            *twist = linearised.twist().into();
            for (quantity, target) in targets.iter_mut() {
                let wheels = match quantity {
                    Quantity::Steering | Quantity::SteeringRate => rover.steered(),
                    _ => &wheels,
                };
                let target = row_mut(target, 3 * wheels.len(), k);
                for (column, wheel) in wheels.iter().enumerate() {
                    let derivative = linearised.derivative(*wheel, *quantity);
                    for (row, value) in derivative.iter().enumerate() {
                        target[row * wheels.len() + column] = *value;
                    }
                }
            }
        };
        rover
            .sensitivity(log.row(rover, k), differentiate)
            .map_err(|error| error.at_row(k))?;
    }
    Ok(())
}
