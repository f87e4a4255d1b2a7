//! The calls of a control loop take nothing from the allocator, whose calls are counted.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::Arc;

use six_wheel_ground_motion::spatial::{Attitude, Odometry3, Sample3, Settings3};
use six_wheel_ground_motion::{
    BodyMotions, Command, Commands, Drives, Driving, Lift, Prepared, ReadingRows, SettledPoseInput, SettledPoses,
    Turns, forward_rows, inverse_rows, traction_rows,
};
use six_wheel_kinematics::admissible::Keep;
use six_wheel_kinematics::batch::{self, Fits};
use six_wheel_kinematics::estimate::{Measured, Method, Unseen};
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::{Inputs, Rover};
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_kinematics::table::Log;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::level::Level;
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_odometry::dimensions::NUMBERS;
use six_wheel_odometry::{Deviations, Odometry, Sample, Settings};
use six_wheel_terrain::suspension::RockerBogie;
use six_wheel_terrain::terrain::{Heights, Terrain};

thread_local! {
    static TAKEN: Cell<usize> = const { Cell::new(0) };
}

/// The system's allocator, counting how often this thread asks it for memory.
struct Counting;

// SAFETY: everything is passed on to the system's allocator as it comes.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        TAKEN.set(TAKEN.get() + 1);
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Number of allocations of `job`, the second time it is done.
fn taken<T>(mut job: impl FnMut() -> T) -> usize {
    job();
    let before = TAKEN.get();
    job();
    TAKEN.get() - before
}

const TWIST: Twist = Twist { vx: 0.1, vy: 0.0, omega: 0.05 };

/// Six wheels with every kind of range, a swerve drive that turns all the way, and no steering at all.
fn rovers() -> Result<Vec<Rover>, Error> {
    let dimensions = [0.4, 0.5, 0.5, 0.45];
    let places = [[0.4, 0.3], [0.4, -0.3], [-0.4, 0.3], [-0.4, -0.3]];
    Ok(vec![
        Rover::six_wheel(dimensions, 0.15, SteeringRange::default())?,
        Rover::six_wheel(dimensions, 0.15, SteeringRange::symmetric(1.0)?)?,
        Rover::swerve(&places, None, 0.1, SteeringRange::symmetric(3.2)?)?,
        Rover::mecanum(0.3, 0.2, 0.1, 0.8)?,
    ])
}

#[test]
fn the_counter_counts() {
    assert_eq!(taken(|| vec![0.0; 100]), 1);
}

#[test]
fn one_call_takes_no_memory() -> Result<(), Error> {
    for rover in rovers()? {
        let (joints, wheels) = (rover.steered().len(), rover.wheels().len());
        let (mut steering, mut speeds) = (vec![0.0; joints], vec![0.0; wheels]);
        let previous = vec![0.2; joints];
        let inputs = Inputs { previous: Some(&previous), ..Inputs::default() };
        for inputs in [Inputs::default(), inputs] {
            let plain = || rover.inverse(TWIST, inputs, &mut steering, &mut speeds);
            assert_eq!(taken(plain), 0);
            let quick = || rover.inverse(TWIST, inputs, &mut steering, &mut speeds);
            assert_eq!(taken(quick), 0);
        }
        rover.inverse(TWIST, inputs, &mut steering, &mut speeds)?;
        let measured = Measured { steering: &steering, speeds: &speeds, steering_rates: None };
        assert_eq!(taken(|| rover.forward(measured, Unseen::Refuse)), 0);
        assert_eq!(taken(|| rover.forward(measured, Unseen::Refuse)), 0);
        let (mut residual, mut weights) = (vec![0.0; wheels], vec![0.0; wheels]);
        for method in [Method::LeastSquares, Method::Robust] {
            let fit = || rover.fit(measured, method, Unseen::Refuse, &mut residual, &mut weights);
            assert_eq!(taken(fit), 0, "{method:?}");
        }
        assert_eq!(taken(|| rover.check(TWIST, None)), 0);
        assert_eq!(taken(|| rover.admissible(TWIST)), 0);
        assert_eq!(taken(|| rover.project(TWIST, Keep::Curvature)), 0);
        assert_eq!(taken(|| rover.project(TWIST, Keep::Curvature)), 0);
    }
    Ok(())
}

#[test]
fn a_batch_takes_no_memory() -> Result<(), Error> {
    for level in Level::available() {
        let workers = Workers { level, ..Workers::PLAIN };
        for (rover, rows) in rovers()?.into_iter().flat_map(|rover| [(rover.clone(), 9), (rover, 1000)]) {
            let (joints, wheels) = (rover.steered().len(), rover.wheels().len());
            let mut twists = vec![<[f64; 3]>::from(TWIST); rows];
            let (mut steering, mut speeds) = (vec![0.0; rows * joints], vec![0.0; rows * wheels]);
            let inverse = taken(|| {
                let inputs = Inputs::default();
                batch::inverse(&rover, &twists, inputs, &mut steering, &mut speeds, workers)
            });
            let log = Log { steering: &steering, speeds: &speeds, steering_rates: None };
            let forward = taken(|| batch::forward(&rover, log, Unseen::Refuse, &mut twists, workers));
            let (mut ranks, mut sigmas) = (vec![0; rows], vec![0.0; rows]);
            let [mut residual, mut weights] = [vec![0.0; rows * wheels], vec![0.0; rows * wheels]];
            let fits = [Method::LeastSquares, Method::Robust].map(|method| {
                taken(|| {
                    let fits = Fits {
                        twists: &mut twists,
                        ranks: &mut ranks,
                        sigmas: &mut sigmas,
                        residual: &mut residual,
                        weights: &mut weights,
                    };
                    batch::fit(&rover, log, method, Unseen::Refuse, fits, workers)
                })
            });
            assert_eq!((inverse, forward, fits), (0, 0, [0; 2]), "{level:?}");
        }
    }
    Ok(())
}

