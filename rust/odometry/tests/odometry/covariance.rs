//! Products of symmetric matrices of three rows.

use nalgebra::{Matrix3, Vector3};
use six_wheel_odometry::covariance::{Covariance3, lane};

#[test]
fn products_are_those_of_the_whole_matrices() {
    let mut covariance = Covariance3::default();
    covariance.add(&Vector3::new(1.0, -2.0, 0.5), 1.0);
    covariance.add(&Vector3::new(0.3, 0.7, -1.1), 2.0);
    let a = Matrix3::new(1.0, 0.2, -0.4, 0.5, -1.0, 0.3, 0.1, 0.0, 2.0);
    let whole = a * covariance.matrix() * a.transpose();
    assert!((covariance.image(&a).matrix() - whole).amax() < 1e-14);
    let lever = [0.4, -0.9];
    let swing = Matrix3::new(1.0, 0.0, lever[0], 0.0, 1.0, lever[1], 0.0, 0.0, 1.0);
    assert!(
        (covariance.lane().propagate(lane(lever)).total().matrix() - covariance.image(&swing).matrix()).amax() < 1e-14
    );
    let a = Matrix3::new(1.0, 0.2, -0.4, 0.5, -1.0, 0.3, 0.0, 0.0, 1.0);
    let moved = covariance.lane().displacement_image(&[lane([1.0, 0.2, -0.4]), lane([0.5, -1.0, 0.3])]).total();
    assert!((moved.matrix() - covariance.image(&a).matrix()).amax() < 1e-14);
    assert_eq!(Covariance3::of(&covariance.matrix()), covariance);
}
