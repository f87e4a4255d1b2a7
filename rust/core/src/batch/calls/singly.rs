//! Calls that go through the plain core row by row.

use super::rows::FEW;
use crate::batch::formulas::fit::{Fits, Plan};
use crate::batch::machine::level::Level;
use crate::batch::machine::table::{Log, row_mut};
use crate::error::Error;
use crate::estimate::sensitivity::{Linearised, Quantity};
use crate::estimate::{Fit, Method, Unseen};
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
    if fits.len() >= FEW
        && log.steering_rates.is_none()
        && let Some(plan) = Plan::new(rover, method, unseen)
    {
        let rows = &mut Fits {
            fits,
            residual,
            weights,
        };
        if let Some(done) = plan.fit(Level::best(), log, rows) {
            return done;
        }
    }
    let wheels = rover.wheels().len();
    for (k, fit) in fits.iter_mut().enumerate() {
        let (residual, weights) = (row_mut(residual, wheels, k), row_mut(weights, wheels, k));
        *fit = rover
            .fit(log.row(rover, k), method, unseen, residual, weights)
            .map_err(|error| error.at_row(k))?;
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
