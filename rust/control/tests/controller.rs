//! Laws of the controller: for random rovers, limits and streams of commands no limit is exceeded, the wheels
//! have one centre of rotation, and every step that is not what was asked for says why.
//!
//! One million steps; `SOAK` times as many if that is set.

use std::f64::consts::FRAC_PI_2;

use six_wheel_control::controller::{Controller, Limits, Mode, Options, reason};
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::layouts::{Drive, SkidCentres};
use six_wheel_kinematics::rover::Rover;
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_kinematics::wheels::Wheel;
use six_wheel_numerics::error::Error;

const STEPS: usize = 2_000;
const STREAMS: usize = 500;

/// Numbers that look random (Steele, Lea & Flood's SplitMix64).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    fn chance(&mut self, share: f64) -> bool {
        self.unit() < share
    }

    fn pick(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }
}

fn rover(random: &mut Random) -> Result<Rover, Error> {
    let radius = random.within(0.05, 0.3);
    let range =
        if random.chance(0.3) { SteeringRange::default() } else { SteeringRange::symmetric(random.within(0.3, 2.5))? };
    let lengths = [(); 4].map(|()| random.within(0.1, 1.0));
    let [a, b, ..] = lengths;
    match random.pick(7) {
        0..=2 => Rover::six_wheel(lengths, radius, range),
        3 => Rover::swerve(&[[a, b], [a, -b], [-a, b], [-a, -b]], None, radius, range),
        4 => Rover::ackermann(a + 0.2, b, radius, SteeringRange::symmetric(0.7)?, Drive::Rear),
        5 if random.chance(0.5) => Rover::mecanum(a, b, radius, FRAC_PI_2 / 2.0),
        5 => Rover::differential(b, [radius; 2], 1, 0.0, SkidCentres::default()),
        _ => {
            let wheel = |name, x, y| Wheel::new(name, x, y, radius);
            let scrub = random.within(-0.1, 0.1);
            let offset = |wheel: Wheel| Wheel { scrub, ..wheel.steered(range) };
            Rover::new(vec![
                offset(wheel("front", a, 0.1)),
                offset(wheel("rear", -a, 0.0)),
                wheel("left", 0.0, b),
                wheel("right", 0.0, -b),
            ])
        }
    }
}

fn limits(random: &mut Random) -> Result<Limits, Error> {
    let mut given = [None; Limits::NAMES.len()];
    for (name, value) in Limits::NAMES.iter().zip(&mut given) {
        if !["steering_limit", "halt_deceleration"].contains(name) && random.chance(0.6) {
            // From tame to rough, on a scale of ratios.
            *value = Some(random.within(-1.5, 1.5).exp2() * if name.contains("wheel") { 10.0 } else { 1.0 });
        }
    }
    Limits::new(given)
}

fn twist(random: &mut Random, before: Twist) -> Twist {
    let [vx, vy, omega] = [(); 3].map(|()| random.within(-1.5, 1.5));
    match random.pick(8) {
        0 => Twist { vx, vy: 0.0, omega: 0.0 },
        1 => Twist { vx: 0.0, vy: 0.0, omega },
        2 => Twist::ZERO,
        3 => Twist { vx: -before.vx, vy: -before.vy, omega: -before.omega },
        4 => Twist { vx: before.vx * 1.01, vy: before.vy, omega: before.omega + 0.01 },
        5 => Twist { vx, vy, omega },
        _ => Twist { vx, vy: 0.0, omega },
    }
}

/// One step of a log.
#[derive(Clone, Debug)]
struct Shot {
    dt: f64,
    twist: Twist,
    steering: Vec<f64>,
    speeds: Vec<f64>,
}

/// Differences of rounded numbers: this many ulp of values near 1, or a share of the limit.
fn within(value: f64, limit: f64, noise: f64) -> bool {
    value <= limit * (1.0 + 1e-6) + noise
}

struct Checker<'a> {
    rover: &'a Rover,
    limits: Limits,
    /// Text that a failure prints.
    context: &'a dyn Fn() -> String,
}

