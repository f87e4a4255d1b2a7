//! The chain of frames: dimensions, the Denavit-Hartenberg table they make, and where joint angles put it.

use nalgebra::{IsometryMatrix3, Matrix3, Point3, Rotation3, Translation3, Vector3};

use crate::error::{Error, finite, number, positive};
use crate::steering::SteeringRange;
use crate::wheels::Direction;

/// Number of frames of the chain.
pub const FRAMES: usize = 15;

/// Largest number of joints: rocker, two bogies, four steered wheels.
pub const MAX_JOINTS: usize = 7;

// Indices of frames: where a chain continues.
const D: usize = 0;
const B1: usize = 1;
const B2: usize = 2;
const S1: usize = 3;
const A1: usize = 9;

// Indices of joints, with the sense in which they turn a frame.
const RHO: Turn = Some((0, 1.0));
const MINUS_RHO: Turn = Some((0, -1.0));
const BETA_1: Turn = Some((1, 1.0));
const BETA_2: Turn = Some((2, 1.0));
/// Index of the first steering joint.
pub(super) const FIRST_PSI: usize = 3;

// The angles alpha of the chain: exactly a quarter turn down, none, a quarter turn up.
const DOWN: Direction = Direction {
    sin: -1.0,
    cos: 0.0,
};
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
    /// `parent_from_frame` at these joint angles.
    fn parent_from_frame(&self, joints: &[f64]) -> IsometryMatrix3<f64> {
        let turned = self.joint.map_or(0.0, |(joint, sign)| sign * joints[joint]);
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

/// Which wheels steer; the middle ones never do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steered {
    /// The front pair.
    Front,
    /// The front and the rear pair.
    Corners,
}

impl Steered {
    /// Indices of the steered wheels.
    pub fn wheels(self) -> &'static [usize] {
        match self {
            Self::Front => &[0, 1],
            Self::Corners => &[0, 1, 4, 5],
        }
    }

    /// The name by which [`str::parse`] finds it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Front => "front",
            Self::Corners => "corners",
        }
    }
}

impl std::str::FromStr for Steered {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        let found = [Self::Front, Self::Corners]
            .into_iter()
            .find(|steered| steered.name() == name);
        found.ok_or_else(|| Error::value("steered", "be 'front' or 'corners'", format!("{name:?}")))
    }
}

/// The left-hand side of a suspension at joint angles 0, in the axes of the rover; the right mirrors it.
///
/// Vectors `[x, y, z]` [m]. A wheel's vector ends at its centre, on its steering axis if it has one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dimensions {
    /// Origin of the rover's frame R to the axis of the rocker.
    pub rocker_pivot: [f64; 3],
    /// Axis of the rocker to the front wheel.
    pub rocker_to_front: [f64; 3],
    /// Axis of the rocker to the axis of the bogie.
    pub rocker_to_bogie: [f64; 3],
    /// Axis of the bogie to the middle wheel.
    pub bogie_to_middle: [f64; 3],
    /// Axis of the bogie to the rear wheel.
    pub bogie_to_rear: [f64; 3],
    /// Hub to ground.
    pub wheel_radius: f64,
    /// Which wheels steer.
    pub steered: Steered,
    /// How far they do.
    pub steering: SteeringRange,
}

impl Dimensions {
    /// Fails unless every number is finite and the left wheels are on the left.
    pub(super) fn check(&self) -> Result<(), Error> {
        let vectors = [
            ("rocker_pivot", self.rocker_pivot),
            ("rocker_to_front", self.rocker_to_front),
            ("rocker_to_bogie", self.rocker_to_bogie),
            ("bogie_to_middle", self.bogie_to_middle),
            ("bogie_to_rear", self.bogie_to_rear),
        ];
        for (argument, vector) in &vectors {
            finite(argument, vector)?;
        }
        let reach: f64 = vectors.iter().flat_map(|(_, v)| v).map(|x| x.abs()).sum();
        if !(reach * reach).is_finite() {
            let rule = "reach a finite distance with the vectors after it";
            return Err(Error::value("rocker_pivot", rule, number(reach)));
        }
        positive("wheel_radius", self.wheel_radius)?;
        self.steering.check()?;
        let [pivot, front, bogie, middle, rear] = vectors.map(|(_, [_, y, _])| y);
        let wheels = [
            ("rocker_to_front", pivot + front),
            ("bogie_to_middle", pivot + bogie + middle),
            ("bogie_to_rear", pivot + bogie + rear),
        ];
        for (argument, y) in wheels {
            if y <= 0.0 {
                let rule = "end at a wheel of the left-hand side, y > 0 in all";
                return Err(Error::value(argument, rule, number(y)));
            }
        }
        Ok(())
    }

