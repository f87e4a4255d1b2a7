//! Laws of odometry without Python.

use nalgebra::Matrix3;
use proptest::prelude::*;
use six_wheel_kinematics::admissible::Keep;
use six_wheel_kinematics::geometry::{Pose, Twist};
use six_wheel_kinematics::rover::{Inputs, Rover};
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_numerics::error::Error;
use six_wheel_odometry::{Health, Noise, Odometry, Readings, Settings};

use crate::sample;

fn rovers() -> impl Strategy<Value = Rover> {
    let dimensions = prop::array::uniform4(0.1..2.0_f64);
    (dimensions, 0.02..0.5_f64)
        .prop_filter_map("valid", |(d, radius)| Rover::six_wheel(d, radius, SteeringRange::default()).ok())
}

fn twists() -> impl Strategy<Value = Twist> {
    prop::array::uniform3(-2.0..2.0_f64).prop_map(Twist::from)
}

fn noise() -> Noise {
    Noise { slip: 0.02, side_slip: 0.01, ..Noise::READINGS }
}

/// Angles and speeds of the wheels for the nearest twist that the rover can make, and that twist.
fn wheels(rover: &Rover, wanted: Twist) -> Result<([f64; 4], [f64; 6], Twist), Error> {
    let twist = rover.project(wanted, Keep::Nearest)?;
    let (mut steering, mut speeds) = ([0.0; 4], [0.0; 6]);
    rover.inverse(twist, Inputs::default(), &mut steering, &mut speeds)?;
    Ok((steering, speeds, twist))
}

fn apart(a: Pose, b: Pose) -> f64 {
    (a.x - b.x).abs().max((a.y - b.y).abs()).max((a.yaw - b.yaw).abs())
}

