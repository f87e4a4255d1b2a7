//! Admissible twists, and the nearest ones to any others.

use crate::admissible::Keep;
use crate::admissible::rows::{AdmissibleRange, ProjectRange};
use crate::geometry::Twist;
use crate::kernels::safe_range::MAX_SQUARABLE;
use crate::rover::Rover;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::sizes::sum_of_sizes;
use six_wheel_numerics::threads::workers::Workers;

/// Writes for each twist if the rover can make it. Fails where one is not finite.
#[inline]
pub fn admissible(rover: &Rover, twists: &[[f64; 3]], answers: &mut [bool], workers: Workers) -> Result<(), Error> {
    let share = workers.share(twists.len());
    let jobs = twists.chunks(share).zip(answers.chunks_mut(share));
    workers.for_each(jobs.enumerate(), |(k, (twists, answers))| {
        let admissibility = AdmissibleRange { cone: &rover.cone, twists, answers };
        workers.here().level.run_any(admissibility).map_err(|error| error.below(k * share))
    })
}

/// [`Rover::project`] of every twist.
#[inline]
pub fn project(
    rover: &Rover,
    twists: &[[f64; 3]],
    keep: Keep,
    projected: &mut [[f64; 3]],
    workers: Workers,
) -> Result<(), Error> {
    let (share, here) = (workers.share(twists.len()), workers.here());
    if !workers.fresh {
        workers.for_each(twists.chunks(share).enumerate(), |(k, twists)| {
            check(rover, twists, keep, here).map_err(|error| error.below(k * share))
        })?;
    }
    let jobs = twists.chunks(share).zip(projected.chunks_mut(share));
    workers.for_each(jobs.enumerate(), |(k, (twists, projected))| {
        project_rows(rover, twists, keep, projected, here).map_err(|error| error.below(k * share))
    })
}

/// Fails at the first twist that cannot be projected.
fn check(rover: &Rover, twists: &[[f64; 3]], keep: Keep, workers: Workers) -> Result<(), Error> {
    if matches!(keep, Keep::Curvature | Keep::Nearest) {
        // The zero twist is always possible.
        let numbers = twists.as_flattened();
        if rover.cone.is_safe() && sum_of_sizes(workers.level, numbers) <= MAX_SQUARABLE {
            return Ok(());
        }
        return twists
            .iter()
            .enumerate()
            .try_for_each(|(k, twist)| rover.check_speeds(Twist::from(*twist)).map_err(|error| error.at_row(k)));
    }
    let mut room = [[0.0; 3]; ROWS];
    for (block, twists) in twists.chunks(ROWS).enumerate() {
        project_rows(rover, twists, keep, &mut room[..twists.len()], workers)
            .map_err(|error| error.below(block * ROWS))?;
    }
    Ok(())
}

/// Rows that are projected at a time by the check.
const ROWS: usize = 512;

fn project_rows(
    rover: &Rover,
    twists: &[[f64; 3]],
    keep: Keep,
    projected: &mut [[f64; 3]],
    workers: Workers,
) -> Result<(), Error> {
    workers.level.run_any(ProjectRange { projection: rover.projection(keep), twists, projected })
}
