//! Limits hold at every step, also when they change.

use six_wheel_control::controller::{Controller, Limits, Options, reason};
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::Rover;
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_numerics::error::Error;

use crate::checker::{Checker, shot};
use crate::random::{Random, limits, rover, twist};

const STEPS: usize = 2_000;
const STREAMS: usize = 500;

fn differs(a: Twist, b: Twist) -> bool {
    let (a, b) = (<[f64; 3]>::from(a), <[f64; 3]>::from(b));
    a.iter().zip(&b).any(|(a, b)| (a - b).abs() > 1e-12)
}

fn stream(seed: u64, steps: usize) -> Result<(), Error> {
    let mut random = Random(seed);
    let rover = rover(&mut random)?;
    let limits = limits(&mut random)?;
    let mut controller = Controller::new(&rover, limits, Options::default(), None)?;
    let limits = limits.on(&rover);
    let (mut now, mut wanted, mut asked) = (0.0, Twist::ZERO, Twist::ZERO);
    // A new command now and then, or at every step, or at some of them, off by noise.
    let noise = [0.0, 1e-8, 0.01, 0.1][random.pick(4)];
    let share = [1.0, 0.5, 0.1][random.pick(3)];
    let period = [0.001, 0.01, 0.05][random.pick(3)];
    let jitter = random.chance(0.5);
    controller.step(now, None)?;
    let mut log = vec![shot(&controller, period); 3];
    let mut history = vec![String::new(); 8];
    for step in 0..steps {
        if random.chance(0.03) {
            wanted = twist(&mut random, wanted);
            asked = wanted;
            controller.command(asked, now, None)?;
        } else if noise > 0.0 && random.chance(share) {
            let factor = 1.0 + random.within(-noise, noise);
            // A sideways part below the tolerance of what a rover can make would be taken as it is.
            let heading = if noise > 1e-3 { random.within(-noise, noise) * wanted.vx } else { 0.0 };
            asked = Twist { omega: wanted.omega * factor, vy: wanted.vy + heading, ..wanted };
            controller.command(asked, now, None)?;
        }
        let dt = if jitter { period * random.within(0.1, 1.9) } else { period };
        let distance = controller.stopping_distance();
        assert!(distance >= 0.0, "{distance}");
        now += dt;
        controller.step(now, None)?;
        history.rotate_left(1);
        history[7] = format!("{dt} {:b} {:?}", controller.reasons(), controller.twist());
        log.rotate_left(1);
        log[2] = shot(&controller, dt);
        let context = || format!("seed {seed} step {step} {limits:?}\n{asked:?} {history:#?} {rover:?}");
        let checker = Checker { rover: &rover, limits, context: &context };
        checker.state(&log[2]);
        checker.change([&log[1], &log[2]]);
        checker.curve([&log[0], &log[1], &log[2]]);
        let reasons = controller.reasons();
        let stale = reasons & reason::STALE != 0;
        if !stale && differs(controller.twist(), asked) {
            assert!(reasons != 0, "no reason\n{}", context());
        }
        let steady = controller.steering_rates().iter().all(|rate| *rate == 0.0);
        if controller.twist() == asked && steady && !stale {
            assert!(reasons == 0, "reasons {reasons:b} for nothing\n{}", context());
        }
    }
    Ok(())
}

#[test]
fn no_limit_is_exceeded() -> Result<(), Error> {
    let soak = std::env::var("SOAK").ok().and_then(|text| text.parse().ok());
    let factor: f64 = soak.unwrap_or(1.0);
    for seed in 0..(STREAMS as f64 * factor) as u64 {
        stream(seed, STEPS)?;
    }
    Ok(())
}

