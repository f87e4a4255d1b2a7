//! Rocker-bogie suspension: the kinematics of six wheels on three passive joints.
//!
//! A differential couples the rockers: the left one has the angle `rho`, the right one `-rho`. Each carries a wheel and
//! a bogie with the angle `beta` and two wheels. It is one of the vehicles of [`Chain`], which are data; the papers
//! give it as a Denavit-Hartenberg table ([`Link`]). Joint angles are about +y, so nose-down is positive. The wheel
//! equation of [`Rover`] gives the motion of its wheels seen from above.
//!
//! (M. Tarokh, G. McDermott, S. Hayati, J. Hung, Kinematic modeling of a high mobility Mars rover, ICRA 1999.)

mod chain;
mod dimensions;
pub mod kinematics;
pub mod lanes;
mod placed;
mod table;
mod vehicles;

use std::f64::consts::{FRAC_PI_2, FRAC_PI_3};

use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::{Inputs, Rover};
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_kinematics::wheels::Wheel;
use six_wheel_numerics::error::{Error, finite, number};
use six_wheel_numerics::threads::workers::Workers;

pub use chain::{
    Chain, ChainLink, Joint, MAX_FREE, MAX_PARTS, MAX_STATE, MAX_WHEELS, Mount, PlanPose, State, Turning, WheelMount,
};
pub use dimensions::{Bogie, Differential, Dimensions, JointRange, Steered};
pub use placed::{Placed, PointSlopes, WheelFrame};
use table::FIRST_PSI;
pub use table::{FRAMES, Frame, Link, MAX_JOINTS, Turn};

pub use vehicles::TripleBogie;

/// Names of the wheels, in the order of every array and of the frames A1 to A6.
pub const WHEELS: [&str; 6] = ["front_left", "front_right", "middle_left", "middle_right", "rear_left", "rear_right"];

/// A rover on a rocker-bogie suspension. Immutable, without state.
#[derive(Clone, Debug)]
pub struct RockerBogie {
    dimensions: Dimensions,
    links: [Link; FRAMES],
    chain: Chain,
}

impl PartialEq for RockerBogie {
    fn eq(&self, other: &Self) -> bool {
        self.dimensions == other.dimensions
    }
}

/// Dimensions common to the presets, with lengths still to be filled in: bogies behind, a gear, no published limits.
const LIKE_CURIOSITY: Dimensions = Dimensions {
    rocker_pivot: [0.0; 3],
    rocker_to_wheel: [0.0; 3],
    rocker_to_bogie: [0.0; 3],
    bogie_to_wheels: [[0.0; 3]; 2],
    bogie: Bogie::Behind,
    wheel_radius: 0.0,
    steered: Steered::Corners,
    steering: SteeringRange { lower: -FRAC_PI_2, upper: FRAC_PI_2 },
    rocker_limit: JointRange { lower: f64::NEG_INFINITY, upper: f64::INFINITY },
    bogie_limit: JointRange { lower: f64::NEG_INFINITY, upper: f64::INFINITY },
    differential: Differential::Gear,
};

/// Angles and speeds of the wheels, and the scrub of the unsteered ones.
#[derive(Clone, Debug)]
pub struct SteeringCommand {
    /// Angles of the steered wheels [rad].
    pub steering: Vec<f64>,
    /// Speeds of all wheels [rad/s].
    pub wheel_speeds: Vec<f64>,
    /// Left of the rover's origin [m]; infinite driving straight, NaN at rest.
    pub turning_radius: f64,
    /// Speed at which each unsteered wheel slides to its left [m/s].
    pub scrub: Vec<f64>,
}

/// A published rocker-bogie.
#[derive(Clone, Copy, Debug)]
pub struct Preset {
    /// Its name in [`RockerBogie::preset`].
    pub name: &'static str,
    /// Source of the dimensions.
    pub source: &'static str,
    make: fn() -> Result<RockerBogie, Error>,
}

