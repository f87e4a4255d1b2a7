//! Suspicions of numbers that cannot be in metres and radians.

use std::f64::consts::PI;

use six_wheel_kinematics::layouts::SkidCentres;
use six_wheel_kinematics::presets;
use six_wheel_kinematics::rover::Rover;
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_kinematics::table::Table;
use six_wheel_kinematics::units::{SETTINGS, angles, dimensions, settings, wheel};
use six_wheel_numerics::error::Error;

#[test]
fn published_rovers_raise_no_suspicion() -> Result<(), Error> {
    for preset in presets::PRESETS {
        let rover = presets::preset(preset.name, None)?;
        assert_eq!(dimensions(&rover), []);
    }
    Ok(())
}

#[test]
fn settings_are_suspicious_beyond_their_range_and_not_at_its_ends() {
    for (name, quantity) in SETTINGS {
        let largest = quantity.largest();
        for (value, odd) in [(largest, false), (largest.next_up(), true), (f64::INFINITY, false), (f64::NAN, false)] {
            for value in [value, -value] {
                let found = settings([(name, value), ("speed", 1e9)]);
                assert_eq!(
                    found.iter().map(|suspicion| suspicion.argument).collect::<Vec<_>>(),
                    vec![name; odd.into()]
                );
            }
        }
    }
    let likely: Vec<String> =
        settings([("yaw_rate", 60.0)]).into_iter().map(|suspicion| suspicion.explanation).collect();
    assert_eq!(likely, ["60 degrees per second are 1.047 rad/s"]);
}

#[test]
fn a_module_may_count_its_turns_and_another_wheel_not() -> Result<(), Error> {
    let square = [[0.4, 0.3], [0.4, -0.3], [-0.4, 0.3], [-0.4, -0.3]];
    for (limit, of_module, of_other) in
        [(PI, false, false), (PI.next_up(), false, true), (10.0 * PI, false, true), (32.0, true, true)]
    {
        let limit = SteeringRange::symmetric(limit)?;
        let modules = Rover::swerve(&square, None, 0.1, limit)?;
        let other = Rover::six_wheel([0.4, 0.5, 0.5, 0.45], 0.15, limit)?;
        assert_eq!([!dimensions(&modules).is_empty(), !dimensions(&other).is_empty()], [of_module, of_other]);
        assert_eq!(!wheel(&other.wheels()[0]).is_empty(), of_other);
    }
    let endless = Rover::swerve(&square, None, 0.1, SteeringRange::ENDLESS)?;
    assert_eq!(dimensions(&endless), []);
    Ok(())
}

#[test]
fn degrees_and_centimetres_and_exchanged_lengths_do() -> Result<(), Error> {
    let about = |rover: &Rover| dimensions(rover).first().map(|suspicion| suspicion.argument);
    let limit = SteeringRange::symmetric(40.0)?;
    assert_eq!(about(&Rover::six_wheel([0.4, 0.5, 0.5, 0.45], 0.15, limit)?), Some("steering_limit"));
    for (track, radius) in [(50.0, 10.0), (500.0, 100.0), (0.1, 0.5)] {
        let rover = Rover::differential(track, [radius; 2], 1, 0.0, SkidCentres::default())?;
        assert_eq!(about(&rover), Some("wheel_radius"));
    }
    let ring = [[0.2, 0.0], [-0.1, 0.17], [-0.1, -0.17]];
    for (third, asked) in [(5.76, None), (330.0, Some("heading"))] {
        let rover = Rover::omni(&ring, &[0.0, 3.67, third], None, 0.05, None)?;
        assert_eq!(about(&rover), asked);
    }
    let rover = Rover::mecanum(0.3, 0.3, 0.1, 45.0)?;
    assert_eq!(about(&rover), Some("roller_angle"));
    Ok(())
}

#[test]
fn angles_are_suspicious_half_a_turn_beyond_their_range() -> Result<(), Error> {
    let limit = SteeringRange::symmetric(1.0)?;
    let rover = Rover::six_wheel([0.4, 0.5, 0.5, 0.45], 0.15, limit)?;
    for (angle, asked) in [(1.0 + PI, false), (1.0 + PI + 1e-9, true), (f64::NAN, false)] {
        let row = [0.0, -angle, 0.0, 0.0];
        assert_eq!(angles(&rover, Table::Flat(&row), 1).is_some(), asked);
        assert_eq!(rover.are_plain(&row), !asked && !angle.is_nan());
    }
    let mut log = vec![0.0; 4000];
    assert_eq!(angles(&rover, Table::Flat(&log), 1000), None);
    log.fill(40.0);
    assert!(angles(&rover, Table::Flat(&log), 1000).is_some());
    Ok(())
}
