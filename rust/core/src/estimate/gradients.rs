//! The derivatives of the twist as sums of products, with constants of the rover: what registers of rows are multiplied by.
//!
//! By any quantity of a wheel, the gradient of the normal equations is a sum of products of `1, cos, sin` of where the
//! wheel points and `1, vx, vy, omega, speed, rate`. [`Linearised`] is asked for their constants once, where all but one of
//! these are 0; so the rules of wheels, rollers and shared rows are written there alone.

use nalgebra::{Matrix3, Vector3};

use super::sensitivity::{Linearised, Quantity};
use super::{Measured, Reading};
use crate::rover::{MAX_WHEELS, Mount, Rover};
use crate::wheels::Direction;

/// `1, vx, vy, omega, speed, rate`, and how often: times 1, cosine and sine of the direction.
pub(crate) const GIVEN: usize = 6;
pub(crate) const PRODUCTS: usize = 3 * GIVEN;

/// A sum of products, by their places.
pub(crate) type Sum = Vec<(usize, f64)>;

/// The derivatives of every wheel by every quantity: of the twist where the solution of the normal equations is a
/// constant of the rover, or else their gradients about the centre of the pivots. First for steering that rests.
#[derive(Clone, Debug)]
pub(crate) struct Gradients([Vec<[[Sum; 3]; Quantity::ALL.len()]>; 2]);

impl Gradients {
    pub fn new(rover: &Rover) -> Self {
        let all = [false, true].map(|turning| {
            let of_wheel = |wheel| {
                Quantity::ALL.map(|quantity| sums(&products(rover, wheel, quantity), turning))
            };
            (0..rover.wheels().len()).map(of_wheel).collect()
        });
        Self(all)
    }

    /// Those of a wheel, of steering that rests or is `turning`.
    pub fn of(&self, wheel: usize, quantity: Quantity, turning: bool) -> &[Sum; 3] {
        &self.0[usize::from(turning)][wheel][quantity as usize]
    }
}

/// What is not 0 of the products, for each part.
fn sums(products: &[Vector3<f64>; PRODUCTS], turning: bool) -> [Sum; 3] {
    [0, 1, 2].map(|part| {
        let parts = products.iter().map(|product| product[part]).enumerate();
        let counts =
            |(place, share): &(usize, f64)| *share != 0.0 && (turning || place % GIVEN < GIVEN - 1);
        parts.filter(counts).collect()
    })
}

/// What every product is multiplied by.
fn products(rover: &Rover, wheel: usize, quantity: Quantity) -> [Vector3<f64>; PRODUCTS] {
    let mut products = [Vector3::zeros(); PRODUCTS];
    let ahead = |sin, cos| Direction { sin, cos };
    for given in 0..GIVEN {
        let ask = |direction| {
            let bare = gradient(rover, wheel, quantity, direction, 0);
            match given {
                0 => bare,
                _ => gradient(rover, wheel, quantity, direction, given) - bare,
            }
        };
        if !matches!(rover.mounts[wheel], Mount::Steered(..)) {
            products[given] = ask(ahead(0.0, 1.0));
            continue;
        }
        let [along, back] = [1.0, -1.0].map(|cos| ask(ahead(0.0, cos)));
        let [left, right] = [1.0, -1.0].map(|sin| ask(ahead(sin, 0.0)));
        products[given] = (along + back) / 2.0;
        products[GIVEN + given] = (along - back) / 2.0;
        products[2 * GIVEN + given] = (left - right) / 2.0;
    }
    products
}

/// What it is with a wheel in this direction, where everything is 0 but this one number, which is 1.
fn gradient(
    rover: &Rover,
    i: usize,
    quantity: Quantity,
    direction: Direction,
    given: usize,
) -> Vector3<f64> {
    let one = |place| if place == given { 1.0 } else { 0.0 };
    let wheel = &rover.wheels()[i];
    let (mut speeds, zeros) = ([0.0; MAX_WHEELS], [0.0; MAX_WHEELS]);
    speeds[i] = one(4);
    let rates = [one(5); MAX_WHEELS];
    let (count, joints) = (rover.wheels().len(), rover.steered().len());
    let measured = Measured {
        steering: &zeros[..joints],
        speeds: &speeds[..count],
        steering_rates: Some(&rates[..joints]),
    };
    let mut readings = [Reading::NONE; MAX_WHEELS];
    rover.read(measured, &mut readings);
    if matches!(rover.mounts[i], Mount::Steered(..)) {
        let rows = wheel.rows(direction);
        (readings[i].rolling, readings[i].side_slip) = (rows.rolling, rows.side_slip);
    }
    let linearised = Linearised {
        rover,
        readings: &readings[..count],
        measured,
        solution: rover.solution.unwrap_or_else(Matrix3::zeros),
        twist: Vector3::new(one(1), one(2), one(3)),
        weights: None,
    };
    match rover.solution {
        Some(_) => linearised.derivative(i, quantity),
        None => rover.shifted(&linearised.gradient(i, quantity)),
    }
}
