//! Readings of one instant of a rover on ground, and its attitude.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use six_wheel_numerics::error::{Error, finite, numbers, radians};
use six_wheel_terrain::suspension::{MAX_FREE, MAX_WHEELS};

/// Largest deviation of a quaternion's length from 1 that counts as rounding.
const UNIT: f64 = 1e-2;

/// Roll or pitch beyond which a rover counts as overturned [rad].
pub const OVERTURNED: f64 = 1.4;

/// Attitude of the body by an IMU: `Rz(yaw) Ry(pitch) Rx(roll)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attitude {
    /// Positive with the right side down [rad].
    pub roll: f64,
    /// Positive with the nose down [rad].
    pub pitch: f64,
    /// Against a zero of the sensor [rad]; None where it was not measured.
    pub yaw: Option<f64>,
}

impl Attitude {
    /// From angles. Fails unless they are finite.
    pub fn from_angles(roll: f64, pitch: f64, yaw: Option<f64>) -> Result<Self, Error> {
        finite("attitude", &[roll, pitch, yaw.unwrap_or(0.0)])?;
        let half = UnitQuaternion::from_euler_angles(roll, pitch, 0.0);
        // Angles beyond a quarter turn are replaced by equivalent ones of the same rotation.
        let (roll, pitch, turn) = match roll.abs() <= OVERTURNED && pitch.abs() <= OVERTURNED {
            true => (roll, pitch, 0.0),
            false => half.euler_angles(),
        };
        Ok(Self { roll, pitch, yaw: yaw.map(|yaw| yaw + turn) })
    }

    /// From a quaternion x, y, z, w. Fails unless its length is 1 up to rounding.
    pub fn from_quaternion(parts: [f64; 4]) -> Result<Self, Error> {
        finite("attitude", &parts)?;
        let [x, y, z, w] = parts;
        let quaternion = Quaternion::new(w, x, y, z);
        if (quaternion.norm() - 1.0).abs() > UNIT {
            let rule = "be a quaternion x, y, z, w of length 1";
            return Err(Error::value("attitude", rule, numbers(&parts)));
        }
        let (roll, pitch, yaw) = UnitQuaternion::new_normalize(quaternion).euler_angles();
        Ok(Self { roll, pitch, yaw: Some(yaw) })
    }

    /// Fails if roll or pitch is beyond [`OVERTURNED`].
    pub fn check_upright(&self) -> Result<(), Error> {
        let tilt = (self.roll.cos() * self.pitch.cos()).acos();
        if tilt <= OVERTURNED {
            return Ok(());
        }
        let rule = format!("be upright, tilted by {OVERTURNED} rad at most");
        Err(Error::value("attitude", rule, format!("a tilt of {}", radians(tilt))))
    }

    /// `Ry(pitch) Rx(roll)`.
    pub fn tilt(&self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_euler_angles(self.roll, self.pitch, 0.0)
    }
}

/// Axes in the world of the rotations by roll and by pitch, at this yaw and pitch.
pub(crate) fn tilting_axes(yaw: f64, pitch: f64) -> [Vector3<f64>; 2] {
    let (sin, cos) = yaw.sin_cos();
    let ahead = Vector3::new(cos * pitch.cos(), sin * pitch.cos(), -pitch.sin());
    [ahead, Vector3::new(-sin, cos, 0.0)]
}

/// Readings of one instant.
#[derive(Clone, Copy, Debug)]
pub struct Sample3<'a> {
    /// Readings of the steering joints, in units of their encoders.
    pub steering: &'a [f64],
    /// Readings of the wheels, in units of their encoders; NaN where one has no encoder.
    pub wheels: &'a [f64],
    /// Time of the readings [s].
    pub stamp: f64,
    /// Free angles of the suspension [rad]; NaN where one was not measured.
    pub joints: Option<&'a [f64]>,
    /// Attitude of the body.
    pub attitude: Option<Attitude>,
    /// Yaw rate of a gyroscope, about the z axis of the body [rad/s].
    pub yaw_rate: Option<f64>,
}

/// Readings of a sample that the state has been updated by.
#[derive(Clone, Copy, Debug)]
pub struct Read {
    /// Time of the readings [s].
    pub stamp: f64,
    /// Readings of the steering joints, in units of their encoders.
    pub steering: [f64; MAX_WHEELS],
    /// Readings of the wheels, in units of their encoders.
    pub wheels: [f64; MAX_WHEELS],
    /// Steering angles, whole turns kept [rad].
    pub angles: [f64; MAX_WHEELS],
    /// Free angles of the suspension [rad]; NaN where one was not measured.
    pub joints: [f64; MAX_FREE],
    pub attitude: Option<Attitude>,
    pub yaw_rate: Option<f64>,
}

impl Read {
    pub const NONE: Self = Self {
        stamp: 0.0,
        steering: [0.0; MAX_WHEELS],
        wheels: [0.0; MAX_WHEELS],
        angles: [0.0; MAX_WHEELS],
        joints: [f64::NAN; MAX_FREE],
        attitude: None,
        yaw_rate: None,
    };

    /// A sample, with the steering angles [rad] that follow from its readings.
    pub fn of(sample: &Sample3<'_>, angles: [f64; MAX_WHEELS]) -> Self {
        let mut read =
            Self { stamp: sample.stamp, angles, attitude: sample.attitude, yaw_rate: sample.yaw_rate, ..Self::NONE };
        read.steering[..sample.steering.len()].copy_from_slice(sample.steering);
        read.wheels[..sample.wheels.len()].copy_from_slice(sample.wheels);
        if let Some(joints) = sample.joints {
            read.joints[..joints.len()].copy_from_slice(joints);
        }
        read
    }
}

/// Columns of a log: one row per sample.
#[derive(Clone, Copy, Debug)]
pub struct Recording3<'a> {
    /// Readings of the steering joints, row after row.
    pub steering: &'a [f64],
    /// Readings of the wheels, row after row.
    pub wheels: &'a [f64],
    /// Times of the readings [s].
    pub stamps: &'a [f64],
    /// Free angles, row after row [rad].
    pub joints: Option<&'a [f64]>,
    /// Attitudes, row after row: two, three or four numbers each.
    pub attitudes: Option<(&'a [f64], usize)>,
    /// Yaw rates [rad/s]; NaN where there was none.
    pub yaw_rates: Option<&'a [f64]>,
}

/// An attitude from two numbers (roll, pitch), three (and yaw, NaN where there is none) or four (a quaternion).
pub fn attitude(numbers: &[f64]) -> Result<Attitude, Error> {
    match *numbers {
        [roll, pitch] => Attitude::from_angles(roll, pitch, None),
        [roll, pitch, yaw] => Attitude::from_angles(roll, pitch, (!yaw.is_nan()).then_some(yaw)),
        [x, y, z, w] => Attitude::from_quaternion([x, y, z, w]),
        _ => {
            let rule = "hold roll and pitch, roll, pitch and yaw, or a quaternion x, y, z, w";
            Err(Error::value("attitude", rule, format!("{} numbers", numbers.len())))
        }
    }
}
