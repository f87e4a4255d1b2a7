//! The vehicles that are chains: each only fills the lists of a [`Chain`].

use std::borrow::Cow;

use nalgebra::Vector3;

use super::WHEELS;
use super::chain::{Chain, ChainLink, Joint, MAX_PARTS, MAX_WHEELS, Mount, Turning};
use super::dimensions::{Dimensions, JointRange};
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_numerics::error::{Error, finite, positive};

/// Six wheels on three bogies, as on ExoMars: left and right each carry a front and a middle wheel and turn about
/// +y; the one behind lies across, carries the rear wheels and turns about +x. The left-hand side at joint
/// angles 0, vectors `[x, y, z]` [m]; the right mirrors it. Free angles beta_1 (left), beta_2 (right; both positive
/// with the front down), beta_3 (rear; positive with its right side down).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TripleBogie {
    /// Origin of the rover's frame to the axis of the left bogie.
    pub bogie_pivot: [f64; 3],
    /// That axis to the front wheel.
    pub bogie_to_front: [f64; 3],
    /// That axis to the middle wheel.
    pub bogie_to_middle: [f64; 3],
    /// Origin of the rover's frame to the axis of the rear bogie.
    pub rear_pivot: [f64; 3],
    /// That axis to the left rear wheel.
    pub rear_to_wheel: [f64; 3],
    /// Hub to ground [m].
    pub wheel_radius: f64,
    /// True for the pairs that steer, from the front.
    pub steered: [bool; 3],
    /// Range of the steering angles.
    pub steering: SteeringRange,
    /// Range of the bogies.
    pub bogie_limit: JointRange,
}

impl Chain {
    /// Six wheels on rockers and bogies; free angles rho, beta_1 (left), beta_2 (right).
    pub fn rocker_bogie(of: &Dimensions) -> Result<Self, Error> {
        of.check()?;
        let mut parts = Vec::with_capacity(MAX_PARTS);
        let sides = ["left", "right"];
        for (side, name) in sides.into_iter().enumerate() {
            parts.push(ChainLink {
                name: format!("{name} rocker").into(),
                parent: None,
                origin: on_side(of.rocker_pivot, side),
                axis: Vector3::y_axis(),
                turning: match name {
                    "left" => Turning::Free(0),
                    _ => Turning::Across(0, of.differential),
                },
            });
        }
        for (side, name) in sides.into_iter().enumerate() {
            parts.push(ChainLink {
                name: format!("{name} bogie").into(),
                parent: Some(side),
                origin: on_side(of.rocker_to_bogie, side),
                axis: Vector3::y_axis(),
                turning: Turning::Free(1 + side),
            });
        }
        let mut wheels = Vec::with_capacity(MAX_WHEELS);
        for (wheel, name) in WHEELS.into_iter().enumerate() {
            let (pair, side) = (wheel / 2, wheel % 2);
            let carrier = if of.bogie.carries(pair) { 2 + side } else { side };
            let centre = on_side(of.to_wheel(pair), side);
            let steering = of.steered.wheels().iter().position(|&other| other == wheel);
            wheels.push(mount(&mut parts, name.into(), Some(carrier), centre, of.wheel_radius, steering));
        }
        let joint = |name: &'static str, range| Joint { name: name.into(), range };
        let joints =
            vec![joint("rho", of.rocker_limit), joint("beta_1", of.bogie_limit), joint("beta_2", of.bogie_limit)];
        let steering = vec![of.steering; of.steered.wheels().len()];
        let mut chain = Self::new(parts, wheels, joints, steering)?;
        // The centre of mass is at the height of the rocker axis.
        chain.set_balance_height(of.rocker_pivot[2]);
        Ok(chain)
    }

