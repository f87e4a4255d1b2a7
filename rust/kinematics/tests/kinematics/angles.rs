//! Angles brought into half a turn to either side.

use std::f64::consts::{PI, TAU};

use six_wheel_kinematics::geometry::wrap_angle;

#[test]
fn angles_wrap_into_half_a_turn_to_either_side() {
    assert_eq!(wrap_angle(PI), PI);
    assert_eq!(wrap_angle(-PI), -PI);
    assert_eq!(wrap_angle(0.5), 0.5);
    assert!((wrap_angle(7.0) - (7.0 - TAU)).abs() < 1e-15);
    assert!((wrap_angle(-1e6) + 1e6 - TAU * (1e6 / TAU).round()).abs() < 1e-9);
    // To the bit what the remainder is, at whole and half turns and their neighbours too.
    let bitwise = |angle: f64| match angle % TAU {
        rest if rest > PI => rest - TAU,
        rest if rest < -PI => rest + TAU,
        rest => rest,
    };
    for k in (0..400_000).step_by(7) {
        for angle in [0.1 * f64::from(k), f64::from(k) * PI] {
            for angle in [angle.next_down(), angle, angle.next_up(), -angle] {
                assert_eq!(wrap_angle(angle), bitwise(angle), "{angle}");
            }
        }
    }
}
