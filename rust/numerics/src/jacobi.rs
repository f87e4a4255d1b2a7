//! Singular values of small matrices by one-sided Jacobi rotations.
//!
//! The vectors that nalgebra 0.35 finds for matrices that lack rank can be wrong: for side-slip rows of a dual
//! differential drive its factors miss the matrix by up to 0.3 (one is in the tests). Here columns are
//! turned until they are orthogonal, which is accurate to rounding whatever the rank.
//!
//! Source: J. Demmel, K. Veselic, Jacobi's Method is More Accurate than QR, SIAM J. Matrix Anal. Appl. 13(4),
//! 1992.

use nalgebra::{Matrix3, Matrix4x3, SMatrix, SVector, Vector3};

/// Columns whose cosine is below this are orthogonal.
const ORTHOGONAL: f64 = 4.0 * f64::EPSILON;

/// Sweeps over all pairs of columns; convergence is quadratic, and a handful is enough.
const SWEEPS: usize = 30;

/// `matrix = columns * turn.transpose()`, with orthogonal columns, longest first, and an orthogonal turn.
#[derive(Clone, Copy, Debug)]
pub struct Jacobi<const R: usize, const C: usize> {
    /// Left singular vectors times the singular values.
    pub columns: SMatrix<f64, R, C>,
    /// Right singular vectors.
    pub turn: SMatrix<f64, C, C>,
    /// Lengths of the columns, descending.
    pub values: SVector<f64, C>,
}

impl<const R: usize, const C: usize> Jacobi<R, C> {
    /// Singular value decomposition of a matrix.
    pub fn new(matrix: &SMatrix<f64, R, C>) -> Self {
        let mut columns = *matrix;
        let mut turn = SMatrix::<f64, C, C>::identity();
        for _ in 0..SWEEPS {
            let mut turned = false;
            for i in 0..C {
                for k in i + 1..C {
                    turned |= orthogonalise(&mut columns, &mut turn, i, k);
                }
            }
            if !turned {
                break;
            }
        }
        // Selection sort: there are no more than seven columns.
        let mut values = SVector::<f64, C>::from_fn(|k, _| columns.column(k).norm());
        for k in 0..C {
            let longest = (k..C).fold(k, |a, b| if values[b] > values[a] { b } else { a });
            values.swap_rows(k, longest);
            columns.swap_columns(k, longest);
            turn.swap_columns(k, longest);
        }
        Self { columns, turn, values }
    }

    /// Number of singular values above a bound.
    #[inline]
    pub fn rank(&self, bound: f64) -> usize {
        self.values.iter().filter(|value| **value > bound).count()
    }

    /// Shortest least-squares solution for a right-hand side, directions with a singular value up to a bound left at
    /// zero.
    pub fn solve(&self, right: &SVector<f64, R>, bound: f64) -> SVector<f64, C> {
        let mut found = SVector::zeros();
        for k in 0..self.rank(bound) {
            let share = self.columns.column(k).dot(right) / (self.values[k] * self.values[k]);
            found += self.turn.column(k) * share;
        }
        found
    }

    /// Pseudo-inverse, directions with a singular value up to a bound left at zero.
    pub fn inverse(&self, bound: f64) -> SMatrix<f64, C, R> {
        let mut inverse = SMatrix::zeros();
        for k in 0..self.rank(bound) {
            let share = self.columns.column(k) / (self.values[k] * self.values[k]);
            inverse += self.turn.column(k) * share.transpose();
        }
        inverse
    }
}

/// Rotates two columns so that they are orthogonal. Returns true if they were not.
fn orthogonalise<const R: usize, const C: usize>(
    columns: &mut SMatrix<f64, R, C>,
    turn: &mut SMatrix<f64, C, C>,
    i: usize,
    k: usize,
) -> bool {
    let (a, b) = (columns.column(i), columns.column(k));
    let (aa, bb, ab) = (a.norm_squared(), b.norm_squared(), a.dot(&b));
    if ab.abs() <= ORTHOGONAL * (aa * bb).sqrt() {
        return false;
    }
    let zeta = (bb - aa) / (2.0 * ab);
    let tangent = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
    let cosine = tangent.hypot(1.0).recip();
    rotate(columns, i, k, cosine, cosine * tangent);
    rotate(turn, i, k, cosine, cosine * tangent);
    true
}

fn rotate<const R: usize, const C: usize>(matrix: &mut SMatrix<f64, R, C>, i: usize, k: usize, cosine: f64, sine: f64) {
    for row in 0..R {
        let (a, b) = (matrix[(row, i)], matrix[(row, k)]);
        matrix[(row, i)] = cosine * a - sine * b;
        matrix[(row, k)] = sine * a + cosine * b;
    }
}

/// The triangular factor of stacked rows, folded row by row: same singular values, same right vectors.
pub fn triangle(rows: impl Iterator<Item = Vector3<f64>>) -> Matrix3<f64> {
    rows.fold(Matrix3::zeros(), |triangle, row| {
        let mut stack = Matrix4x3::zeros();
        stack.fixed_view_mut::<3, 3>(0, 0).copy_from(&triangle);
        stack.set_row(3, &row.transpose());
        stack.qr().r()
    })
}
