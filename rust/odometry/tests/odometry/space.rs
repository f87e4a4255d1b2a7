//! Motions in space and the Jacobians of their exponential.

use nalgebra::Vector6;
use six_wheel_kinematics::geometry::Twist;
use six_wheel_odometry::preintegrated::space::{Motion3, left_jacobian, right_jacobian};

fn tangents() -> Vec<Vector6<f64>> {
    let directions = [Vector6::new(0.4, -0.3, 0.2, 0.6, -0.5, 0.62), Vector6::new(1.0, 0.5, 0.0, 0.0, 0.0, 1.0)];
    let sizes = [0.0, 1e-9, 1e-3, 0.2999, 0.3001, 1.0, 2.9];
    let all = directions.iter().flat_map(|d| sizes.map(|size| d * size));
    all.collect()
}

#[test]
fn the_logarithm_undoes_the_exponential() {
    for tangent in tangents() {
        let back = Motion3::exp(&tangent).log();
        assert!((back - tangent).amax() < 1e-13, "{tangent} {back}");
    }
}

#[test]
fn jacobians_are_differences() {
    for tangent in tangents() {
        let (left, right) = (left_jacobian(&tangent), right_jacobian(&tangent));
        let here = Motion3::exp(&tangent);
        for k in 0..6 {
            let mut step = Vector6::zeros();
            step[k] = 1e-6;
            let more = Motion3::exp(&(tangent + step));
            let less = Motion3::exp(&(tangent - step));
            let by_left = (more.compose(&here.inverse()).log() - less.compose(&here.inverse()).log()) / 2e-6;
            let by_right = (here.inverse().compose(&more).log() - here.inverse().compose(&less).log()) / 2e-6;
            assert!((by_left - left.column(k)).amax() < 1e-9, "{tangent} {k}");
            assert!((by_right - right.column(k)).amax() < 1e-9, "{tangent} {k}");
        }
        let swapped = here.adjoint() * right;
        assert!((swapped - left).amax() < 1e-13);
    }
}

#[test]
fn the_plane_is_that_of_the_plane() {
    let twist = Twist::from([0.4, -0.3, 1.2]);
    let (plane, space) = (twist.exp(1.0), Motion3::exp(&Vector6::new(0.4, -0.3, 0.0, 0.0, 0.0, 1.2)));
    let there = Motion3::planar(plane.into());
    assert!((there.translation - space.translation).amax() < 1e-15);
    assert!(there.rotation.angle_to(&space.rotation) < 1e-15);
}
