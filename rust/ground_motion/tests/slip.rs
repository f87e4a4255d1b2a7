//! Slip of the whole rover: the test by its chi-squared distribution.

use six_wheel_ground_motion::SlipTest;
use six_wheel_numerics::error::Error;

/// Covariance of independent errors of a standard deviation of 1, row by row.
fn unit(length: usize) -> Vec<f64> {
    (0..length * length).map(|k| if k % (length + 1) == 0 { 1.0 } else { 0.0 }).collect()
}

#[test]
fn thresholds_are_those_of_the_tables() -> Result<(), Error> {
    // Printed tables of the chi-squared distribution, to their last digit.
    for (degrees, probability, value) in [
        (1, 0.05, 3.841_458_820_694_124),
        (2, 0.01, 9.210_340_371_976_182),
        (3, 0.05, 7.814_727_903_251_179),
        (6, 0.001, 22.457_744_484_825_32),
    ] {
        let test = SlipTest::new(&vec![0.0; degrees], &unit(degrees), probability)?;
        assert!((test.threshold - value).abs() < 1e-11 * value);
    }
    Ok(())
}

#[test]
fn probabilities_of_two_degrees_are_exponentials() -> Result<(), Error> {
    for (slip, tolerance) in [([1.0, 1.0], 1e-15), ([3.0, 4.0], 1e-20)] {
        let test = SlipTest::new(&slip, &unit(2), 0.01)?;
        assert!((test.probability - (-0.5 * test.statistic).exp()).abs() < tolerance);
    }
    Ok(())
}

#[test]
fn a_covariance_that_is_none_is_refused() {
    let test = SlipTest::new(&[0.1, 0.0], &[1.0, 2.0, 2.0, 1.0], 0.01);
    assert!(test.is_err_and(|error| error.to_string().starts_with("covariance must")));
}
