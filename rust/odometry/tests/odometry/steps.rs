//! Steps of odometry: constant shares against a fit of every step, and the same bits alone and in a log.

use nalgebra::Matrix3;
use proptest::prelude::*;
use six_wheel_kinematics::geometry::Pose;
use six_wheel_kinematics::rover::Rover;
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::threads::workers::never;
use six_wheel_odometry::dimensions::NUMBERS;
use six_wheel_odometry::{
    Deviations, Encoder, Gyroscope, LogOdometry, Noise, Odometry, Recording, Sample, Settings, TrackRows,
};

use crate::sample;

/// A gyroscope whose bias is a state, or only its noise.
fn gyroscopes() -> impl Strategy<Value = Option<Gyroscope>> {
    let numbers = (0.0..0.05_f64, -0.1..0.1_f64, 0.0..0.1_f64, 0.0..0.01_f64);
    prop::option::of(numbers.prop_map(|(noise, bias, bias_noise, bias_walk)| Gyroscope {
        noise,
        bias,
        bias_noise,
        bias_walk,
        scale_noise: 0.0,
    }))
}

/// Of every row what wheels and joints change by, the time since the row before, and a yaw rate, if there is one. Every
/// third stretch of five rows the rover stands, and the gyroscope reads next to nothing.
fn drives(most: usize) -> impl Strategy<Value = Vec<(Vec<f64>, f64, Option<f64>)>> {
    let changes = prop::collection::vec(-0.2..0.2_f64, 22);
    let rate = prop::option::weighted(0.8, -1.0..1.0_f64);
    prop::collection::vec((changes, 0.01..0.5_f64, rate), 1..most).prop_map(|mut rows| {
        for stretch in rows.chunks_mut(5).skip(2).step_by(3) {
            for (changes, _, rate) in stretch {
                changes.fill(0.0);
                *rate = rate.map(|rate| 0.01 * rate);
            }
        }
        rows
    })
}

