//! Whole arrays at once: every row is checked before the first one is written.

use crate::admissible::Keep;
use crate::error::{Error, ErrorKind};
use crate::estimate::{Fit, Measured, Method, Unseen};
use crate::geometry::Twist;
use crate::rover::{Inputs, Rover};

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

/// [`Rover::inverse`] of every twist.
pub fn inverse(
    rover: &Rover,
    twists: &[[f64; 3]],
    inputs: Inputs<'_>,
    steering: &mut [f64],
    speeds: &mut [f64],
) -> Result<(), Error> {
    let (joints, wheels) = (rover.steered().len(), rover.wheels().len());
    for (k, twist) in twists.iter().enumerate() {
        let inputs = inputs.row(rover, k);
        inputs
            .check()
            .and_then(|()| rover.check(Twist::from(*twist), inputs.steering_rates))
            .map_err(|error| error.at_row(k))?;
    }
    for (k, twist) in twists.iter().enumerate() {
        let (steering, speeds) = (row_mut(steering, joints, k), row_mut(speeds, wheels, k));
        rover.solve(Twist::from(*twist), inputs.row(rover, k), steering, speeds);
    }
    Ok(())
}

/// [`Rover::forward`] of every row of a log.
pub fn forward(
    rover: &Rover,
    log: Log<'_>,
    unseen: Unseen,
    twists: &mut [[f64; 3]],
) -> Result<(), Error> {
    // Where the rows depend on the angles or on gaps in the readings, only solving shows whether it works.
    let solvable = |k: usize| {
        let measured = log.row(rover, k);
        if rover.solution.is_some() && measured.is_complete() {
            rover.check_readings(measured)
        } else {
            rover.forward(measured, unseen).map(drop)
        }
    };
    for k in 0..twists.len() {
        solvable(k).map_err(|error| error.at_row(k))?;
    }
    for (k, twist) in twists.iter_mut().enumerate() {
        *twist = rover.forward(log.row(rover, k), unseen)?.into();
    }
    Ok(())
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
