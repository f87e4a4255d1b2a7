//! The analytic derivatives of the estimated twist against differences of the estimate itself.

use proptest::prelude::*;
use six_wheel_kinematics::batch;
use six_wheel_kinematics::estimate::Measured;
use six_wheel_kinematics::estimate::Unseen;
use six_wheel_kinematics::estimate::sensitivity::Quantity;
use six_wheel_kinematics::rover::Rover;
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_kinematics::table::Log;
use six_wheel_kinematics::wheels::{Pivot, Wheel};
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::level::Level;
use six_wheel_numerics::threads::workers::Workers;

/// Readings of one instant.
#[derive(Clone, Debug)]
struct Readings {
    steering: Vec<f64>,
    speeds: Vec<f64>,
    rates: Vec<f64>,
}

impl Readings {
    fn measured(&self) -> Measured<'_> {
        Measured { steering: &self.steering, speeds: &self.speeds, steering_rates: Some(&self.rates) }
    }
}

const KINDS: usize = 5;

fn wheel(index: usize, kind: usize, numbers: [f64; 7]) -> Wheel {
    let [x, y, radius, heading, scrub, trail, roller] = numbers;
    let mut wheel = Wheel::new(format!("wheel_{index}"), x, y, 0.1 + 0.1 * radius.abs());
    wheel.heading = heading;
    wheel.scrub = 0.1 * scrub;
    wheel.trail = 0.1 * trail;
    match kind {
        0 => {}
        1 => wheel.heading = 0.0, // shares its axle direction with others of its kind
        2 => {
            wheel.heading = std::f64::consts::PI; // the same direction, turned about
        }
        3 => wheel.roller_angle = Some(0.8 + 0.4 * roller),
        _ => wheel.pivot = Pivot::Steered(SteeringRange::default()),
    }
    wheel
}

fn cases() -> impl Strategy<Value = (Vec<Wheel>, Readings)> {
    let one = (0..KINDS, prop::array::uniform7(-1.0..1.0_f64));
    prop::collection::vec(one, 3..8).prop_flat_map(|wheels| {
        let wheels: Vec<Wheel> =
            wheels.into_iter().enumerate().map(|(index, (kind, numbers))| wheel(index, kind, numbers)).collect();
        let steered = wheels.iter().filter(|wheel| wheel.steering().is_some()).count();
        let (speeds, angles, rates) = (
            prop::collection::vec(-5.0..5.0_f64, wheels.len()),
            prop::collection::vec(-1.5..1.5_f64, steered),
            prop::collection::vec(-1.0..1.0_f64, steered),
        );
        (Just(wheels), speeds, angles, rates)
            .prop_map(|(wheels, speeds, steering, rates)| (wheels, Readings { steering, speeds, rates }))
    })
}

fn twist(wheels: &[Wheel], readings: &Readings) -> Result<[f64; 3], Error> {
    let rover = Rover::new(wheels.to_vec())?;
    Ok(rover.forward(readings.measured(), Unseen::Refuse)?.into())
}

/// The wheels and readings with one quantity of one wheel moved; nothing where it does not apply.
fn moved(
    wheels: &[Wheel],
    readings: &Readings,
    i: usize,
    quantity: Quantity,
    step: f64,
) -> Option<(Vec<Wheel>, Readings)> {
    let (mut wheels, mut readings) = (wheels.to_vec(), readings.clone());
    let joint = wheels[..i].iter().filter(|wheel| wheel.steering().is_some()).count();
    let is_steered = wheels[i].steering().is_some();
    match quantity {
        Quantity::Speed => readings.speeds[i] += step,
        Quantity::Steering if is_steered => readings.steering[joint] += step,
        Quantity::SteeringRate if is_steered => readings.rates[joint] += step,
        Quantity::X => wheels[i].x += step,
        Quantity::Y => wheels[i].y += step,
        Quantity::Heading => wheels[i].heading += step,
        Quantity::Radius => wheels[i].radius += step,
        Quantity::Scrub => wheels[i].scrub += step,
        Quantity::Trail => wheels[i].trail += step,
        Quantity::RollerAngle => *wheels[i].roller_angle.as_mut()? += step,
        _ => return None,
    }
    Some((wheels, readings))
}