#[test]
fn limits_that_change_are_met_from_both_sides() -> Result<(), Error> {
    for seed in 0..300 {
        let mut random = Random(seed);
        let rover = rover(&mut random)?;
        let given = [limits(&mut random)?, limits(&mut random)?];
        let filled = given.map(|limits| limits.on(&rover));
        let [old, new] = filled.map(|limits| limits.values());
        let mut widest = [None; Limits::NAMES.len()];
        for (k, value) in widest.iter_mut().enumerate() {
            *value = Some(old[k].max(new[k]));
        }
        let widest = Limits::new(widest)?;
        let options = Options { timeout: f64::INFINITY, ..Options::default() };
        let mut controller = Controller::new(&rover, given[0], options, None)?;
        let (dt, mut now, mut wanted) = (0.01, 0.0, Twist::ZERO);
        controller.step(now, None)?;
        let mut log = vec![shot(&controller, dt); 3];
        let change = 100 + random.pick(300);
        for step in 0..2000 {
            if step == change {
                controller.set_limits(given[1])?;
                assert_eq!(*controller.limits(), given[1]);
            }
            if random.chance(0.03) {
                wanted = twist(&mut random, wanted);
            }
            controller.command(wanted, now, None)?;
            now += dt;
            controller.step(now, None)?;
            log.rotate_left(1);
            log[2] = shot(&controller, dt);
            let context = || format!("seed {seed} step {step} of {change} {filled:?}\n{wanted:?} {rover:?}");
            // Ramps of jerk, and the slowest limit of the speed, take no longer than this in these streams.
            let settled = step > change + 900;
            let limits = if step < change {
                filled[0]
            } else if settled {
                filled[1]
            } else {
                widest
            };
            let checker = Checker { rover: &rover, limits, context: &context };
            checker.state(&log[2]);
            checker.change([&log[1], &log[2]]);
            checker.curve([&log[0], &log[1], &log[2]]);
        }
    }
    Ok(())
}

#[test]
fn a_narrower_steering_limit_brings_the_joints_in_at_their_rate() -> Result<(), Error> {
    let range = SteeringRange::symmetric(1.0)?;
    let rover = Rover::six_wheel([0.4, 0.5, 0.5, 0.45], 0.15, range)?;
    let limits = Limits { speed: 0.5, acceleration: 0.5, steering_rate: 0.5, ..Limits::default() };
    let options = Options { timeout: f64::INFINITY, ..Options::default() };
    for rest in [true, false] {
        let mut controller = Controller::new(&rover, limits, options, None)?;
        let tight = Twist { vx: 0.4, vy: 0.0, omega: 0.45 };
        controller.command(tight, 0.0, None)?;
        let mut steps = 0;
        let mut step = |controller: &mut Controller| -> Result<(), Error> {
            steps += 1;
            let before = controller.steering().to_vec();
            controller.step(f64::from(steps) * 0.01, None)?;
            for (a, b) in before.iter().zip(controller.steering()) {
                assert!((b - a).abs() <= 0.5 * 0.01 * (1.0 + 1e-9), "{a} {b}");
            }
            for (angle, &i) in controller.steering().iter().zip(rover.steered()) {
                assert!(rover.wheels()[i].side_slip(*angle, controller.twist(), 0.0).abs() < 1e-9);
            }
            Ok(())
        };
        for _ in 0..400 {
            step(&mut controller)?;
        }
        assert_eq!(controller.twist(), tight);
        if rest {
            controller.command(Twist::ZERO, 5.0, None)?;
            for _ in 0..200 {
                step(&mut controller)?;
            }
        }
        controller.set_limits(Limits { steering_limit: 0.2, ..limits })?;
        for _ in 0..300 {
            step(&mut controller)?;
            assert!(rest || controller.twist().vx > 0.1, "no stop on the way");
        }
        assert!(controller.steering().iter().all(|angle| angle.abs() <= 0.2 + 1e-9), "{:?}", controller.steering());
        let refused = controller.set_limits(Limits { steering_limit: 2.0, ..limits });
        assert!(refused.is_err() && controller.limits().steering_limit == 0.2);
    }
    Ok(())
}
