//! Sizes of all numbers of a batch.

use six_wheel_numerics::sizes::{are_below, longest};

#[test]
fn one_number_that_is_not_finite_is_seen_wherever_it_stands() {
    for count in 0..70 {
        let mut values = vec![1.5; count];
        assert!(are_below(&values, 1e150));
        assert_eq!(longest(&values), Some(if count == 0 { 0.0 } else { 1.5 }));
        for k in 0..count {
            for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                values[k] = wrong;
                assert!(!are_below(&values, 1e150));
                assert_eq!(longest(&values), None);
            }
            for large in [1e150, -1e150] {
                values[k] = large;
                assert!(!are_below(&values, 1e150));
            }
            for (dt, right) in [(0.0, None), (-1.0, None), (2.0, Some(2.0))] {
                values[k] = dt;
                assert!(are_below(&values, 1e150));
                assert_eq!(longest(&values), right);
            }
            values[k] = 1.5;
        }
    }
}
