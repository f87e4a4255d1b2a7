//! Every level and the single call give the same bits, over layouts and inputs of every kind.

use six_wheel_kinematics::admissible::Keep;
use six_wheel_kinematics::batch;
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::{Inputs, Rover};
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_kinematics::wheels::{Pivot, Wheel};
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::level::Level;
use six_wheel_numerics::threads::workers::Workers;

use crate::random::Numbers;

/// Twists the rover can make: some as they are, most at an end of a range, some at rest, some straight.
fn possible(rover: &Rover, numbers: &mut Numbers, count: usize) -> Vec<[f64; 3]> {
    let mut twist = |k: usize| {
        let wanted = numbers.twist();
        let wanted = match k % 7 {
            0 => Twist { vy: 0.0, ..wanted },
            1 => Twist { omega: 0.0, ..wanted },
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
        if numbers.chance(0.2) { 0.0 } else { numbers.between(-4.0, 4.0) }
    };
    (0..count).map(|_| one()).collect()
}

/// Bits of numbers; all zeros are one.
fn bits(numbers: &[f64]) -> Vec<u64> {
    numbers.iter().map(|number| (number + 0.0).to_bits()).collect()
}

#[test]
fn every_level_and_the_single_call_give_the_same_bits_whatever_is_given() -> Result<(), Error> {
    let mut numbers = Numbers(3);
    for round in 0..300 {
        let rover = numbers.rover()?;
        let (joints, wheels) = (rover.steered().len(), rover.wheels().len());
        let count = 131;
        let mut twists = possible(&rover, &mut numbers, count);
        // Of any size, as far as they stay possible.
        for (k, twist) in twists.iter_mut().enumerate() {
            let scale = [1.0, 1.0, 1.0, 1e-150, 1e120, 1e-310, -1.0][k % 7];
            *twist = twist.map(|part| part * scale);
        }
        let (previous, rates) = (angles(&mut numbers, count * joints), angles(&mut numbers, count * joints));
        let rolling = angles(&mut numbers, count * wheels);
        let given = |bit: usize, values| (round >> bit & 1 == 1).then_some(values);
        let inputs = Inputs {
            previous: given(0, &previous[..]),
            previous_speeds: given(1, &rolling[..]),
            steering_rates: given(2, &rates[..]),
        };
        let solve = |level| {
            let (mut steering, mut speeds) = (vec![7.0; count * joints], vec![7.0; count * wheels]);
            let workers = Workers { level, ..Workers::PLAIN };
            let done = batch::inverse(&rover, &twists, inputs, &mut steering, &mut speeds, workers);
            done.map(|()| [bits(&steering), bits(&speeds)])
        };
        let expected = solve(Level::Scalar);
        for level in Level::available() {
            assert_eq!(solve(level), expected, "{level:?} {rover:?}");
        }
        for (k, twist) in twists.iter().enumerate() {
            let (mut steering, mut speeds) = (vec![7.0; joints], vec![7.0; wheels]);
            let done = rover.inverse((*twist).into(), inputs.row(&rover, k), &mut steering, &mut speeds);
            match (&expected, done) {
                (Ok([angles, rotations]), done) => {
                    done?;
                    assert_eq!(bits(&steering), angles[k * joints..][..joints], "{twist:?} {rover:?}");
                    assert_eq!(bits(&speeds), rotations[k * wheels..][..wheels], "{twist:?} {rover:?}");
                }
                (Err(expected), Err(error)) => {
                    assert_eq!(error.at_row(k), *expected);
                    break;
                }
                (Err(error), Ok(())) => assert!(error.row > Some(k)),
            }
        }
    }
    Ok(())
}

#[test]
fn wheels_with_trail_are_let_pass_at_every_level_or_at_none() -> Result<(), Error> {
    // Angle beyond an end of its range that a wheel would have to turn: within the tolerance, next to it, and far from it [rad].
    let beyond = [-1.0, -1e-9, 0.0, 4e-10, 6e-10, 0.99e-9, 1.01e-9, 1e-8, 0.3];
    let mut numbers = Numbers(7);
    let mut refused = 0;
    for _ in 0..1000 {
        let wheel = |name, x, y| Wheel { pivot: Pivot::Castor, trail: 0.03, ..Wheel::new(name, x, y, 0.1) };
        let lower = numbers.between(-3.0, 1.0);
        let range = SteeringRange { lower, upper: lower + numbers.between(0.05, 4.0) };
        let (x, y) = (numbers.between(-1.0, 1.0), numbers.between(-1.0, 1.0));
        let trailing = Wheel {
            heading: numbers.between(-3.0, 3.0),
            trail: numbers.between(-0.2, 0.2),
            ..Wheel::new("a", x, y, 0.1).steered(range)
        };
        let (heading, trail) = (trailing.heading, trailing.trail);
        let rover = Rover::new(vec![trailing, wheel("b", 0.4, 0.3), wheel("c", -0.4, 0.1)])?;
        for off in beyond {
            let at = if numbers.chance(0.5) { range.upper + off } else { range.lower - off };
            // Rolls one way at this angle, and does not slide.
            let (sin, cos) = (heading + at).sin_cos();
            let (rolled, omega) = (numbers.between(-1.0, 1.0), numbers.between(-2.0, 2.0));
            let rate = if numbers.chance(0.5) { 0.0 } else { numbers.between(-2.0, 2.0) };
            let across = trail * (omega + rate);
            let vx = cos * rolled - sin * across + omega * y;
            let vy = sin * rolled + cos * across - omega * x;
            let (twists, rates) = ([[vx, vy, omega]; 8], [rate; 8]);
            let solve = |level| {
                let (mut steering, mut speeds) = ([0.0; 8], [0.0; 24]);
                let inputs = Inputs { steering_rates: Some(&rates), ..Inputs::default() };
                let workers = Workers { level, ..Workers::PLAIN };
                batch::inverse(&rover, &twists, inputs, &mut steering, &mut speeds, workers).map(|()| steering)
            };
            let expected = solve(Level::Scalar);
            refused += usize::from(expected.is_err());
            let is_at_end = off.abs() < 1e-10 && across.abs() < 0.5 * rolled.abs();
            assert!(!(is_at_end && expected.is_err()), "{rover:?} {twists:?} {rate}");
            for level in Level::available() {
                assert_eq!(solve(level), expected, "{level:?} {rover:?} {twists:?} {rate}");
            }
        }
    }
    assert!((500..8000).contains(&refused), "{refused}");
    Ok(())
}

#[test]
fn wheels_that_may_go_either_way_agree_at_every_level() -> Result<(), Error> {
    let mut numbers = Numbers(11);
    for _ in 0..100 {
        let mut wheels = Vec::new();
        for name in ["a", "b", "c", "d", "e"] {
            let (x, y) = (numbers.between(-1.0, 1.0), numbers.between(-1.0, 1.0));
            let range = SteeringRange { lower: -numbers.between(1.58, 3.4), upper: numbers.between(1.58, 3.4) };
            wheels.push(Wheel::new(name, x, y, 0.1).steered(range));
        }
        let rover = Rover::new(wheels)?;
        // To the side, all of them or all but one are undecided.
        let mut twist = || {
            let along = numbers.between(-0.1, 0.1);
            [along, numbers.between(-1.0, 1.0), numbers.between(-0.1, 0.1)]
        };
        let twists: Vec<_> = (0..512).map(|_| twist()).collect();
        let solve = |level| {
            let (mut steering, mut speeds) = (vec![0.0; 2560], vec![0.0; 2560]);
            let workers = Workers { level, ..Workers::PLAIN };
            let inputs = Inputs::default();
            batch::inverse(&rover, &twists, inputs, &mut steering, &mut speeds, workers).map(|()| [steering, speeds])
        };
        let expected = solve(Level::Scalar)?.concat();
        for level in Level::available() {
            assert_eq!(bits(&solve(level)?.concat()), bits(&expected), "{level:?} {rover:?}");
        }
    }
    Ok(())
}
