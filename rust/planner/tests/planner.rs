//! After its first cycle a planner takes nothing from the allocator, in no thread: counted, not believed.
//!
//! The counter is one for all threads, so this test has a program to itself.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use six_wheel_control::controller::Limits;
use six_wheel_kinematics::geometry::GridPlacement;
use six_wheel_kinematics::rover::Rover;
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::level::Level;
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_planner::{Costmap, CycleInput, Mppi, Options, Precision};

static TAKEN: AtomicUsize = AtomicUsize::new(0);

/// The system's allocator, counting the bytes that are asked for.
struct Counting;

// SAFETY: everything is passed on to the system's allocator as it comes.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        TAKEN.fetch_add(layout.size(), Ordering::Relaxed);
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

fn rovers() -> Result<Vec<Rover>, Error> {
    let places = [[0.4, 0.3], [0.4, -0.3], [-0.4, 0.3], [-0.4, -0.3]];
    Ok(vec![
        Rover::six_wheel([0.4, 0.5, 0.5, 0.45], 0.15, SteeringRange::symmetric(1.2)?)?,
        Rover::swerve(&places, None, 0.1, SteeringRange::symmetric(1.0)?)?,
    ])
}

#[test]
fn cycles_after_the_first_take_no_memory() -> Result<(), Error> {
    let map =
        Costmap::new(vec![0.5; 100 * 100], [100, 100], GridPlacement::new([0.1; 2], [-5.0; 2], 0.0)?, Some(0.9), None)?;
    let limits = Limits {
        speed: 1.0,
        yaw_rate: 1.0,
        acceleration: 2.0,
        wheel_speed: 8.0,
        steering_rate: 1.0,
        ..Limits::default()
    };
    let path = [[0.0, 0.0], [1.0, 0.5], [3.0, 0.5]];
    let before = TAKEN.load(Ordering::Relaxed);
    let counts = vec![0.0; 100];
    assert_eq!(TAKEN.load(Ordering::Relaxed) - before, 8 * counts.len());
    for rover in rovers()? {
        for (precision, threads, record) in
            [(Precision::Double, 1, false), (Precision::Single, 1, true), (Precision::Double, 3, true)]
        {
            let options = Options { samples: 1000, horizon: 30, precision, ..Options::default() };
            let extra = vec![0.1; options.samples];
            let mut planner = Mppi::new(&rover, limits, options)?;
            let workers = Workers { level: Level::best(), threads, ..Workers::PLAIN };
            let mut cycle = |k: usize| -> Result<(), Error> {
                let situation = CycleInput {
                    pose: [0.05 * k as f64, 0.0, 0.1],
                    twist: [0.5, 0.0, 0.0],
                    costmap: Some(&map),
                    path: Some(&path),
                    record,
                    ..CycleInput::default()
                };
                planner.start_cycle(situation, workers)?;
                planner.finish_cycle(Some(&extra), workers).map(|_| ())
            };
            cycle(0)?;
            let before = TAKEN.load(Ordering::Relaxed);
            for k in 1..6 {
                cycle(k)?;
            }
            let taken = TAKEN.load(Ordering::Relaxed) - before;
            assert_eq!(taken, 0, "{precision:?}, {threads} threads");
        }
    }
    Ok(())
}
