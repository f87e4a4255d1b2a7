//! A chain in the world, at one pose: frames of its parts and wheels, and derivatives of their points.

use nalgebra::{Matrix3, Vector3};
use pulp::Scalar;

use super::chain::{Chain, MAX_FREE, MAX_PARTS, MAX_STATE, MAX_WHEELS, PlanPose, State, Turning};
use super::kinematics::{JointAngles, MatrixPose, WorldPoses};
use super::lanes::{Turned, Vectors, all};
use six_wheel_kinematics::geometry::Direction;
use six_wheel_numerics::simd::level::run_scalar;

impl Chain {
    /// The chain at a pose, a state and steering angles (0 if there are none). None where a differential has no
    /// solution.
    #[inline]
    pub fn place(&self, pose: PlanPose, state: &State, steering: &[f64]) -> Option<Placed<'_>> {
        let part = PlacedPart { rotation: Matrix3::identity(), origin: Vector3::zeros(), axis: Vector3::zeros() };
        let mut placed = Placed {
            chain: self,
            pose,
            state: *state,
            origin: part.origin,
            rotation: part.rotation,
            roll_axis: part.axis,
            pitch_axis: part.axis,
            parts: [part; MAX_PARTS],
        };
        placed.put(pose, state, steering).map(|()| placed)
    }
}

/// The pose of a part in world axes.
#[derive(Clone, Copy, Debug)]
struct PlacedPart {
    rotation: Matrix3<f64>,
    origin: Vector3<f64>,
    /// Its axis times the derivative of its angle by the joint that turns it.
    axis: Vector3<f64>,
}

/// A chain in the world.
#[derive(Clone, Debug)]
pub struct Placed<'a> {
    chain: &'a Chain,
    pose: PlanPose,
    state: State,
    /// Origin of the body in the world [m].
    pub origin: Vector3<f64>,
    /// `world_from_body`.
    pub rotation: Matrix3<f64>,
    /// Axis of roll.
    pub roll_axis: Vector3<f64>,
    /// Axis of pitch.
    pub pitch_axis: Vector3<f64>,
    parts: [PlacedPart; MAX_PARTS],
}

/// A wheel in the world: a circle with `centre + radius (forward sin t - up cos t)`, t its contact angle.
#[derive(Clone, Copy, Debug)]
pub struct WheelFrame {
    /// Its centre [m].
    pub centre: Vector3<f64>,
    /// Unit vector in which it rolls.
    pub forward: Vector3<f64>,
    /// Unit vector of its axle, to the left.
    pub axle: Vector3<f64>,
    /// Unit vector of its steering axis, upwards.
    pub up: Vector3<f64>,
}

impl WheelFrame {
    /// Unit vector from the centre to the rim at a contact angle.
    #[inline]
    pub fn spoke(&self, at: Direction) -> Vector3<f64> {
        self.forward * at.sin - self.up * at.cos
    }

    /// Unit vector along the rim there: the derivative of the spoke by the angle.
    #[inline]
    pub fn tangent(&self, at: Direction) -> Vector3<f64> {
        self.forward * at.cos + self.up * at.sin
    }
}

/// Derivatives of a point by x, y, yaw, z, roll, pitch and the free angles.
pub type PointSlopes = [Vector3<f64>; 3 + MAX_STATE];