impl Checker<'_> {
    fn demand(&self, name: &str, value: f64, limit: f64, noise: f64) {
        assert!(within(value, limit, noise), "{name}: {value} > {limit}\n{}", (self.context)());
    }

    /// One instant.
    fn state(&self, shot: &Shot) {
        let Shot { twist, steering, speeds, .. } = shot;
        let speed = twist.linear().norm();
        self.demand("speed", speed, self.limits.speed, 1e-12);
        self.demand("yaw rate", twist.omega.abs(), self.limits.yaw_rate, 1e-12);
        let lateral = speed * twist.omega.abs();
        self.demand("lateral", lateral, self.limits.lateral_acceleration, 1e-12);
        for speed in speeds {
            self.demand("wheel speed", speed.abs(), self.limits.wheel_speed, 1e-12);
        }
        for bank in self.rover.banks() {
            let row = bank.row;
            let slip = row.x * twist.vx + row.y * twist.vy + row.z * twist.omega;
            let slip = slip.abs();
            self.demand("bank", slip, 1e-9, 0.0);
        }
        for (angle, &i) in steering.iter().zip(self.rover.steered()) {
            let wheel = &self.rover.wheels()[i];
            self.demand("scrub", wheel.side_slip(*angle, *twist, 0.0).abs(), 1e-9, 0.0);
        }
    }

    /// From one to the next.
    fn change(&self, [first, second]: [&Shot; 2]) {
        let dt = second.dt;
        let step = |a: f64, b: f64| (b - a).abs() / dt;
        let linear = (second.twist.linear() - first.twist.linear()).norm() / dt;
        let limits = &self.limits;
        let turned = first.steering != second.steering;
        let pick = |up: f64, down: f64, grows: bool| match (turned, grows) {
            (true, _) => up.max(down),
            (_, true) => up,
            _ => down,
        };
        let grows = second.twist.linear().norm() > first.twist.linear().norm();
        let noise = 1e-14 / dt;
        self.demand("acceleration", linear, pick(limits.acceleration, limits.deceleration, grows), noise);
        let angular = step(first.twist.omega, second.twist.omega);
        let grows = second.twist.omega.abs() > first.twist.omega.abs();
        let limit = pick(limits.angular_acceleration, limits.angular_deceleration, grows);
        self.demand("angular acceleration", angular, limit, noise);
        for (a, b) in first.speeds.iter().zip(&second.speeds) {
            self.demand("wheel acceleration", step(*a, *b), limits.wheel_acceleration, 100.0 * noise);
        }
        for (a, b) in first.steering.iter().zip(&second.steering) {
            self.demand("steering rate", step(*a, *b), limits.steering_rate, noise);
        }
    }

    /// Over three: divided differences, which the mean value theorem bounds by the derivative.
    fn curve(&self, [first, second, third]: [&Shot; 3]) {
        let [early, late] = [second.dt, third.dt];
        let bend = |a: f64, b: f64, c: f64| ((c - b) / late - (b - a) / early) * 2.0 / (early + late);
        let noise = 1e-14 / (early.min(late) * early.min(late));
        let part = |of: fn(&Twist) -> f64| bend(of(&first.twist), of(&second.twist), of(&third.twist));
        let linear = part(|twist| twist.vx).hypot(part(|twist| twist.vy));
        self.demand("jerk", linear, self.limits.jerk, noise);
        self.demand("angular jerk", part(|twist| twist.omega).abs(), self.limits.angular_jerk, noise);
        for (k, angle) in third.steering.iter().enumerate() {
            let value = bend(first.steering[k], second.steering[k], *angle).abs();
            self.demand("steering acceleration", value, self.limits.steering_acceleration, noise);
        }
    }
}

fn shot(controller: &Controller, dt: f64) -> Shot {
    Shot {
        dt,
        twist: controller.twist(),
        steering: controller.steering().to_vec(),
        speeds: controller.speeds().to_vec(),
    }
}

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
    let factor: usize = soak.unwrap_or(1);
    for seed in 0..(STREAMS * factor) as u64 {
        stream(seed, STEPS)?;
    }
    Ok(())
}

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
        let turned = controller.steering_rates().iter().any(|rate| *rate != 0.0);
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
