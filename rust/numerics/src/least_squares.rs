//! Small systems of equations in arrays on the stack.

use nalgebra::{SMatrix, SVector};

use crate::jacobi::Jacobi;

/// A column depends on the others if its pivot is at most this share of the largest pivot.
pub const DEPENDENT: f64 = 1e-10;

/// Makes the first `used` columns of the first `count` rows upper triangular, by Householder reflections, which are
/// applied to the columns after them too: the triangle is `Qᵀ A`, and the later columns become `Qᵀ b`. `count >= used`.
pub fn triangular<const R: usize, const W: usize>(rows: &mut [[f64; W]; R], count: usize, used: usize) {
    for j in 0..used {
        let mut square = 0.0;
        for row in &rows[j..count] {
            square += row[j] * row[j];
        }
        let head = rows[j][j];
        let size = square.sqrt();
        if size == 0.0 {
            continue;
        }
        let image = if head > 0.0 { -size } else { size };
        // v = column - image e_j, and v . v / 2 = image (image - head).
        let half = image * (image - head);
        let lead = head - image;
        for k in j + 1..W {
            let mut along = lead * rows[j][k];
            for row in &rows[j + 1..count] {
                along += row[j] * row[k];
            }
            let share = along / half;
            rows[j][k] -= share * lead;
            for row in &mut rows[j + 1..count] {
                row[k] -= share * row[j];
            }
        }
        rows[j][j] = image;
        for row in &mut rows[j + 1..count] {
            row[j] = 0.0;
        }
    }
}

/// Back substitution in the triangle of [`triangular`], for the `K` right-hand sides after its first `used` columns.
/// NaN where the columns depend on each other.
pub fn back<const R: usize, const W: usize, const C: usize, const K: usize>(
    rows: &[[f64; W]; R],
    used: usize,
) -> [[f64; K]; C] {
    let mut solution = [[0.0; K]; C];
    let longest = (0..used).fold(0.0, |most: f64, j| most.max(rows[j][j].abs()));
    for j in (0..used).rev() {
        let pivot = rows[j][j];
        let known = pivot.abs() > DEPENDENT * longest;
        for k in 0..K {
            let mut rest = rows[j][used + k];
            for i in j + 1..used {
                rest -= rows[j][i] * solution[i][k];
            }
            solution[j][k] = if known { rest / pivot } else { f64::NAN };
        }
    }
    solution
}

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
