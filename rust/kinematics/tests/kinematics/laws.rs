//! Laws of the core without Python: what holds for every rover and every twist.

use proptest::prelude::*;
use six_wheel_kinematics::admissible::Keep;
use six_wheel_kinematics::batch;
use six_wheel_kinematics::estimate::Measured;
use six_wheel_kinematics::estimate::Unseen;
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::{Inputs, Rover};
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_kinematics::table::Log;
use six_wheel_numerics::error::{Error, ErrorKind};
use six_wheel_numerics::threads::workers::Workers;

fn rovers() -> impl Strategy<Value = Rover> {
    let dimensions = prop::array::uniform4(0.05..3.0_f64);
    (dimensions, 0.02..0.5_f64, 0.1..2.0_f64).prop_filter_map("valid", |(d, radius, limit)| {
        Rover::six_wheel(d, radius, SteeringRange::symmetric(limit).ok()?).ok()
    })
}

fn twists() -> impl Strategy<Value = Twist> {
    prop::array::uniform3(-3.0..3.0_f64).prop_map(Twist::from)
}

/// Angles and speeds of the wheels for a twist the rover can make.
fn commands(rover: &Rover, twist: Twist) -> Result<([f64; 4], [f64; 6]), Error> {
    let (mut steering, mut speeds) = ([0.0; 4], [0.0; 6]);
    rover.inverse(twist, Inputs::default(), &mut steering, &mut speeds)?;
    Ok((steering, speeds))
}

proptest! {
    #[test]
    fn inverse_then_forward_is_the_identity(rover in rovers(), wanted in twists()) {
        let twist = rover.project(wanted, Keep::Nearest)?;
        let (steering, speeds) = commands(&rover, twist)?;
        let measured = Measured { steering: &steering, speeds: &speeds, steering_rates: None };
        let back = rover.forward(measured, Unseen::Refuse)?;
        // Rounding, and the slip that passes as rounding: 1e-9 of the fastest pivot's speed.
        for (got, expected) in <[f64; 3]>::from(back).iter().zip(<[f64; 3]>::from(twist)) {
            prop_assert!((got - expected).abs() < 2e-8, "{back:?} {twist:?}");
        }
    }

    #[test]
    fn steering_stays_in_its_range(rover in rovers(), wanted in twists()) {
        let twist = rover.project(wanted, Keep::Curvature)?;
        let (steering, _) = commands(&rover, twist)?;
        for (angle, &i) in steering.iter().zip(rover.steered()) {
            let Some(range) = rover.wheels()[i].steering() else { continue };
            prop_assert!(range.lower <= *angle && *angle <= range.upper);
        }
    }

    #[test]
    fn a_batch_is_its_rows(rover in rovers(), wanted in prop::collection::vec(twists(), 0..40)) {
        let twists: Vec<[f64; 3]> = wanted
            .into_iter()
            .map(|twist| rover.project(twist, Keep::Nearest).map(<[f64; 3]>::from))
            .collect::<Result<_, _>>()?;
        let rows = twists.len();
        let (mut steering, mut speeds) = (vec![0.0; 4 * rows], vec![0.0; 6 * rows]);
        batch::inverse(&rover, &twists, Inputs::default(), &mut steering, &mut speeds, Workers::PLAIN)?;
        let mut back = vec![[0.0; 3]; rows];
        let log = Log { steering: &steering, speeds: &speeds, steering_rates: None };
        batch::forward(&rover, log, Unseen::Refuse, &mut back, Workers::PLAIN)?;
        for (k, twist) in twists.iter().enumerate() {
            let (angles, rates) = commands(&rover, Twist::from(*twist))?;
            prop_assert_eq!(&steering[4 * k..4 * k + 4], &angles);
            prop_assert_eq!(&speeds[6 * k..6 * k + 6], &rates);
            let measured = Measured { steering: &angles, speeds: &rates, steering_rates: None };
            let one: [f64; 3] = rover.forward(measured, Unseen::Refuse)?.into();
            prop_assert_eq!(back[k], one);
        }
    }

    #[test]
    fn a_failed_batch_writes_nothing(rover in rovers(), good in 0..20_usize) {
        let mut twists = vec![[0.5, 0.0, 0.0]; good];
        twists.push([0.0, 1.0, 0.0]);
        let (mut steering, mut speeds) = (vec![7.0; 4 * (good + 1)], vec![7.0; 6 * (good + 1)]);
        let failed = batch::inverse(&rover, &twists, Inputs::default(), &mut steering, &mut speeds, Workers::PLAIN);
        prop_assert_eq!(failed.map_err(|error| (error.kind, error.row)),
            Err((ErrorKind::Infeasible, Some(good))));
        prop_assert!(steering.iter().chain(&speeds).all(|value| *value == 7.0));
    }
}
