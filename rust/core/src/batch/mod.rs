//! Whole arrays at once: every row is checked before the first one is written.

mod forward;
mod integrate;
mod inverse;
mod lanes;
mod level;
mod polynomials;
pub(crate) mod single;
pub(crate) mod single_forward;
mod steered;
mod vector;
mod weave;
mod workers;

use crate::admissible::Keep;
use crate::error::{Error, ErrorKind};
use crate::estimate::sensitivity::{Linearised, Quantity};
use crate::estimate::{Fit, Measured, Method, Unseen};
use crate::geometry::{self, Steps, Twist};
use crate::rover::{Inputs, Rover};

pub use level::Level;
pub use single::{check_one, inverse_one, project_one};
pub use single_forward::forward_one;
pub use workers::Workers;

impl<'a> Inputs<'a> {
    /// The inputs of one row of a batch.
    fn row(&self, rover: &Rover, k: usize) -> Self {
        let (joints, wheels) = (rover.steered().len(), rover.wheels().len());
        let at = |values: Option<&'a [f64]>, width| values.map(|values| row(values, width, k));
        Self {
            previous: at(self.previous, joints),
            previous_speeds: at(self.previous_speeds, wheels),
            steering_rates: at(self.steering_rates, joints),
        }
    }
}

/// Readings of many instants, row after row.
#[derive(Clone, Copy, Debug)]
pub struct Log<'a> {
    /// Steering angles [rad], one row of steered wheels per instant.
    pub steering: &'a [f64],
    /// Wheel speeds [rad/s], one row of wheels per instant.
    pub speeds: &'a [f64],
    /// Steering rates [rad/s].
    pub steering_rates: Option<&'a [f64]>,
}

impl<'a> Log<'a> {
    fn row(&self, rover: &Rover, k: usize) -> Measured<'a> {
        let (joints, wheels) = (rover.steered().len(), rover.wheels().len());
        Measured {
            steering: row(self.steering, joints, k),
            speeds: row(self.speeds, wheels, k),
            steering_rates: self.steering_rates.map(|rates| row(rates, joints, k)),
        }
    }
}

fn row(values: &[f64], width: usize, k: usize) -> &[f64] {
    &values[k * width..(k + 1) * width]
}

fn row_mut(values: &mut [f64], width: usize, k: usize) -> &mut [f64] {
    &mut values[k * width..(k + 1) * width]
}

/// Rows from which a batch is worth setting up a kernel for.
const FEW: usize = 8;

/// [`Rover::inverse`] of every twist.
pub fn inverse(
    rover: &Rover,
    twists: &[[f64; 3]],
    inputs: Inputs<'_>,
    steering: &mut [f64],
    speeds: &mut [f64],
    workers: Workers,
) -> Result<(), Error> {
    let workers = workers.here();
    let (joints, wheels) = (rover.steered().len(), rover.wheels().len());
    let plan = (workers.level != Level::Plain && twists.len() >= FEW && inputs.is_empty())
        .then(|| inverse::Plan::new(rover))
        .flatten();
    let share = workers.share(twists.len());
    let shares = twists
        .chunks(share)
        .enumerate()
        .map(|(k, rows)| (k * share, rows));
    workers::each(shares.clone(), |(first, rows)| match &plan {
        Some(plan) => plan.check(workers.level, rows, first),
        None => rows.iter().enumerate().try_for_each(|(k, twist)| {
            let inputs = inputs.row(rover, first + k);
            single::check_row(workers.level, rover, Twist::from(*twist), inputs)
                .map_err(|error| error.at_row(first + k))
        }),
    })?;
    // A rover without steered wheels has no columns to cut.
    let mut steering = steering.chunks_mut((share * joints).max(1));
    let targets = speeds
        .chunks_mut(share * wheels)
        .map(|speeds| (steering.next().unwrap_or_default(), speeds));
    workers::each(
        shares.zip(targets),
        |((first, rows), (steering, speeds))| {
            if let Some(plan) = &plan {
                plan.solve(workers.level, rows, steering, speeds);
                return Ok(());
            }
            for (k, twist) in rows.iter().enumerate() {
                let (steering, speeds) = (row_mut(steering, joints, k), row_mut(speeds, wheels, k));
                let inputs = inputs.row(rover, first + k);
                let twist = Twist::from(*twist);
                single::solve_row(workers.level, rover, twist, inputs, steering, speeds);
            }
            Ok(())
        },
    )
}