/// Every preset, by name.
pub const PRESETS: [Preset; 4] = [
    Preset {
        name: "perseverance",
        source: "nasa-jpl/m2020-urdf-models, rover/m2020.urdf (c422fc6)",
        make: RockerBogie::perseverance,
    },
    Preset {
        name: "curiosity",
        source: "Project Chrono Curiosity model (BSD-3-Clause), read off a 3D model to about 1 cm; \
                 origin moved from the chassis by (-0.089, 0, -0.001), radius half the nominal wheel diameter",
        make: RockerBogie::curiosity,
    },
    Preset {
        name: "rocky7",
        source: "nealseegmiller/wmrde, Rocky 7 model after Tarokh and McDermott (da081e4)",
        make: RockerBogie::rocky7,
    },
    Preset {
        name: "open_source_rover",
        source: "nasa-jpl/osr-rover-code, ROS/osr_gazebo/urdf/osr.urdf.xacro (8d1de34); wheel radius from its \
                 osr_params.yaml (e7c9e87); steering axes taken through the wheel centres, from which they \
                 are up to 6 mm behind and 20 mm inside in the model",
        make: RockerBogie::open_source_rover,
    },
];

impl RockerBogie {
    /// A rover with this suspension. Fails if a dimension is outside its range.
    #[inline]
    pub fn new(dimensions: Dimensions) -> Result<Self, Error> {
        Ok(Self { chain: Chain::rocker_bogie(&dimensions)?, links: dimensions.links(), dimensions })
    }

    /// A published rocker-bogie by name.
    pub fn preset(name: &str) -> Result<Self, Error> {
        match PRESETS.iter().find(|preset| preset.name == name) {
            Some(preset) => (preset.make)(),
            None => {
                let rule = format!("be one of {}", PRESETS.map(|preset| preset.name).join(", "));
                Err(Error::value("name", rule, format!("{name:?}")))
            }
        }
    }

    /// Rocky 7. Frame R as in the papers: between the bogie axes, to 3.5 um.
    ///
    /// (Dimensions: nealseegmiller/wmrde, Rocky 7 model after Tarokh and McDermott, da081e4.)
    pub fn rocky7() -> Result<Self, Error> {
        let (sin, cos) = 139.0_f64.to_radians().sin_cos(); // k9
        Self::new(Dimensions {
            rocker_pivot: [0.12075, 0.2, 0.105],
            rocker_to_wheel: [0.288, 0.0, -0.125],
            rocker_to_bogie: [0.16 * cos, 0.0, -0.16 * sin],
            bogie_to_wheels: [[0.069, 0.0, -0.02], [-0.069, 0.0, -0.02]],
            wheel_radius: 0.065,
            steered: Steered::Front,
            steering: SteeringRange::symmetric(FRAC_PI_3)?,
            ..LIKE_CURIOSITY
        })
    }

    /// Perseverance. Frame R on the ground under the middle of the middle wheels.
    ///
    /// (Dimensions: nasa-jpl/m2020-urdf-models, rover/m2020.urdf, c422fc6, signs turned from z-down.)
    pub fn perseverance() -> Result<Self, Error> {
        Self::new(Dimensions {
            rocker_pivot: [0.30402, 0.79959, 0.89288],
            rocker_to_wheel: [0.881, 0.26291, -0.63],
            rocker_to_bogie: [-0.754, 0.12, -0.23],
            bogie_to_wheels: [[0.44998, 0.26491, -0.4], [-0.625, 0.14291, -0.4]],
            wheel_radius: 0.26288,
            ..LIKE_CURIOSITY
        })
    }

    /// Curiosity, to about 1 cm. Frame R on the ground under the middle of the middle wheels.
    ///
    /// (Dimensions: Project Chrono Curiosity model, read off a 3D model; origin moved from its chassis by
    /// (-0.089, 0, -0.001); radius half the nominal wheel diameter of 0.5 m.)
    pub fn curiosity() -> Result<Self, Error> {
        Self::new(Dimensions {
            rocker_pivot: [0.303, 0.604, 0.8764],
            rocker_to_wheel: [0.881, 0.459, -0.6264],
            rocker_to_bogie: [-0.754, 0.241, -0.2321],
            bogie_to_wheels: [[0.451, 0.349, -0.3943], [-0.623, 0.218, -0.3943]],
            wheel_radius: 0.25,
            ..LIKE_CURIOSITY
        })
    }

