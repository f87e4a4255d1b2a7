//! Registers against the plain core, over layouts and inputs of every kind.

use crate::admissible::Keep;
use crate::admissible::tests::Numbers;
use crate::batch::{self, Level, Workers};
use crate::error::Error;
use crate::rover::{Inputs, Rover};

/// Twists the rover can make: some as they are, most at an end of a range, some at rest, some straight.
fn possible(rover: &Rover, numbers: &mut Numbers, count: usize) -> Vec<[f64; 3]> {
    let mut twist = |k: usize| {
        let wanted = numbers.twist();
        let wanted = match k % 7 {
            0 => crate::Twist { vy: 0.0, ..wanted },
            1 => crate::Twist {
                omega: 0.0,
                ..wanted
            },
            _ => wanted,
        };
        match rover.project(wanted, [Keep::Curvature, Keep::Nearest][k % 2]) {
            Ok(found) => found.into(),
            Err(_) => [0.0; 3],
        }
    };
    (0..count).map(&mut twist).collect()
}

fn angles(numbers: &mut Numbers, count: usize) -> Vec<f64> {
    let mut one = || {
        if numbers.chance(0.2) {
            0.0
        } else {
            numbers.between(-4.0, 4.0)
        }
    };
    (0..count).map(|_| one()).collect()
}

#[test]
fn every_level_agrees_with_the_plain_core_whatever_is_given() -> Result<(), Error> {
    let mut numbers = Numbers(3);
    for round in 0..300 {
        let rover = numbers.rover()?;
        let (joints, wheels) = (rover.steered().len(), rover.wheels().len());
        let count = 131;
        let twists = possible(&rover, &mut numbers, count);
        let (previous, rates) = (
            angles(&mut numbers, count * joints),
            angles(&mut numbers, count * joints),
        );
        let rolling = angles(&mut numbers, count * wheels);
        let given = |bit: usize, values| (round >> bit & 1 == 1).then_some(values);
        let inputs = Inputs {
            previous: given(0, &previous[..]),
            previous_speeds: given(1, &rolling[..]),
            steering_rates: given(2, &rates[..]),
        };
        let solve = |level| {
            let (mut steering, mut speeds) = (vec![7.0; count * joints], vec![7.0; count * wheels]);
            let workers = Workers {
                level,
                ..Workers::PLAIN
            };
            let done = batch::inverse(&rover, &twists, inputs, &mut steering, &mut speeds, workers);
            done.map(|()| (steering, speeds))
        };
        let expected = solve(Level::Plain);
        for level in Level::available() {
            let (found, expected) = match (solve(level), &expected) {
                (Ok(found), Ok(expected)) => (found, expected),
                (found, expected) => {
                    assert_eq!(&found, expected);
                    continue;
                }
            };
            for (k, twist) in twists.iter().enumerate() {
                let largest = expected.1[k * wheels..(k + 1) * wheels]
                    .iter()
                    .fold(1e-3, |most: f64, speed| most.max(speed.abs()));
                let angle = |at: usize| (found.0[at] - expected.0[at]).abs();
                let speed = |at: usize| (found.1[at] - expected.1[at]).abs() / largest;
                let row = |width: usize| k * width..(k + 1) * width;
                let (off, slow) = (
                    row(joints).map(angle).fold(0.0, f64::max),
                    row(wheels).map(speed).fold(0.0, f64::max),
                );
                assert!(
                    off <= 1e-13 && slow <= 1e-13,
                    "{level:?} {:?}: {off} {slow} {:?} {:?} {rover:?}",
                    twist,
                    &found.0[row(joints)],
                    &expected.0[row(joints)],
                );
            }
        }
    }
    Ok(())
}
