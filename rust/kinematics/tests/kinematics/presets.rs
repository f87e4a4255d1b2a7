//! Published rovers.

use six_wheel_kinematics::presets::{PRESETS, Preset, preset};
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_numerics::error::Error;

#[test]
fn every_preset_is_a_rover_that_is_known_again() {
    let range = SteeringRange { lower: -0.3, upper: 0.4 };
    for Preset { name, .. } in PRESETS {
        assert_eq!(preset(name, None).ok().and_then(|rover| Preset::of(&rover)), Some((name, None)));
        if let Ok(rover) = preset(name, Some(range)) {
            assert_eq!(Preset::of(&rover), Some((name, Some(range))));
        }
    }
}

#[test]
fn the_rocky_7_bogie_joint_is_where_its_link_puts_it() -> Result<(), Error> {
    let reach = 0.12075 + 0.16 * 139.0_f64.to_radians().cos();
    let front = preset("rocky7", None)?.wheels()[0].x;
    assert!((front - (0.12075 + 0.288 - reach)).abs() < 1e-16);
    Ok(())
}
