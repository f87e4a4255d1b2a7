//! A suspension as data: parts that turn about axes of their parents, and wheels mounted on them.
//!
//! A part turns by a free angle (a rocker, a bogie, an axle: what the ground decides) or by a steering angle
//! (what is commanded). Every vehicle here is such a list ([`Chain::rocker_bogie`], [`Chain::triple_bogie`],
//! [`Chain::pivoting_axles`], [`Chain::rigid`]), and nothing that works on chains asks which.
//!
//! The body stands at `(x, y, z)` with rotation `Rz(yaw) Ry(pitch) Rx(roll)`: pitch > 0 nose down, roll > 0 right
//! side down. Free angles count about the axis of their part.

use std::borrow::Cow;

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

use super::dimensions::{Differential, JointRange};
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_numerics::error::{Error, finite, positive};

/// Largest number of free angles.
pub const MAX_FREE: usize = 3;

/// Largest number of wheels.
pub const MAX_WHEELS: usize = 6;

/// Largest number of parts: two rockers, two bogies, six steering knuckles.
pub const MAX_PARTS: usize = 10;

/// Numbers that the ground decides: z, roll, pitch and the free angles.
pub const MAX_STATE: usize = 3 + MAX_FREE;

/// The angle that turns a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Turning {
    /// A free angle, as it is.
    Free(usize),
    /// A free angle through a differential, of which it is the left-hand side.
    Across(usize, Differential),
    /// A steering angle.
    Steering(usize),
}

/// A rigid part of a suspension.
#[derive(Clone, Debug, PartialEq)]
pub struct ChainLink {
    /// Its name.
    pub name: Cow<'static, str>,
    /// The part that carries it; None is the body.
    pub parent: Option<usize>,
    /// A point of its axis, in coordinates of the parent [m]: the origin of its own.
    pub origin: Vector3<f64>,
    /// Direction of its axis in the parent.
    pub axis: Unit<Vector3<f64>>,
    /// The angle that turns it.
    pub turning: Turning,
}

/// A wheel on its part: it rolls along the part's x axis, turns about its y axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Mount {
    /// Name of the wheel.
    pub name: Cow<'static, str>,
    /// The part; None is the body.
    pub part: Option<usize>,
    /// Its centre in coordinates of the part [m].
    pub centre: Vector3<f64>,
    /// Hub to ground [m].
    pub radius: f64,
}

/// A free angle.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Its name.
    pub name: Cow<'static, str>,
    /// Range of its angle.
    pub range: JointRange,
}

/// A suspension. Immutable; a chain that exists is valid.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    parts: Vec<ChainLink>,
    wheels: Vec<Mount>,
    joints: Vec<Joint>,
    steering: Vec<SteeringRange>,
    balance: Vector3<f64>,
}

/// Pose of the body in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanPose {
    /// Of the body's origin [m].
    pub x: f64,
    /// Of the body's origin [m].
    pub y: f64,
    /// Heading [rad].
    pub yaw: f64,
}

impl From<[f64; 3]> for PlanPose {
    fn from([x, y, yaw]: [f64; 3]) -> Self {
        Self { x, y, yaw }
    }
}

/// State that the ground decides: z [m], roll, pitch and the free angles [rad], in this order; a chain with fewer
/// angles leaves the last ones 0.
pub type State = [f64; MAX_STATE];

