//! Small systems of equations in lanes: what `least_squares` does for one.

use super::super::least_squares::DEPENDENT;
use crate::batch::machine::lanes::Lanes;
use crate::batch::machine::vector::Vector;
use crate::suspension::lanes::all;

/// Rotates rows so that the first `used` of their columns become upper triangular, by Householder reflections; the
/// columns after them go along, up to `width`.
#[inline(always)]
pub(super) fn triangular<S: Vector, const W: usize>(
    simd: S,
    rows: &mut [[Lanes<S>; W]],
    used: usize,
    width: usize,
) {
    let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
    for j in 0..used.min(rows.len()).min(W) {
        let mut square = zero;
        for row in &rows[j..] {
            square = row[j].mul_add(row[j], square);
        }
        let head = rows[j][j];
        let size = square.sqrt();
        let image = zero.below(head).select(-size, size);
        let half = image * (image - head);
        let empty = square.at_most(zero);
        let inverse = empty.select(zero, one.quotient(empty.select(one, half)));
        let lead = head - image;
        for k in j + 1..width.min(W) {
            let mut along = lead * rows[j][k];
            for row in &rows[j + 1..] {
                along = row[j].mul_add(row[k], along);
            }
            let share = -(along * inverse);
            rows[j][k] = share.mul_add(lead, rows[j][k]);
            for row in &mut rows[j + 1..] {
                row[k] = share.mul_add(row[j], row[k]);
            }
        }
        rows[j][j] = image;
    }
}

/// Solves what [`triangular`] has made, for the `K` columns after the first `used`. NaN where the columns depend on
/// each other.
#[inline(always)]
pub(super) fn back<S: Vector, const W: usize, const C: usize, const K: usize>(
    simd: S,
    rows: &[[Lanes<S>; W]],
    used: usize,
) -> [[Lanes<S>; K]; C] {
    let (one, nan) = (all(simd, 1.0), all(simd, f64::NAN));
    let used = used.min(C);
    let mut solution = [[all(simd, 0.0); K]; C];
    if rows.len() < used {
        return [[nan; K]; C];
    }
    let mut longest = all(simd, 0.0);
    for (j, row) in rows.iter().enumerate().take(used) {
        longest = longest.max(row[j].abs());
    }
    let bound = all(simd, DEPENDENT) * longest;
    for j in (0..used).rev() {
        let pivot = rows[j][j];
        let inverse = bound.below(pivot.abs()).select(one.quotient(pivot), nan);
        for k in 0..K {
            let mut rest = rows[j][(used + k) % W];
            for i in j + 1..used {
                rest = (-rows[j][i]).mul_add(solution[i][k], rest);
            }
            solution[j][k] = rest * inverse;
        }
    }
    solution
}
