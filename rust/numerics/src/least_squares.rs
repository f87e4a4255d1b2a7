//! Small systems of equations in arrays on the stack.

use nalgebra::{SMatrix, SVector};

use crate::jacobi::Jacobi;

/// A column depends on the others if its pivot is at most this share of the largest pivot.
pub const DEPENDENT: f64 = 1e-10;

/// The shortest least-squares solution of three unknowns, from the triangle of their columns and the right-hand
/// side: directions that the rows do not determine are 0.
#[inline]
pub fn shortest(triangle: [[f64; 4]; 3]) -> [f64; 3] {
    let matrix = SMatrix::<f64, 3, 3>::from_fn(|i, j| triangle[i][j]);
    let right = SVector::<f64, 3>::from_fn(|i, _| triangle[i][3]);
    let values = Jacobi::new(&matrix);
    let bound = DEPENDENT * values.values[0];
    values.solve(&right, bound).into()
}
