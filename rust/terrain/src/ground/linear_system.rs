//! Small systems of linear equations in plain numbers: derivatives of settled poses, and loads.

use super::pivots::SMALLEST_PIVOT;
use crate::suspension::{MAX_STATE, MAX_WHEELS};

/// As many equations as unknowns, at most six, with `RIGHT` right-hand sides.
pub(crate) struct LinearSystem<const RIGHT: usize> {
    /// Rows of coefficients.
    pub rows: [[f64; MAX_STATE]; MAX_WHEELS],
    /// Right-hand sides, row by row.
    pub right: [[f64; RIGHT]; MAX_WHEELS],
    /// Number of both.
    pub count: usize,
}

impl<const RIGHT: usize> LinearSystem<RIGHT> {
    #[inline]
    pub fn empty() -> Self {
        Self { rows: [[0.0; MAX_STATE]; MAX_WHEELS], right: [[0.0; RIGHT]; MAX_WHEELS], count: 0 }
    }

    /// Adds an equation.
    #[inline]
    pub fn push(&mut self, row: [f64; MAX_STATE], right: [f64; RIGHT]) {
        self.rows[self.count] = row;
        self.right[self.count] = right;
        self.count += 1;
    }

    /// Solves by elimination with row exchanges: the solutions in place of the right-hand sides. None if it is
    /// singular.
    #[inline]
    pub fn solve(mut self) -> Option<[[f64; RIGHT]; MAX_WHEELS]> {
        let n = self.count;
        for k in 0..n {
            let largest = (k..n).max_by(|&a, &b| self.rows[a][k].abs().total_cmp(&self.rows[b][k].abs()))?;
            self.rows.swap(k, largest);
            self.right.swap(k, largest);
            let pivot = self.rows[k][k];
            if pivot.abs() < SMALLEST_PIVOT || !pivot.is_finite() {
                return None;
            }
            let (above, below) = self.rows.split_at_mut(k + 1);
            let (right_above, right_below) = self.right.split_at_mut(k + 1);
            for (row, right) in below.iter_mut().zip(right_below).take(n - k - 1) {
                let factor = row[k] / pivot;
                for (x, y) in row.iter_mut().zip(&above[k]).take(n).skip(k) {
                    *x -= factor * y;
                }
                for (x, y) in right.iter_mut().zip(&right_above[k]) {
                    *x -= factor * y;
                }
            }
        }
        for k in (0..n).rev() {
            for c in 0..RIGHT {
                let known: f64 = (k + 1..n).map(|j| self.rows[k][j] * self.right[j][c]).sum();
                self.right[k][c] = (self.right[k][c] - known) / self.rows[k][k];
            }
        }
        Some(self.right)
    }
}
