//! Laws of odometry without Python.

use nalgebra::Matrix3;
use proptest::prelude::*;
use six_wheel_core::odometry::{
    Encoder, Health, Noise, Odometry, Readings, Recording, Sample, Settings, TrackRows,
};
use six_wheel_core::{Error, Inputs, Keep, Pose, Rover, SteeringRange, Twist};

fn rovers() -> impl Strategy<Value = Rover> {
    let dimensions = prop::array::uniform4(0.1..2.0_f64);
    (dimensions, 0.02..0.5_f64).prop_filter_map("valid", |(d, radius)| {
        Rover::six_wheel(d, radius, SteeringRange::default()).ok()
    })
}

fn twists() -> impl Strategy<Value = Twist> {
    prop::array::uniform3(-2.0..2.0_f64).prop_map(Twist::from)
}

fn noise() -> Noise {
    Noise {
        slip: 0.02,
        side_slip: 0.01,
        ..Noise::READINGS
    }
}

/// Angles and speeds of the wheels for the nearest twist that the rover can make, and that twist.
fn wheels(rover: &Rover, wanted: Twist) -> Result<([f64; 4], [f64; 6], Twist), Error> {
    let twist = rover.project(wanted, Keep::Nearest)?;
    let (mut steering, mut speeds) = ([0.0; 4], [0.0; 6]);
    rover.inverse(twist, Inputs::default(), &mut steering, &mut speeds)?;
    Ok((steering, speeds, twist))
}

fn sample<'a>(steering: &'a [f64], wheels: &'a [f64], stamp: f64) -> Sample<'a> {
    Sample {
        steering,
        wheels,
        stamp,
        yaw: None,
        yaw_rate: None,
    }
}

fn apart(a: Pose, b: Pose) -> f64 {
    (a.x - b.x)
        .abs()
        .max((a.y - b.y).abs())
        .max((a.yaw - b.yaw).abs())
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
    let settings = Settings {
        readings: Readings::Speeds,
        ..Settings::default()
    };
    let mut odometry = Odometry::new(rover, settings)?;
    assert_eq!(
        odometry.update(sample(&[0.0; 4], &[1.0; 6], 0.0))?,
        Health::FIRST
    );
    odometry.update(sample(&[0.0; 4], &[3.0; 6], 0.5))?;
    assert!((odometry.pose().x - 0.1 * 2.0 * 0.5).abs() < 1e-15);
    Ok(())
}

#[test]
fn memory_for_late_poses_is_bounded() -> Result<(), Error> {
    let rover = Rover::six_wheel([0.4, 0.5, 0.5, 0.45], 0.1, SteeringRange::default())?;
    let settings = Settings {
        lag: 1e6,
        history: 8,
        ..Settings::default()
    };
    let mut odometry = Odometry::new(rover, settings)?;
    for k in 0..100 {
        odometry.update(sample(&[0.0; 4], &[f64::from(k); 6], f64::from(k)))?;
    }
    let unit = Matrix3::identity().into();
    assert!(odometry.correct(Pose::default(), 91.0, unit).is_ok());
    assert!(odometry.correct(Pose::default(), 90.5, unit).is_err());
    Ok(())
}

/// Vehicles whose steps go through registers: steered wheels in none, part, one or several of them.
fn vehicles() -> Result<Vec<Rover>, Error> {
    let around = |count: u32| -> Vec<[f64; 2]> {
        let turn = |k: u32| std::f64::consts::TAU * f64::from(k) / f64::from(count);
        (0..count)
            .map(|k| [turn(k).cos() + 0.3, turn(k).sin()])
            .collect()
    };
    let whole = SteeringRange::symmetric(3.2)?;
    Ok(vec![
        Rover::six_wheel([0.4, 0.5, 0.5, 0.45], 0.15, SteeringRange::default())?,
        Rover::mecanum(0.3, 0.2, 0.1, 0.8)?,
        Rover::swerve(&around(3), None, 0.1, whole)?,
        Rover::swerve(&around(5), None, 0.1, whole)?,
        Rover::swerve(&around(11), None, 0.1, whole)?,
    ])
}

fn close(found: &[f64], expected: &[f64], rounding: f64) -> bool {
    let largest = expected
        .iter()
        .fold(0.0_f64, |most, value| most.max(value.abs()));
    let pairs = found.iter().zip(expected);
    found.len() == expected.len()
        && pairs
            .into_iter()
            .all(|(a, b)| a == b || (a - b).abs() <= rounding * largest)
}

