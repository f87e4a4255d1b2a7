//! The jobs whose instructions callgrind counts: each a function of its own that runs `RUNS` times on values made outside.
//!
//! `benches/instructions.py` runs this under valgrind and compares with the figures that stand beside it. Batches run at
//! AVX2, the widest registers valgrind knows.

use std::hint::black_box;

use six_wheel_control::controller::Controller;
use six_wheel_control::controller::{Limits, Options};
use six_wheel_kinematics::admissible::Keep;
use six_wheel_kinematics::batch;
use six_wheel_kinematics::estimate::Measured;
use six_wheel_kinematics::estimate::{Method, Unseen};
use six_wheel_kinematics::geometry::Steps;
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::kernels::fit::Fits;
use six_wheel_kinematics::presets;
use six_wheel_kinematics::rover::{Inputs, Rover};
use six_wheel_kinematics::table::Log;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::level::Level;
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_odometry::Odometry;
use six_wheel_odometry::{Sample, Settings};
use six_wheel_terrain::ground::Settler;
use six_wheel_terrain::suspension::PlanPose;
use six_wheel_terrain::suspension::RockerBogie;
use six_wheel_terrain::terrain::Heights;
use six_wheel_terrain::terrain::Terrain;

/// Of every job: `benches/instructions.py` divides by it.
const RUNS: usize = 64;
const ROWS: usize = 256;
const TWIST: Twist = Twist { vx: 0.5, vy: 0.0, omega: 0.3 };
const WORKERS: Workers = Workers { level: Level::Avx2, ..Workers::PLAIN };

/// A rover, and a log of it over all turning radii.
struct Drive {
    rover: Rover,
    twists: Vec<[f64; 3]>,
    steering: Vec<f64>,
    speeds: Vec<f64>,
}

impl Drive {
    fn new(rover: Rover) -> Result<Self, Error> {
        let angles = (0..ROWS).map(|k| k as f64 * 0.02);
        let twists: Vec<_> = angles.map(|angle| [0.5 * angle.cos(), 0.0, 0.5 * angle.sin()]).collect();
        let (mut steering, mut speeds) = (vec![0.0; 4 * ROWS], vec![0.0; 6 * ROWS]);
        batch::inverse(&rover, &twists, Inputs::default(), &mut steering, &mut speeds, WORKERS)?;
        Ok(Self { rover, twists, steering, speeds })
    }

    fn log(&self) -> Log<'_> {
        Log { steering: &self.steering, speeds: &self.speeds, steering_rates: None }
    }
}

#[inline(never)]
fn inverse_one(drive: &Drive) -> Result<(), Error> {
    let (mut steering, mut speeds) = ([0.0; 4], [0.0; 6]);
    for _ in 0..RUNS {
        let twist = black_box(TWIST);
        drive.rover.inverse(twist, Inputs::default(), &mut steering, &mut speeds)?;
    }
    Ok(())
}

#[inline(never)]
fn forward_one(drive: &Drive) -> Result<(), Error> {
    for _ in 0..RUNS {
        let measured =
            Measured { steering: black_box(&drive.steering[..4]), speeds: &drive.speeds[..6], steering_rates: None };
        black_box(drive.rover.forward(measured, Unseen::Refuse)?);
    }
    Ok(())
}

#[inline(never)]
fn admissible_one(drive: &Drive) -> Result<(), Error> {
    for _ in 0..RUNS {
        black_box(drive.rover.admissible(black_box(TWIST))?);
    }
    Ok(())
}

#[inline(never)]
fn project_one(drive: &Drive) -> Result<(), Error> {
    let beyond = Twist { omega: 3.0, ..TWIST };
    for _ in 0..RUNS {
        black_box(drive.rover.project(black_box(beyond), Keep::Nearest)?);
    }
    Ok(())
}

#[inline(never)]
fn odometry_update(drive: &Drive, odometry: &mut Odometry) -> Result<(), Error> {
    for k in 0..RUNS {
        let stamp = 0.01 * (k + 1) as f64;
        let mut wheels = [0.0; 6];
        for (turned, speed) in wheels.iter_mut().zip(&drive.speeds) {
            *turned = speed * stamp;
        }
        odometry.update(Sample {
            steering: &drive.steering[..4],
            wheels: &wheels,
            stamp,
            yaw: None,
            yaw_rate: None,
        })?;
    }
    Ok(())
}

#[inline(never)]
fn controller_step(controller: &mut Controller) -> Result<(), Error> {
    controller.command(TWIST, 0.0, None)?;
    for k in 0..RUNS {
        controller.step(0.005 * k as f64, None)?;
    }
    Ok(())
}

