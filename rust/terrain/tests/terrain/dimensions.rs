//! The differential of a rocker-bogie.

use six_wheel_terrain::suspension::Differential;

#[test]
fn a_bar_turns_the_right_rocker_back_and_nearly_as_far() {
    let bar = Differential::Bar { half_length: 0.4, lever: 0.2, rod: 0.3 };
    for k in -8..=8 {
        let left = f64::from(k) * 0.05;
        let [right, slope] = bar.right(left).unwrap_or([f64::NAN; 2]);
        // Rods of finite length: an even term of second order.
        assert!((right + left).abs() <= 0.7 * left * left + 1e-15, "{left} {right}");
        // The linkage is the same seen from the other side.
        assert!((bar.right(right).unwrap_or([f64::NAN; 2])[0] - left).abs() < 1e-12);
        let step = 1e-6;
        let at = |q| bar.right(q).map_or(f64::NAN, |[right, _]| right);
        let difference = (at(left + step) - at(left - step)) / (2.0 * step);
        assert!((slope - difference).abs() < 1e-8, "{left} {slope} {difference}");
    }
    assert_eq!(bar.right(3.0), None);
    assert_eq!(Differential::Gear.right(0.3), Some([-0.3, -1.0]));
}
