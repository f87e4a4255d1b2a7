//! The arc of a step: its chord, how it bends, and how the pose at its end answers.

use crate::arithmetic::{Arithmetic, Unfused};
use crate::uncertainty::StepJacobian;
use six_wheel_kinematics::geometry::sinc;

/// Half turn of a steered wheel during a step below which its series is exact to rounding [rad].
pub(crate) const SMALL_TURN: f64 = 0.25;

/// Chord of an arc that turns by `angle`, as a share of its length.
#[inline]
pub fn chord(angle: f64) -> f64 {
    let half = angle / 2.0;
    if half.abs() > SMALL_TURN {
        return sinc(half);
    }
    series(Unfused, half * half, &SINE)
}

/// `1 - x²/a (1 - x²/b (1 - ...))`, the reciprocals of `a`, `b` and so on given: the series of sin(x) / x, of cos(x), and
/// of the derivative of the first one as a share of -x / 3. What is left out is below 1e-17 at [`SMALL_TURN`].
#[inline(always)]
fn series<F: Arithmetic>(by: F, square: F::Number, terms: &[f64; 6]) -> F::Number {
    let (one, minus) = (by.number(1.0), -square);
    let mut sum = one;
    for term in terms.iter().rev() {
        sum = by.fused(minus * by.number(*term), sum, one);
    }
    sum
}

const SINE: [f64; 6] = [1.0 / 6.0, 1.0 / 20.0, 1.0 / 42.0, 1.0 / 72.0, 1.0 / 110.0, 1.0 / 156.0];
const COSINE: [f64; 6] = [1.0 / 2.0, 1.0 / 12.0, 1.0 / 30.0, 1.0 / 56.0, 1.0 / 90.0, 1.0 / 132.0];
const SLOPE: [f64; 6] = [1.0 / 10.0, 1.0 / 28.0, 1.0 / 54.0, 1.0 / 88.0, 1.0 / 130.0, 1.0 / 180.0];

/// Factors of an arc by half its turn h: `sin h / h` (chord over length), its derivative by h, `sin h` and `cos h`.
pub(crate) type Bend<T> = [T; 4];

/// Factors of an arc whose half turn is below [`SMALL_TURN`], by series.
#[inline(always)]
pub(crate) fn small_bend<F: Arithmetic>(by: F, half: F::Number) -> Bend<F::Number> {
    let square = half * half;
    let length = series(by, square, &SINE);
    [length, half * by.number(-1.0 / 3.0) * series(by, square, &SLOPE), half * length, series(by, square, &COSINE)]
}

/// Factors of any arc.
#[inline(always)]
pub(crate) fn bend<F: Arithmetic<Number = f64>>(by: F, half: f64) -> Bend<f64> {
    if half.abs() < SMALL_TURN {
        return small_bend(by, half);
    }
    let (sin, cos) = half.sin_cos();
    let length = sin / half;
    [length, (cos - length) / half, sin, cos]
}

/// Derivatives of the pose at the end of a step, from the heading `(sin, cos)` at its start and the displacement.
#[inline(always)]
pub(crate) fn step_jacobian<F: Arithmetic>(
    by: F,
    [vx, vy, _]: [F::Number; 3],
    [length, slope, sin, cos]: Bend<F::Number>,
    heading: [F::Number; 2],
) -> StepJacobian<F::Number> {
    // The chord leaves at half the turn, in world axes.
    let [heading_sin, heading_cos] = heading;
    let (s, c) = (heading_sin * cos + heading_cos * sin, heading_cos * cos - heading_sin * sin);
    let (ahead, left) = (c * vx - s * vy, s * vx + c * vy);
    let half = by.number(0.5);
    StepJacobian {
        shift: [length * ahead, length * left],
        by_displacement: [
            [length * c, -(length * s), (slope * ahead - length * left) * half],
            [length * s, length * c, (slope * left + length * ahead) * half],
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use six_wheel_kinematics::geometry::{Pose, Twist};

    #[test]
    fn a_step_answers_as_its_differences_do() {
        let yaw: f64 = 0.7;
        let end = |yaw: f64, displacement: [f64; 3]| -> [f64; 3] {
            let start = Pose { x: 0.0, y: 0.0, yaw };
            start.compose(Twist::from(displacement).exp(1.0)).into()
        };
        for omega in [0.0, 1e-9, 0.1, -0.3, 0.499_999, 0.500_001, -2.0, 6.0] {
            let displacement = [0.4, -0.3, omega];
            let heading = [yaw.sin(), yaw.cos()];
            let step = step_jacobian(Unfused, displacement, bend(Unfused, omega / 2.0), heading);
            let ended = end(yaw, displacement);
            assert!((step.shift[0] - ended[0]).abs() < 1e-15, "{omega}");
            assert!((step.shift[1] - ended[1]).abs() < 1e-15, "{omega}");
            for k in 0..3 {
                let (mut more, mut less) = (displacement, displacement);
                more[k] += 1e-6;
                less[k] -= 1e-6;
                let (more, less) = (end(yaw, more), end(yaw, less));
                for row in 0..3 {
                    let difference = (more[row] - less[row]) / 2e-6;
                    let derivative = step.matrix()[(row, k)];
                    assert!((difference - derivative).abs() < 1e-9, "{omega} {row} {k}");
                }
            }
        }
    }

    #[test]
    fn the_chord_is_the_same_on_both_sides_of_its_bound() {
        for angle in [0.0, 1e-300, 1e-8, 0.1, 0.499_999_999, 0.500_000_001, 3.0, -0.2] {
            assert!((chord(angle) - sinc(angle / 2.0)).abs() < 2.0 * f64::EPSILON, "{angle}");
        }
    }
}