#[test]
fn rows_of_motion_on_the_ground_take_no_memory() -> Result<(), Error> {
    const ROWS: usize = 200;
    let chain = RockerBogie::perseverance()?.chain().clone();
    let prepared = Prepared::new(&chain);
    let mut transform = [0.0; 16];
    transform[0] = 1.0;
    let mut gap = vec![0.0; 6 * ROWS];
    gap[30] = 0.1; // a wheel in the air
    let [level, zeros] = [vec![0.0; ROWS], vec![0.0; 6 * ROWS]];
    let footings = SettledPoses::Input(SettledPoseInput {
        roll: &level,
        pitch: &level,
        transform: &[transform; ROWS],
        joints: &zeros[..3 * ROWS],
        steering: &zeros[..4 * ROWS],
        angles: &zeros,
        normals: &[[0.0, 0.0, 1.0]; 6 * ROWS],
        gap: &gap,
    });
    let (mut steering, mut speeds) = (vec![0.0; 4 * ROWS], vec![0.0; 6 * ROWS]);
    let (mut twists, mut joint_rates) = (vec![[0.0; 6]; ROWS], vec![0.0; 3 * ROWS]);
    let (mut vertical, mut lifted) = (vec![0.0; ROWS], vec![false; 6 * ROWS]);
    let (mut contact_angles, mut residuals) = (vec![0.0; 6 * ROWS], vec![0.0; 18 * ROWS]);
    for level in Level::available() {
        let workers = Workers { level, ..Workers::PLAIN };
        let command = Command::new(&chain);
        let inverted = taken(|| {
            let commands = Commands {
                steering: &mut steering,
                speeds: &mut speeds,
                twists: &mut twists,
                joint_rates: &mut joint_rates,
                scales: &mut vertical,
            };
            let wanted = [[0.1, 0.01]];
            inverse_rows(&chain, &prepared, &footings, &command, &wanted, None, commands, workers)
        });
        let moved = taken(|| {
            let readings = ReadingRows {
                steering: None,
                speeds: &speeds,
                steering_rates: None,
                joint_rates: None,
                angular_velocity: None,
                weights: None,
            };
            let motions = BodyMotions { twists: &mut twists, joint_rates: &mut joint_rates, residuals: &mut residuals };
            forward_rows(&chain, &prepared, &footings, &readings, motions, workers)
        });
        let driven = taken(|| {
            let driving = Driving {
                speed: &[0.1],
                turning: Turns::Curvature(&[0.2]),
                angular_velocity: &[[0.0; 3]; ROWS],
                joints: &zeros[..3 * ROWS],
                joint_rates: &zeros[..3 * ROWS],
                steering: None,
                wheel_speeds: None,
                lift: Lift::default(),
            };
            let drives = Drives {
                steering: &mut steering,
                speeds: &mut speeds,
                contact_angles: &mut contact_angles,
                lifted: &mut lifted,
                vertical: &mut vertical,
            };
            traction_rows(&chain, &prepared, &driving, drives, workers)
        });
        assert_eq!([inverted, moved, driven], [0; 3], "{level:?}");
    }
    Ok(())
}

#[test]
fn a_sample_of_odometry_in_space_takes_no_memory() -> Result<(), Error> {
    let flat = Heights::Double(vec![0.0; 32 * 32].into());
    let ground = Arc::new(Terrain::new(flat, 32, [1.0; 2], [-16.0; 2], 0.0)?);
    for map in [None, Some(ground)] {
        let chain = RockerBogie::perseverance()?.chain().clone();
        let settings = Settings3 { common: Settings { lag: 1.0, ..Settings::default() }, ..Settings3::default() };
        let mut odometry = Odometry3::new(chain, map, settings)?;
        let mut stamp = 0.0;
        let step = || {
            stamp += 0.1;
            odometry.update(Sample3 {
                steering: &[0.1, 0.1, -0.1, -0.1],
                wheels: &[stamp; 6],
                stamp,
                joints: Some(&[0.0; 3]),
                attitude: Some(Attitude::from_angles(0.0, 0.0, None)?),
                yaw_rate: None,
            })
        };
        assert_eq!(taken(step), 0);
    }
    Ok(())
}

#[test]
fn a_sample_of_odometry_takes_no_memory() -> Result<(), Error> {
    for (rover, doubts) in rovers()?.into_iter().flat_map(|rover| [(rover.clone(), 0), (rover, 2)]) {
        let (steering, mut wheels) = (vec![0.1; rover.steered().len()], vec![0.0; rover.wheels().len()]);
        let tables = vec![1e-3; doubts * wheels.len() * NUMBERS];
        let settings = Settings { dimensions: Deviations::new(&tables, wheels.len())?, ..Settings::default() };
        let mut odometry = Odometry::new(rover, settings)?;
        let mut stamp = 0.0;
        let step = || {
            stamp += 0.1;
            wheels.fill(stamp);
            odometry.update(Sample { steering: &steering, wheels: &wheels, stamp, yaw: None, yaw_rate: None })
        };
        assert_eq!(taken(step), 0);
    }
    Ok(())
}
