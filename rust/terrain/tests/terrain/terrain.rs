//! Heights and gradients of a grid.

use std::sync::Arc;

use six_wheel_numerics::error::Error;
use six_wheel_terrain::terrain::{Heights, Interpolation, Sample, Terrain};

fn ramp(yaw: f64) -> Result<Terrain, Error> {
    // 4 rows, 5 columns of a plane: 1 + 0.3 u - 0.2 v in the axes of the grid.
    let heights: Vec<f64> =
        (0..20).map(|k| 1.0 + 0.3 * 0.5 * f64::from(k % 5) - 0.2 * 0.25 * f64::from(k / 5)).collect();
    Terrain::new(Heights::Double(Arc::new(heights)), 5, [0.5, 0.25], [2.0, -3.0], yaw)
}

#[test]
fn a_plane_is_itself_everywhere_by_both_interpolations() -> Result<(), Error> {
    for yaw in [0.0, 0.7, -2.0] {
        let ground = ramp(yaw)?;
        for (u, v) in [(0.0, 0.0), (0.1, 0.7), (1.99, 0.01), (2.0, 0.75), (0.3, 0.3)] {
            let [x, y] = ground.placement().world_from_grid(u / 0.5, v / 0.25);
            let [gx, gy] = ground.placement().world_axes([0.3, -0.2]);
            for method in [Interpolation::Bilinear, Interpolation::Bicubic] {
                let [back, _] = ground.placement().grid_from_world(x, y);
                if !(0.0..=4.0).contains(&back) {
                    continue; // rounded off the rim
                }
                let Sample::Known { height, gradient } = ground.sample(x, y, method) else {
                    continue;
                };
                assert!((height - (1.0 + 0.3 * u - 0.2 * v)).abs() < 1e-14);
                assert!((gradient[0] - gx).abs() < 1e-13 && (gradient[1] - gy).abs() < 1e-13);
            }
        }
    }
    Ok(())
}

#[test]
fn the_outside_and_the_unknown_are_answers() -> Result<(), Error> {
    let mut heights = vec![0.0_f32; 9];
    heights[4] = f32::NAN;
    let ground = Terrain::new(Heights::Single(Arc::new(heights)), 3, [1.0; 2], [0.0; 2], 0.0)?;
    let sample = |x, y| ground.sample(x, y, Interpolation::Bilinear);
    assert_eq!(sample(0.5, 0.5), Sample::Unknown);
    assert_eq!(sample(2.0 + 1e-12, 0.5), Sample::Outside);
    assert_eq!(sample(f64::NAN, 0.5), Sample::Outside);
    Ok(())
}
