//! Whether one twist is possible, and the nearest that is: the kernels of whole batches, with the twist in every lane.

use super::inverse::level;
use crate::admissible::Keep;
use crate::batch::formulas::admissible::{JudgeOne, ProjectOne};
use crate::error::Error;
use crate::geometry::Twist;
use crate::rover::Rover;

/// What the kernel says of a twist; nothing where the plain core has to decide.
fn judge(rover: &Rover, twist: Twist) -> Option<bool> {
    let cone = rover.whole_cone()?;
    level()?.run(JudgeOne { cone, twist })?
}

/// Whether [`Rover::check`] would surely pass.
pub(super) fn is_sure(rover: &Rover, twist: Twist) -> bool {
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
