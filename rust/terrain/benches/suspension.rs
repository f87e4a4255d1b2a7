//! Times of the rocker-bogie chain, one row and batch, without Python.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use six_wheel_kinematics::rover::Inputs;
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_terrain::suspension::RockerBogie;
use six_wheel_terrain::suspension::{FRAMES, WHEELS, frames, jacobians};

const ROWS: usize = 10_000;

fn one_row(criterion: &mut Criterion) {
    let Ok(rover) = RockerBogie::rocky7() else {
        return;
    };
    let joints = [0.1, 0.2, -0.1, 0.3, -0.3];
    criterion.bench_function("place", |bencher| {
        bencher.iter(|| rover.place(black_box(&joints)).map(|placed| placed.wheel(5)));
    });
    let Ok(placed) = rover.place(&joints) else {
        return;
    };
    criterion.bench_function("slopes of six wheels", |bencher| {
        bencher.iter(|| {
            let placed = black_box(&placed);
            [0, 1, 2, 3, 4, 5].map(|wheel| placed.point_slopes(wheel, placed.wheel(wheel).centre))
        });
    });
    criterion.bench_function("steer", |bencher| {
        bencher.iter(|| rover.steer(black_box(0.1), 0.05, 0.1, [0.2, -0.1], Inputs::default()));
    });
}

fn batches(criterion: &mut Criterion) {
    let Ok(rover) = RockerBogie::rocky7() else {
        return;
    };
    let width = rover.joint_count();
    let joints: Vec<f64> = (0..ROWS * width).map(|k| (k as f64).sin()).collect();
    let mut transforms = vec![0.0; FRAMES * ROWS * 16];
    let mut derivatives = vec![0.0; WHEELS.len() * ROWS * 3 * width];
    let mut group = criterion.benchmark_group("suspension batch");
    group.throughput(Throughput::Elements(ROWS as u64));
    group.bench_function("frames", |bencher| {
        bencher.iter(|| frames(&rover, &joints, &mut transforms, Workers::PLAIN));
    });
    group.bench_function("jacobians", |bencher| {
        bencher.iter(|| jacobians(&rover, &joints, &mut derivatives, Workers::PLAIN));
    });
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(30);
    targets = one_row, batches
}
criterion_main!(benches);