/// [`Rover::forward`] of every row of a log.
pub fn forward(
    rover: &Rover,
    log: Log<'_>,
    unseen: Unseen,
    twists: &mut [[f64; 3]],
    workers: Workers,
) -> Result<(), Error> {
    let workers = workers.here();
    let count = twists.len();
    let plan = (workers.level != Level::Plain && count >= FEW && log.steering_rates.is_none())
        .then(|| forward::Plan::new(rover))
        .flatten();
    // Where the rows depend on the angles or on gaps in the readings, only solving shows whether it works.
    let solvable = |k: usize| {
        let measured = log.row(rover, k);
        if rover.solution.is_some() && measured.is_complete() {
            rover.check_readings(measured)
        } else {
            rover.forward(measured, unseen).map(drop)
        }
    };
    let share = workers.share(count);
    let firsts = (0..count).step_by(share);
    workers::each(firsts.clone(), |first| {
        let rows = first..count.min(first + share);
        match &plan {
            Some(plan) => plan.check(workers.level, log, rows, unseen),
            None => rows
                .clone()
                .try_for_each(|k| solvable(k).map_err(|error| error.at_row(k))),
        }
    })?;
    workers::each(firsts.zip(twists.chunks_mut(share)), |(first, twists)| {
        if let Some(plan) = &plan {
            return plan.solve(workers.level, log, first, unseen, twists);
        }
        for (k, twist) in twists.iter_mut().enumerate() {
            let measured = log.row(rover, first + k);
            *twist = single_forward::solve_row(workers.level, rover, measured, unseen)?.into();
        }
        Ok(())
    })
}

/// Poses along logs of `count` twists each, every twist held over its step: exact, whatever its length.
///
/// There is one start per log; `poses` takes `count + 1` rows per log, the first of which is its start.
/// Nothing is written on failure, and rows of errors count over all logs.
pub fn integrate(
    twists: &[[f64; 3]],
    count: usize,
    steps: Steps<'_>,
    starts: &[[f64; 3]],
    poses: &mut [[f64; 3]],
    workers: Workers,
) -> Result<(), Error> {
    debug_assert_eq!(twists.len(), starts.len() * count);
    debug_assert_eq!(poses.len(), starts.len() * (count + 1));
    let workers = workers.here();
    let level = workers.level;
    steps.check(count)?;
    let share = workers.share_of_logs(starts.len(), count);
    let log = |k: usize| &twists[k * count..(k + 1) * count];
    let shares = starts
        .chunks(share)
        .enumerate()
        .map(|(k, starts)| (k * share, starts));
    workers::each(shares.clone(), |(first, starts)| {
        starts.iter().enumerate().try_for_each(|(k, start)| {
            if integrate::stays_finite(level, log(first + k), steps, *start) {
                return Ok(());
            }
            geometry::check_log(log(first + k), steps, *start).map_err(|error| Error {
                row: error.row.map(|row| (first + k) * count + row),
                ..error
            })
        })
    })?;
    let targets = poses.chunks_mut(share * (count + 1));
    workers::each(shares.zip(targets), |((first, starts), poses)| {
        let logs = starts.iter().zip(poses.chunks_exact_mut(count + 1));
        for (k, (start, poses)) in logs.enumerate() {
            integrate::log(level, log(first + k), steps, *start, poses);
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