proptest! {
    #[test]
    fn derivatives_are_the_limits_of_differences((wheels, readings) in cases()) {
        let Ok(rover) = Rover::new(wheels.clone()) else { return Ok(()) };
        // Close to where the wheels no longer determine the twist, differences are nothing but rounding.
        let (mut residual, mut weights) = (vec![0.0; wheels.len()], vec![0.0; wheels.len()]);
        let fit = rover.fit(
            readings.measured(),
            six_wheel_kinematics::estimate::Method::LeastSquares,
            Unseen::Zero,
            &mut residual,
            &mut weights,
        )?;
        prop_assume!(fit.sigma_min > 0.1);
        // At the angle at which two fixed wheels stop having a say in each other's side slip, 10 degrees apart, the derivative is
        // continuous but bends, and differences across it err by the step itself.
        let fixed: Vec<_> = wheels
            .iter()
            .filter(|wheel| wheel.pivot == Pivot::Fixed && wheel.roller_angle.is_none())
            .collect();
        let aside = 10.0_f64.to_radians().sin();
        for one in &fixed {
            for other in &fixed {
                prop_assume!(((one.heading - other.heading).sin().abs() - aside).abs() > 1e-4);
            }
        }
        for quantity in Quantity::ALL {
            for i in 0..wheels.len() {
                let step = 1e-5;
                let (Some(ahead), Some(behind)) = (
                    moved(&wheels, &readings, i, quantity, step),
                    moved(&wheels, &readings, i, quantity, -step),
                ) else { continue };
                let (ahead, behind) = (twist(&ahead.0, &ahead.1)?, twist(&behind.0, &behind.1)?);
                let derivative =
                    rover.sensitivity(readings.measured(), |linear| linear.derivative(i, quantity))?;
                for k in 0..3 {
                    let difference = (ahead[k] - behind[k]) / (2.0 * step);
                    // The third derivative times the step squared, and rounding over the step, both many
                    // times over for rows of condition up to some hundred.
                    let tolerance = 1e-6 * (1.0 + derivative.amax()) / fit.sigma_min.min(1.0).powi(3);
                    prop_assert!(
                        (derivative[k] - difference).abs() < tolerance,
                        "{quantity:?} of wheel {i}: {} against {difference}",
                        derivative[k]
                    );
                }
            }
        }
    }

    /// Normal equations lose digits by the square of the condition.
    #[test]
    fn registers_say_what_the_plain_core_says((wheels, readings) in cases(), with_rates in any::<bool>()) {
        let Ok(rover) = Rover::new(wheels.clone()) else { return Ok(()) };
        let count = 70;
        // Some rows are not of a usual size.
        let size = |k: usize| if k % 23 == 5 { 1e120 } else { 1.0 - k as f64 / 16.0 };
        let rows = |row: &[f64], size: &dyn Fn(usize) -> f64| -> Vec<f64> {
            (0..count).flat_map(|k| row.iter().map(move |number| number * size(k))).collect()
        };
        let steering = rows(&readings.steering, &|k| k as f64 / 16.0);
        let (speeds, rates) = (rows(&readings.speeds, &size), rows(&readings.rates, &size));
        let log = Log {
            steering: &steering,
            speeds: &speeds,
            steering_rates: with_rates.then_some(&rates),
        };
        let measured = |k: usize| {
            let of = |rows: &'_ [f64], width: usize| rows[k * width..(k + 1) * width].to_vec();
            let joints = readings.steering.len();
            (of(&steering, joints), of(&speeds, wheels.len()), of(&rates, joints))
        };
        for level in Level::available() {
            let workers = Workers { level, ..Workers::PLAIN };
            let mut columns: Vec<_> = Quantity::ALL
                .iter()
                .map(|quantity| match quantity {
                    Quantity::Steering | Quantity::SteeringRate => rover.steered().to_vec(),
                    _ => (0..wheels.len()).collect(),
                })
                .map(|wheels| (vec![0.0; 3 * wheels.len() * count], wheels))
                .collect();
            let mut targets: Vec<_> = Quantity::ALL
                .into_iter()
                .zip(&mut columns)
                .map(|(quantity, (target, _))| (quantity, target.as_mut_slice()))
                .collect();
            let (mut twists, mut estimates) = (vec![[0.0; 3]; count], vec![[0.0; 3]; count]);
            let done = batch::sensitivity(&rover, log, &mut twists, &mut targets, workers);
            let forward = batch::forward(&rover, log, Unseen::Refuse, &mut estimates, workers);
            for k in 0..count {
                let (steering, speeds, rates) = measured(k);
                let measured = Measured {
                    steering: &steering,
                    speeds: &speeds,
                    steering_rates: with_rates.then_some(&rates),
                };
                let (mut slips, mut says) = (vec![0.0; wheels.len()], vec![0.0; wheels.len()]);
                let method = six_wheel_kinematics::estimate::Method::LeastSquares;
                let fit = rover.fit(measured, method, Unseen::Zero, &mut slips, &mut says)?;
                let loss = 1e-13 * (1.0 + fit.sigma_min.powi(-4)) * size(k).abs().max(1.0);
                let checked = rover.sensitivity(measured, |linear| {
                    let expected: [f64; 3] = linear.twist().into();
                    for found in [twists[k], estimates[k]] {
                        for (found, expected) in found.into_iter().zip(expected) {
                            prop_assert!((found - expected).abs() <= loss, "{found} {expected}");
                        }
                    }
                    for (quantity, (found, wheels)) in Quantity::ALL.into_iter().zip(&columns) {
                        for (column, wheel) in wheels.iter().enumerate() {
                            let expected = linear.derivative(*wheel, quantity);
                            for part in 0..3 {
                                let found = found[(3 * k + part) * wheels.len() + column];
                                prop_assert!(
                                    (found - expected[part]).abs() <= loss * 100.0,
                                    "{quantity:?} of wheel {wheel}, row {k}: {found} {expected}"
                                );
                            }
                        }
                    }
                    Ok(())
                });
                match checked {
                    Ok(checked) => checked?,
                    Err(error) => {
                        prop_assert_eq!(&done, &Err(error.clone().at_row(k)));
                        prop_assert_eq!(&forward, &Err(error.at_row(k)));
                        break;
                    }
                }
            }
        }
    }

    #[test]
    fn parallel_axles_turn_together(turn in -0.5..0.5_f64, speeds in prop::array::uniform4(-5.0..5.0_f64)) {
        let axles = |heading: f64| -> Vec<Wheel> {
            let places = [(0.3, 0.2), (0.3, -0.2), (-0.1, 0.2), (-0.4, -0.2)];
            let wheel = |(i, (x, y)): (usize, (f64, f64))| {
                let mut wheel = Wheel::new(format!("{i}"), x, y, 0.1);
                wheel.heading = heading;
                wheel
            };
            places.into_iter().enumerate().map(wheel).collect()
        };
        let readings = Readings { steering: vec![], speeds: speeds.to_vec(), rates: vec![] };
        let step = 1e-5;
        let ahead = twist(&axles(turn + step), &readings)?;
        let behind = twist(&axles(turn - step), &readings)?;
        let rover = Rover::new(axles(turn))?;
        let derivative = rover.sensitivity(readings.measured(), |linear| {
            (0..4).map(|i| linear.derivative(i, Quantity::Heading)).sum::<nalgebra::Vector3<f64>>()
        })?;
        for k in 0..3 {
            let difference = (ahead[k] - behind[k]) / (2.0 * step);
            prop_assert!((derivative[k] - difference).abs() < 1e-6, "{derivative} {difference}");
        }
    }
}

#[test]
fn a_wheel_without_an_encoder_is_silent() -> Result<(), Error> {
    let mut wheels = vec![Wheel::new("left", 0.0, 0.2, 0.1), Wheel::new("right", 0.0, -0.2, 0.1)];
    wheels.push(Wheel::new("middle", 0.0, 0.0, 0.1).passive());
    let rover = Rover::new(wheels)?;
    let measured = Measured { steering: &[], speeds: &[1.0, 2.0, f64::NAN], steering_rates: None };
    for quantity in Quantity::ALL {
        let derivative = rover.sensitivity(measured, |linear| linear.derivative(2, quantity))?;
        assert!(derivative.iter().all(|value| value.is_finite()), "{quantity:?}");
    }
    let silent = rover.sensitivity(measured, |linear| linear.derivative(2, Quantity::Radius))?;
    assert_eq!(silent.amax(), 0.0);
    Ok(())
}
