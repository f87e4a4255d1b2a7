//! A chain in the world, at one pose: frames of its parts and wheels, and derivatives of their points.

use nalgebra::{Matrix3, Vector3};

use super::chain::{Chain, MAX_FREE, MAX_PARTS, MAX_STATE, MAX_WHEELS, PlanPose, State, Turning};
use super::kinematics::{JointAngles, MatrixPose, WorldPoses};
use super::lanes::{Turned, Vectors};
use six_wheel_kinematics::geometry::Direction;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::{Kernel, Level};
use six_wheel_numerics::simd::vector::Vector;

impl Chain {
    /// The chain at a pose, a state and steering angles (0 if there are none). None where a differential has no
    /// solution.
    #[inline]
    pub fn place(&self, pose: PlanPose, state: &State, steering: &[f64]) -> Option<Placed<'_>> {
        let mut placed = self.unplaced();
        placed.put(pose, state, steering).map(|()| placed)
    }

    /// Memory for the chain in the world, before [`Placed::put`].
    pub fn unplaced(&self) -> Placed<'_> {
        Placed {
            chain: self,
            pose: PlanPose { x: 0.0, y: 0.0, yaw: 0.0 },
            state: [0.0; MAX_STATE],
            origin: Vector3::zeros(),
            rotation: Matrix3::identity(),
            roll_axis: Vector3::zeros(),
            pitch_axis: Vector3::zeros(),
            parts: [PlacedPart { rotation: Matrix3::identity(), origin: Vector3::zeros(), axis: Vector3::zeros() };
                MAX_PARTS],
        }
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
        let angles = Angles { yaw: pose.yaw, state, steering };
        Level::Scalar.run_any(Put { placed: self, angles })
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

/// The angles of a pose [rad]; missing steering angles are 0.
struct Angles<'a> {
    yaw: f64,
    state: &'a State,
    steering: &'a [f64],
}

/// Sine and cosine of an angle [rad] of any size.
#[inline(always)]
fn turned<S: Vector>(simd: S, angle: f64) -> Turned<S> {
    let (sin, cos) = if angle == 0.0 { (0.0, 1.0) } else { angle.sin_cos() };
    (Lanes::splat(simd, sin), Lanes::splat(simd, cos))
}

#[inline_always]
impl Angles<'_> {
    fn steering<S: Vector>(&self, simd: S) -> [Turned<S>; MAX_WHEELS] {
        let mut steering = [turned(simd, 0.0); MAX_WHEELS];
        for (to, angle) in steering.iter_mut().zip(self.steering) {
            *to = turned(simd, *angle);
        }
        steering
    }

    fn of_joints<'a, S: Vector>(&self, simd: S, steering: &'a [Turned<S>; MAX_WHEELS]) -> JointAngles<'a, S> {
        let mut angles = [Lanes::splat(simd, 0.0); MAX_FREE];
        let mut free = [turned(simd, 0.0); MAX_FREE];
        for (k, angle) in self.state[3..].iter().enumerate() {
            angles[k] = Lanes::splat(simd, *angle);
            free[k] = turned(simd, *angle);
        }
        JointAngles::from_directions(angles, free, steering)
    }
}

/// A vector of one lane.
#[inline(always)]
fn vector<S: Vector>(simd: S, lanes: Vectors<S>) -> Vector3<f64> {
    Vector3::new(lanes[0].last(simd), lanes[1].last(simd), lanes[2].last(simd))
}

/// A rotation of one lane.
#[inline(always)]
fn matrix<S: Vector>(simd: S, columns: &[Vectors<S>; 3]) -> Matrix3<f64> {
    Matrix3::from_columns(&[vector(simd, columns[0]), vector(simd, columns[1]), vector(simd, columns[2])])
}

impl PlacedPart {
    /// A part at a pose from the origin of the body.
    #[inline(always)]
    fn new<S: Vector>(simd: S, pose: &MatrixPose<S>, origin: Vector3<f64>) -> Self {
        let rotation = matrix(simd, &pose.columns);
        Self { rotation, origin: origin + vector(simd, pose.origin), axis: vector(simd, pose.axis) }
    }
}

/// See [`Placed::put`].
struct Put<'a, 'b> {
    placed: &'a mut Placed<'b>,
    angles: Angles<'a>,
}

impl Kernel for Put<'_, '_> {
    type Output = Option<()>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Option<()> {
        let Self { placed, angles } = self;
        let steering = angles.steering(simd);
        let [_, roll, pitch, ..] = *angles.state;
        let attitude = [turned(simd, angles.yaw), turned(simd, pitch), turned(simd, roll)];
        let poses = WorldPoses::new(simd, placed.chain, attitude, &angles.of_joints(simd, &steering));
        placed.rotation = matrix(simd, &poses.links.body.columns);
        placed.roll_axis = vector(simd, poses.roll_axis);
        placed.pitch_axis = vector(simd, poses.pitch_axis);
        for k in 0..placed.chain.parts().len() {
            placed.parts[k] = PlacedPart::new(simd, &poses.links.links[k], placed.origin);
        }
        poses.links.reaches.any().then_some(())
    }
}