    /// Six wheels on three bogies, as on ExoMars.
    pub fn triple_bogie(of: &TripleBogie) -> Result<Self, Error> {
        positive("wheel_radius", of.wheel_radius)?;
        of.steering.check()?;
        of.bogie_limit.check("bogie_limit")?;
        finite("bogie_pivot", &of.bogie_pivot)?;
        finite("bogie_to_front", &of.bogie_to_front)?;
        finite("bogie_to_middle", &of.bogie_to_middle)?;
        finite("rear_pivot", &of.rear_pivot)?;
        finite("rear_to_wheel", &of.rear_to_wheel)?;
        let part = |name: &'static str, origin, axis, joint| ChainLink {
            name: name.into(),
            parent: None,
            origin,
            axis,
            turning: Turning::Free(joint),
        };
        let mut parts = vec![
            part("left bogie", on_side(of.bogie_pivot, 0), Vector3::y_axis(), 0),
            part("right bogie", on_side(of.bogie_pivot, 1), Vector3::y_axis(), 1),
            part("rear bogie", Vector3::from(of.rear_pivot), Vector3::x_axis(), 2),
        ];
        let (mut wheels, mut joint) = (Vec::with_capacity(MAX_WHEELS), 0);
        for (wheel, name) in WHEELS.into_iter().enumerate() {
            let (pair, side) = (wheel / 2, wheel % 2);
            let carrier = if pair == 2 { 2 } else { side };
            let centre = [of.bogie_to_front, of.bogie_to_middle, of.rear_to_wheel][pair];
            let steering = of.steered[pair].then_some(joint);
            joint += usize::from(of.steered[pair]);
            let centre = on_side(centre, side);
            wheels.push(mount(&mut parts, name.into(), Some(carrier), centre, of.wheel_radius, steering));
        }
        let joints = ["beta_1", "beta_2", "beta_3"].map(|name| Joint { name: name.into(), range: of.bogie_limit });
        Self::new(parts, wheels, joints.into(), vec![of.steering; joint])
    }

    /// Four wheels on two axles that pivot about the vertical in their middle, as on Zoe; the rear one also rolls:
    /// free angle gamma, positive with its right side down. The steering angles are those of the axles, front
    /// and rear. The origin is midway between the pivots, `drop` above the wheel centres [m].
    pub fn pivoting_axles(
        wheelbase: f64,
        track_width: f64,
        drop: f64,
        wheel_radius: f64,
        steering: SteeringRange,
        limit: JointRange,
    ) -> Result<Self, Error> {
        positive("wheelbase", wheelbase)?;
        positive("track_width", track_width)?;
        finite("drop", &[drop])?;
        positive("wheel_radius", wheel_radius)?;
        steering.check()?;
        limit.check("roll_limit")?;
        let part = |name: &'static str, parent, x, axis, turning| ChainLink {
            name: name.into(),
            parent,
            origin: Vector3::new(x, 0.0, 0.0),
            axis,
            turning,
        };
        let half = wheelbase / 2.0;
        let parts = vec![
            part("front axle", None, half, Vector3::z_axis(), Turning::Steering(0)),
            part("rear roll", None, -half, Vector3::x_axis(), Turning::Free(0)),
            part("rear axle", Some(1), 0.0, Vector3::z_axis(), Turning::Steering(1)),
        ];
        let names = ["front_left", "front_right", "rear_left", "rear_right"];
        let wheels = names.into_iter().enumerate().map(|(wheel, name)| {
            let side = if wheel % 2 == 0 { 0.5 } else { -0.5 };
            Mount {
                name: name.into(),
                part: Some(if wheel < 2 { 0 } else { 2 }),
                centre: Vector3::new(0.0, side * track_width, -drop),
                radius: wheel_radius,
            }
        });
        let joint = Joint { name: "gamma".into(), range: limit };
        Self::new(parts, wheels.collect(), vec![joint], vec![steering; 2])
    }

    /// Three to six wheels on the body itself; of these, three touch. Centres `[x, y, z]` [m].
    #[inline]
    pub fn rigid(wheels: &[(&str, [f64; 3], Option<SteeringRange>)], wheel_radius: f64) -> Result<Self, Error> {
        positive("wheel_radius", wheel_radius)?;
        let (mut parts, mut mounts, mut ranges) = (Vec::new(), Vec::new(), Vec::new());
        for (name, centre, range) in wheels {
            finite("wheels", centre)?;
            let steering = range.map(|range| range.check().map(|()| ranges.push(range))).transpose()?;
            let joint = steering.map(|()| ranges.len() - 1);
            let name = Cow::Owned((*name).to_owned());
            mounts.push(mount(&mut parts, name, None, Vector3::from(*centre), wheel_radius, joint));
        }
        Self::new(parts, mounts, Vec::new(), ranges)
    }
}

/// A vector of the left-hand side (0), or its mirror image (1).
fn on_side([x, y, z]: [f64; 3], side: usize) -> Vector3<f64> {
    Vector3::new(x, if side == 0 { y } else { -y }, z)
}

/// A wheel on its carrier, behind a knuckle if it steers.
fn mount(
    parts: &mut Vec<ChainLink>,
    name: Cow<'static, str>,
    carrier: Option<usize>,
    centre: Vector3<f64>,
    radius: f64,
    steering: Option<usize>,
) -> Mount {
    let Some(joint) = steering else {
        return Mount { name, part: carrier, centre, radius };
    };
    parts.push(ChainLink {
        name: format!("{name} steering").into(),
        parent: carrier,
        origin: centre,
        axis: Vector3::z_axis(),
        turning: Turning::Steering(joint),
    });
    Mount { name, part: Some(parts.len() - 1), centre: Vector3::zeros(), radius }
}