proptest! {
    #[test]
    fn a_twist_that_is_held_is_found(
        rover in rovers(),
        wanted in twists(),
        steps in prop::collection::vec(0.001..0.5_f64, 1..20),
    ) {
        let (steering, speeds, twist) = wheels(&rover, wanted)?;
        let mut odometry = Odometry::new(rover, Settings::default())?;
        let mut stamp = 100.0;
        odometry.update(sample(&steering, &[0.0; 6], stamp))?;
        for dt in steps {
            stamp += dt;
            let totals = speeds.map(|speed| speed * (stamp - 100.0));
            odometry.update(sample(&steering, &totals, stamp))?;
        }
        // The slip that the inverse lets pass as rounding, 1e-9 of the fastest pivot's speed, over 10 s.
        prop_assert!(apart(odometry.pose(), twist.exp(stamp - 100.0)) < 1e-6);
    }

    #[test]
    fn halves_make_the_whole(rover in rovers(), wanted in twists(), dt in 0.01..1.0_f64) {
        let (steering, speeds, _) = wheels(&rover, wanted)?;
        let settings = Settings { noise: noise(), ..Settings::default() };
        let mut whole = Odometry::new(rover, settings)?;
        let mut halves = whole.clone();
        for odometry in [&mut whole, &mut halves] {
            odometry.update(sample(&steering, &[0.0; 6], 0.0))?;
        }
        halves.update(sample(&steering, &speeds.map(|speed| speed * dt / 2.0), dt / 2.0))?;
        let end = speeds.map(|speed| speed * dt);
        halves.update(sample(&steering, &end, dt))?;
        whole.update(sample(&steering, &end, dt))?;
        prop_assert!(apart(whole.pose(), halves.pose()) < 1e-12);
    }

    #[test]
    fn what_is_refused_leaves_no_trace(rover in rovers(), wanted in twists(), flaw in 0..4_usize) {
        let (steering, speeds, _) = wheels(&rover, wanted)?;
        let settings = Settings { max_speed: Some(50.0), lag: 1.0, ..Settings::default() };
        let mut odometry = Odometry::new(rover, settings)?;
        odometry.update(sample(&steering, &[0.0; 6], 0.0))?;
        odometry.update(sample(&steering, &speeds, 1.0))?;
        let mut tried = odometry.clone();
        let mut bad = speeds.map(|speed| 2.0 * speed);
        match flaw {
            0 => bad[3] = f64::NAN,
            1 => bad[0] = 1e7,
            _ => {}
        }
        let stamp = [2.0, 2.0, 1.0, f64::NEG_INFINITY][flaw];
        prop_assert!(tried.update(sample(&steering, &bad, stamp)).is_err());
        let next = speeds.map(|speed| 2.0 * speed);
        for odometry in [&mut odometry, &mut tried] {
            odometry.update(sample(&steering, &next, 2.0))?;
        }
        prop_assert_eq!(tried.pose(), odometry.pose());
        prop_assert_eq!(tried.covariance(), odometry.covariance());
        prop_assert_eq!(tried.residual(), odometry.residual());
    }

    #[test]
    fn no_direction_has_a_negative_variance(
        rover in rovers(),
        rows in prop::collection::vec((prop::array::uniform4(-1.5..1.5_f64), prop::array::uniform6(-3.0..3.0_f64)), 2..30),
        fix in prop::array::uniform3(1e-9..1.0_f64),
    ) {
        let settings = Settings { noise: noise(), lag: 10.0, inflate: true, ..Settings::default() };
        let mut odometry = Odometry::new(rover, settings)?;
        for (k, (steering, totals)) in rows.iter().enumerate() {
            odometry.update(sample(steering, totals, 0.1 * k as f64))?;
            if k % 5 == 4 {
                let variances = [[fix[0], 0.0, 0.0], [0.0, fix[1], 0.0], [0.0, 0.0, fix[2]]];
                let stamp = 0.1 * k as f64 - 0.15;
                odometry.correct(Pose { x: 0.1, y: 0.0, yaw: 0.0 }, stamp, variances)?;
            }
            let covariance = Matrix3::from(odometry.covariance());
            prop_assert!((covariance - covariance.transpose()).amax() == 0.0);
            prop_assert!(covariance.symmetric_eigenvalues().min() >= 0.0, "{covariance}");
        }
    }

    #[test]
    fn a_correction_that_says_nothing_changes_nothing(rover in rovers(), wanted in twists(), late in 0.0..0.9_f64) {
        let (steering, speeds, _) = wheels(&rover, wanted)?;
        let settings = Settings { noise: noise(), lag: 2.0, ..Settings::default() };
        let mut odometry = Odometry::new(rover, settings)?;
        for k in 0..12 {
            let stamp = 0.1 * f64::from(k);
            odometry.update(sample(&steering, &speeds.map(|speed| speed * stamp), stamp))?;
        }
        let (pose, covariance) = (odometry.pose(), odometry.covariance());
        let nothing = [[f64::INFINITY, 0.0, 0.0], [0.0, f64::INFINITY, 0.0], [0.0, 0.0, f64::INFINITY]];
        odometry.correct(Pose { x: 9.0, y: 9.0, yaw: 1.0 }, 1.1 - late, nothing)?;
        prop_assert!(apart(odometry.pose(), pose) < 1e-14);
        let difference = Matrix3::from(odometry.covariance()) - Matrix3::from(covariance);
        prop_assert!(difference.amax() < 1e-15);
    }
}

#[test]
fn rates_take_the_mean_of_both_ends() -> Result<(), Error> {
    let rover = Rover::six_wheel([0.4, 0.5, 0.5, 0.45], 0.1, SteeringRange::default())?;
    let settings = Settings { readings: Readings::Speeds, ..Settings::default() };
    let mut odometry = Odometry::new(rover, settings)?;
    assert_eq!(odometry.update(sample(&[0.0; 4], &[1.0; 6], 0.0))?, Health::FIRST);
    odometry.update(sample(&[0.0; 4], &[3.0; 6], 0.5))?;
    assert!((odometry.pose().x - 0.1 * 2.0 * 0.5).abs() < 1e-15);
    Ok(())
}

#[test]
fn memory_for_late_poses_is_bounded() -> Result<(), Error> {
    let rover = Rover::six_wheel([0.4, 0.5, 0.5, 0.45], 0.1, SteeringRange::default())?;
    let settings = Settings { lag: 1e6, history: 8, ..Settings::default() };
    let mut odometry = Odometry::new(rover, settings)?;
    for k in 0..100 {
        odometry.update(sample(&[0.0; 4], &[f64::from(k); 6], f64::from(k)))?;
    }
    let unit = Matrix3::identity().into();
    assert!(odometry.correct(Pose::default(), 91.0, unit).is_ok());
    assert!(odometry.correct(Pose::default(), 90.5, unit).is_err());
    Ok(())
}
