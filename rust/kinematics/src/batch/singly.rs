//! Fits and sensitivities of many rows, and values that are computed row by row.

use crate::estimate::sensitivity::Quantity;
use crate::estimate::{Method, Unseen};
use crate::kernels::fit::Fits;
use crate::kernels::sensitivity::{SensitivityQuery, write_row};
use crate::rover::Rover;
use crate::table::Log;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::threads::workers::Workers;

/// Computes a value for every row, one row at a time.
pub fn fill<const N: usize>(
    targets: &mut [[f64; N]],
    workers: Workers,
    value: impl Fn(usize) -> [f64; N] + Sync,
) -> Result<(), Error> {
    let share = workers.share(targets.len());
    workers.for_each(targets.chunks_mut(share).enumerate(), |(k, targets)| {
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
    let constants = rover.fit_constants(method, unseen);
    let twists = fits.twists.chunks_mut(share).zip(fits.ranks.chunks_mut(share));
    let slips = fits.residual.chunks_mut(share * wheels);
    let says = fits.weights.chunks_mut(share * wheels);
    let parts = twists.zip(fits.sigmas.chunks_mut(share)).zip(slips).zip(says);
    workers.for_each(parts.enumerate(), |(k, ((((twists, ranks), sigmas), residual), weights))| {
        let count = twists.len();
        let log = log.rows(rover, k * share..k * share + count);
        let mut fits = Fits { twists, ranks, sigmas, residual, weights };
        constants.fit(workers.here().level, rover, log, &mut fits).map_err(|error| error.below(k * share))
    })
}

/// The twist of every row of a log and its derivatives. A target takes `3 x wheels` numbers per row, or `3 x
/// steered wheels` for quantities of the steering.
#[inline]
pub fn sensitivity(
    rover: &Rover,
    log: Log<'_>,
    twists: &mut [[f64; 3]],
    targets: &mut [(Quantity, &mut [f64])],
    workers: Workers,
) -> Result<(), Error> {
    let (share, all) = (workers.share(twists.len()), (0..rover.wheels().len()));
    let all: Vec<_> = all.collect();
    let constants = &rover.forward_constants;
    let mut parts: Vec<_> = targets
        .iter_mut()
        .map(|(quantity, target)| {
            let wheels = match quantity {
                Quantity::Steering | Quantity::SteeringRate => rover.steered(),
                _ => &all,
            };
            // Chunks of size 1 for a rover without steered wheels.
            let size = (share * 3 * wheels.len()).max(1);
            (*quantity, wheels, target.chunks_mut(size))
        })
        .collect();
    let jobs: Vec<_> = twists
        .chunks_mut(share)
        .map(|twists| {
            let parts = parts
                .iter_mut()
                .map(|(quantity, wheels, parts)| (*quantity, *wheels, parts.next().unwrap_or_default()));
            (twists, parts.collect::<Vec<_>>())
        })
        .collect();
    workers.for_each(jobs.into_iter().enumerate(), |(k, (twists, mut targets))| {
        let log = log.rows(rover, k * share..k * share + twists.len());
        let failed = |error: Error| error.below(k * share);
        if constants.is_regular {
            let gradients: Vec<_> = targets.iter().map(|(quantity, ..)| rover.gradients(*quantity)).collect();
            let ask = SensitivityQuery { rover, constants, log, twists, targets: &mut targets, gradients: &gradients };
            return workers.here().level.run_any(ask).map_err(failed);
        }
        for (k, twist) in twists.iter_mut().enumerate() {
            let done = write_row(rover, log, k, k, twist, &mut targets);
            done.map_err(|error| failed(error.at_row(k)))?;
        }
        Ok(())
    })
}
