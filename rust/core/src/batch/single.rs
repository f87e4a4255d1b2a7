//! One row: the wheels are the lanes.
use crate::error::Error;
use crate::estimate::{Measured, Unseen};
use crate::geometry::Twist;
use crate::rover::{Inputs, Rover};

/// [`Rover::inverse`], by the best kernel.
pub fn inverse_one(
    rover: &Rover,
    twist: Twist,
    inputs: Inputs<'_>,
    steering: &mut [f64],
    speeds: &mut [f64],
) -> Result<(), Error> {
    rover.inverse(twist, inputs, steering, speeds)
}

/// [`Rover::forward`], by the best kernel.
pub fn forward_one(rover: &Rover, measured: Measured<'_>, unseen: Unseen) -> Result<Twist, Error> {
    rover.forward(measured, unseen)
}
