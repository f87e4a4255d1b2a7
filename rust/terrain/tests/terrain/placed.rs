//! Axes of a chain at its joint angles.

use nalgebra::Vector3;
use six_wheel_numerics::error::Error;
use six_wheel_terrain::suspension::{MAX_JOINTS, RockerBogie, WheelFrame};

#[test]
fn axes_move_the_points_and_directions_of_a_wheel() -> Result<(), Error> {
    let rover = RockerBogie::perseverance()?;
    let joints = [0.2, -0.3, 0.1, 0.4, -0.5, 0.6, -0.7];
    let (step, placed) = (1e-5, rover.place(&joints)?);
    // A point of the wheel and the direction of its axle.
    let rim = |frame: WheelFrame| (frame.centre + frame.forward * 0.1 + frame.axle * 0.05 - frame.up * 0.2, frame.axle);
    for wheel in 0..6 {
        let (mut point, mut axle) = ([Vector3::zeros(); MAX_JOINTS], [Vector3::zeros(); MAX_JOINTS]);
        let steering = placed.steering_axes(wheel).map(|(joint, axis, origin)| (3 + joint, axis, origin));
        let here = rim(placed.wheel(wheel));
        for (joint, axis, origin) in placed.free_axes(wheel).chain(steering) {
            point[joint] += axis.cross(&(here.0 - origin));
            axle[joint] += axis.cross(&here.1);
        }
        for joint in 0..7 {
            let moved = |step| {
                let mut joints = joints;
                joints[joint] += step;
                rover.place(&joints).map(|placed| rim(placed.wheel(wheel)))
            };
            let (ahead, behind) = (moved(step)?, moved(-step)?);
            // Truncation, arm step^2 / 6, and rounding, eps arm / step: 6e-11 together.
            assert!((point[joint] - (ahead.0 - behind.0) / (2.0 * step)).amax() < 5e-10, "{wheel} {joint}");
            assert!((axle[joint] - (ahead.1 - behind.1) / (2.0 * step)).amax() < 5e-10, "{wheel} {joint}");
        }
    }
    Ok(())
}
