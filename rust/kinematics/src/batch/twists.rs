//! Admissible twists, and the nearest ones to any others.

use crate::admissible::Keep;
use crate::geometry::Twist;
use crate::kernels::admissible::{Admissible, Project};
use crate::kernels::usual::LARGEST;
use crate::rover::Rover;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::sizes::sum_of_sizes;
use six_wheel_numerics::threads::workers::Workers;

/// Writes for each twist if the rover can make it. Fails where one is not finite.
#[inline]
pub fn admissible(rover: &Rover, twists: &[[f64; 3]], answers: &mut [bool], workers: Workers) -> Result<(), Error> {
    let share = workers.share(twists.len());
    let jobs = twists.chunks(share).zip(answers.chunks_mut(share));
    workers.each(jobs.enumerate(), |(k, (twists, answers))| {
        admissible_rows(rover, twists, answers, workers.here()).map_err(|error| error.below(k * share))
    })
}

fn admissible_rows(rover: &Rover, twists: &[[f64; 3]], answers: &mut [bool], workers: Workers) -> Result<(), Error> {
    if let Some(cone) = rover.whole_cone()
        && let Some(done) = workers.level.run(Admissible { rover, cone, twists, answers })
    {
        return done;
    }
    for (k, (twist, answer)) in twists.iter().zip(answers).enumerate() {
        let answered = rover.admissible(Twist::from(*twist));
        *answer = answered.map_err(|error| error.at_row(k))?;
    }
    Ok(())
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
        workers.each(twists.chunks(share).enumerate(), |(k, twists)| {
            check(rover, twists, keep, here).map_err(|error| error.below(k * share))
        })?;
    }
    let jobs = twists.chunks(share).zip(projected.chunks_mut(share));
    workers.each(jobs.enumerate(), |(k, (twists, projected))| {
        project_rows(rover, twists, keep, projected, here).map_err(|error| error.below(k * share))
    })
}

/// Fails at the first twist that cannot be projected.
fn check(rover: &Rover, twists: &[[f64; 3]], keep: Keep, workers: Workers) -> Result<(), Error> {
    if matches!(keep, Keep::Curvature | Keep::Nearest) {
        // To stand still is always possible.
        let numbers = twists.as_flattened();
        if rover.whole_cone().is_some() && sum_of_sizes(workers.level, numbers) <= LARGEST {
            return Ok(());
        }
        return twists.iter().enumerate().try_for_each(|(k, twist)| {
            let checked = rover.check_speeds(Twist::from(*twist), None);
            checked.map(drop).map_err(|error| error.at_row(k))
        });
    }
    let mut room = [[0.0; 3]; ROWS];
    for (block, twists) in twists.chunks(ROWS).enumerate() {
        project_rows(rover, twists, keep, &mut room[..twists.len()], workers)
            .map_err(|error| error.below(block * ROWS))?;
    }
    Ok(())
}

/// Rows that are tried at a time.
const ROWS: usize = 512;

fn project_rows(
    rover: &Rover,
    twists: &[[f64; 3]],
    keep: Keep,
    projected: &mut [[f64; 3]],
    workers: Workers,
) -> Result<(), Error> {
    if let Some(cone) = rover.whole_cone()
        && let Some(done) = workers.level.run(Project { rover, cone, faces: rover.faces(), keep, twists, projected })
    {
        return done;
    }
    for (k, (twist, projected)) in twists.iter().zip(projected).enumerate() {
        let found = rover.project(Twist::from(*twist), keep);
        *projected = found.map_err(|error| error.at_row(k))?.into();
    }
    Ok(())
}