#[inline(never)]
fn inverse(drive: &Drive, steering: &mut [f64], speeds: &mut [f64]) -> Result<(), Error> {
    for _ in 0..RUNS {
        let inputs = Inputs::default();
        batch::inverse(&drive.rover, black_box(&drive.twists), inputs, steering, speeds, WORKERS)?;
    }
    Ok(())
}

#[inline(never)]
fn forward(drive: &Drive, twists: &mut [[f64; 3]]) -> Result<(), Error> {
    for _ in 0..RUNS {
        batch::forward(&drive.rover, black_box(drive.log()), Unseen::Refuse, twists, WORKERS)?;
    }
    Ok(())
}

#[inline(never)]
fn integrate(drive: &Drive, poses: &mut [[f64; 3]]) -> Result<(), Error> {
    for _ in 0..RUNS {
        let steps = Steps::Constant(0.01);
        batch::integrate(black_box(&drive.twists), ROWS, steps, &[[0.0; 3]], poses, WORKERS)?;
    }
    Ok(())
}

#[inline(never)]
fn admissible(drive: &Drive, answers: &mut [bool]) -> Result<(), Error> {
    for _ in 0..RUNS {
        batch::admissible(&drive.rover, black_box(&drive.twists), answers, WORKERS)?;
    }
    Ok(())
}

#[inline(never)]
fn project(drive: &Drive, beyond: &[[f64; 3]], twists: &mut [[f64; 3]]) -> Result<(), Error> {
    for _ in 0..RUNS {
        batch::project(&drive.rover, black_box(beyond), Keep::Nearest, twists, WORKERS)?;
    }
    Ok(())
}

#[inline(never)]
fn fit(drive: &Drive, twists: &mut [[f64; 3]], residual: &mut [f64], weights: &mut [f64]) -> Result<(), Error> {
    let (mut ranks, mut sigmas) = ([0; ROWS], [0.0; ROWS]);
    for _ in 0..RUNS {
        let log = black_box(drive.log());
        batch::fit(
            &drive.rover,
            log,
            Method::LeastSquares,
            Unseen::Refuse,
            Fits {
                twists: &mut *twists,
                ranks: &mut ranks,
                sigmas: &mut sigmas,
                residual: &mut *residual,
                weights: &mut *weights,
            },
            WORKERS,
        )?;
    }
    Ok(())
}

#[inline(never)]
fn settle(settler: &Settler<'_>) -> Result<(), Error> {
    for k in 0..RUNS {
        let pose = PlanPose { x: 4.0 + 0.05 * k as f64, y: 5.0, yaw: 0.1 * k as f64 };
        black_box(settler.settle(pose, &[0.0; 4])?);
    }
    Ok(())
}

fn main() -> Result<(), Error> {
    let drive = Drive::new(presets::preset("perseverance", None)?)?;
    let (mut steering, mut speeds) = (vec![0.0; 4 * ROWS], vec![0.0; 6 * ROWS]);
    let (mut twists, mut poses) = (vec![[0.0; 3]; ROWS], vec![[0.0; 3]; ROWS + 1]);
    let beyond: Vec<_> = drive.twists.iter().map(|[vx, _, omega]| [*vx, 0.2, *omega]).collect();
    inverse_one(&drive)?;
    forward_one(&drive)?;
    admissible_one(&drive)?;
    drive.rover.project(Twist { vy: 0.2, ..TWIST }, Keep::Nearest)?; // makes the faces
    project_one(&drive)?;
    odometry_update(&drive, &mut Odometry::new(drive.rover.clone(), Settings::default())?)?;
    let limits = Limits { speed: 1.0, acceleration: 0.5, ..Limits::NONE };
    controller_step(&mut Controller::new(&drive.rover, limits, Options::default(), None)?)?;
    inverse(&drive, &mut steering, &mut speeds)?;
    forward(&drive, &mut twists)?;
    integrate(&drive, &mut poses)?;
    admissible(&drive, &mut [false; ROWS])?;
    project(&drive, &beyond, &mut twists)?;
    fit(&drive, &mut twists, &mut speeds, &mut vec![0.0; 6 * ROWS])?;
    let heights = (0..200 * 200).map(|k| 0.1 * (0.05 * (k % 200) as f64).sin() * (0.07 * (k / 200) as f64).cos());
    let ground = Terrain::new(Heights::Double(std::sync::Arc::new(heights.collect())), 200, [0.05; 2], [0.0; 2], 0.0)?;
    let arm = RockerBogie::perseverance()?;
    settle(&Settler::new(&ground, arm.chain()))
}
