//! Commands that no limit holds back, and those of every mode.

use six_wheel_control::controller::{Controller, Limits, Mode, Options, reason};
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::Rover;
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_numerics::error::Error;

use crate::random::{Random, rover, twist};

#[test]
fn without_limits_every_command_is_met_at_once() -> Result<(), Error> {
    for seed in 0..200 {
        let mut random = Random(seed);
        let rover = rover(&mut random)?;
        let mut controller = Controller::new(&rover, Limits::NONE, Options::default(), None)?;
        let mut wanted = Twist::ZERO;
        for step in 0..100 {
            wanted = twist(&mut random, wanted);
            let now = f64::from(step) * 0.01;
            controller.command(wanted, now, None)?;
            controller.step(now, None)?;
            if rover.check(wanted, None).is_ok() {
                assert_eq!(controller.twist(), wanted, "seed {seed} step {step}");
                assert_eq!(controller.reasons(), 0, "seed {seed} step {step}");
            } else {
                assert!(controller.reasons() & reason::PROJECTED != 0, "seed {seed} step {step}");
            }
        }
    }
    Ok(())
}

#[test]
fn modes_mean_what_they_say() -> Result<(), Error> {
    let range = SteeringRange::default();
    let swerve = Rover::swerve(&[[0.5, 0.4], [0.5, -0.4], [-0.5, 0.4], [-0.5, -0.4]], None, 0.1, range)?;
    let wanted = Twist { vx: 0.5, vy: 0.2, omega: 0.3 };
    for (mode, expected) in [
        (Mode::Free, wanted),
        (Mode::Crab, Twist { omega: 0.0, ..wanted }),
        (Mode::Spin, Twist { vx: 0.0, vy: 0.0, ..wanted }),
    ] {
        let options = Options { mode, ..Options::default() };
        let mut controller = Controller::new(&swerve, Limits::NONE, options, None)?;
        controller.command(wanted, 0.0, None)?;
        controller.step(0.0, None)?;
        assert_eq!(controller.twist(), expected);
        assert_eq!(controller.reasons() == 0, mode == Mode::Free);
    }
    let options = Options { mode: Mode::FrontOnly, ..Options::default() };
    let mut controller = Controller::new(&swerve, Limits::NONE, options, None)?;
    controller.command(wanted, 0.0, None)?;
    controller.step(0.0, None)?;
    // About a point on the rear axle.
    assert_eq!(controller.steering()[2..], [0.0, 0.0]);
    assert!((controller.twist().at(-0.5, 0.0).y).abs() < 1e-15);
    assert_eq!(controller.twist().omega, 0.3);
    Ok(())
}
