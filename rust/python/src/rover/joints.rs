//! The joints of a rover's wheels: their names, their order and the sense in which they count.

use pyo3::prelude::*;
use pyo3::types::PyMapping;
use six_wheel_kinematics::rover::Rover as Core;

use crate::convert::refuse;

/// A joint of the robot: what it is called there, the index of its wheel, and which way it counts.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Joint {
    pub name: String,
    pub wheel: usize,
    pub reversed: bool,
}

impl Joint {
    /// Takes the wheel's angle or speed to the joint's and back: 1, or -1 for a reversed joint.
    pub fn sign(&self) -> f64 {
        if self.reversed { -1.0 } else { 1.0 }
    }
}

/// The joints of a kind, in the order of the commands.
pub type Joints = Vec<Joint>;

pub const TRACTION: &str = "wheel_joint";
pub const STEERING: &str = "steering_joint";

/// The joints of these wheels under their default names.
pub fn default_joints(core: &Core, wheels: &[usize], suffix: &str) -> Joints {
    wheels
        .iter()
        .map(|&wheel| Joint { name: format!("{}_{suffix}", core.wheels()[wheel].name), wheel, reversed: false })
        .collect()
}

/// Marks the joints that count the other way, each of which must be there.
pub fn reverse(reversed: &[String], traction: &mut Joints, steering: &mut Joints) -> PyResult<()> {
    for name in reversed {
        let mut joints = traction.iter_mut().chain(steering.iter_mut());
        let Some(joint) = joints.find(|joint| joint.name == *name) else {
            let names: Vec<_> = (traction.iter().chain(steering.iter())).map(|joint| joint.name.as_str()).collect();
            let rule = format!("be some of the joints {}", names.join(", "));
            return Err(refuse("reversed_joints", &rule, format!("{name:?}")));
        };
        if std::mem::replace(&mut joint.reversed, true) {
            return Err(refuse("reversed_joints", "name every joint once", format!("{name:?} twice")));
        }
    }
    Ok(())
}

/// Reads a mapping of joint names to wheel names, which must name each of these wheels once.
pub fn read_joints(
    core: &Core,
    wheels: &[usize],
    argument: &str,
    given: Option<&Bound<'_, PyMapping>>,
    suffix: &str,
) -> PyResult<Joints> {
    let Some(given) = given else { return Ok(default_joints(core, wheels, suffix)) };
    let mut joints = Joints::new();
    for item in given.items()?.iter() {
        let (joint, wheel) = item.extract::<(String, String)>()?;
        let found = wheels.iter().copied().find(|&i| core.wheels()[i].name == wheel);
        let Some(index) = found else {
            let names: Vec<_> = wheels.iter().map(|&i| core.wheels()[i].name.as_str()).collect();
            let rule = format!("map joints to the wheels {}", names.join(", "));
            return Err(refuse(argument, &rule, format!("{wheel:?} for {joint:?}")));
        };
        if joints.iter().any(|other| other.wheel == index) {
            return Err(refuse(argument, "name every wheel once", format!("{wheel:?} twice")));
        }
        if joints.iter().any(|other| other.name == joint) {
            return Err(refuse(argument, "name every joint once", format!("{joint:?} twice")));
        }
        joints.push(Joint { name: joint, wheel: index, reversed: false });
    }
    if let Some(&missing) = wheels.iter().find(|&&i| joints.iter().all(|other| other.wheel != i)) {
        let got = format!("no joint for {:?}", core.wheels()[missing].name);
        return Err(refuse(argument, "name every wheel once", &got));
    }
    Ok(joints)
}

/// The same joints in the order in which arrays have their values.
pub fn in_order_of_wheels(joints: &Joints) -> Joints {
    let mut joints = joints.clone();
    joints.sort_by_key(|joint| joint.wheel);
    joints
}
