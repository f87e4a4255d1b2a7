//! The arc of a step: its chord, its derivatives, and those of the pose at its end.

use pulp::Simd;

use six_wheel_kinematics::se2::angles::sin_cos_any;
pub use six_wheel_kinematics::se2::maps::chord_ratio;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::polynomials::{horner, sinc_of_square, taylor};
use six_wheel_numerics::simd::vector::Vector;

/// Half yaw increment below which the factors of an arc are series [rad]: their truncation error is below 1e-17.
const SMALL_TURN: f64 = 0.25;

/// `cos h` in powers of h².
const COSINE: [f64; 7] = taylor(0);

/// Derivative of `sin h / h`, divided by h, in powers of h²: `(cos h - sin h / h) / h²`.
const CHORD_DERIVATIVE: [f64; 7] = {
    let (mut difference, cosine) = (taylor::<7>(3), taylor::<7>(2));
    let mut k = 0;
    while k < 7 {
        difference[k] -= cosine[k];
        k += 1;
    }
    difference
};

/// Factors of an arc with the yaw increment 2 h.
#[derive(Clone, Copy)]
pub struct Arc<S: Simd> {
    /// Length of the chord over that of the arc, `sin h / h`.
    pub chord: Lanes<S>,
    /// Derivative of that by h.
    pub chord_derivative: Lanes<S>,
    /// `sin h`.
    pub sin: Lanes<S>,
    /// `cos h`.
    pub cos: Lanes<S>,
}

impl<S: Vector> Arc<S> {
    /// From half the turn [rad].
    #[inline(always)]
    pub fn new(simd: S, half: Lanes<S>) -> Self {
        let square = half * half;
        let chord = sinc_of_square(simd, square);
        let small = Self {
            chord,
            chord_derivative: half * horner(simd, CHORD_DERIVATIVE, square),
            sin: half * chord,
            cos: horner(simd, COSINE, square),
        };
        let is_large = !half.abs().lt(Lanes::splat(simd, SMALL_TURN));
        if !is_large.any() {
            return small;
        }
        let (sin, cos) = sin_cos_any(simd, half);
        let chord = sin / half;
        Self {
            chord: is_large.select(chord, small.chord),
            chord_derivative: is_large.select((cos - chord) / half, small.chord_derivative),
            sin: is_large.select(sin, small.sin),
            cos: is_large.select(cos, small.cos),
        }
    }
}

/// Derivatives of the end of a step with respect to its start and to its displacement in body axes.
#[derive(Clone, Copy)]
pub struct StepJacobian<S: Simd> {
    /// Displacement in world axes [m].
    pub shift: [Lanes<S>; 2],
    /// First two rows of L, the derivative of the end by the displacement in body axes. The third row is 0, 0, 1: the
    /// yaw at the end is the yaw at the start plus that of the displacement.
    pub by_displacement: [[Lanes<S>; 3]; 2],
}

#[inline_always]
impl<S: Simd> StepJacobian<S> {
    /// From the sine and cosine of the heading at the start and the displacement `[x, y, yaw]` in body axes.
    pub fn new([x, y, _]: [Lanes<S>; 3], arc: Arc<S>, [heading_sin, heading_cos]: [Lanes<S>; 2]) -> Self {
        // Sine and cosine of the direction of the chord in world axes: heading plus half the yaw increment.
        let Arc { chord, chord_derivative, sin, cos } = arc;
        let (s, c) = (heading_sin * cos + heading_cos * sin, heading_cos * cos - heading_sin * sin);
        let (ahead, left) = (c * x - s * y, s * x + c * y);
        let half = Lanes::splat(x.simd(), 0.5);
        Self {
            shift: [chord * ahead, chord * left],
            by_displacement: [
                [chord * c, -(chord * s), (chord_derivative * ahead - chord * left) * half],
                [chord * s, chord * c, (chord_derivative * left + chord * ahead) * half],
            ],
        }
    }

    /// Derivative of the end position with respect to the yaw at the start [m].
    pub fn yaw_lever(&self) -> [Lanes<S>; 2] {
        [-self.shift[1], self.shift[0]]
    }

    /// Error of the pose at the end by an error of the displacement: `L d`.
    pub fn displacement_error(&self, [x, y, z]: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
        let [[a, b, c], [d, e, f]] = self.by_displacement;
        [c.mul_add(z, b.mul_add(y, a * x)), f.mul_add(z, e.mul_add(y, d * x)), z]
    }

    /// Error of the pose at the end by an error of the pose at the start and one of the displacement: `F e + L d`.
    pub fn propagate(&self, start: [Lanes<S>; 3], displacement: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
        propagate_error(self.yaw_lever(), start, self.displacement_error(displacement))
    }
}

impl<S: Vector> StepJacobian<S> {
    /// The Jacobian of the last lane, in every lane of another level.
    #[inline(always)]
    pub fn broadcast<T: Simd>(&self, simd: S, to: T) -> StepJacobian<T> {
        let [[a, b, c], [d, e, f]] = self.by_displacement;
        let splat = |lanes: Lanes<S>| Lanes::splat(to, lanes.last(simd));
        StepJacobian {
            shift: [splat(self.shift[0]), splat(self.shift[1])],
            by_displacement: [[splat(a), splat(b), splat(c)], [splat(d), splat(e), splat(f)]],
        }
    }
}

/// Propagates a pose error through one step: `e' = F e + end`, `F = [[1, 0, lever_x], [0, 1, lever_y], [0, 0, 1]]`,
/// with `lever = d(end position) / d(yaw)` [m].
#[inline(always)]
pub(crate) fn propagate_error<S: Simd>(
    [lever_x, lever_y]: [Lanes<S>; 2],
    [x, y, z]: [Lanes<S>; 3],
    end: [Lanes<S>; 3],
) -> [Lanes<S>; 3] {
    [lever_x.mul_add(z, x + end[0]), lever_y.mul_add(z, y + end[1]), z + end[2]]
}