impl Chain {
    /// A chain of these parts, parents before children. Fails unless every number makes sense, and there are
    /// as many wheels as they carry.
    pub fn new(
        parts: Vec<ChainLink>,
        wheels: Vec<Mount>,
        joints: Vec<Joint>,
        steering: Vec<SteeringRange>,
    ) -> Result<Self, Error> {
        let count = |argument: &'static str, length: usize, least, most: usize| {
            let rule = format!("hold {least} to {most}");
            let fits = (least..=most).contains(&length);
            fits.then_some(()).ok_or_else(|| Error::value(argument, rule, length.to_string()))
        };
        count("parts", parts.len(), 0, MAX_PARTS)?;
        count("wheels", wheels.len(), 3, MAX_WHEELS)?;
        count("joints", joints.len(), 0, MAX_FREE.min(wheels.len() - 3))?;
        for (k, part) in parts.iter().enumerate() {
            finite("origin", part.origin.as_slice())?;
            finite("axis", part.axis.as_slice())?;
            let known = match part.turning {
                Turning::Free(joint) | Turning::Across(joint, _) => joint < joints.len(),
                Turning::Steering(steering_joint) => steering_joint < steering.len(),
            };
            if part.parent.is_some_and(|parent| parent >= k) || !known {
                let rule = "hang on a part before it and turn by a joint there is";
                return Err(Error::value("parts", rule, format!("{:?}", part.name)));
            }
        }
        for wheel in &wheels {
            finite("centre", wheel.centre.as_slice())?;
            positive("wheel_radius", wheel.radius)?;
            if wheel.part.is_some_and(|part| part >= parts.len()) {
                let rule = "be mounted on a part there is";
                return Err(Error::value("wheels", rule, format!("{:?}", wheel.name)));
            }
        }
        for joint in &joints {
            joint.range.check("joint_limit")?;
        }
        let mut chain = Self { parts, wheels, joints, steering, balance: Vector3::zeros() };
        chain.balance = chain.mean_wheel();
        Ok(chain)
    }

    /// The parts, parents before children.
    #[inline]
    pub fn parts(&self) -> &[ChainLink] {
        &self.parts
    }

    /// The wheels, front to rear, left before right.
    #[inline]
    pub fn wheels(&self) -> &[Mount] {
        &self.wheels
    }

    /// The free angles.
    #[inline]
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Range of each steering joint.
    #[inline]
    pub fn steering(&self) -> &[SteeringRange] {
        &self.steering
    }

    /// Numbers that the ground decides: three of the body and the free angles.
    pub fn state_count(&self) -> usize {
        3 + self.joints.len()
    }

    /// Default centre of the weight in the body [m]: the mean of the wheel centres, on a rocker-bogie at the height of
    /// the rocker axis. Only what joints at their stops leave open depends on it.
    pub fn balance(&self) -> Vector3<f64> {
        self.balance
    }

    /// Name of the first wheel that a steering joint turns.
    #[inline]
    pub fn steered_name(&self, joint: usize) -> &str {
        let turns = |wheel: &usize| self.steering_joint(*wheel) == Some(joint);
        let found = (0..self.wheels.len()).find(turns);
        found.map_or("", |wheel| &self.wheels[wheel].name)
    }

    /// The joint that steers a wheel.
    #[inline]
    pub fn steering_joint(&self, wheel: usize) -> Option<usize> {
        self.carriers(wheel).find_map(|part| match self.parts[part].turning {
            Turning::Steering(joint) => Some(joint),
            _ => None,
        })
    }

    /// The parts between the body and a wheel, innermost last.
    pub fn carriers(&self, wheel: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(self.wheels[wheel].part, |&part| self.parts[part].parent)
    }

    /// Puts the chain where a pose, a state and steering angles (all 0 if there are none) say. None where a
    /// differential does not reach.
    #[inline]
    pub fn place(&self, pose: PlanPose, state: &State, steering: &[f64]) -> Option<Placed<'_>> {
        let mut placed = self.nowhere();
        placed.put(pose, state, steering).map(|()| placed)
    }

    /// Room for the chain in the world.
    pub fn nowhere(&self) -> Placed<'_> {
        Placed {
            chain: self,
            origin: Vector3::zeros(),
            rotation: Matrix3::identity(),
            roll_axis: Vector3::zeros(),
            pitch_axis: Vector3::zeros(),
            parts: [PlacedPart {
                rotation: Matrix3::identity(),
                origin: Vector3::zeros(),
                axis: Vector3::zeros(),
                slope: 0.0,
            }; MAX_PARTS],
        }
    }

    /// Takes the weight to act at another height of the body [m].
    pub(super) fn set_balance_height(&mut self, height: f64) {
        self.balance.z = height;
    }

    /// Mean of the wheel centres at angles 0 [m].
    fn mean_wheel(&self) -> Vector3<f64> {
        let level = PlanPose { x: 0.0, y: 0.0, yaw: 0.0 };
        let Some(placed) = self.place(level, &[0.0; MAX_STATE], &[]) else {
            return Vector3::zeros();
        };
        let count = self.wheels.len();
        (0..count).map(|wheel| placed.wheel(wheel).centre).sum::<Vector3<f64>>() / count as f64
    }
}

