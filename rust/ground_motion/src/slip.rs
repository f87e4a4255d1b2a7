//! Test for slip of the whole rover: a chi-squared test of the difference of two estimates of its motion.

use nalgebra::{DMatrixView, SMatrix, SVector};

use six_wheel_numerics::error::{Error, number};

/// Largest number of components of a motion.
pub const LARGEST: usize = 6;

/// Result of the test whether two estimates of a motion differ by more than their noise.
#[derive(Clone, Copy, Debug)]
pub struct SlipTest {
    /// Squared Mahalanobis distance `slipᵀ covariance⁻¹ slip`.
    pub statistic: f64,
    /// Value that the statistic exceeds with the rate of false alarms, for a rover without slip.
    pub threshold: f64,
    /// Probability that the statistic of a rover without slip is at least as large.
    pub probability: f64,
}

impl SlipTest {
    /// The test of `slip`, a navigated motion less a kinematic one, with its covariance (`n * n`, row by row).
    /// Fails unless that is positive definite and the rate of false alarms between 0 and 1.
    pub fn new(slip: &[f64], covariance: &[f64], false_alarm: f64) -> Result<Self, Error> {
        let length = slip.len();
        if !(false_alarm > 0.0 && false_alarm < 1.0) {
            let rule = "be between 0 and 1";
            return Err(Error::value("false_alarm", rule, number(false_alarm)));
        }
        // Components beyond those given have the variance 1 and no slip.
        let mut matrix = SMatrix::<f64, LARGEST, LARGEST>::identity();
        matrix.view_mut((0, 0), (length, length)).tr_copy_from(&DMatrixView::from_slice(covariance, length, length));
        let vector = SVector::<f64, LARGEST>::from_fn(|i, _| slip.get(i).copied().unwrap_or(0.0));
        let Some(factor) = matrix.cholesky() else {
            let rule = "be symmetric and positive definite";
            return Err(Error::value("covariance", rule, "one that is not"));
        };
        let statistic = vector.dot(&factor.solve(&vector));
        Ok(Self { statistic, threshold: quantile(length, false_alarm), probability: survival(length, statistic) })
    }

    /// True if the rover slips.
    pub fn slips(&self) -> bool {
        self.statistic > self.threshold
    }
}

/// Probability that a chi-squared variable with these degrees of freedom is larger than `value`: the regularised upper
/// incomplete gamma function, by its series below `a + 1` and by Lentz's continued fraction above.
///
/// (W. Press et al., Numerical Recipes, 3rd ed., 6.2; M. Abramowitz, I. Stegun, 6.5.29 and 6.5.31.)
fn survival(degrees: usize, value: f64) -> f64 {
    if value.is_nan() {
        return f64::NAN;
    }
    let (a, x) = (degrees as f64 / 2.0, value / 2.0);
    if x <= 0.0 {
        return 1.0;
    }
    // Gamma(degrees / 2) by recurrence from Gamma(1/2) = sqrt(pi) or Gamma(1) = 1.
    let mut gamma = if degrees % 2 == 1 { std::f64::consts::PI.sqrt() } else { 1.0 };
    let mut at = if degrees % 2 == 1 { 0.5 } else { 1.0 };
    while at < a {
        gamma *= at;
        at += 1.0;
    }
    let front = (a * x.ln() - x).exp() / gamma;
    if x < a + 1.0 {
        let (mut term, mut sum, mut n) = (1.0 / a, 1.0 / a, a);
        while term > sum * f64::EPSILON {
            n += 1.0;
            term *= x / n;
            sum += term;
        }
        return 1.0 - front * sum;
    }
    let mut b = x + 1.0 - a;
    let mut c = 1.0 / f64::MIN_POSITIVE;
    let mut d = 1.0 / b;
    let mut fraction = d;
    for n in 1..500 {
        let n = f64::from(n);
        let factor = -n * (n - a);
        b += 2.0;
        d = 1.0 / (factor * d + b);
        c = b + factor / c;
        let change = c * d;
        fraction *= change;
        if (change - 1.0).abs() < f64::EPSILON {
            break;
        }
    }
    front * fraction
}

/// Value that a chi-squared variable exceeds with this probability, by bisection.
fn quantile(degrees: usize, probability: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    while survival(degrees, high) > probability {
        high *= 2.0;
    }
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if survival(degrees, middle) > probability {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}
