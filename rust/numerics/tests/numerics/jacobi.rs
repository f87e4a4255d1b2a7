//! Singular values of small matrices.

use nalgebra::{Matrix3, Matrix4x3, Vector3, Vector4};
use six_wheel_numerics::jacobi::Jacobi;

#[test]
fn the_factors_make_the_matrix_whatever_its_rank() {
    let full = Matrix4x3::new(1.0, 2.0, 3.0, 0.0, 1.0, -1.0, 4.0, 0.5, 0.0, 1e-9, 0.0, 2.0);
    let mut twice = full;
    twice.set_column(2, &(full.column(0) * 2.0));
    for (matrix, rank) in [(full, 3), (twice, 2), (Matrix4x3::zeros(), 0)] {
        let found = Jacobi::new(&matrix);
        assert_eq!(found.rank(1e-12), rank);
        assert!((found.columns * found.turn.transpose() - matrix).amax() < 1e-14);
        let square = found.turn.transpose() * found.turn;
        assert!((square - Matrix3::identity()).amax() < 1e-14);
        assert!(found.values.x >= found.values.y && found.values.y >= found.values.z);
    }
}

#[test]
fn side_slip_rows_of_two_axles_are_factored_to_rounding() {
    for k in -15..=15 {
        let (sin, cos) = (0.1 * f64::from(k) + 0.0194).sin_cos();
        let matrix = Matrix4x3::new(0.0, 1.0, 1.0, 0.0, 1.0, 1.0, -sin, cos, -cos, -sin, cos, -cos);
        let found = Jacobi::new(&matrix);
        assert!((found.columns * found.turn.transpose() - matrix).amax() < 1e-14);
        assert!(found.values.z < 1e-15, "{}", found.values.z);
    }
}

#[test]
fn a_consistent_system_is_solved_to_rounding() {
    let matrix = Matrix4x3::new(0.0, 1.0, 0.4, 0.0, 1.0, 0.4, 0.1, 0.99, -0.4, 0.1, 0.99, -0.41);
    let wanted = Vector3::new(0.5, -0.02, 0.06);
    let right: Vector4<f64> = matrix * wanted;
    let found = Jacobi::new(&matrix).solve(&right, 1e-9);
    assert!((found - wanted).amax() < 1e-13, "{found}");
}
