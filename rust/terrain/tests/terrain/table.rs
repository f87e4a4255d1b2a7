//! The Denavit-Hartenberg table of a rocker-bogie.

use nalgebra::{Matrix3, Rotation3, Vector3};
use six_wheel_kinematics::geometry::Direction;
use six_wheel_numerics::error::Error;
use six_wheel_terrain::suspension::{Bogie, Differential, FRAMES, Frame, Link, RockerBogie};

/// The rows of the table multiplied, parents before children.
fn multiplied(links: &[Link; FRAMES], joints: &[f64], right_rocker: f64) -> [Frame; FRAMES] {
    let mut frames = [(Matrix3::identity(), Vector3::zeros()); FRAMES];
    for (k, link) in links.iter().enumerate() {
        let (rotation, origin) = link.parent.map_or(frames[FRAMES - 1], |parent| frames[parent]);
        let turned = match link.joint {
            Some((0, sense)) if sense < 0.0 => right_rocker,
            other => other.map_or(0.0, |(joint, _)| joints[joint]),
        };
        let gamma = Rotation3::from_axis_angle(&Vector3::z_axis(), link.gamma + turned).into_inner();
        let Direction { sin, cos } = link.alpha;
        let alpha = Matrix3::new(1.0, 0.0, 0.0, 0.0, cos, -sin, 0.0, sin, cos);
        frames[k] = (rotation * gamma * alpha, origin + rotation * gamma * Vector3::new(link.a, 0.0, link.d));
    }
    frames
}

#[test]
fn a_rocker_bogie_is_its_table() -> Result<(), Error> {
    let mut rovers = vec![RockerBogie::rocky7()?, RockerBogie::open_source_rover()?];
    let mut bar = *RockerBogie::perseverance()?.dimensions();
    bar.differential = Differential::Bar { half_length: 0.6, lever: 0.2, rod: 0.3 };
    rovers.push(RockerBogie::new(bar)?);
    assert_eq!(rovers[1].dimensions().bogie, Bogie::InFront);
    for rover in rovers {
        let joints = [0.2, -0.3, 0.1, 0.4, -0.5, 0.6, -0.7];
        let joints = &joints[..rover.joint_count()];
        let [right, _] = rover.dimensions().differential.right(joints[0]).unwrap_or([f64::NAN; 2]);
        let table = multiplied(rover.links(), joints, right);
        for ((rotation, origin), expected) in rover.frames(joints)?.into_iter().zip(table) {
            assert!((origin - expected.1).amax() < 1e-15);
            assert!((rotation - expected.0).amax() < 1e-15);
        }
    }
    Ok(())
}

#[test]
fn the_number_of_joints_is_checked() -> Result<(), Error> {
    let rover = RockerBogie::rocky7()?;
    let Err(error) = rover.place(&[0.0; 4]) else {
        return Err(Error::value("joints", "be refused", "4"));
    };
    assert_eq!(error.to_string(), "joints must hold 5 angles, got 4");
    Ok(())
}
