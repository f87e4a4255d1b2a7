//! Uncertain dimensions of a rover. Their errors are constant over a run, so that the relative error of the distance
//! does not decrease with it, as that by readings does.
//!
//! [`Deviations`] are errors of one standard deviation, independent of one another. Every step propagates a column for
//! each of them, the error of the pose by it; corrections of the pose do not correct the dimensions.
//!
//! Source: S. F. Schmidt, Application of State-Space Methods to Navigation Problems, Advances in Control Systems 3,
//! 1966: parameters that are considered, but not estimated.

use nalgebra::Vector3;

use super::quantities::{Column, DIMENSIONS};
use six_wheel_kinematics::estimate::sensitivity::LinearisedFit;
use six_wheel_numerics::error::{Error, HUGE, number};

/// Uncertain numbers of one wheel, in this order: [`DIMENSIONS`], and the scale factors of the readings of its rotation
/// and of its steering angle.
pub const NUMBERS: usize = DIMENSIONS.len() + 2;

/// Independent errors of one standard deviation, each with the quantities that it changes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Deviations {
    count: usize,
    wheels: usize,
    /// Quantities that an error changes, with the change by each error.
    moved: Vec<(Column, Vec<f64>)>,
}

impl Deviations {
    /// From a table for each error: a row of [`NUMBERS`] for every wheel.
    pub fn new(tables: &[f64], wheels: usize) -> Result<Self, Error> {
        if let Some(wrong) = tables.iter().find(|by| by.is_nan() || by.abs() >= HUGE) {
            return Err(Error::value("dimensions", "be finite", number(*wrong)));
        }
        let each = (wheels * NUMBERS).max(1);
        let mut moved = Vec::new();
        for wheel in 0..wheels {
            let dimensions = DIMENSIONS.map(|quantity| Column::Dimension(quantity, wheel));
            let readings = [Column::Turned(wheel), Column::Steered(wheel)];
            for (place, column) in dimensions.into_iter().chain(readings).enumerate() {
                let numbers = tables.iter().skip(wheel * NUMBERS + place).step_by(each);
                let by: Vec<f64> = numbers.copied().collect();
                if by.iter().any(|by| *by != 0.0) {
                    moved.push((column, by));
                }
            }
        }
        Ok(Self { count: tables.len() / each, wheels, moved })
    }

    /// Number of errors.
    #[inline]
    pub fn len(&self) -> usize {
        self.count
    }

    /// True if there is none: all dimensions are exact.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Fails unless they are of a rover with this number of wheels.
    pub fn check_for(&self, wheels: usize) -> Result<(), Error> {
        if self.is_empty() || self.wheels == wheels {
            return Ok(());
        }
        Err(Error::value("dimensions", format!("be of {wheels} wheels"), self.wheels))
    }

    /// Error of the displacement of a step by each of them.
    pub(crate) fn displacement_errors(&self, linearised: &LinearisedFit<'_>, errors: &mut [[f64; 3]]) {
        errors.fill([0.0; 3]);
        for (column, by) in &self.moved {
            let derivative = column.displacement_derivative(linearised);
            for (error, by) in errors.iter_mut().zip(by) {
                *error = (Vector3::from(*error) + derivative * *by).into();
            }
        }
    }
}
