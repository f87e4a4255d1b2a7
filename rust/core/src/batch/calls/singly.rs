//! Calls that go through the plain core row by row.

use super::rows::FEW;
use crate::batch::formulas::fit::{Fits, Plan};
use crate::batch::machine::table::{Log, row_mut};
use crate::batch::machine::workers::Workers;
use crate::error::Error;
use crate::estimate::sensitivity::{Linearised, Quantity};
use crate::estimate::{Method, Unseen};
use crate::rover::Rover;

/// A value for every row, each on its own.
pub fn fill<const N: usize>(
    targets: &mut [[f64; N]],
    workers: Workers,
    value: impl Fn(usize) -> [f64; N] + Sync,
) -> Result<(), Error> {
    let share = workers.share(targets.len());
    workers.each(targets.chunks_mut(share).enumerate(), |(k, targets)| {
        for (row, target) in targets.iter_mut().enumerate() {
            *target = value(k * share + row);
        }
        Ok(())
    })
}

/// [`Rover::fit`] of every row of a log.
pub fn fit(
    rover: &Rover,
    log: Log<'_>,
    method: Method,
    unseen: Unseen,
    fits: Fits<'_>,
    workers: Workers,
) -> Result<(), Error> {
    let (count, wheels) = (fits.twists.len(), rover.wheels().len());
    let share = workers.share(count);
    let plan = ((count >= FEW || method == Method::Robust) && log.steering_rates.is_none())
        .then(|| Plan::new(rover, method, unseen))
        .flatten();
    let twists = fits
        .twists
        .chunks_mut(share)
        .zip(fits.ranks.chunks_mut(share));
    let slips = fits.residual.chunks_mut(share * wheels);
    let says = fits.weights.chunks_mut(share * wheels);
    let parts = twists
        .zip(fits.sigmas.chunks_mut(share))
        .zip(slips)
        .zip(says);
    workers.each(
        parts.enumerate(),
        |(k, ((((twists, ranks), sigmas), residual), weights))| {
            let count = twists.len();
            let log = log.rows(rover, k * share..k * share + count);
            let failed = |error: Error| error.below(k * share);
            let mut fits = Fits {
                twists,
                ranks,
                sigmas,
                residual,
                weights,
            };
            if let Some(plan) = &plan
                && let Some(done) = plan.fit(workers.here().level, log, &mut fits)
            {
                return done.map_err(failed);
            }
            for k in 0..count {
                let solve = |residual: &mut [f64], weights: &mut [f64]| {
                    rover.fit(log.row(rover, k), method, unseen, residual, weights)
                };
                let solved = fits.one(k, wheels, solve);
                solved.map_err(|error| failed(error.at_row(k)))?;
            }
            Ok(())
        },
    )
}

/// The twist of every row of a log and its derivatives. A target takes `3 x wheels` numbers per row, or `3 x
/// steered wheels` for quantities of the steering.
pub fn sensitivity(
    rover: &Rover,
    log: Log<'_>,
    twists: &mut [[f64; 3]],
    targets: &mut [(Quantity, &mut [f64])],
    workers: Workers,
) -> Result<(), Error> {
    let share = workers.share(twists.len());
    let width = |quantity: Quantity| 3 * differentiated(rover, quantity).len();
    let mut parts: Vec<_> = targets
        .iter_mut()
        .map(|(quantity, target)| {
            // A rover without steered wheels has no columns to cut.
            let size = (share * width(*quantity)).max(1);
            (*quantity, target.chunks_mut(size))
        })
        .collect();
    let jobs: Vec<_> = twists
        .chunks_mut(share)
        .map(|twists| {
            let parts = parts
                .iter_mut()
                .map(|(quantity, parts)| (*quantity, parts.next().unwrap_or_default()));
            (twists, parts.collect::<Vec<_>>())
        })
        .collect();
    workers.each(
        jobs.into_iter().enumerate(),
        |(k, (twists, mut targets))| {
            let log = log.rows(rover, k * share..k * share + twists.len());
            sensitivity_rows(rover, log, twists, &mut targets)
                .map_err(|error| error.below(k * share))
        },
    )
}

/// Indices of the wheels with a derivative by this quantity.
fn differentiated(rover: &Rover, quantity: Quantity) -> Vec<usize> {
    match quantity {
        Quantity::Steering | Quantity::SteeringRate => rover.steered().to_vec(),
        _ => (0..rover.wheels().len()).collect(),
    }
}

fn sensitivity_rows(
    rover: &Rover,
    log: Log<'_>,
    twists: &mut [[f64; 3]],
    targets: &mut [(Quantity, &mut [f64])],
) -> Result<(), Error> {
    let columns: Vec<_> = targets
        .iter()
        .map(|(quantity, _)| differentiated(rover, *quantity))
        .collect();
    for (k, twist) in twists.iter_mut().enumerate() {
        let differentiate = |linearised: &Linearised<'_>| {
            *twist = linearised.twist().into();
            for ((quantity, target), wheels) in targets.iter_mut().zip(&columns) {
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
