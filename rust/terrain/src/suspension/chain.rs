//! A suspension as data: parts that turn about axes of their parents, and wheels mounted on them.
//!
//! A part has a free angle, which the ground determines (a rocker, a bogie, an axle), or a steering angle, which is
//! commanded. Every vehicle here is such a list ([`Chain::rocker_bogie`], [`Chain::triple_bogie`],
//! [`Chain::pivoting_axles`], [`Chain::rigid`]).
//!
//! The body is at `(x, y, z)` with the rotation `Rz(yaw) Ry(pitch) Rx(roll)`: pitch > 0 nose down, roll > 0 right side
//! down. Free angles are about the axis of their part.

use std::borrow::Cow;

use nalgebra::{Unit, Vector3};

use super::dimensions::{Differential, JointRange};
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_numerics::error::{Error, finite, positive};

/// Largest number of free angles.
pub const MAX_FREE: usize = 3;

/// Largest number of wheels.
pub const MAX_WHEELS: usize = 6;

/// Largest number of parts: two rockers, two bogies, six steering knuckles.
pub const MAX_PARTS: usize = 10;

/// Numbers that the ground determines: z, roll, pitch and the free angles.
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
    /// For every link the index of the parent's axis (x 0, y 1, z 2) that is its own axis, if one is.
    main_axes: Vec<Option<usize>>,
    /// All links, and all links without knuckles.
    placed: [Vec<usize>; 2],
    /// The mount of every wheel.
    mounts: Vec<WheelMount>,
}

/// A wheel on the link that carries it, its knuckle left out: a knuckle is a link that steers and carries nothing but wheels.
#[derive(Clone, Debug, PartialEq)]
pub struct WheelMount {
    /// The link; None is the body.
    pub link: Option<usize>,
    /// The centre straight ahead [m].
    pub centre: [f64; 3],
    /// A point of the steering axis [m], or the centre.
    pub pivot: [f64; 3],
    /// Vector from the pivot to the centre, straight ahead [m].
    pub offset: [f64; 3],
    /// The steering joint.
    pub steering: Option<usize>,
    /// The links with free angles that carry the wheel, innermost first, and their joints.
    pub movers: Vec<(usize, usize)>,
}

impl WheelMount {
    /// True if the centre lies off the steering axis.
    #[inline]
    pub fn is_offset(&self) -> bool {
        self.offset[..2] != [0.0; 2]
    }
}

/// Pose of the body in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanPose {
    /// Position of the body's origin [m].
    pub x: f64,
    /// Position of the body's origin [m].
    pub y: f64,
    /// Heading [rad].
    pub yaw: f64,
}

impl PlanPose {
    /// The pose relative to a point [m]. Coordinates of maps may be so large that positions of wheels would have few
    /// digits.
    #[inline]
    pub fn relative_to(self, [x, y]: [f64; 2]) -> Self {
        Self { x: self.x - x, y: self.y - y, ..self }
    }
}

impl From<[f64; 3]> for PlanPose {
    fn from([x, y, yaw]: [f64; 3]) -> Self {
        Self { x, y, yaw }
    }
}

/// State that the ground determines: z [m], roll, pitch and the free angles [rad], in this order; the last ones are 0
/// for a chain with fewer angles.
pub type State = [f64; MAX_STATE];

impl Chain {
    /// A chain of these parts, parents before children. Fails unless every number is inside its range and there are
    /// enough wheels to determine the state.
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
        let balance = Vector3::zeros();
        let (main_axes, placed, mounts) = (Vec::new(), [Vec::new(), Vec::new()], Vec::new());
        let mut chain = Self { parts, wheels, joints, steering, balance, main_axes, placed, mounts };
        chain.prepare();
        Ok(chain)
    }

    /// Fills in what follows from the lists.
    fn prepare(&mut self) {
        let is_axis = |part: &ChainLink, k: usize| (0..3).all(|i| part.axis[i] == f64::from(i == k));
        self.main_axes = self.parts.iter().map(|part| (0..3).find(|&k| is_axis(part, k))).collect();
        let all = 0..self.parts.len();
        self.placed = [all.clone().collect(), all.filter(|&part| !self.is_knuckle(part)).collect()];
        self.mounts = (0..self.wheels.len()).map(|wheel| self.find_mount(wheel)).collect();
        self.balance = self.mean_wheel();
    }

    fn find_mount(&self, wheel: usize) -> WheelMount {
        let Mount { part, centre, .. } = self.wheels[wheel];
        let (mut link, mut pivot, mut offset) = (part, centre, Vector3::zeros());
        if let Some(knuckle) = part.filter(|&part| self.is_knuckle(part)) {
            (link, pivot, offset) = (self.parts[knuckle].parent, self.parts[knuckle].origin, centre);
        }
        let steering = |part: usize| match self.parts[part].turning {
            Turning::Steering(joint) => Some(joint),
            _ => None,
        };
        let free = |part: usize| match self.parts[part].turning {
            Turning::Free(joint) | Turning::Across(joint, _) => Some((part, joint)),
            Turning::Steering(_) => None,
        };
        WheelMount {
            link,
            centre: (pivot + offset).into(),
            pivot: pivot.into(),
            offset: offset.into(),
            steering: self.carriers(wheel).find_map(steering),
            movers: self.carriers(wheel).filter_map(free).collect(),
        }
    }

    /// True for a link that steers and carries nothing but wheels.
    fn is_knuckle(&self, part: usize) -> bool {
        let steers = matches!(self.parts[part].turning, Turning::Steering(_));
        steers && !self.parts.iter().any(|other| other.parent == Some(part))
    }

    /// True if links with free angles turn about x or y, those on one another about the same, and wheels steer by knuckles
    /// about z.
    pub fn is_planar(&self) -> bool {
        let carrier_axis = |part: usize| self.parts[part].parent.map(|parent| self.main_axes[parent]);
        (0..self.parts.len()).all(|part| match (self.parts[part].turning, self.main_axes[part]) {
            (Turning::Steering(_), axis) => axis == Some(2) && self.is_knuckle(part),
            (_, axis @ Some(0 | 1)) => carrier_axis(part).is_none_or(|carrier| carrier == axis),
            _ => false,
        })
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

    /// Number of numbers that the ground determines: three of the body and the free angles.
    pub fn state_count(&self) -> usize {
        3 + self.joints.len()
    }

    /// Default centre of mass in the body [m]: the mean of the wheel centres, on a rocker-bogie at the height of the
    /// rocker axis. It only decides which wheels are in the air when joints are at their stops.
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
        self.mounts[wheel].steering
    }

    /// The parts between the body and a wheel, innermost last.
    pub fn carriers(&self, wheel: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(self.wheels[wheel].part, |&part| self.parts[part].parent)
    }

    /// The axis of its parent about which a link turns, if it is one of them.
    #[inline]
    pub fn main_axis(&self, part: usize) -> Option<usize> {
        self.main_axes[part]
    }

    /// The links whose poses are computed, parents before children: without steering angles, knuckles are fixed to
    /// their parents.
    #[inline]
    pub(crate) fn placed_links(&self, is_steered: bool) -> &[usize] {
        &self.placed[usize::from(!is_steered)]
    }

    /// A wheel on the link that carries it, straight ahead.
    #[inline]
    pub fn mount(&self, wheel: usize) -> &WheelMount {
        &self.mounts[wheel]
    }

    /// Sets the height of the default centre of mass in the body [m].
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
