//! The clearance of the underside of the body, against dense sampling.

use nalgebra::{Rotation3, Vector3};
use six_wheel_numerics::error::Error;
use six_wheel_terrain::bounds::Belly;
use six_wheel_terrain::terrain::{Heights, Interpolation, Sample, Terrain};

#[test]
fn clearance_is_that_of_dense_sampling() -> Result<(), Error> {
    let heights: Vec<f64> =
        (0_u32..1600).map(|k| f64::from(k.wrapping_mul(2_654_435_761) >> 16 & 255) / 2000.0).collect();
    let ground = Terrain::new(Heights::Double(heights.into()), 40, [0.1, 0.12], [0.0, 0.0], 0.3)?;
    let belly = Belly::new([-0.5, 0.7], 0.4, 0.3)?;
    for k in 0..20 {
        let yaw = f64::from(k) * 0.7;
        let rotation = Rotation3::from_euler_angles(0.1, -0.15, yaw).into_inner();
        let [x, y] = ground.placement().world_from_grid(20.3, 19.1);
        let origin = Vector3::new(x, y, 0.1);
        let exact = belly.clearance(&ground, origin, &rotation).unwrap_or(f64::NAN);
        let mut dense = f64::INFINITY;
        for i in 0..=400 {
            for j in 0..=400 {
                let x = -0.5 + 1.2 * f64::from(i) / 400.0;
                let y = -0.4 + 0.8 * f64::from(j) / 400.0;
                let point = origin + rotation * Vector3::new(x, y, 0.3);
                let sample = ground.sample(point.x, point.y, Interpolation::Bilinear);
                if let Sample::Known { height, .. } = sample {
                    dense = dense.min(point.z - height);
                }
            }
        }
        // Samples 3 mm apart on slopes of up to 2.
        assert!(exact <= dense + 1e-12 && exact > dense - 6e-3, "{k} {exact} {dense}");
    }
    Ok(())
}