impl Placed<'_> {
    /// [`Chain::place`] in this memory.
    pub fn put(&mut self, pose: PlanPose, state: &State, steering: &[f64]) -> Option<()> {
        (self.pose, self.state) = (pose, *state);
        self.origin = Vector3::new(pose.x, pose.y, state[0]);
        run_scalar(place_links, (self, steering))
    }

    /// Sets the steering angles and the free angles, with the body at its pose. None where a differential has no
    /// solution.
    pub fn steer(&mut self, joints: &[f64], steering: &[f64]) -> Option<()> {
        let (pose, mut state) = (self.pose, self.state);
        state[3..].iter_mut().zip(joints).for_each(|(angle, joint)| *angle = *joint);
        self.put(pose, &state, steering)
    }

    fn carrier(&self, part: Option<usize>) -> (Matrix3<f64>, Vector3<f64>) {
        part.map_or((self.rotation, self.origin), |part| (self.parts[part].rotation, self.parts[part].origin))
    }

    /// A wheel.
    pub fn wheel(&self, wheel: usize) -> WheelFrame {
        let mount = &self.chain.wheels()[wheel];
        let (rotation, origin) = self.carrier(mount.part);
        WheelFrame {
            centre: origin + rotation * mount.centre,
            forward: rotation.column(0).into(),
            axle: rotation.column(1).into(),
            up: rotation.column(2).into(),
        }
    }

    /// Rotation and origin of a part.
    #[inline]
    pub fn part(&self, part: usize) -> (Matrix3<f64>, Vector3<f64>) {
        self.carrier(Some(part))
    }

    /// Derivatives of a point that is fixed to a wheel's carrier by x, y, yaw, z, roll, pitch and the free angles, at
    /// constant steering angles.
    pub fn point_slopes(&self, wheel: usize, point: Vector3<f64>) -> PointSlopes {
        let arm = point - self.origin;
        let mut slopes = [Vector3::zeros(); 3 + MAX_STATE];
        slopes[0] = Vector3::x();
        slopes[1] = Vector3::y();
        slopes[2] = Vector3::new(-arm.y, arm.x, 0.0);
        slopes[3] = Vector3::z();
        slopes[4] = self.roll_axis.cross(&arm);
        slopes[5] = self.pitch_axis.cross(&arm);
        for (joint, axis, origin) in self.free_axes(wheel) {
            slopes[6 + joint] += axis.cross(&(point - origin));
        }
        slopes
    }

    /// Derivatives of a point fixed to the body by z, roll and pitch.
    pub fn body_slopes(&self, point: Vector3<f64>) -> [Vector3<f64>; 3] {
        let arm = point - self.origin;
        [Vector3::z(), self.roll_axis.cross(&arm), self.pitch_axis.cross(&arm)]
    }

    /// The free angles between the body and a wheel: index, axis times the derivative of the part's angle by the
    /// free one, and a point of the axis, in world axes.
    pub fn free_axes(&self, wheel: usize) -> impl Iterator<Item = (usize, Vector3<f64>, Vector3<f64>)> {
        self.turning_axes(wheel).filter_map(|(turning, axis, origin)| match turning {
            Turning::Free(joint) | Turning::Across(joint, _) => Some((joint, axis, origin)),
            Turning::Steering(_) => None,
        })
    }

    /// The same for the steering angles.
    pub fn steering_axes(&self, wheel: usize) -> impl Iterator<Item = (usize, Vector3<f64>, Vector3<f64>)> {
        self.turning_axes(wheel).filter_map(|(turning, axis, origin)| match turning {
            Turning::Steering(joint) => Some((joint, axis, origin)),
            _ => None,
        })
    }

    fn turning_axes(&self, wheel: usize) -> impl Iterator<Item = (Turning, Vector3<f64>, Vector3<f64>)> {
        self.chain.carriers(wheel).map(|part| {
            let placed = &self.parts[part];
            let turning = self.chain.parts()[part].turning;
            (turning, placed.axis, placed.origin)
        })
    }
}

/// Sine and cosine of an angle [rad] of any size.
#[inline(always)]
fn turned(angle: f64) -> Turned<Scalar> {
    let (sin, cos) = if angle == 0.0 { (0.0, 1.0) } else { angle.sin_cos() };
    (all(Scalar, sin), all(Scalar, cos))
}

#[inline(always)]
fn vector([x, y, z]: Vectors<Scalar>) -> Vector3<f64> {
    Vector3::new(x.last(Scalar), y.last(Scalar), z.last(Scalar))
}

#[inline(always)]
fn matrix([x, y, z]: [Vectors<Scalar>; 3]) -> Matrix3<f64> {
    Matrix3::from_columns(&[vector(x), vector(y), vector(z)])
}

/// Places the links of a chain whose body is at its pose; missing steering angles are 0.
#[inline(always)]
fn place_links((placed, steering): (&mut Placed<'_>, &[f64])) -> Option<()> {
    let [_, roll, pitch, joints @ ..] = placed.state;
    let mut steered = [turned(0.0); MAX_WHEELS];
    for (to, angle) in steered.iter_mut().zip(steering) {
        *to = turned(*angle);
    }
    let mut angles =
        JointAngles { angles: [all(Scalar, 0.0); MAX_FREE], free: [turned(0.0); MAX_FREE], steering: Some(&steered) };
    for (k, angle) in joints.into_iter().enumerate() {
        (angles.angles[k], angles.free[k]) = (all(Scalar, angle), turned(angle));
    }
    let attitude = [turned(placed.pose.yaw), turned(pitch), turned(roll)];
    let poses = WorldPoses::new(Scalar, placed.chain, attitude, &angles);
    placed.rotation = matrix(poses.links.body.columns);
    placed.roll_axis = vector(poses.roll_axis);
    placed.pitch_axis = vector(poses.pitch_axis);
    for k in 0..placed.chain.parts().len() {
        let MatrixPose { columns, origin, axis } = poses.links.links[k];
        placed.parts[k] =
            PlacedPart { rotation: matrix(columns), origin: placed.origin + vector(origin), axis: vector(axis) };
    }
    poses.links.reaches.any().then_some(())
}
