//! The arc of a step and its derivatives.

use nalgebra::Matrix3;
use pulp::Scalar;
use six_wheel_kinematics::geometry::{Pose, Twist, sinc};
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_odometry::arc::{Arc, StepJacobian, chord_ratio};

fn lane(number: f64) -> Lanes<Scalar> {
    Lanes::splat(Scalar, number)
}

#[test]
fn a_step_answers_as_its_differences_do() {
    let yaw: f64 = 0.7;
    let end = |yaw: f64, displacement: [f64; 3]| -> [f64; 3] {
        let start = Pose { x: 0.0, y: 0.0, yaw };
        start.compose(Twist::from(displacement).exp(1.0)).into()
    };
    for omega in [0.0, 1e-9, 0.1, -0.3, 0.499_999, 0.500_001, -2.0, 6.0] {
        let displacement = [0.4, -0.3, omega];
        let heading = [lane(yaw.sin()), lane(yaw.cos())];
        let step = StepJacobian::new(displacement.map(lane), Arc::new(Scalar, lane(omega / 2.0)), heading);
        let [[a, b, c], [d, e, f]] = step.by_displacement.map(|row| row.map(|part| part.last(Scalar)));
        let derivatives = Matrix3::new(a, b, c, d, e, f, 0.0, 0.0, 1.0);
        let ended = end(yaw, displacement);
        assert!((step.shift[0].last(Scalar) - ended[0]).abs() < 1e-15, "{omega}");
        assert!((step.shift[1].last(Scalar) - ended[1]).abs() < 1e-15, "{omega}");
        for k in 0..3 {
            let (mut more, mut less) = (displacement, displacement);
            more[k] += 1e-6;
            less[k] -= 1e-6;
            let (more, less) = (end(yaw, more), end(yaw, less));
            for row in 0..3 {
                let difference = (more[row] - less[row]) / 2e-6;
                let derivative = derivatives[(row, k)];
                assert!((difference - derivative).abs() < 1e-9, "{omega} {row} {k}");
            }
        }
    }
}

#[test]
fn factors_are_the_same_on_both_sides_of_their_bounds() {
    let eighth = std::f64::consts::FRAC_PI_4;
    let near = [0.249_999_999, 0.25, 0.250_000_001, eighth, eighth.next_up(), 1e9, 1.1e9];
    for half in [0.0, 1e-300, 1e-8, 0.1, 3.0, -0.2].into_iter().chain(near) {
        let arc = Arc::new(Scalar, lane(half));
        for chord in [arc.chord, chord_ratio(Scalar, lane(half))] {
            assert!((chord.last(Scalar) - sinc(half)).abs() < 2.0 * f64::EPSILON, "{half}");
        }
        assert!((arc.sin.last(Scalar) - half.sin()).abs() < 2.0 * f64::EPSILON, "{half}");
        assert!((arc.cos.last(Scalar) - half.cos()).abs() < 2.0 * f64::EPSILON, "{half}");
        let expected = if half.abs() < 1e-3 { -half / 3.0 } else { (half.cos() - sinc(half)) / half };
        assert!((arc.chord_derivative.last(Scalar) - expected).abs() < 1e-11 * (1.0 + half.abs()), "{half}");
    }
}
