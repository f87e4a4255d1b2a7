//! Any samples, commands and poses from outside: no panic, finite poses, no negative variance, and nothing changes on failure.

use six_wheel_kinematics::geometry::Pose;
use six_wheel_odometry::{Odometry, Readings, Sample, Settings};

use super::bytes::Bytes;

/// One input.
pub fn one(data: &[u8]) {
    let mut bytes = Bytes(data);
    let Some(rover) = bytes.rover() else { return };
    let (joints, wheels) = (rover.steered().len(), rover.wheels().len());
    let mut settings = Settings {
        readings: [Readings::Angles, Readings::Speeds, Readings::Increments][usize::from(bytes.byte() % 3)],
        lag: f64::from(bytes.byte() % 3),
        history: usize::from(bytes.byte()),
        inflate: bytes.byte() % 2 == 0,
        ..Settings::default()
    };
    settings.noise.slip = f64::from(bytes.byte() % 2) * 0.02;
    let Ok(mut odometry) = Odometry::new(rover, settings) else {
        return;
    };
    let mut stamp = 0.0;
    while bytes.any() {
        let before = (odometry.pose(), odometry.stamp());
        let kind = bytes.byte();
        stamp += if kind & 128 == 0 { 0.1 } else { bytes.number() };
        let result = match kind % 8 {
            0 => odometry.command([bytes.number(), bytes.number(), bytes.number()].into(), stamp).map(|_| ()),
            1 => odometry.correct(
                Pose::from([bytes.number(), bytes.number(), bytes.number()]),
                stamp,
                [[bytes.number().abs(), 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            ),
            2 => odometry.set_pose(Pose::from([bytes.number(), 0.0, bytes.number()]), [[0.0; 3]; 3]),
            _ => {
                let (steering, turned) = (bytes.numbers(joints), bytes.numbers(wheels));
                let sample = Sample {
                    steering: &steering,
                    wheels: &turned,
                    stamp,
                    yaw: (kind % 8 == 3).then(|| bytes.number()),
                    yaw_rate: (kind % 8 == 4).then(|| bytes.number()),
                };
                odometry.update(sample).map(|_| ())
            }
        };
        if result.is_err() {
            assert_eq!(before, (odometry.pose(), odometry.stamp()));
        }
        let covariance = odometry.covariance();
        assert!((0..3).all(|i| covariance[i][i] >= 0.0), "{covariance:?}");
        assert!(<[f64; 3]>::from(odometry.pose()).iter().all(|value| value.is_finite()));
        let twist = odometry.twist_covariance();
        assert!((0..3).all(|i| twist[i][i] >= 0.0), "{twist:?} of {odometry:?}");
    }
}