proptest! {
    /// A counter that starts over is not for registers: with one that never gets there the readings are the same.
    #[test]
    fn registers_and_the_plain_core_agree(
        which in 0..5_usize,
        slip in prop::sample::select(vec![0.0, 0.02]),
        side_slip in prop::sample::select(vec![0.0, 0.01]),
        speed in prop::sample::select(vec![0.0, 0.01]),
        threshold in prop::option::of(0.001..0.5_f64),
        rows in prop::collection::vec((prop::collection::vec(-0.2..0.2_f64, 22), 0.01..0.5_f64), 1..30),
        yaw in prop::option::of(-1.0..1.0_f64),
    ) {
        let rover = vehicles()?.swap_remove(which);
        let (joints, count) = (rover.steered().len(), rover.wheels().len());
        let settings = Settings {
            noise: Noise { speed, slip, side_slip, yaw: 0.05, ..Noise::READINGS },
            slip_threshold: threshold,
            lag: 1.0,
            ..Settings::default()
        };
        let endless = Encoder { modulus: Some(1e12), ..Encoder::default() };
        let plain = Settings { wheel_encoders: vec![endless], ..settings.clone() };
        let mut registers = Odometry::new(rover.clone(), settings)?;
        let mut plain = Odometry::new(rover, plain)?;
        let (mut steering, mut wheels, mut stamp) = (vec![0.0; joints], vec![0.0; count], 0.0);
        for (k, (changes, dt)) in rows.iter().enumerate() {
            for (reading, change) in steering.iter_mut().chain(&mut wheels).zip(changes) {
                *reading += change;
            }
            stamp += dt;
            let yaw = yaw.filter(|_| k % 5 == 3);
            let sample = Sample { yaw, ..sample(&steering, &wheels, stamp) };
            let health = plain.update(sample)?;
            prop_assert_eq!(registers.update(sample)?, health);
            // Sums of up to 22 terms a step, over up to 30 steps.
            let pose = <[f64; 3]>::from(registers.pose());
            let expected = <[f64; 3]>::from(plain.pose());
            prop_assert!(close(&pose, &expected, 1e-13), "{:?} {:?}", pose, expected);
            let twist = <[f64; 3]>::from(registers.twist());
            let expected = <[f64; 3]>::from(plain.twist());
            prop_assert!(close(&twist, &expected, 1e-13), "{:?} {:?}", twist, expected);
            let largest = wheels.iter().fold(0.0_f64, |most, turn| most.max(turn.abs())) / dt;
            for (slid, expected) in registers.residual().iter().zip(plain.residual()) {
                prop_assert!((slid - expected).abs() <= 1e-14 * (1.0 + largest));
            }
            for (found, expected) in [
                (registers.covariance(), plain.covariance()),
                (registers.twist_covariance(), plain.twist_covariance()),
            ] {
                let (found, expected) = (found.as_flattened(), expected.as_flattened());
                prop_assert!(close(found, expected, 1e-13), "{:?} {:?}", found, expected);
            }
        }
        let unit = Matrix3::identity().into();
        let back = stamp - rows[rows.len() - 1].1 / 2.0;
        if registers.correct(Pose::default(), back, unit).is_ok() {
            plain.correct(Pose::default(), back, unit)?;
            let (found, expected) = (registers.covariance(), plain.covariance());
            prop_assert!(close(found.as_flattened(), expected.as_flattened(), 1e-13));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// By registers of samples or one by one: the same bits, whatever lies in between, and the same way on from there.
    #[test]
    fn a_log_is_its_samples_one_after_the_other(
        which in 0..5_usize,
        slip in prop::sample::select(vec![0.0, 0.02]),
        speed in prop::sample::select(vec![0.0, 0.01]),
        period in prop::option::of(0.01..0.2_f64),
        threshold in prop::option::of(0.001..0.5_f64),
        max_gap in prop::option::of(0.2..0.5_f64),
        max_speed in prop::option::of(1.0..8.0_f64),
        smoothing in prop::sample::select(vec![0.0, 0.3]),
        resolution in prop::option::of(100.0..1000.0_f64),
        rows in prop::collection::vec((prop::collection::vec(-0.2..0.2_f64, 22), 0.01..0.5_f64), 1..200),
        odd in prop::collection::vec((0..200_usize, 0..6_u32), 0..5),
        cut in 0..200_usize,
        start in prop::array::uniform3(-5.0..5.0_f64),
    ) {
        let rover = vehicles()?.swap_remove(which);
        let (joints, count) = (rover.steered().len(), rover.wheels().len());
        let encoder = Encoder { resolution, ..Encoder::default() };
        let settings = Settings {
            noise: Noise { speed, slip, period, yaw: 0.05, ..Noise::READINGS },
            slip_threshold: threshold,
            steering_encoders: vec![encoder],
            max_gap,
            max_speed,
            smoothing,
            ..Settings::default()
        };
        let mut log = Log { yaws: vec![f64::NAN; rows.len()], ..Log::default() };
        let (mut angles, mut turned, mut stamp) = (vec![0.0; joints], vec![0.0; count], 0.0);
        let per_count = encoder.angle_per_count();
        for (changes, dt) in &rows {
            for (reading, change) in angles.iter_mut().chain(&mut turned).zip(changes) {
                *reading += change;
            }
            stamp += dt;
            log.steering.extend(angles.iter().map(|angle| angle / per_count));
            log.wheels.extend(&turned);
            log.stamps.push(stamp);
        }
        for &(row, kind) in odd.iter().filter(|(row, _)| *row < rows.len()) {
            match kind {
                0 => log.wheels[row * count] = f64::NAN,
                1 => log.yaws[row] = 0.3,
                2 => log.stamps[row] -= 1.0,
                3 => log.wheels[row * count] += 30.0,
                4 if joints > 0 => log.steering[row * joints] += 2.0 / per_count,
                _ => log.wheels[row * count] += 0.7,
            }
        }
        let mut whole = Odometry::new(rover, settings)?;
        let unit = Matrix3::from_diagonal_element(0.01).into();
        whole.set_pose(start.into(), unit)?;
        let mut singly = whole.clone();
        let cut = cut.min(rows.len());
        let mut found = Found::new(rows.len(), count);
        whole.run(log.of(0..cut, count, joints), false, found.of(0..cut, count))?;
        whole.run(log.of(cut..rows.len(), count, joints), false, found.of(cut..rows.len(), count))?;
        for k in 0..rows.len() {
            let steering = &log.steering[k * joints..(k + 1) * joints];
            let wheels = &log.wheels[k * count..(k + 1) * count];
            let yaw = Some(log.yaws[k]).filter(|yaw| !yaw.is_nan());
            let health = singly.absorb(Sample { yaw, ..sample(steering, wheels, log.stamps[k]) })?;
            prop_assert_eq!(found.health[k], health.0, "row {}", k);
            prop_assert_eq!(found.poses[k], <[f64; 3]>::from(singly.pose()), "row {}", k);
            prop_assert_eq!(found.twists[k], <[f64; 3]>::from(singly.twist()), "row {}", k);
            let covariance = singly.covariance();
            prop_assert_eq!(&found.covariances[k][..], covariance.as_flattened(), "row {}", k);
            if !health.is_left_out() {
                prop_assert_eq!(&found.residuals[k * count..(k + 1) * count], singly.residual());
            }
        }
        for odometry in [&mut whole, &mut singly] {
            odometry.update(sample(&vec![0.0; joints], &vec![0.1; count], stamp + 1.0)).ok();
        }
        prop_assert_eq!(whole.pose(), singly.pose());
        prop_assert_eq!(whole.velocity(), singly.velocity());
        prop_assert_eq!(whole.covariance(), singly.covariance());
        prop_assert_eq!(whole.twist_covariance(), singly.twist_covariance());
        prop_assert_eq!(whole.residual(), singly.residual());
    }
}

#[test]
fn in_no_time_nothing_slides() -> Result<(), Error> {
    let rover = vehicles()?.swap_remove(0);
    let stamps: Vec<_> = (0..20).map(|k| f64::from(k) * 1e-315).collect();
    let log = Log {
        steering: vec![0.0; 80],
        wheels: vec![1.0; 120],
        yaws: vec![f64::NAN; 20],
        stamps,
    };
    let mut found = Found::new(20, 6);
    Odometry::new(rover, Settings::default())?.run(
        log.of(0..20, 6, 4),
        true,
        found.of(0..20, 6),
    )?;
    assert!(found.residuals.iter().all(|slid| *slid == 0.0));
    assert!(found.twists.as_flattened().iter().all(|part| *part == 0.0));
    Ok(())
}

/// Columns of a log.
#[derive(Default)]
struct Log {
    steering: Vec<f64>,
    wheels: Vec<f64>,
    stamps: Vec<f64>,
    yaws: Vec<f64>,
}

impl Log {
    fn of(&self, rows: std::ops::Range<usize>, wheels: usize, joints: usize) -> Recording<'_> {
        Recording {
            steering: &self.steering[rows.start * joints..rows.end * joints],
            wheels: &self.wheels[rows.start * wheels..rows.end * wheels],
            stamps: &self.stamps[rows.clone()],
            yaws: Some(&self.yaws[rows]),
            yaw_rates: None,
        }
    }
}

/// What came of it.
struct Found {
    poses: Vec<[f64; 3]>,
    twists: Vec<[f64; 3]>,
    covariances: Vec<[f64; 9]>,
    residuals: Vec<f64>,
    health: Vec<u32>,
}

impl Found {
    fn new(rows: usize, wheels: usize) -> Self {
        Self {
            poses: vec![[0.0; 3]; rows],
            twists: vec![[0.0; 3]; rows],
            covariances: vec![[0.0; 9]; rows],
            residuals: vec![0.0; rows * wheels],
            health: vec![0; rows],
        }
    }

    fn of(&mut self, rows: std::ops::Range<usize>, wheels: usize) -> TrackRows<'_> {
        TrackRows {
            residuals: Some(&mut self.residuals[rows.start * wheels..rows.end * wheels]),
            covariances: Some(&mut self.covariances[rows.clone()]),
            poses: &mut self.poses[rows.clone()],
            twists: &mut self.twists[rows.clone()],
            health: &mut self.health[rows],
            weights: None,
        }
    }
}
