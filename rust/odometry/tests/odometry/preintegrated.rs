//! Motions between two instants: parts and the whole, derivatives against differences.

use nalgebra::{UnitQuaternion, Vector3, Vector6};
use six_wheel_kinematics::estimate::sensitivity::Quantity;
use six_wheel_kinematics::rover::Rover;
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_kinematics::wheels::{Pivot, Wheel};
use six_wheel_numerics::threads::workers::never;
use six_wheel_odometry::preintegrated::space::Motion3;
use six_wheel_odometry::preintegrated::{
    Column, DIMENSIONS, ErrorFrame, PLANE, Preintegrated, PreintegrationOptions, Residual,
};
use six_wheel_odometry::{Gyroscope, Noise, Sample, Settings};

use crate::sample;

fn noise() -> Noise {
    Noise { speed: 0.02, steering: 0.01, slip: 0.01, side_slip: 0.02, ..Noise::READINGS }
}

fn options(gyroscope: Option<Gyroscope>) -> PreintegrationOptions {
    PreintegrationOptions {
        settings: Settings { noise: noise(), ..Settings::default() },
        gyroscope,
        in_space: false,
        attitude_noise: 0.0,
    }
}

/// Any wheels: steered with scrub and trail, fixed, a passive one.
fn rover(change: impl Fn(usize, &mut Wheel)) -> Rover {
    let steered = Pivot::Steered(SteeringRange::default());
    let places = [
        ("front", 0.5, 0.1, steered, 0.02, 0.03),
        ("rear", -0.4, -0.2, steered, 0.0, 0.0),
        ("left", 0.05, 0.3, Pivot::Fixed, 0.0, 0.0),
        ("right", 0.05, -0.3, Pivot::Fixed, 0.01, 0.0),
    ];
    let wheels = places.iter().enumerate().map(|(i, place)| {
        let mut wheel = Wheel {
            name: place.0.into(),
            x: place.1,
            y: place.2,
            radius: 0.1,
            heading: 0.0,
            pivot: place.3,
            scrub: place.4,
            trail: place.5,
            roller_angle: None,
            driven: true,
        };
        change(i, &mut wheel);
        wheel
    });
    Rover::new(wheels.collect()).unwrap()
}

/// Time, steering angles and angles of the wheels of sample `k`.
fn readings(k: usize) -> (f64, [f64; 2], [f64; 4]) {
    let t = 0.05 * k as f64;
    let steering = [0.4 * (0.9 * t).sin(), -0.3 * (0.7 * t).sin()];
    (t, steering, [6.0 * t, 5.8 * t + (0.5 * t).sin(), 5.5 * t, 6.3 * t])
}

fn drive(into: &mut Preintegrated, rows: std::ops::Range<usize>, bias: f64) {
    for k in rows {
        let (t, steering, wheels) = readings(k);
        let yaw_rate = into.options().gyroscope.map(|_| 0.3 * t.cos() + bias);
        let half = 0.1 * (0.8 * t).sin();
        let attitude = into.options().in_space.then(|| [half.sin(), 0.0, 0.0, half.cos()]);
        into.add(Sample { yaw_rate, ..sample(&steering, &wheels, t) }, attitude).unwrap();
    }
}

fn whole(rover: Rover, options: PreintegrationOptions) -> Preintegrated {
    let mut motion = Preintegrated::new(rover, options).unwrap();
    drive(&mut motion, 0..80, 0.0);
    motion
}

#[test]
fn a_replay_is_the_motion_of_odometry() {
    for gyroscope in [None, Some(Gyroscope::default())] {
        let motion = whole(rover(|_, _| {}), options(gyroscope));
        let replayed = motion.replay(never).unwrap();
        let pose = motion.pose().unwrap();
        assert!((replayed.yaw - pose.yaw).abs() < 1e-13);
        assert!((replayed.motion.translation.x - pose.x).abs() < 1e-13);
        assert!((replayed.motion.translation.y - pose.y).abs() < 1e-13);
        let covariance = motion.covariance().unwrap();
        let again = replayed.covariance_in(ErrorFrame::Coordinates);
        for (i, row) in PLANE.into_iter().enumerate() {
            for (k, column) in PLANE.into_iter().enumerate() {
                let apart = (covariance[i][k] - again[(row, column)]).abs();
                assert!(apart < 1e-14, "{i} {k} {covariance:?} {again}");
            }
        }
    }
}

#[test]
fn parts_are_the_whole() {
    let motion = whole(rover(|_, _| {}), options(Some(Gyroscope::default())));
    let all = motion.replay(never).unwrap();
    for stamp in [0.0, 0.02, 0.05, 1.0, 1.234, 3.94, 3.95] {
        let [first, second] = motion.split(stamp).unwrap();
        assert_eq!(first.span().unwrap()[1], second.span().unwrap()[0]);
        let (a, b) = (first.replay(never).unwrap(), second.replay(never).unwrap());
        let composed = a.motion.compose(&b.motion);
        assert!((composed.translation - all.motion.translation).norm() < 1e-13);
        assert!(composed.rotation.angle_to(&all.motion.rotation) < 1e-13);
        let merged = first.merge(&second).unwrap();
        let again = merged.replay(never).unwrap();
        assert!((again.motion.translation - all.motion.translation).norm() < 1e-13);
        assert!((again.covariance - all.covariance).amax() < 1e-15);
        // The share of a later part stays, that of an earlier one is carried along.
        let carry = b.motion.inverse().adjoint();
        for (column, by) in &all.columns {
            let parts = carry * a.by(*column) + b.by(*column);
            assert!((parts - by).amax() < 1e-12, "{column:?} {stamp}");
        }
        // Cut twice within one step.
        if let Ok([middle, last]) = second.split(stamp + 0.01) {
            let joined = first.merge(&middle.merge(&last).unwrap()).unwrap();
            let joined = joined.replay(never).unwrap();
            assert!((joined.covariance - all.covariance).amax() < 1e-15);
        }
        assert!(second.merge(&first).is_err());
    }
}

