//! Quadratic forms of a motion, and the subset of them that can be the largest.

use nalgebra::DMatrix;

/// Share of a form below which a value counts as rounding.
pub(crate) const ROUNDING: f64 = 1e-12;
/// Number of forms above which pairs are not compared.
const MANY: usize = 16;

/// A quadratic form of a motion: coefficients of the products of components, `00 01 02 11 12 22`.
pub(crate) type Form = Vec<f64>;

/// The product of two rows as a form.
pub(crate) fn product(rows: &[&[f64]], factor: f64) -> Form {
    let n = rows[0].len();
    let mut form = Vec::new();
    for i in 0..n {
        for j in i..n {
            let twice = if i == j { 1.0 } else { 2.0 };
            form.push(rows.iter().map(|row| twice * factor * row[i] * row[j]).sum());
        }
    }
    form
}

/// The matrix of a form.
fn matrix(form: &[f64], n: usize) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(n, n);
    let mut k = 0;
    for i in 0..n {
        for j in i..n {
            let value = if i == j { form[k] } else { form[k] / 2.0 };
            (matrix[(i, j)], matrix[(j, i)]) = (value, value);
            k += 1;
        }
    }
    matrix
}

/// The value of a form.
pub(crate) fn square(form: &[f64], motion: &[f64]) -> f64 {
    let n = motion.len();
    let mut k = 0;
    let mut sum = 0.0;
    for i in 0..n {
        for j in i..n {
            sum += form[k] * motion[i] * motion[j];
            k += 1;
        }
    }
    sum
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
        let pairs = kept.iter().enumerate();
        let mut pairs = pairs.flat_map(|(i, a)| kept[..i].iter().map(move |b| mean(a, b)));
        if !pairs.any(|mean| covers(&mean, &form)) {
            kept.push(form);
            let last = kept.len() - 1;
            kept.swap(k, last);
            k += 1;
        }
    }
    kept
}
