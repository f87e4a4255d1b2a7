//! One row at a time: the lanes are the wheels.

use crate::admissible::Keep;
use crate::estimate::{Measured, Unseen};
use crate::geometry::Twist;
use crate::rover::Rover;
use crate::rover_data::Inputs;
use six_wheel_numerics::error::Error;

/// [`Rover::inverse`].
pub fn inverse_one(
    rover: &Rover,
    twist: Twist,
    inputs: Inputs<'_>,
    steering: &mut [f64],
    speeds: &mut [f64],
) -> Result<(), Error> {
    rover.inverse(twist, inputs, steering, speeds)
}

/// [`Rover::forward`].
pub fn forward_one(rover: &Rover, measured: Measured<'_>, unseen: Unseen) -> Result<Twist, Error> {
    rover.forward(measured, unseen)
}

/// [`Rover::admissible`].
pub fn admissible_one(rover: &Rover, twist: Twist) -> Result<bool, Error> {
    rover.admissible(twist)
}

/// [`Rover::project`].
pub fn project_one(rover: &Rover, twist: Twist, keep: Keep) -> Result<Twist, Error> {
    rover.project(twist, keep)
}
