//! The same bits on every level, alone and in a log.

use six_wheel_kinematics::rover::Rover;
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::level::Level;
use six_wheel_odometry::{Gyroscope, LogOdometry, Noise, Odometry, Recording, Sample, Settings, TrackRows};

/// Readings of a drive in which nothing has to be checked, with a step that turns far.
struct Drive {
    steering: Vec<f64>,
    wheels: Vec<f64>,
    stamps: Vec<f64>,
    rates: Vec<f64>,
}

const ROWS: usize = 40;

impl Drive {
    fn new(rover: &Rover) -> Self {
        let (joints, wheels) = (rover.steered().len(), rover.wheels().len());
        let number = |k: usize, i: usize| (1.0 + (k * 31 + i * 17) as f64).sin();
        let far = |k: usize| if k > 20 { 2.0 } else { 0.0 };
        let each = |count: usize, size: f64| {
            (0..ROWS)
                .flat_map(move |k| (0..count).map(move |i| far(k) + size * k as f64 + 0.1 * number(k, i)))
                .collect()
        };
        Self {
            steering: each(joints, 0.01),
            wheels: each(wheels, 0.5),
            stamps: (0..ROWS).map(|k| 0.1 * k as f64).collect(),
            rates: (0..ROWS).map(|k| 0.2 * number(k, 5)).collect(),
        }
    }

    fn recording(&self) -> Recording<'_> {
        Recording {
            steering: &self.steering,
            wheels: &self.wheels,
            stamps: &self.stamps,
            yaws: None,
            yaw_rates: Some(&self.rates),
        }
    }
}

fn numbers(odometry: &Odometry) -> Vec<u64> {
    let [covariance, twist] = [odometry.covariance(), odometry.twist_covariance()];
    let all = <[f64; 3]>::from(odometry.pose()).into_iter().chain(<[f64; 3]>::from(odometry.twist()));
    let all = all.chain(covariance.into_iter().flatten()).chain(twist.into_iter().flatten());
    all.chain(odometry.residual().iter().copied()).map(f64::to_bits).collect()
}

#[test]
fn every_level_has_the_same_bits() -> Result<(), Error> {
    let around: Vec<[f64; 2]> = (0..11_i32).map(|k| [f64::from(k).cos() + 0.3, f64::from(k).sin()]).collect();
    let rovers = [
        Rover::six_wheel([0.4, 0.5, 0.5, 0.45], 0.15, SteeringRange::default())?,
        Rover::mecanum(0.3, 0.2, 0.1, 0.8)?,
        Rover::swerve(&around, None, 0.1, SteeringRange::symmetric(3.2)?)?,
    ];
    let settings = Settings {
        noise: Noise { slip: 0.02, side_slip: 0.01, ..Noise::READINGS },
        gyroscope: Some(Gyroscope::default()),
        ..Settings::default()
    };
    for rover in rovers {
        let drive = Drive::new(&rover);
        let recording = drive.recording();
        let (wheels, joints) = (rover.wheels().len(), rover.steered().len());
        let fresh = Odometry::new(rover, settings.clone())?;
        let mut best = fresh.clone();
        for k in 0..ROWS {
            best.update(recording.row(wheels, joints, k))?;
        }
        let levels = Level::available();
        for level in levels.iter().copied().filter(|level| level.lanes() <= 4) {
            let mut other = fresh.clone();
            other.set_level(level);
            for k in 0..ROWS {
                other.update(recording.row(wheels, joints, k))?;
            }
            assert_eq!(numbers(&best), numbers(&other), "{}", level.name());
        }
        for level in levels {
            let mut log = fresh.clone();
            let first: Sample<'_> = recording.row(wheels, joints, 0);
            log.update(first)?;
            let (mut poses, mut twists, mut health) = ([[0.0; 3]; ROWS], [[0.0; 3]; ROWS], [0; ROWS]);
            let mut track = TrackRows {
                poses: &mut poses,
                twists: &mut twists,
                covariances: None,
                residuals: None,
                weights: None,
                health: &mut health,
            };
            let mut blocks = log.blocks().ok_or_else(|| Error::value("memory", "be there", "none"))?;
            blocks.0.level = level;
            let count = log.update_block(&recording, 1, &mut blocks, &mut track);
            assert_eq!(count, ROWS - 1, "{}", level.name());
            assert_eq!(numbers(&best), numbers(&log), "{}", level.name());
        }
    }
    Ok(())
}
