//! Boxes that hold the wheels and the belly, seen from above, while the angles stay within a range.
//!
//! Everything is a sinusoid of one angle at a time, so its extremes are at the ends of the range or where its
//! derivative is 0: no sampling. In the frame of the heading, with the body turned by `Ry(pitch) Rx(roll)`, a point
//! `(x, y, z)` of the body is at `X = x cos(pitch) + (y sin(roll) + z cos(roll)) sin(pitch)`,
//! `Y = y cos(roll) - z sin(roll)`.

use crate::suspension::Dimensions;

/// Largest absolute angles [rad] at which the wheels and the belly are inside the boxes of ground that are searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TiltLimits {
    /// Largest roll and pitch.
    pub attitude: f64,
    /// Largest angle of a rocker.
    pub rocker: f64,
    /// Largest angle of a bogie.
    pub bogie: f64,
}

impl TiltLimits {
    /// Wider ranges than [`Self::default`]: 25, 20 and 38 degrees. Their boxes have wider intervals of heights, so that
    /// they bound fewer poses.
    pub fn wide() -> Self {
        Self { attitude: 25_f64.to_radians(), rocker: 20_f64.to_radians(), bogie: 38_f64.to_radians() }
    }
}

impl Default for TiltLimits {
    /// The limits of Curiosity: 15, 7 and 17 degrees.
    ///
    /// (A. Rankin, M. Maimone, J. Biesiadecki, N. Patel, D. Levine, O. Toupet, Driving Curiosity: Mars rover
    /// mobility trends during the first seven years, IEEE Aerospace Conference 2020.)
    fn default() -> Self {
        Self { attitude: 15_f64.to_radians(), rocker: 7_f64.to_radians(), bogie: 17_f64.to_radians() }
    }
}

/// A box in the frame of the heading, its origin below that of the body [m].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Patch {
    pub centre: [f64; 2],
    pub half: [f64; 2],
    /// Distance of its farthest corner from the origin, at most [m].
    pub reach: f64,
}

/// Added on every side: more than rounding can move a wheel [m].
const ROUNDING: f64 = 1e-6;

impl Patch {
    fn new(centre: [f64; 2], half: [f64; 2]) -> Self {
        Self { centre, half, reach: centre[0].hypot(centre[1]) + half[0].hypot(half[1]) }
    }

    fn between([x0, x1]: [f64; 2], [y0, y1]: [f64; 2]) -> Self {
        let half = [(x1 - x0) / 2.0 + ROUNDING, (y1 - y0) / 2.0 + ROUNDING];
        Self::new([(x0 + x1) / 2.0, (y0 + y1) / 2.0], half)
    }

    /// The box cut into `lengthwise` by `N / lengthwise` parts, each searched by the smallest rectangle along the grid
    /// around it.
    pub fn parts<const N: usize>(self, lengthwise: usize) -> [Self; N] {
        let counts = [lengthwise, N / lengthwise];
        let half = [0, 1].map(|axis| self.half[axis] / counts[axis] as f64);
        std::array::from_fn(|k| {
            let place = [k % lengthwise, k / lengthwise];
            let centre =
                [0, 1].map(|axis| self.centre[axis] - self.half[axis] + half[axis] * (2 * place[axis] + 1) as f64);
            Self::new(centre, half)
        })
    }

    /// The mirror image on the right.
    pub fn mirrored(self) -> Self {
        Self { centre: [self.centre[0], -self.centre[1]], ..self }
    }
}

/// Extremes of `c cos(t) + s sin(t)` for `t` from `low` to `high`, at most half a turn apart.
fn sinusoid(c: f64, s: f64, low: f64, high: f64) -> [f64; 2] {
    let peak = s.atan2(c);
    let trough = (-s).atan2(-c);
    let at = |t: f64| c * t.cos() + s * t.sin();
    let (mut least, mut most) = (at(low).min(at(high)), at(low).max(at(high)));
    if (low..=high).contains(&peak) {
        most = c.hypot(s);
    }
    if (low..=high).contains(&trough) {
        least = -c.hypot(s);
    }
    [least, most]
}

/// Extremes of [`sinusoid`] over intervals of both coefficients, in each of which it is linear.
fn sinusoids([c0, c1]: [f64; 2], [s0, s1]: [f64; 2], low: f64, high: f64) -> [f64; 2] {
    let mut all = [f64::INFINITY, f64::NEG_INFINITY];
    for (c, s) in [(c0, s0), (c0, s1), (c1, s0), (c1, s1)] {
        let [least, most] = sinusoid(c, s, low, high);
        all = [all[0].min(least), all[1].max(most)];
    }
    all
}

/// Box, seen from above, that holds a box of the body `[x] [y] [z]` at any roll and pitch up to `largest`.
fn seen([x, y, z]: [[f64; 2]; 3], largest: f64) -> [[f64; 2]; 2] {
    let tilted = sinusoids(z, y, -largest, largest);
    [sinusoids(x, tilted, -largest, largest), sinusoids(y, [-z[1], -z[0]], -largest, largest)]
}

fn widened([low, high]: [f64; 2], by: f64) -> [f64; 2] {
    [low - by, high + by]
}

/// Intervals of x and z of a vector rotated by up to `largest` [rad] about +y.
fn rotated_about_y([x, _, z]: [f64; 3], largest: f64) -> [[f64; 2]; 2] {
    [sinusoid(x, z, -largest, largest), sinusoid(z, -x, -largest, largest)]
}

fn sum([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [a + c, b + d]
}

/// Boxes of the projections of the left circles, front to rear.
pub(super) fn wheels(dimensions: &Dimensions, within: TiltLimits) -> [Patch; 3] {
    let [px, py, pz] = dimensions.rocker_pivot;
    std::array::from_fn(|pair| {
        let to_wheel = dimensions.to_wheel(pair);
        let (mut x, mut y, mut z) = ([px, px], py + to_wheel[1], [pz, pz]);
        let turned = if dimensions.bogie.carries(pair) {
            let to_bogie = dimensions.rocker_to_bogie;
            let [dx, dz] = rotated_about_y(to_bogie, within.rocker);
            (x, z) = (sum(x, dx), sum(z, dz));
            y += to_bogie[1];
            within.rocker + within.bogie
        } else {
            within.rocker
        };
        let [dx, dz] = rotated_about_y(to_wheel, turned);
        let [x, y] = seen([sum(x, dx), [y, y], sum(z, dz)], within.attitude);
        let r = dimensions.wheel_radius;
        // The inclination of the axle is at most the roll, so that the half width of the circle is at most `r
        // sin(roll)`.
        Patch::between(widened(x, r), widened(y, r * within.attitude.sin()))
    })
}

/// The box of a level plate of the body.
pub(super) fn plate(x: [f64; 2], y: [f64; 2], z: f64, within: TiltLimits) -> Patch {
    let [x, y] = seen([x, y, [z, z]], within.attitude);
    Patch::between(x, y)
}

/// Largest distance by which the height of a vector rotated by up to `largest` [rad] exceeds the interval between its
/// heights at any two angles [m]: 0 unless its lowest or highest position is between them.
pub(super) fn sag([x, _, z]: [f64; 3], largest: f64) -> f64 {
    let [least, most] = sinusoid(z, -x, -largest, largest);
    let ends = [-largest, largest].map(|t| z * t.cos() - x * t.sin());
    if least < ends[0].min(ends[1]) || most > ends[0].max(ends[1]) {
        // The nearer end is at most half the interval away, which is at most `largest`.
        x.hypot(z) * (1.0 - largest.cos())
    } else {
        0.0
    }
}
