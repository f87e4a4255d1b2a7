//! The border of a map of costs.

use six_wheel_kinematics::geometry::GridPlacement;
use six_wheel_numerics::error::Error;
use six_wheel_planner::Costmap;

/// The 20th column from -5 m on with 0.1 m between columns is at -3.1 m, which is 19.000000000000004 columns from there.
#[test]
fn the_border_is_on_the_map() -> Result<(), Error> {
    for (spacing, origin) in [(0.1, [-5.0, -0.2]), (0.05, [-17.35, 1e6]), (1.0 / 3.0, [0.0; 2])] {
        for yaw in [0.0, 0.7, -2.5] {
            let placement = GridPlacement::new([spacing; 2], origin, yaw)?;
            let map = Costmap::new(vec![0.0; 40 * 20], [40, 20], placement, None, None)?;
            for step in 0..=100 {
                let (column, row) = (0.19 * f64::from(step), 0.39 * f64::from(step));
                for [u, v] in [[column, 0.0], [column, 39.0], [0.0, row], [19.0, row]] {
                    let [x, y] = placement.world_from_grid(u, v);
                    map.check_holds([x, y, 0.0])?;
                }
            }
            for [u, v] in [[-1e-3, 5.0], [19.001, 5.0], [5.0, -1e-3], [5.0, 39.001], [f64::NAN, 5.0]] {
                let [x, y] = placement.world_from_grid(u, v);
                assert!(map.check_holds([x, y, 0.0]).is_err());
            }
        }
    }
    Ok(())
}
