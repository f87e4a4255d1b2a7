//! The chain of frames: the Denavit-Hartenberg table that dimensions make, and where joint angles put it.

use nalgebra::{IsometryMatrix3, Matrix3, Point3, Rotation3, Translation3, Vector3};

use super::dimensions::Dimensions;
use six_wheel_kinematics::geometry::Direction;

/// Number of frames of the chain.
pub const FRAMES: usize = 15;

/// Largest number of joints: rocker, two bogies, six steered wheels.
pub const MAX_JOINTS: usize = 9;

// Indices of frames: where a chain continues.
const D: usize = 0;
const B1: usize = 1;
const B2: usize = 2;
const S1: usize = 3;
const A1: usize = 9;

const MOUNTS: [&str; 6] = ["S1", "S2", "S3", "S4", "S5", "S6"];
const AXLES: [&str; 6] = ["A1", "A2", "A3", "A4", "A5", "A6"];

// Indices of joints, with the sense in which they turn a frame.
const RHO: Turn = Some((0, 1.0));
const MINUS_RHO: Turn = Some((0, -1.0));
const BETA_1: Turn = Some((1, 1.0));
const BETA_2: Turn = Some((2, 1.0));
/// Index of the first steering joint.
pub(super) const FIRST_PSI: usize = 3;

// The angles alpha of the chain: exactly a quarter turn down, none, a quarter turn up.
const DOWN: Direction = Direction { sin: -1.0, cos: 0.0 };
const LEVEL: Direction = Direction { sin: 0.0, cos: 1.0 };
const UP: Direction = Direction { sin: 1.0, cos: 0.0 };

/// The joint whose angle is added to a link's gamma, and the sign with which it is.
pub type Turn = Option<(usize, f64)>;

/// One row of the table: `Rotz(gamma + joint) Transz(d) Transx(a) Rotx(alpha)` from the parent.
#[derive(Clone, Copy, Debug)]
pub struct Link {
    /// Name of the frame: D, B1, B2, S1 to S6, A1 to A6; odd left, even right.
    pub frame: &'static str,
    /// Index of the frame it starts from; `None` is the rover's own, R.
    pub parent: Option<usize>,
    /// The joint that turns it.
    pub joint: Turn,
    /// Angle about the parent's z axis at joint angle 0 [rad].
    pub gamma: f64,
    /// Shift along the parent's z axis [m].
    pub d: f64,
    /// Shift along the new x axis [m].
    pub a: f64,
    /// Angle about the new x axis.
    pub alpha: Direction,
}

impl Link {
    /// `parent_from_frame` at these joint angles and this one of the right rocker.
    fn parent_from_frame(&self, joints: &[f64], right: f64) -> IsometryMatrix3<f64> {
        let turned = match self.joint {
            None => 0.0,
            MINUS_RHO => right,
            Some((joint, _)) => joints[joint],
        };
        let gamma = Direction::from(self.gamma + turned);
        let (alpha, a) = (self.alpha, self.a);
        let rotation = Matrix3::new(
            gamma.cos,
            -gamma.sin * alpha.cos,
            gamma.sin * alpha.sin,
            gamma.sin,
            gamma.cos * alpha.cos,
            -gamma.cos * alpha.sin,
            0.0,
            alpha.sin,
            alpha.cos,
        );
        IsometryMatrix3::from_parts(
            Translation3::new(a * gamma.cos, a * gamma.sin, self.d),
            Rotation3::from_matrix_unchecked(rotation),
        )
    }
}

impl Dimensions {
    /// The chain. Comments give the symbols of Tarokh et al. for Rocky 7.
    pub(super) fn links(&self) -> [Link; FRAMES] {
        let [k2, half_track, k1] = self.rocker_pivot;
        let [x_bogie, y_bogie, z_bogie] = self.rocker_to_bogie;
        let (k6, k9) = (x_bogie.hypot(z_bogie), (-z_bogie).atan2(x_bogie));
        let bogie = half_track + y_bogie; // k3
        let psi = |wheel| -> Turn {
            let mut steered = self.steered.wheels().iter();
            let place = steered.position(|&other| other == wheel)?;
            Some((FIRST_PSI + place, 1.0))
        };
        let row = |frame, parent, joint, gamma, d, a, alpha| Link { frame, parent, joint, gamma, d, a, alpha };
        let mut rows = [row("D", None, None, 0.0, k1, k2, DOWN); FRAMES];
        rows[B1] = row("B1", Some(D), RHO, k9, bogie, k6, LEVEL);
        rows[B2] = row("B2", Some(D), MINUS_RHO, k9, -bogie, k6, LEVEL);
        for wheel in 0..6 {
            let (pair, left) = (wheel / 2, wheel % 2 == 0);
            // k4, 0, -k5 in front; k7, k3b, -k8 and -k7, k3b, -k8 on the bogie
            let [x, y, z] = self.to_wheel(pair);
            let side = if left { 1.0 } else { -1.0 };
            let (mount, axle) = (MOUNTS[wheel], AXLES[wheel]);
            rows[S1 + wheel] = if self.bogie.carries(pair) {
                let (parent, beta) = if left { (B1, BETA_1) } else { (B2, BETA_2) };
                row(mount, Some(parent), beta, -k9, side * y, x, UP)
            } else {
                let rho = if left { RHO } else { MINUS_RHO };
                row(mount, Some(D), rho, 0.0, side * (half_track + y), x, UP)
            };
            rows[A1 + wheel] = row(axle, Some(S1 + wheel), psi(wheel), 0.0, z, 0.0, LEVEL);
        }
        rows
    }
}

