//! Vehicles that are chains: settled in lanes as alone, slopes of their points.

use nalgebra::{Unit, Vector3};
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::level::Level;
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_terrain::ground::{Settler, Stand, Status, settle};
use six_wheel_terrain::suspension::{
    Chain, ChainLink, Differential, Joint, JointRange, Mount, PlanPose, RockerBogie, Steered, TripleBogie, Turning,
};
use six_wheel_terrain::terrain::{Heights, Terrain};

fn chains() -> Result<Vec<Chain>, Error> {
    let level = SteeringRange::default();
    let mut bar = *RockerBogie::perseverance()?.dimensions();
    bar.differential = Differential::Bar { half_length: 0.6, lever: 0.2, rod: 0.3 };
    bar.steered = Steered::All;
    Ok(vec![
        Chain::rocker_bogie(RockerBogie::rocky7()?.dimensions())?,
        Chain::rocker_bogie(&bar)?,
        Chain::rocker_bogie(RockerBogie::open_source_rover()?.dimensions())?,
        Chain::triple_bogie(&TripleBogie {
            bogie_pivot: [0.13, 0.3, 0.1],
            bogie_to_front: [0.13, 0.0, -0.1],
            bogie_to_middle: [-0.13, 0.0, -0.1],
            rear_pivot: [-0.26, 0.0, 0.1],
            rear_to_wheel: [0.0, 0.3, -0.1],
            wheel_radius: 0.07,
            steered: [true, false, true],
            steering: level,
            bogie_limit: JointRange::default(),
        })?,
        Chain::pivoting_axles(1.91, 1.64, 0.119, 0.325, level, JointRange::default())?,
        Chain::rigid(
            &[
                ("fl", [0.5, 0.4, 0.1], Some(level)),
                ("fr", [0.5, -0.4, 0.1], Some(level)),
                ("rl", [-0.5, 0.4, 0.1], None),
                ("rr", [-0.5, -0.4, 0.1], None),
            ],
            0.1,
        )?,
        tilted_axes()?,
    ])
}

/// Rockers and bogies none of whose axes is one of their parent.
fn tilted_axes() -> Result<Chain, Error> {
    let part = |parent, origin: [f64; 3], axis: [f64; 3], turning| ChainLink {
        name: "part".into(),
        parent,
        origin: origin.into(),
        axis: Unit::new_normalize(axis.into()),
        turning,
    };
    let parts = vec![
        part(None, [0.3, 0.8, 0.9], [0.1, 1.0, 0.05], Turning::Free(0)),
        part(None, [0.3, -0.8, 0.9], [-0.1, 1.0, -0.05], Turning::Across(0, Differential::Gear)),
        part(Some(0), [-0.75, 0.12, -0.23], [0.0, 1.0, 0.2], Turning::Free(1)),
        part(Some(1), [-0.75, -0.12, -0.23], [0.1, 1.0, 0.0], Turning::Free(2)),
        part(Some(0), [0.88, 0.26, -0.63], [0.1, 0.0, 1.0], Turning::Steering(0)),
    ];
    let mounts = [
        (4, [0.0; 3]),
        (1, [0.88, -0.26, -0.63]),
        (2, [0.45, 0.26, -0.4]),
        (3, [0.45, -0.26, -0.4]),
        (2, [-0.62, 0.14, -0.4]),
        (3, [-0.62, -0.14, -0.4]),
    ];
    let wheel = |(part, centre): (usize, [f64; 3])| Mount {
        name: "wheel".into(),
        part: Some(part),
        centre: centre.into(),
        radius: 0.26,
    };
    let joint = Joint { name: "joint".into(), range: JointRange::default() };
    let wheels = mounts.into_iter().map(wheel).collect();
    Chain::new(parts, wheels, vec![joint.clone(), joint.clone(), joint], vec![SteeringRange::default()])
}

#[test]
fn every_chain_settles_in_lanes_as_alone() -> Result<(), Error> {
    let heights: Vec<f32> = (0..6400_u16)
        .map(|k| (f32::from(k % 80) * 0.31).sin() * 0.06 + (f32::from(k / 80) * 0.17).cos() * 0.1)
        .collect();
    let ground = Terrain::new(Heights::Single(heights.into()), 80, [0.1; 2], [0.0; 2], 0.2)?;
    let poses: Vec<[f64; 3]> = (0..16_u8).map(|k| [1.5 + 0.2 * f64::from(k), 4.5, 0.4 * f64::from(k)]).collect();
    for chain in chains()? {
        let steering = vec![0.2; chain.steering().len()];
        for level in Level::available() {
            let settler = Settler { level, ..Settler::new(&ground, &chain) };
            let mut stands = vec![Stand::nothing(Status::NotConverged); poses.len()];
            settle(&settler, &poses, &steering, Workers::PLAIN, &mut stands)?;
            for (pose, stand) in poses.iter().zip(&stands) {
                let alone = settler.settle((*pose).into(), &steering)?;
                assert!(stand.status == Status::Settled);
                let bits = |stand: &Stand| (stand.status, stand.numbers().map(f64::to_bits));
                assert_eq!(bits(stand), bits(&alone), "{level:?}");
            }
        }
    }
    Ok(())
}

#[test]
fn slopes_are_the_differences_of_points() -> Result<(), Error> {
    let (steering, rim) = ([0.2, -0.1, 0.3, 0.05, -0.2, 0.1], Vector3::new(0.03, 0.0, -0.04));
    let numbers = [0.3, -0.2, 0.7, 0.4, 0.1, -0.2, 0.15, -0.1, 0.25];
    let at = |chain: &Chain, numbers: [f64; 9], wheel: usize| {
        let [x, y, yaw, state @ ..] = numbers;
        let placed = chain.place(PlanPose { x, y, yaw }, &state, &steering);
        let placed = placed.ok_or_else(|| Error::value("rho", "be within reach", "more"))?;
        let frame = placed.wheel(wheel);
        let point = frame.centre + frame.forward * rim.x + frame.up * rim.z;
        Ok::<_, Error>((point, placed.point_slopes(wheel, point)))
    };
    for chain in chains()? {
        for wheel in 0..chain.wheels().len() {
            let (_, slopes) = at(&chain, numbers, wheel)?;
            for k in 0..3 + chain.state_count() {
                let step = 1e-6;
                let (mut ahead, mut behind) = (numbers, numbers);
                ahead[k] += step;
                behind[k] -= step;
                let difference = (at(&chain, ahead, wheel)?.0 - at(&chain, behind, wheel)?.0) / (2.0 * step);
                // Rounding: 1 m / 1e-6 of 2e-16.
                assert!((slopes[k] - difference).amax() < 1e-9, "{wheel} {k}");
            }
        }
    }
    Ok(())
}
