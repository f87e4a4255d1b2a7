//! One row at a time, by the kernels whose lanes are the wheels, or by those of whole batches with the same row in every lane.

use crate::admissible::Keep;
use crate::estimate::{Measured, Unseen};
use crate::geometry::Twist;
use crate::kernels::admissible::{JudgeOne, ProjectOne};
use crate::one_row::inverse::level;
use crate::rover::Rover;
use crate::rover_data::Inputs;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::level::Level;

/// [`Rover::inverse`], by the kernel for one row where there is one.
pub fn inverse_one(
    rover: &Rover,
    twist: Twist,
    inputs: Inputs<'_>,
    steering: &mut [f64],
    speeds: &mut [f64],
) -> Result<(), Error> {
    if try_one(rover, twist, inputs, steering, speeds) {
        return Ok(());
    }
    rover.inverse(twist, inputs, steering, speeds)
}

/// Solves one twist by the kernel. False if the kernel could not; nothing is written then.
#[inline]
fn try_one(rover: &Rover, twist: Twist, inputs: Inputs<'_>, steering: &mut [f64], speeds: &mut [f64]) -> bool {
    rover.inverse_constants.as_ref().is_some_and(|constants| constants.solve(twist, inputs, steering, speeds))
}

/// Fails unless [`solve_row`] may be called: at the plain level without the kernel.
pub(crate) fn check_row(level: Level, rover: &Rover, twist: Twist, inputs: Inputs<'_>) -> Result<(), Error> {
    inputs.check()?;
    match inputs.steering_rates {
        None if level != Level::Scalar && is_sure(rover, twist) => Ok(()),
        rates => rover.check(twist, rates),
    }
}

/// A row that has been checked.
pub(crate) fn solve_row(
    level: Level,
    rover: &Rover,
    twist: Twist,
    inputs: Inputs<'_>,
    steering: &mut [f64],
    speeds: &mut [f64],
) {
    let solved = level != Level::Scalar && try_one(rover, twist, inputs, steering, speeds);
    if !solved {
        rover.solve(twist, inputs, steering, speeds);
    }
}

/// [`Rover::forward`], by the kernel for one row where there is one.
pub fn forward_one(rover: &Rover, measured: Measured<'_>, unseen: Unseen) -> Result<Twist, Error> {
    if let Some(constants) = &rover.forward_constants
        && let Some(twist) = constants.solve(measured)
    {
        return Ok(twist);
    }
    rover.forward(measured, unseen)
}

/// A row of a log: at the plain level without the kernel.
pub(crate) fn read_row(level: Level, rover: &Rover, measured: Measured<'_>, unseen: Unseen) -> Result<Twist, Error> {
    match level {
        Level::Scalar => rover.forward(measured, unseen),
        _ => forward_one(rover, measured, unseen),
    }
}

/// Verdict of the kernel on a twist; `None` where the plain core has to decide.
fn judge(rover: &Rover, twist: Twist) -> Option<bool> {
    let cone = rover.whole_cone()?;
    level()?.run(JudgeOne { cone, twist })?
}

/// True if [`Rover::check`] would surely pass.
fn is_sure(rover: &Rover, twist: Twist) -> bool {
    judge(rover, twist) == Some(true)
}

/// [`Rover::admissible`], by the kernel where there is one.
pub fn admissible_one(rover: &Rover, twist: Twist) -> Result<bool, Error> {
    match judge(rover, twist) {
        Some(answer) => Ok(answer),
        None => rover.admissible(twist),
    }
}

/// [`Rover::project`], by the kernel where there is one.
pub fn project_one(rover: &Rover, twist: Twist, keep: Keep) -> Result<Twist, Error> {
    let kernel = || {
        let cone = rover.whole_cone()?;
        let faces = rover.faces();
        level()?.run(ProjectOne { cone, faces, keep, twist })?
    };
    kernel().map_or_else(|| rover.project(twist, keep), Ok)
}