    /// The chain. Comments give the symbols of Tarokh et al. for Rocky 7.
    pub(super) fn links(&self) -> [Link; FRAMES] {
        let [k2, half_track, k1] = self.rocker_pivot;
        let [k4, y_front, minus_k5] = self.rocker_to_front;
        let [x_bogie, y_bogie, z_bogie] = self.rocker_to_bogie;
        let [x_middle, y_middle, z_middle] = self.bogie_to_middle; // k7, k3b, -k8
        let [x_rear, y_rear, z_rear] = self.bogie_to_rear; // -k7, k3b, -k8
        let (k6, k9) = (x_bogie.hypot(z_bogie), (-z_bogie).atan2(x_bogie));
        let (front, bogie) = (half_track + y_front, half_track + y_bogie); // k3
        let psi = |wheel| -> Turn {
            let mut steered = self.steered.wheels().iter();
            let place = steered.position(|&other| other == wheel)?;
            Some((FIRST_PSI + place, 1.0))
        };
        let rows = [
            ("D", None, None, 0.0, k1, k2, DOWN),
            ("B1", Some(D), RHO, k9, bogie, k6, LEVEL),
            ("B2", Some(D), MINUS_RHO, k9, -bogie, k6, LEVEL),
            ("S1", Some(D), RHO, 0.0, front, k4, UP),
            ("S2", Some(D), MINUS_RHO, 0.0, -front, k4, UP),
            ("S3", Some(B1), BETA_1, -k9, y_middle, x_middle, UP),
            ("S4", Some(B2), BETA_2, -k9, -y_middle, x_middle, UP),
            ("S5", Some(B1), BETA_1, -k9, y_rear, x_rear, UP),
            ("S6", Some(B2), BETA_2, -k9, -y_rear, x_rear, UP),
            ("A1", Some(S1), psi(0), 0.0, minus_k5, 0.0, LEVEL),
            ("A2", Some(S1 + 1), psi(1), 0.0, minus_k5, 0.0, LEVEL),
            ("A3", Some(S1 + 2), psi(2), 0.0, z_middle, 0.0, LEVEL),
            ("A4", Some(S1 + 3), psi(3), 0.0, z_middle, 0.0, LEVEL),
            ("A5", Some(S1 + 4), psi(4), 0.0, z_rear, 0.0, LEVEL),
            ("A6", Some(S1 + 5), psi(5), 0.0, z_rear, 0.0, LEVEL),
        ];
        rows.map(|(frame, parent, joint, gamma, d, a, alpha)| Link {
            frame,
            parent,
            joint,
            gamma,
            d,
            a,
            alpha,
        })
    }
}

/// Where the joints put every frame.
#[derive(Clone, Debug)]
pub struct Posture<'a> {
    links: &'a [Link; FRAMES],
    frames: [IsometryMatrix3<f64>; FRAMES],
}

impl<'a> Posture<'a> {
    /// Composes the chain at finite joint angles.
    pub(super) fn new(links: &'a [Link; FRAMES], joints: &[f64]) -> Self {
        let mut frames = [IsometryMatrix3::identity(); FRAMES];
        for (k, link) in links.iter().enumerate() {
            let local = link.parent_from_frame(joints);
            frames[k] = link.parent.map_or(local, |parent| frames[parent] * local);
        }
        Self { links, frames }
    }

    /// `rover_from_frame` of every frame, in the order of the table.
    pub fn frames(&self) -> &[IsometryMatrix3<f64>; FRAMES] {
        &self.frames
    }

    /// `rover_from_wheel`: origin in the wheel's centre, x where it rolls, y along its axle.
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
        let links = std::iter::successors(Some(&self.links[A1 + wheel]), |link| {
            link.parent.map(|parent| &self.links[parent])
        });
        links.filter_map(|link| {
            let (joint, sign) = link.joint?;
            let parent = &self.frames[link.parent?];
            let axis = parent.rotation * Vector3::z() * sign;
            Some((joint, axis, Point3::from(parent.translation.vector)))
        })
    }

    /// Derivative of a wheel's centre in the rover's frame by every joint angle [m/rad].
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

    use super::*;

    #[test]
    fn axes_move_the_points_and_directions_of_a_wheel() -> Result<(), Error> {
        let rover = RockerBogie::perseverance()?;
        let joints = [0.2, -0.3, 0.1, 0.4, -0.5, 0.6, -0.7];
        let (step, posture) = (1e-5, rover.posture(&joints)?);
        let rim = Point3::new(0.1, 0.05, -0.2);
        for wheel in 0..6 {
            let (mut point, mut axle) = ([Vector3::zeros(); 7], [Vector3::zeros(); 7]);
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