/// A rotation followed, in its own axes, by a turn about an axis; most turn about y or z.
fn turned(rotation: Matrix3<f64>, axis: &Unit<Vector3<f64>>, angle: f64) -> Matrix3<f64> {
    if angle == 0.0 {
        return rotation;
    }
    let (first, second) = match axis.as_slice() {
        [0.0, 1.0, 0.0] => (2, 0),
        [0.0, 0.0, 1.0] => (0, 1),
        _ => return rotation * Rotation3::from_axis_angle(axis, angle).into_inner(),
    };
    let (sin, cos) = angle.sin_cos();
    let (a, b) = (rotation.column(first), rotation.column(second));
    let mut turned = rotation;
    turned.set_column(first, &(a * cos + b * sin));
    turned.set_column(second, &(b * cos - a * sin));
    turned
}

/// A part where its pose, the state and the steering put it, in world axes.
#[derive(Clone, Copy, Debug)]
struct PlacedPart {
    rotation: Matrix3<f64>,
    origin: Vector3<f64>,
    axis: Vector3<f64>,
    /// Derivative of its angle by the joint that turns it.
    slope: f64,
}

/// A chain in the world.
#[derive(Clone, Debug)]
pub struct Placed<'a> {
    chain: &'a Chain,
    /// Of the body [m].
    pub origin: Vector3<f64>,
    /// `world_from_body`.
    pub rotation: Matrix3<f64>,
    /// About which roll turns the body.
    pub roll_axis: Vector3<f64>,
    /// About which pitch turns it.
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

/// Derivatives of a point by x, y, yaw, z, roll, pitch and the free angles.
pub type PointSlopes = [Vector3<f64>; 3 + MAX_STATE];

impl Placed<'_> {
    /// See [`Chain::place`].
    pub fn put(&mut self, pose: PlanPose, state: &State, steering: &[f64]) -> Option<()> {
        let [z, roll, pitch, ref joints @ ..] = *state;
        let heading = Rotation3::from_axis_angle(&Vector3::z_axis(), pose.yaw).into_inner();
        let tilt = Rotation3::from_euler_angles(roll, pitch, 0.0).into_inner();
        self.origin = Vector3::new(pose.x, pose.y, z);
        self.rotation = heading * tilt;
        // Rz Ry x, Rz y.
        self.roll_axis = heading * Vector3::new(pitch.cos(), 0.0, -pitch.sin());
        self.pitch_axis = heading * Vector3::y();
        (0..self.chain.parts.len()).try_for_each(|k| self.turn(k, joints, steering))
    }

    /// Puts a part where its parent and these angles say; angles that are not there are 0. None where a differential does not reach.
    #[inline]
    fn turn(&mut self, k: usize, joints: &[f64], steering: &[f64]) -> Option<()> {
        let part = &self.chain.parts[k];
        let (rotation, origin) = self.carrier(part.parent);
        let of = |angles: &[f64], joint: usize| angles.get(joint).copied().unwrap_or(0.0);
        let (angle, slope) = match part.turning {
            Turning::Free(joint) => (of(joints, joint), 1.0),
            Turning::Across(joint, differential) => {
                let [angle, slope] = differential.right(of(joints, joint))?;
                (angle, slope)
            }
            Turning::Steering(joint) => (of(steering, joint), 1.0),
        };
        self.parts[k] = PlacedPart {
            rotation: turned(rotation, &part.axis, angle),
            origin: origin + rotation * part.origin,
            axis: rotation * *part.axis,
            slope,
        };
        Some(())
    }

    /// Steers, with the joints where they are: what no steering joint carries stays. None where a differential does not reach.
    pub fn steer(&mut self, joints: &[f64], steering: &[f64]) -> Option<()> {
        let mut moved = 0_u32;
        for (k, part) in self.chain.parts.iter().enumerate() {
            let steers = matches!(part.turning, Turning::Steering(_));
            if steers || part.parent.is_some_and(|parent| moved >> parent & 1 == 1) {
                moved |= 1 << k;
                self.turn(k, joints, steering)?;
            }
        }
        Some(())
    }

    fn carrier(&self, part: Option<usize>) -> (Matrix3<f64>, Vector3<f64>) {
        part.map_or((self.rotation, self.origin), |part| (self.parts[part].rotation, self.parts[part].origin))
    }

    /// A wheel.
    pub fn wheel(&self, wheel: usize) -> WheelFrame {
        let mount = &self.chain.wheels[wheel];
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

    /// Derivatives of a point that is fixed to a wheel's carrier, steering held: by x, y, yaw, z, roll, pitch and
    /// the free angles.
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
            let turning = self.chain.parts[part].turning;
            (turning, placed.axis * placed.slope, placed.origin)
        })
    }
}
