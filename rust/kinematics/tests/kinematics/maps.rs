//! Maps between twists and poses at every level, against the functions of the standard library.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Rotation2, Vector2};
use six_wheel_kinematics::batch::{Map, map};
use six_wheel_kinematics::geometry::{Steps, wrap_angle};
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::level::Level;
use six_wheel_numerics::threads::workers::Workers;

use crate::random::Numbers;

const CORNERS: [f64; 12] = [0.0, -0.0, 5e-324, -1e-310, 1e-150, 1e-9, FRAC_PI_2, PI, -PI, 7.0, 1e12, -1e200];

/// The map by the functions of the standard library.
fn expected(map: Map, first: [f64; 3], second: [f64; 3], dt: f64) -> [f64; 3] {
    let sinc = |x: f64| if x == 0.0 { 1.0 } else { x.sin() / x };
    let [x, y, yaw] = first;
    let chord = Vector2::new(x, y);
    let log = |chord: Vector2<f64>, yaw: f64| {
        let yaw = wrap_angle(yaw);
        let linear = Rotation2::new(-yaw / 2.0) * chord / (sinc(yaw / 2.0) * dt);
        [linear.x, linear.y, yaw / dt]
    };
    match map {
        Map::Exp => {
            let half = yaw * dt / 2.0;
            let chord = Rotation2::new(half) * chord * (sinc(half) * dt);
            [chord.x, chord.y, yaw * dt]
        }
        Map::Log => log(chord, yaw),
        Map::Compose => {
            let shift = Rotation2::new(yaw) * Vector2::new(second[0], second[1]);
            [x + shift.x, y + shift.y, yaw + second[2]]
        }
        Map::Between => log(Rotation2::new(-yaw) * Vector2::new(second[0] - x, second[1] - y), second[2] - yaw),
    }
}

/// The size of the terms of a result: where they cancel, their rounding stays.
fn size(map: Map, first: [f64; 3], second: [f64; 3], dt: f64) -> [f64; 3] {
    let way = |row: [f64; 3]| row[0].abs() + row[1].abs();
    match map {
        Map::Exp => [way(first) * dt, way(first) * dt, 0.0],
        Map::Log => [2.0 * way(first) / dt, 2.0 * way(first) / dt, 0.0],
        Map::Compose => [way(first) + way(second); 3],
        Map::Between => [2.0 * (way(first) + way(second)) / dt; 3],
    }
}

#[test]
fn every_level_maps_rows_as_the_standard_library_does() -> Result<(), Error> {
    let mut numbers = Numbers(9);
    for round in 0..400 {
        let kind = [Map::Exp, Map::Log, Map::Compose, Map::Between][round % 4];
        let count = [1, 2, 7, 8, 9, 64, 131][round % 7];
        let mut rows = || -> Vec<[f64; 3]> {
            (0..count)
                .map(|k| {
                    let mut number = || match numbers.between(0.0, 6.0) as usize {
                        0 => CORNERS[(numbers.between(0.0, 12.0) as usize).min(11)],
                        _ => numbers.between(-4.0, 4.0),
                    };
                    if k % 3 == 0 { [number(), number(), number()] } else { [0.5, number(), 0.1 * number()] }
                })
                .collect()
        };
        let (first, second) = (rows(), rows());
        let dts: Vec<_> = (0..count).map(|_| numbers.between(0.001, 2.0)).collect();
        let steps = if round % 3 == 0 { Steps::Constant(0.1) } else { Steps::Each(&dts) };
        let one = |k: usize| kind.of(first[k], second[k], steps.get(k));
        for level in Level::available() {
            let mut found = vec![[f64::NAN; 3]; count];
            map(kind, &first, &second, steps, &mut found, Workers { level, ..Workers::PLAIN })?;
            for (k, found) in found.into_iter().enumerate() {
                let dt = steps.get(k);
                let bits = |row: [f64; 3]| row.map(|number| if number.is_nan() { 0 } else { number.to_bits() });
                assert_eq!(bits(found), bits(one(k)), "{kind:?} {level:?}");
                let sizes = size(kind, first[k], second[k], dt);
                let expected = expected(kind, first[k], second[k], dt);
                for (part, (a, b)) in found.into_iter().zip(expected).enumerate() {
                    let near = 4.0 * f64::EPSILON * sizes[part].max(b.abs());
                    let same = a == b || (a.is_nan() && b.is_nan());
                    assert!(
                        same || (a - b).abs() <= near,
                        "{kind:?} {level:?} {:?} {:?} {dt}: {a:e} {b:e}",
                        first[k],
                        second[k]
                    );
                }
            }
        }
    }
    Ok(())
}
