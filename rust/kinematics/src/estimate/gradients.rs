//! Derivatives of the twist as sums of products with constants of the rover, by which registers of rows are multiplied.
//!
//! The gradient of the normal equations with respect to any quantity of a wheel is a sum of products of `1, cos, sin`
//! of the wheel's direction and `1, vx, vy, omega, speed, rate`. Their constants are evaluated once by
//! [`LinearisedFit`], with all but one of these numbers 0; so the rules of wheels, rollers and shared rows are written
//! there alone.

use nalgebra::{Matrix3, Vector3};

use super::sensitivity::{LinearisedFit, Quantity};
use super::{Measured, Reading};
use crate::geometry::Direction;
use crate::rover_data::{MAX_WHEELS, Mount, RoverData};

/// Numbers `1, vx, vy, omega, speed, rate`, and products: each of them times 1, cosine and sine of the direction.
pub(crate) const GIVEN: usize = 6;
pub(crate) const PRODUCTS: usize = 3 * GIVEN;

/// A sum of products: their indices and factors.
pub(crate) type Sum = Vec<(usize, f64)>;

/// Derivatives with respect to a quantity of every wheel: of the twist where the solution of the normal equations is a
/// constant of the rover, otherwise the gradients of these about the centre of the pivots. First without, then with
/// steering rates.
#[derive(Clone, Debug, Default)]
pub(crate) struct Gradients([Vec<[Sum; 3]>; 2]);

impl Gradients {
    pub fn new(rover: &RoverData, quantity: Quantity) -> Self {
        let zeros = [0.0; MAX_WHEELS];
        let at_rest = Measured {
            steering: &zeros[..rover.steered().len()],
            speeds: &zeros[..rover.wheels().len()],
            steering_rates: None,
        };
        let mut readings = [Reading::NONE; MAX_WHEELS];
        rover.read(at_rest, &mut readings);
        let mut all = Self::default();
        for wheel in 0..rover.wheels().len() {
            let products = products(rover, &readings, wheel, quantity);
            for (sums_of, turning) in all.0.iter_mut().zip([false, true]) {
                sums_of.push(sums(&products, turning));
            }
        }
        all
    }

    /// The sums of a wheel, with steering rates if `turning`.
    #[inline]
    pub fn of(&self, wheel: usize, turning: bool) -> &[Sum; 3] {
        &self.0[usize::from(turning)][wheel]
    }
}

/// Products that are not 0, with their indices, for each component.
fn sums(products: &[Vector3<f64>; PRODUCTS], turning: bool) -> [Sum; 3] {
    [0, 1, 2].map(|part| {
        let parts = products.iter().map(|product| product[part]).enumerate();
        let counts = |(place, share): &(usize, f64)| *share != 0.0 && (turning || place % GIVEN < GIVEN - 1);
        parts.filter(counts).collect()
    })
}

/// Factors of all products.
fn products(
    rover: &RoverData,
    readings: &[Reading; MAX_WHEELS],
    i: usize,
    quantity: Quantity,
) -> [Vector3<f64>; PRODUCTS] {
    let mut products = [Vector3::zeros(); PRODUCTS];
    let gradients = |sin, cos| {
        let mut all = [Vector3::zeros(); GIVEN];
        for given in 0..GIVEN {
            // The gradient of the constant 1; of another number what it adds to that.
            let direction = Direction { sin, cos };
            all[given] = gradient(rover, *readings, i, quantity, direction, given) - all[0];
        }
        all
    };
    if !matches!(rover.mounts[i], Mount::Steered(..)) {
        products[..GIVEN].copy_from_slice(&gradients(0.0, 1.0));
        return products;
    }
    let [along, back] = [gradients(0.0, 1.0), gradients(0.0, -1.0)];
    let [left, right] = [gradients(1.0, 0.0), gradients(-1.0, 0.0)];
    for given in 0..GIVEN {
        products[given] = (along[given] + back[given]) / 2.0;
        products[GIVEN + given] = (along[given] - back[given]) / 2.0;
        products[2 * GIVEN + given] = (left[given] - right[given]) / 2.0;
    }
    products
}

/// Gradient with wheel `i` in this direction, with number `given` (and the constant) 1 and all others 0.
fn gradient(
    rover: &RoverData,
    mut readings: [Reading; MAX_WHEELS],
    i: usize,
    quantity: Quantity,
    direction: Direction,
    given: usize,
) -> Vector3<f64> {
    let one = |place| if place == given { 1.0 } else { 0.0 };
    let (wheel, reading) = (&rover.wheels()[i], &mut readings[i]);
    let (mut speeds, rates) = ([0.0; MAX_WHEELS], [one(5); MAX_WHEELS]);
    speeds[i] = one(4);
    reading.rolled = wheel.radius * one(4);
    if matches!(rover.mounts[i], Mount::Steered(..)) {
        let rows = wheel.rows(direction);
        (reading.rolling, reading.side_slip) = (rows.rolling, rows.side_slip);
        reading.rolled += wheel.scrub * one(5);
        reading.slipped = wheel.trail * one(5);
    }
    let (count, joints) = (rover.wheels().len(), rover.steered().len());
    let linearised = LinearisedFit {
        rover,
        readings: &readings[..count],
        measured: Measured { steering: &[], speeds: &speeds[..count], steering_rates: Some(&rates[..joints]) },
        solution: rover.solution.unwrap_or_else(Matrix3::zeros),
        twist: Vector3::new(one(1), one(2), one(3)),
        weights: None,
    };
    match rover.solution {
        Some(_) => linearised.derivative(i, quantity),
        None => rover.row_about_centre(&linearised.gradient(i, quantity)),
    }
}