    /// The Open Source Rover of JPL: bogies in front, four steered corners. Frame R on the ground under the middle of
    /// the middle wheels, with all joints at 0; the model's wheel centres then differ in height by 5 mm.
    ///
    /// (Dimensions: nasa-jpl/osr-rover-code, ROS/osr_gazebo/urdf/osr.urdf.xacro, 8d1de34; wheel radius from its
    /// osr_params.yaml, e7c9e87. Steering axes are taken through the wheel centres; in the model they run up
    /// to 6 mm behind and 20 mm inside.)
    pub fn open_source_rover() -> Result<Self, Error> {
        Self::new(Dimensions {
            rocker_pivot: [-0.004853, 0.18111, 0.261126],
            rocker_to_wheel: [-0.311966, 0.008131, -0.191057],
            rocker_to_bogie: [0.099618, 0.0, -0.091275],
            bogie_to_wheels: [[0.176344, 0.019209, -0.09327], [-0.094765, 0.100435, -0.094851]],
            bogie: Bogie::InFront,
            wheel_radius: 0.075,
            ..LIKE_CURIOSITY
        })
    }

    /// Dimensions that it was made of.
    #[inline]
    pub fn dimensions(&self) -> &Dimensions {
        &self.dimensions
    }

    /// The suspension as parts, joints and wheels.
    #[inline]
    pub fn chain(&self) -> &Chain {
        &self.chain
    }

    /// The Denavit-Hartenberg table, parents before children.
    pub fn links(&self) -> &[Link; FRAMES] {
        &self.links
    }

    /// Number of joint angles: rho, beta_1, beta_2, then one psi per steered wheel.
    pub fn joint_count(&self) -> usize {
        FIRST_PSI + self.dimensions.steered.wheels().len()
    }

    /// The chain at these joint angles [rad], its body at the origin. Fails unless there is a finite angle for every joint, and
    /// one of the left rocker at which the differential reaches the right one.
    pub fn place(&self, joints: &[f64]) -> Result<Placed<'_>, Error> {
        if joints.len() != self.joint_count() {
            let rule = format!("hold {} angles", self.joint_count());
            return Err(Error::value("joints", rule, joints.len().to_string()));
        }
        let (suspension, steering) = joints.split_at(FIRST_PSI);
        finite("joints", suspension)?;
        finite("steering", steering)?;
        let mut state = [0.0; MAX_STATE];
        state[3..].copy_from_slice(suspension);
        self.chain.place([0.0; 3].into(), &state, steering).ok_or_else(|| {
            let rule = "be within reach of the differential bar";
            Error::value("joints", rule, number(suspension[0]))
        })
    }

    /// All frames of the table at these joint angles [rad], in its order. Fails as [`Self::place`].
    pub fn frames(&self, joints: &[f64]) -> Result<[Frame; FRAMES], Error> {
        let placed = self.place(joints)?;
        Ok(table::frames(&self.links, &self.chain, &placed))
    }

    /// The rover seen from above: its wheels where the suspension puts their centres.
    pub fn planar(&self, rho: f64, beta: [f64; 2]) -> Result<Rover, Error> {
        let mut joints = [0.0; MAX_JOINTS];
        joints[..FIRST_PSI].copy_from_slice(&[rho, beta[0], beta[1]]);
        let placed = self.place(&joints[..self.joint_count()])?;
        let Dimensions { wheel_radius, steered, steering, .. } = self.dimensions;
        let wheel = |(i, name): (usize, &&str)| {
            let centre = placed.wheel(i).centre;
            let wheel = Wheel::new(*name, centre.x, centre.y, wheel_radius);
            if steered.wheels().contains(&i) { wheel.steered(steering) } else { wheel }
        };
        Rover::new(WHEELS.iter().enumerate().map(wheel).collect())
    }

    /// x_R [m]: in rotations about points of the line x = -x_R, the side slip of the unsteered wheels is least.
    pub fn icr_offset(&self, rho: f64, beta: [f64; 2]) -> Result<f64, Error> {
        Ok(icr_offset(&self.planar(rho, beta)?))
    }

    /// The wheel equation of [`Self::planar`] for a forward speed [m/s] of the rover's origin and a yaw rate [rad/s],
    /// with the least side slip of the unsteered wheels.
    #[inline]
    pub fn steer(
        &self,
        speed: f64,
        yaw_rate: f64,
        rho: f64,
        beta: [f64; 2],
        inputs: Inputs<'_>,
    ) -> Result<SteeringCommand, Error> {
        finite("speed", &[speed])?;
        finite("yaw_rate", &[yaw_rate])?;
        let rover = self.planar(rho, beta)?;
        let twist = Twist { vx: speed, vy: 0.0, omega: yaw_rate };
        let twist = twist.about([-icr_offset(&rover), 0.0]);
        let mut steering = vec![0.0; rover.steered().len()];
        let mut wheel_speeds = vec![0.0; WHEELS.len()];
        rover.inverse(twist, inputs, &mut steering, &mut wheel_speeds)?;
        let unsteered = rover.wheels().iter().filter(|w| w.steering().is_none());
        Ok(SteeringCommand {
            steering,
            wheel_speeds,
            turning_radius: twist.icr()[1],
            scrub: unsteered.map(|w| w.side_slip(0.0, twist, 0.0)).collect(),
        })
    }
}

