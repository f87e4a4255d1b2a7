//! Stops and halts.

use six_wheel_control::controller::limits::stop;
use six_wheel_control::controller::{Controller, Options, reason};
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::Rover;
use six_wheel_numerics::error::Error;

use crate::random::{Random, limits, rover, twist};

#[test]
fn a_stop_takes_no_longer_a_way_than_stated_and_keeps_the_curvature() -> Result<(), Error> {
    for seed in 0..300 {
        let mut random = Random(seed);
        let rover = rover(&mut random)?;
        let mut limits = limits(&mut random)?;
        limits.deceleration = limits.deceleration.min(1.0);
        limits.angular_deceleration = limits.angular_deceleration.min(2.0);
        let options = Options { timeout: 0.2, ..Options::default() };
        let mut controller = Controller::new(&rover, limits, options, None)?;
        let (dt, mut now) = (0.002, 0.0);
        controller.command(twist(&mut random, Twist::ZERO), now, None)?;
        let moving = random.pick(2000);
        for step in 0..moving {
            now += dt;
            if step % 50 == 0 {
                let wanted = twist(&mut random, controller.twist());
                controller.command(wanted, now, None)?;
            }
            controller.step(now, None)?;
        }
        // Stale from the first step past the timeout; nothing changes the route until then.
        let mut stated = controller.stopping_distance();
        let mut way = 0.0;
        let mut stale = false;
        for _ in 0..20_000 {
            let held = controller.twist().linear().norm() * dt;
            now += dt;
            let before = controller.stopping_distance();
            controller.step(now, None)?;
            if !stale && controller.reasons() & reason::STALE != 0 {
                (stale, stated, way) = (true, before, 0.0);
            }
            way += held; // each command holds until the next
            if stale && controller.stopped() {
                break;
            }
        }
        assert!(controller.stopped(), "seed {seed} {controller:#?}");
        assert!(way <= stated * (1.0 + 1e-9) + 1e-12, "seed {seed}: {way} > {stated}");
    }
    Ok(())
}

/// Speeds of the wheels over the ground [m/s].
fn rims(controller: &Controller, rover: &Rover) -> Vec<f64> {
    // Without what steering a wheel with scrub adds, which is no motion over the ground.
    let steered = rover.steered().iter().zip(controller.steering_rates());
    let mut rims: Vec<f64> =
        rover.wheels().iter().zip(controller.speeds()).map(|(wheel, speed)| speed * wheel.radius).collect();
    for (&i, rate) in steered {
        rims[i] += rover.wheels()[i].scrub * rate;
    }
    rims.into_iter().map(f64::abs).collect()
}

#[test]
fn a_halt_brakes_as_fast_as_it_may_and_nothing_moves_after_the_release() -> Result<(), Error> {
    for seed in 0..400 {
        let mut random = Random(seed);
        let rover = rover(&mut random)?;
        let mut limits = limits(&mut random)?;
        limits.deceleration = limits.deceleration.min(1.0);
        limits.halt_deceleration = limits.deceleration * random.within(1.0, 4.0);
        let options = Options { timeout: f64::INFINITY, ..Options::default() };
        let mut controller = Controller::new(&rover, limits, options, None)?;
        let dt = [0.001, 0.01, 0.05][random.pick(3)];
        let mut step = 0;
        let mut next = |controller: &mut Controller| -> Result<(), Error> {
            step += 1;
            controller.step(f64::from(step) * dt, None)
        };
        let mut wanted = twist(&mut random, Twist::ZERO);
        for _ in 0..random.pick(1000) {
            if random.chance(0.02) {
                wanted = twist(&mut random, wanted);
            }
            controller.command(wanted, 0.0, None)?;
            next(&mut controller)?;
        }
        controller.halt();
        let mut before = rims(&controller, &rover);
        let first = before.iter().copied().fold(0.0, f64::max);
        let allowed = limits.halt_deceleration * dt;
        let count = (first / allowed).ceil() as usize + 2;
        // Without a limit of their acceleration the joints are at rest in the first step.
        let turned =
            limits.steering_acceleration.is_finite() && controller.steering_rates().iter().any(|rate| *rate != 0.0);
        for k in 0..count {
            assert!(!controller.command(wanted, 0.0, None)?, "seed {seed}");
            next(&mut controller)?;
            assert!(controller.reasons() & reason::HALTED != 0 && controller.halted());
            let now = rims(&controller, &rover);
            // While the joints brake the direction goes on a little, and with it what a wheel near the centre does.
            for (a, b) in before.iter().zip(&now).filter(|_| !turned) {
                assert!(a - b <= allowed * (1.0 + 1e-9) + 1e-12, "seed {seed} step {k}: {a} {b}");
            }
            let [fast, slow] = [&before, &now].map(|rims| rims.iter().copied().fold(0.0, f64::max));
            assert!(turned || fast - slow >= (allowed * (1.0 - 1e-9)).min(fast) - 1e-12, "seed {seed}: {fast} {slow}");
            for (angle, &i) in controller.steering().iter().zip(rover.steered()) {
                let slip = rover.wheels()[i].side_slip(*angle, controller.twist(), 0.0);
                assert!(slip.abs() < 1e-9, "seed {seed}: {slip}");
            }
            before = now;
        }
        assert_eq!(controller.twist(), Twist::ZERO, "seed {seed}: {first} m/s after {count} steps");
        while !controller.release() {
            next(&mut controller)?;
        }
        let rest = controller.steering().to_vec();
        for _ in 0..20 {
            next(&mut controller)?;
            assert!(controller.stopped() && controller.steering() == rest && controller.reasons() == 0, "seed {seed}");
        }
        assert!(controller.command(wanted, 0.0, None)?);
    }
    Ok(())
}

/// The quickest stop in small steps.
fn simulated(speed: f64, rate: f64, deceleration: f64, jerk: f64) -> f64 {
    let (mut v, mut a, mut way) = (speed, rate, 0.0);
    let dt = 1e-5;
    while v > 0.0 {
        // The deceleration begins to fall once the speed that is left is what that takes.
        let ease = a < 0.0 && v <= a * a / (2.0 * jerk);
        a = if ease { (a + jerk * dt).min(-1e-4) } else { (a - jerk * dt).max(-deceleration) };
        way += v * dt;
        v += a * dt;
    }
    way
}

#[test]
fn the_way_of_a_stop_is_that_of_its_integral() {
    for (speed, rate, deceleration, jerk) in [
        (1.0, 0.0, 0.5, 2.0),
        (0.05, 0.0, 0.5, 2.0),
        (1.0, 0.4, 0.5, 2.0),
        (1.0, -0.4, 0.5, 2.0),
        (0.2, -0.5, 0.5, 2.0),
        (2.0, 1.0, 3.0, 0.7),
    ] {
        let (way, expected) = (stop(speed, rate, deceleration, jerk), simulated(speed, rate, deceleration, jerk));
        // The steps: about v dt and the tail of the easing.
        assert!((way - expected).abs() < 2e-3 * expected, "{way} {expected}");
    }
}