/// Vehicles with constant shares: steered wheels in none, part, one or several registers.
fn vehicles() -> Result<Vec<Rover>, Error> {
    let around = |count: u32| -> Vec<[f64; 2]> {
        let turn = |k: u32| std::f64::consts::TAU * f64::from(k) / f64::from(count);
        (0..count).map(|k| [turn(k).cos() + 0.3, turn(k).sin()]).collect()
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
    let largest = expected.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let pairs = found.iter().zip(expected);
    found.len() == expected.len() && pairs.into_iter().all(|(a, b)| a == b || (a - b).abs() <= rounding * largest)
}

proptest! {
    /// Errors of the dimensions call for a fit of every step: with errors of 0 the numbers are the same.
    #[test]
    fn constant_shares_and_a_fit_agree(
        which in 0..5_usize,
        slip in prop::sample::select(vec![0.0, 0.02]),
        side_slip in prop::sample::select(vec![0.0, 0.01]),
        speed in prop::sample::select(vec![0.0, 0.01]),
        threshold in prop::option::of(0.001..0.5_f64),
        gyroscope in gyroscopes(),
        rows in drives(30),
        has_rates in any::<bool>(),
        yaw in prop::option::of(-1.0..1.0_f64),
    ) {
        let rover = vehicles()?.swap_remove(which);
        let (joints, count) = (rover.steered().len(), rover.wheels().len());
        let settings = Settings {
            noise: Noise { speed, slip, side_slip, yaw: 0.05, ..Noise::READINGS },
            gyroscope,
            slip_threshold: threshold,
            lag: 1.0,
            ..Settings::default()
        };
        let known = Deviations::new(&vec![0.0; count * NUMBERS], count)?;
        let fitted = Settings { dimensions: known, ..settings.clone() };
        // A counter that never starts over asks for another way to the rotations of the wheels.
        let endless = Encoder { modulus: Some(1e12), ..Encoder::default() };
        let mut rotations = Odometry::new(rover.clone(), Settings { wheel_encoders: vec![endless], ..settings.clone() })?;
        let mut constant = Odometry::new(rover.clone(), settings)?;
        // Its variances are as large as those that a gyroscope takes away, of which what is left has the rounding.
        let mut wheels_alone = Odometry::new(rover.clone(), Settings { gyroscope: None, ..fitted.clone() })?;
        let mut fitted = Odometry::new(rover, fitted)?;
        let (mut steering, mut wheels, mut stamp) = (vec![0.0; joints], vec![0.0; count], 0.0);
        for (k, (changes, dt, yaw_rate)) in rows.iter().enumerate() {
            for (reading, change) in steering.iter_mut().chain(&mut wheels).zip(changes) {
                *reading += change;
            }
            stamp += dt;
            let yaw = yaw.filter(|_| k % 5 == 3);
            let yaw_rate = yaw_rate.filter(|_| has_rates);
            let sample = Sample { yaw, yaw_rate, ..sample(&steering, &wheels, stamp) };
            let health = fitted.update(sample)?;
            prop_assert_eq!(constant.update(sample)?, health);
            prop_assert_eq!(rotations.update(sample)?, health);
            prop_assert_eq!(rotations.pose(), constant.pose());
            prop_assert_eq!(rotations.covariance(), constant.covariance());
            prop_assert_eq!(rotations.residual(), constant.residual());
            wheels_alone.update(Sample { yaw_rate: None, ..sample })?;
            // Sums of up to 22 terms a step, over up to 30 steps.
            let pose = <[f64; 3]>::from(constant.pose());
            let expected = <[f64; 3]>::from(fitted.pose());
            prop_assert!(close(&pose, &expected, 1e-13), "{:?} {:?}", pose, expected);
            let twist = <[f64; 3]>::from(constant.twist());
            let expected = <[f64; 3]>::from(fitted.twist());
            prop_assert!(close(&twist, &expected, 1e-13), "{:?} {:?}", twist, expected);
            let largest = wheels.iter().fold(0.0_f64, |most, turn| most.max(turn.abs())) / dt;
            for (slid, expected) in constant.residual().iter().zip(fitted.residual()) {
                prop_assert!((slid - expected).abs() <= 1e-14 * (1.0 + largest));
            }
            for of in [Odometry::covariance, Odometry::twist_covariance] {
                let [found, expected, alone] = [&constant, &fitted, &wheels_alone].map(of);
                let largest = [expected, alone].as_flattened().as_flattened().iter().fold(0.0, |most: f64, part| most.max(part.abs()));
                let pairs = found.as_flattened().iter().zip(expected.as_flattened());
                for (found, expected) in pairs {
                    let is_close = found == expected || (found - expected).abs() <= 1e-13 * largest;
                    prop_assert!(is_close, "{} {} {}", found, expected, largest);
                }
            }
        }
        let unit = Matrix3::identity().into();
        let back = stamp - rows[rows.len() - 1].1 / 2.0;
        if constant.correct(Pose::default(), back, unit).is_ok() {
            fitted.correct(Pose::default(), back, unit)?;
            let (found, expected) = (constant.covariance(), fitted.covariance());
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
        gyroscope in gyroscopes(),
        rows in drives(200),
        has_rates in any::<bool>(),
        odd in prop::collection::vec((0..200_usize, 0..10_u32), 0..5),
        cut in 0..200_usize,
        start in prop::array::uniform3(-5.0..5.0_f64),
    ) {
        let rover = vehicles()?.swap_remove(which);
        let (joints, count) = (rover.steered().len(), rover.wheels().len());
        let encoder = Encoder { resolution, ..Encoder::default() };
        let settings = Settings {
            noise: Noise { speed, slip, period, yaw: 0.05, ..Noise::READINGS },
            gyroscope,
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
        for (changes, dt, rate) in &rows {
            for (reading, change) in angles.iter_mut().chain(&mut turned).zip(changes) {
                *reading += change;
            }
            stamp += dt;
            log.steering.extend(angles.iter().map(|angle| angle / per_count));
            log.wheels.extend(&turned);
            log.stamps.push(stamp);
            log.rates.push(rate.filter(|_| has_rates).unwrap_or(f64::NAN));
        }
        for &(row, kind) in odd.iter().filter(|(row, _)| *row < rows.len()) {
            match kind {
                0 => log.wheels[row * count] = f64::NAN,
                1 => log.yaws[row] = 0.3,
                2 => log.stamps[row] -= 1.0,
                3 => log.wheels[row * count] += 30.0,
                6 => log.rates[row] = f64::INFINITY,
                7 => log.yaws[row] = f64::INFINITY,
                8 => log.rates[row] = f64::NAN,
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
        whole.run(log.of(0..cut, count, joints), false, found.of(0..cut, count), never)?;
        whole.run(log.of(cut..rows.len(), count, joints), false, found.of(cut..rows.len(), count), never)?;
        for k in 0..rows.len() {
            let steering = &log.steering[k * joints..(k + 1) * joints];
            let wheels = &log.wheels[k * count..(k + 1) * count];
            let [yaw, yaw_rate] = [log.yaws[k], log.rates[k]].map(|read| Some(read).filter(|read| !read.is_nan()));
            let health = singly.update_or_skip(Sample { yaw, yaw_rate, ..sample(steering, wheels, log.stamps[k]) })?;
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
        prop_assert_eq!(whole.gyroscope_bias(), singly.gyroscope_bias());
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
        rates: vec![f64::NAN; 20],
        stamps,
    };
    let mut found = Found::new(20, 6);
    Odometry::new(rover, Settings::default())?.run(log.of(0..20, 6, 4), true, found.of(0..20, 6), never)?;
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
    rates: Vec<f64>,
}

impl Log {
    fn of(&self, rows: std::ops::Range<usize>, wheels: usize, joints: usize) -> Recording<'_> {
        Recording {
            steering: &self.steering[rows.start * joints..rows.end * joints],
            wheels: &self.wheels[rows.start * wheels..rows.end * wheels],
            stamps: &self.stamps[rows.clone()],
            yaws: Some(&self.yaws[rows.clone()]),
            yaw_rates: Some(&self.rates[rows]),
        }
    }
}

/// Results of a log, row by row.
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
