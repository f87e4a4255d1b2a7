//! Counters that start over.

use std::f64::consts::TAU;

use six_wheel_odometry::Encoder;

#[test]
fn counters_go_the_shorter_way_round() {
    let counter = Encoder { modulus: Some(65536.0), ..Encoder::default() };
    assert_eq!(counter.difference(65530.0, 4.0), (10.0, true));
    assert_eq!(counter.difference(4.0, 65530.0), (-10.0, true));
    assert_eq!(counter.difference(-32760.0, 32760.0), (-16.0, true)); // a signed counter
    assert_eq!(counter.difference(100.0, 350.0), (250.0, false));
    assert_eq!(Encoder::default().difference(1.0, 1e6), (999_999.0, false));
}

#[test]
fn an_absolute_encoder_knows_its_angle_at_once() {
    let encoder = Encoder { resolution: Some(4096.0), modulus: Some(4096.0), offset: -3.0, ..Encoder::default() };
    let angle = encoder.first_angle(3000.0);
    assert!((angle - (3000.0 / 4096.0 * TAU - 3.0)).abs() < 1e-12, "{angle}");
    let round = encoder.first_angle(100.0) - encoder.first_angle(4095.0);
    assert!((round - 101.0 / 4096.0 * TAU).abs() < 1e-12, "{round}");
}