#[test]
fn derivatives_are_differences() {
    let plain = whole(rover(|_, _| {}), options(None));
    let all = plain.replay(never).unwrap();
    let step = 1e-6;
    for i in 0..4 {
        for quantity in DIMENSIONS {
            // Wheels that share an axle direction no longer would.
            let shares = i > 1 && quantity == Quantity::Heading;
            if shares || quantity == Quantity::RollerAngle {
                continue;
            }
            let moved = |by: f64| {
                let changed = rover(|k, wheel| {
                    if k == i {
                        match quantity {
                            Quantity::Radius => wheel.radius += by,
                            Quantity::X => wheel.x += by,
                            Quantity::Y => wheel.y += by,
                            Quantity::Heading => wheel.heading += by,
                            Quantity::Scrub => wheel.scrub += by,
                            _ => wheel.trail += by,
                        }
                    }
                });
                whole(changed, options(None)).replay(never).unwrap().motion
            };
            let back = all.motion.inverse();
            let difference = (back.compose(&moved(step)).log() - back.compose(&moved(-step)).log()) / (2.0 * step);
            let by = all.by(Column::Dimension(quantity, i));
            assert!((difference - by).amax() < 1e-7, "{quantity:?} {i} {difference} {by}");
        }
    }
}

#[test]
fn the_bias_of_a_gyroscope_has_its_derivative() {
    let with = |bias: f64| {
        let gyroscope = Gyroscope { bias, ..Gyroscope::default() };
        whole(rover(|_, _| {}), options(Some(gyroscope))).replay(never).unwrap()
    };
    let (here, more, less) = (with(0.01), with(0.01 + 1e-5), with(0.01 - 1e-5));
    let back = here.motion.inverse();
    let difference = (back.compose(&more.motion).log() - back.compose(&less.motion).log()) / 2e-5;
    assert!((difference - here.by(Column::Bias)).amax() < 1e-7);
}

#[test]
fn residuals_answer_as_their_differences_do() {
    let motion = whole(rover(|_, _| {}), options(None)).replay(never).unwrap().motion;
    let first = Motion3::exp(&Vector6::new(0.3, -1.0, 0.2, 0.1, -0.2, 0.8));
    let off = Motion3::exp(&Vector6::new(0.05, 0.02, -0.01, 0.1, 0.05, -0.2));
    let second = first.compose(&motion).compose(&off);
    let change = Vector6::new(0.01, -0.02, 0.0, 0.0, 0.0, 0.03);
    let residual = Residual::of(&motion, &change, [&first, &second]);
    for k in 0..6 {
        let mut step = Vector6::zeros();
        step[k] = 1e-6;
        let at = |sign: f64| {
            let moved = Motion3::exp(&(step * sign));
            [
                Residual::of(&motion, &change, [&first.compose(&moved), &second]).error,
                Residual::of(&motion, &change, [&first, &second.compose(&moved)]).error,
                Residual::of(&motion, &(change + step * sign), [&first, &second]).error,
            ]
        };
        let (more, less) = (at(1.0), at(-1.0));
        let by = [&residual.by_first, &residual.by_second, &residual.by_motion];
        for (part, by) in by.into_iter().enumerate() {
            let difference = (more[part] - less[part]) / 2e-6;
            assert!((difference - by.column(k)).amax() < 1e-8, "{part} {k}");
        }
    }
}

#[test]
fn a_tilted_plane_is_a_plane() {
    // The same wheels on a slope: seen along it, the same motion.
    let flat = whole(rover(|_, _| {}), options(None)).replay(never).unwrap();
    let tilt = UnitQuaternion::from_euler_angles(0.4, -0.7, 2.0);
    let mut sloped = Preintegrated::new(
        rover(|_, _| {}),
        PreintegrationOptions { in_space: true, attitude_noise: 0.01, ..options(None) },
    )
    .unwrap();
    let (source, mut yaw) = (whole(rover(|_, _| {}), options(None)), 0.0);
    for k in 0..80 {
        let (t, steering, wheels) = readings(k);
        if k > 0 {
            let [part, _] = source.split(t).unwrap();
            yaw = part.pose().unwrap().yaw;
        }
        let turned = tilt * UnitQuaternion::from_scaled_axis(Vector3::z() * yaw);
        let parts = turned.coords;
        let attitude = [parts.x, parts.y, parts.z, parts.w];
        sloped.add(sample(&steering, &wheels, t), Some(attitude)).unwrap();
    }
    let seen = sloped.replay(never).unwrap();
    assert!((seen.motion.translation - flat.motion.translation).norm() < 1e-12);
    assert!(seen.motion.rotation.angle_to(&flat.motion.rotation) < 1e-12);
    // Tilt errs by the readings at both ends, however many there are between.
    let about = seen.covariance.diagonal();
    assert!((about[3] - 2.0 * 1e-4).abs() < 2e-6, "{about}");
    assert!(seen.covariance.symmetric_eigenvalues().min() > -1e-15);
}