/// The homogeneous transforms of [`RockerBogie::frames`] for every row of joint angles: frame after frame, in
/// each row after row, row-major.
pub fn frames(rover: &RockerBogie, joints: &[f64], transforms: &mut [f64], workers: Workers) -> Result<(), Error> {
    for_each_row::<FRAMES>(rover, joints, (transforms, 16), workers, |joints, matrices| {
        let frames = rover.frames(joints)?;
        for (matrix, (rotation, origin)) in matrices.into_iter().zip(frames) {
            for (i, row) in matrix.chunks_exact_mut(4).enumerate() {
                row.copy_from_slice(&match i {
                    3 => [0.0, 0.0, 0.0, 1.0],
                    _ => [rotation[(i, 0)], rotation[(i, 1)], rotation[(i, 2)], origin[i]],
                });
            }
        }
        Ok(())
    })
}

/// Derivatives of the wheels' centres by the joint angles [m/rad] for every row of them: wheel after wheel, in each row after
/// row, each three rows of joints. Steering turns a wheel about its centre.
pub fn jacobians(rover: &RockerBogie, joints: &[f64], derivatives: &mut [f64], workers: Workers) -> Result<(), Error> {
    let width = rover.joint_count();
    for_each_row::<{ WHEELS.len() }>(rover, joints, (derivatives, 3 * width), workers, |joints, matrices| {
        let placed = rover.place(joints)?;
        for (wheel, matrix) in matrices.into_iter().enumerate() {
            let slopes = placed.point_slopes(wheel, placed.wheel(wheel).centre);
            matrix.fill(0.0);
            for (joint, slope) in slopes[6..].iter().enumerate() {
                (0..3).for_each(|k| matrix[k * width + joint] = slope[k]);
            }
        }
        Ok(())
    })
}

/// Computes `N` outputs of this width for every row of joint angles; the array holds them one after another.
fn for_each_row<const N: usize>(
    rover: &RockerBogie,
    joints: &[f64],
    (array, width): (&mut [f64], usize),
    workers: Workers,
    row: impl Fn(&[f64], [&mut [f64]; N]) -> Result<(), Error> + Sync,
) -> Result<(), Error> {
    let angles = rover.joint_count();
    let count = joints.len() / angles;
    let mut blocks = array.chunks_exact_mut((count * width).max(1));
    let blocks = std::array::from_fn(|_| (blocks.next().unwrap_or_default(), width));
    workers.rows(count, blocks, |k, outputs| {
        row(&joints[k * angles..][..angles], outputs).map_err(|error| error.at_row(k))
    })
}

/// x_R [m]. The unsteered wheels are parallel: one bank, whose row is that of their mean axle. If all wheels steer, it
/// is 0.
fn icr_offset(rover: &Rover) -> f64 {
    rover.banks.first().map_or(0.0, |bank| 0.0 - bank.row.z) // not minus zero
}
