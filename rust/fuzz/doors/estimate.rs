//! Any rover, any twists and readings, every kernel: no panic, finite answers, and the levels agree.

use six_wheel_kinematics::batch;
use six_wheel_kinematics::estimate::{Measured, Method, Readings, Unseen};
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::table::{InputTables, Table};
use six_wheel_numerics::simd::level::Level;
use six_wheel_numerics::threads::workers::Workers;

use super::bytes::Bytes;

/// One input.
pub fn one(data: &[u8]) {
    let mut bytes = Bytes(data);
    let Some(rover) = bytes.rover() else { return };
    let (joints, wheels) = (rover.steered().len(), rover.wheels().len());
    let rows = usize::from(bytes.byte() % 40);
    let twists: Vec<[f64; 3]> = (0..rows).map(|_| [bytes.number(), bytes.number(), bytes.number()]).collect();
    for twist in &twists {
        let _ = rover.check(Twist::from(*twist), None);
        if let Ok(found) = rover.project(Twist::from(*twist), six_wheel_kinematics::admissible::Keep::Curvature) {
            assert!(<[f64; 3]>::from(found).iter().all(|value| value.is_finite()));
        }
    }
    let (steering, speeds) = (bytes.numbers(rows * joints), bytes.numbers(rows * wheels));
    let mut results = Vec::new();
    for level in Level::available() {
        let workers = Workers { level, ..Workers::PLAIN };
        let mut found = vec![[7.0; 3]; rows];
        let tables = Readings { steering: Table::Flat(&steering), speeds: Table::Flat(&speeds), steering_rates: None };
        let forward = batch::forward(&rover, tables, Unseen::Zero, &mut found, workers);
        let mut commands = (vec![7.0; rows * joints], vec![7.0; rows * wheels]);
        let beside = InputTables { previous: Some(Table::Flat(&steering)), ..InputTables::default() };
        let inverse = batch::inverse(&rover, &twists, beside, &mut commands.0, &mut commands.1, workers);
        if inverse.is_err() {
            assert!(commands.1.iter().all(|value| *value == 7.0), "half written");
        }
        results.push((forward.is_ok(), inverse.is_ok()));
    }
    assert!(results.windows(2).all(|pair| pair[0] == pair[1]), "{results:?}");
    let (mut residual, mut weights) = (vec![0.0; wheels], vec![0.0; wheels]);
    for k in 0..rows {
        let measured = Measured {
            steering: &steering[k * joints..(k + 1) * joints],
            speeds: &speeds[k * wheels..(k + 1) * wheels],
            steering_rates: None,
        };
        let _ = rover.fit(measured, Method::Robust, Unseen::Zero, &mut residual, &mut weights);
    }
}