/// Poses of all frames at some joint angles.
#[derive(Clone, Debug)]
pub struct Posture<'a> {
    links: &'a [Link; FRAMES],
    frames: [IsometryMatrix3<f64>; FRAMES],
    /// Derivative of the right rocker's angle by rho.
    right: f64,
}

impl<'a> Posture<'a> {
    /// Composes the chain at finite joint angles and this one of the right rocker, with its derivative by rho.
    pub(super) fn new(links: &'a [Link; FRAMES], joints: &[f64], right: [f64; 2]) -> Self {
        let mut frames = [IsometryMatrix3::identity(); FRAMES];
        for (k, link) in links.iter().enumerate() {
            let local = link.parent_from_frame(joints, right[0]);
            frames[k] = link.parent.map_or(local, |parent| frames[parent] * local);
        }
        Self { links, frames, right: right[1] }
    }

    /// `rover_from_frame` of every frame, in the order of the table.
    pub fn frames(&self) -> &[IsometryMatrix3<f64>; FRAMES] {
        &self.frames
    }

    /// `rover_from_wheel`: origin in the wheel's centre, x where it rolls, y along its axle.
    #[inline]
    pub fn wheel(&self, wheel: usize) -> &IsometryMatrix3<f64> {
        &self.frames[A1 + wheel]
    }

    /// Centre of a wheel in the rover's frame [m].
    pub fn wheel_centre(&self, wheel: usize) -> Point3<f64> {
        Point3::from(self.wheel(wheel).translation.vector)
    }

    /// The joints between the rover and a wheel, outermost first: index, axis in the sense of the joint
    /// angle, and a point of the axis, in the rover's frame. A direction fixed to the wheel changes with the
    /// angle by `axis x direction`, a point by `axis x (point - origin)`.
    pub fn axes(&self, wheel: usize) -> impl Iterator<Item = (usize, Vector3<f64>, Point3<f64>)> {
        let links =
            std::iter::successors(Some(&self.links[A1 + wheel]), |link| link.parent.map(|parent| &self.links[parent]));
        links.filter_map(|link| {
            let (joint, _) = link.joint?;
            let sign = if link.joint == MINUS_RHO { self.right } else { 1.0 };
            let parent = &self.frames[link.parent?];
            let axis = parent.rotation * Vector3::z() * sign;
            Some((joint, axis, Point3::from(parent.translation.vector)))
        })
    }

    /// Derivative of a wheel's centre in the rover's frame by every joint angle [m/rad].
    #[inline]
    pub fn jacobian(&self, wheel: usize) -> [Vector3<f64>; MAX_JOINTS] {
        let centre = self.wheel_centre(wheel);
        let mut columns = [Vector3::zeros(); MAX_JOINTS];
        for (joint, axis, origin) in self.axes(wheel) {
            columns[joint] += axis.cross(&(centre - origin));
        }
        columns
    }
}

#[cfg(test)]
mod tests {
    use crate::suspension::RockerBogie;
    use six_wheel_numerics::error::Error;

    use super::*;

    #[test]
    fn axes_move_the_points_and_directions_of_a_wheel() -> Result<(), Error> {
        let rover = RockerBogie::perseverance()?;
        let joints = [0.2, -0.3, 0.1, 0.4, -0.5, 0.6, -0.7];
        let (step, posture) = (1e-5, rover.posture(&joints)?);
        let rim = Point3::new(0.1, 0.05, -0.2);
        for wheel in 0..6 {
            let (mut point, mut axle) = ([Vector3::zeros(); MAX_JOINTS], [Vector3::zeros(); MAX_JOINTS]);
            for (joint, axis, origin) in posture.axes(wheel) {
                point[joint] += axis.cross(&(posture.wheel(wheel) * rim - origin));
                axle[joint] += axis.cross(&(posture.wheel(wheel) * Vector3::y()));
            }
            for joint in 0..7 {
                let moved = |step| {
                    let mut joints = joints;
                    joints[joint] += step;
                    rover.posture(&joints).map(|posture| *posture.wheel(wheel))
                };
                let (ahead, behind) = (moved(step)?, moved(-step)?);
                let slope = (ahead * rim - behind * rim) / (2.0 * step);
                // Truncation, arm step^2 / 6, and rounding, eps arm / step: 6e-11 together.
                assert!((point[joint] - slope).amax() < 5e-10, "{wheel} {joint}");
                let slope = (ahead * Vector3::y() - behind * Vector3::y()) / (2.0 * step);
                assert!((axle[joint] - slope).amax() < 5e-10, "{wheel} {joint}");
            }
        }
        Ok(())
    }

    #[test]
    fn the_number_of_joints_is_checked() -> Result<(), Error> {
        let rover = RockerBogie::rocky7()?;
        let Err(error) = rover.posture(&[0.0; 4]) else {
            return Err(Error::value("joints", "be refused", "4"));
        };
        assert_eq!(error.to_string(), "joints must hold 5 angles, got 4");
        Ok(())
    }
}
