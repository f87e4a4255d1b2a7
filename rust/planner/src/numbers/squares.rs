//! Quadratic forms of a motion, and the subset of them that can be the largest.

use nalgebra::DMatrix;

/// Share of a form below which a value counts as rounding.
pub(crate) const ROUNDING: f64 = 1e-12;
/// Number of forms above which pairs are not compared.
const MANY: usize = 16;

/// A quadratic form of a motion: coefficients of the products of components, `00 01 02 11 12 22`.
pub(crate) type Form = Vec<f64>;

/// Indices of the components of each coefficient of a form of `n` components.
pub(crate) fn pairs(n: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..n).flat_map(move |i| (i..n).map(move |j| (i, j)))
}

/// The product of two rows as a form.
pub(crate) fn product(rows: &[&[f64]], factor: f64) -> Form {
    let coefficient = |(i, j): (usize, usize)| {
        let twice = if i == j { 1.0 } else { 2.0 };
        rows.iter().map(|row| twice * factor * row[i] * row[j]).sum()
    };
    pairs(rows[0].len()).map(coefficient).collect()
}

/// The matrix of a form.
fn matrix(form: &[f64], n: usize) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(n, n);
    for ((i, j), part) in pairs(n).zip(form) {
        let value = if i == j { *part } else { part / 2.0 };
        (matrix[(i, j)], matrix[(j, i)]) = (value, value);
    }
    matrix
}

/// The value of a form.
pub(crate) fn square(form: &[f64], motion: &[f64]) -> f64 {
    let parts = pairs(motion.len()).zip(form).map(|((i, j), part)| part * motion[i] * motion[j]);
    parts.fold(0.0, |sum, part| sum + part)
}

/// The forms without those that are nowhere larger than another one or than the mean of two others: they are never the
/// largest.
pub(crate) fn needed(forms: Vec<Form>, n: usize) -> Vec<Form> {
    let mut kept: Vec<Form> = Vec::new();
    let covers = |large: &Form, small: &Form| {
        let difference = matrix(large, n) - matrix(small, n);
        let size = matrix(large, n).norm();
        let least = difference.symmetric_eigenvalues().min();
        least >= -ROUNDING * size
    };
    let mean = |a: &Form, b: &Form| a.iter().zip(b).map(|(a, b)| f64::midpoint(*a, *b)).collect();
    for form in forms {
        if kept.iter().any(|other| covers(other, &form)) {
            continue;
        }
        kept.retain(|other| !covers(&form, other));
        kept.push(form);
    }
    let mut k = 0;
    while k < kept.len() && kept.len() <= MANY {
        let form = kept.swap_remove(k);
        let mut means = kept.iter().enumerate().flat_map(|(i, a)| kept[..i].iter().map(move |b| mean(a, b)));
        if !means.any(|mean| covers(&mean, &form)) {
            kept.push(form);
            let last = kept.len() - 1;
            kept.swap(k, last);
            k += 1;
        }
    }
    kept
}
