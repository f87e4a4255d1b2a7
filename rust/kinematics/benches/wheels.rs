//! Times of the kernels, one call and batch, without Python.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use six_wheel_kinematics::batch;
use six_wheel_kinematics::estimate::Measured;
use six_wheel_kinematics::estimate::Unseen;
use six_wheel_kinematics::geometry::Steps;
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::presets;
use six_wheel_kinematics::rover::{Inputs, Rover};
use six_wheel_kinematics::table::Log;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::level::Level;
use six_wheel_numerics::threads::workers::Workers;

const ROWS: usize = 100_000;

/// Twists over all turning radii, a thousandth of the way round the (vx, omega) plane apart.
fn twists() -> Vec<[f64; 3]> {
    let angles = (0..ROWS).map(|k| k as f64 * 1e-3);
    angles.map(|angle| [0.5 * angle.cos(), 0.0, 0.5 * angle.sin()]).collect()
}

fn rover() -> Result<Rover, Error> {
    presets::preset("perseverance", None)
}

fn one_call(criterion: &mut Criterion) {
    let Ok(rover) = rover() else { return };
    let (mut steering, mut speeds) = ([0.0; 4], [0.0; 6]);
    let twist = Twist::from([0.5, 0.0, 0.3]);
    criterion.bench_function("inverse, one call", |bencher| {
        bencher.iter(|| rover.inverse(black_box(twist), Inputs::default(), &mut steering, &mut speeds).is_ok());
    });
    criterion.bench_function("forward, one call", |bencher| {
        bencher.iter(|| {
            let (steering, speeds) = (black_box(&steering), black_box(&speeds));
            let steering_rates = None;
            let measured = Measured { steering, speeds, steering_rates };
            rover.forward(measured, Unseen::Refuse)
        });
    });
}

fn batches(criterion: &mut Criterion) {
    let Ok(rover) = rover() else { return };
    let twists = twists();
    let (mut steering, mut speeds) = (vec![0.0; 4 * ROWS], vec![0.0; 6 * ROWS]);
    let (mut back, mut poses) = (vec![[0.0; 3]; ROWS], vec![[0.0; 3]; ROWS + 1]);
    let mut group = criterion.benchmark_group("batch");
    group.throughput(Throughput::Elements(ROWS as u64));
    let inputs = Inputs::default();
    for level in Level::available() {
        let workers = Workers { level, ..Workers::PLAIN };
        let name = |job: &str| format!("{job}, {}", level.name());
        group.bench_function(name("inverse"), |bencher| {
            bencher.iter(|| batch::inverse(&rover, &twists, inputs, &mut steering, &mut speeds, workers));
        });
        let log = Log { steering: &steering, speeds: &speeds, steering_rates: None };
        group.bench_function(name("forward"), |bencher| {
            bencher.iter(|| batch::forward(&rover, log, Unseen::Refuse, &mut back, workers));
        });
        let (steps, starts) = (Steps::Constant(0.01), [[0.0; 3]]);
        group.bench_function(name("integrate"), |bencher| {
            bencher.iter(|| batch::integrate(&twists, ROWS, steps, &starts, &mut poses, workers));
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(30);
    targets = one_call, batches
}
criterion_main!(benches);
