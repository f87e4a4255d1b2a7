//! A circle over a grid: its points, the gap below it over one cell, and where lines of the grid cut it.
//!
//! Directions are pairs `(sin t, cos t)`; no angle is computed.

use crate::terrain::Cell;
use six_wheel_kinematics::wheels::Direction;
use six_wheel_numerics::simd::vec3::cross2;

/// Grid lines that half a circle may cross and still be cut on the stack.
const MOST_CUTS: usize = 96;

/// A circle over a grid: horizontal coordinates in columns and rows, heights in metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Circle {
    /// Its centre.
    pub centre: [f64; 3],
    /// Radius times the direction in which the wheel rolls.
    pub forward: [f64; 3],
    /// Radius times the direction of its steering axis, upwards.
    pub up: [f64; 3],
}

/// Columns and rows of a point of the rim.
pub(crate) fn point(circle: &Circle, Direction { sin, cos }: Direction) -> [f64; 2] {
    [0, 1].map(|k| circle.centre[k] + circle.forward[k] * sin - circle.up[k] * cos)
}

/// The gap over one cell: `constant + p sin t + q cos t + r cos 2t + s sin 2t`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gap {
    constant: f64,
    p: f64,
    q: f64,
    r: f64,
    s: f64,
    /// Bound of the fourth derivative [m].
    pub fourth: f64,
}

/// Value, first and second derivative of a gap.
pub(crate) type Jet = [f64; 3];

impl Gap {
    #[inline]
    pub fn new(cell: &Cell, circle: &Circle, [column, row]: [f64; 2]) -> Self {
        let ([x, y, z], [hx, hy, hz], [ux, uy, uz]) = (circle.centre, circle.forward, circle.up);
        let (a, b) = (x - column, y - row);
        let [along, across] = cell.slope(a, b);
        let twist = cell.twist;
        let (p, q) = (hz - along * hx - across * hy, along * ux + across * uy - uz);
        let (r, s) = (0.5 * twist * (hx * hy - ux * uy), 0.5 * twist * (hx * uy + ux * hy));
        Self {
            constant: z - cell.height(a, b) - 0.5 * twist * (hx * hy + ux * uy),
            p,
            q,
            r,
            s,
            fourth: length([p, q]) + 16.0 * length([r, s]),
        }
    }

    #[inline]
    pub fn jet(&self, Direction { sin, cos }: Direction) -> Jet {
        let (sin2, cos2) = (2.0 * sin * cos, (cos - sin) * (cos + sin));
        let (first, second) = (self.p * sin + self.q * cos, self.r * cos2 + self.s * sin2);
        [
            self.constant + first + second,
            self.p * cos - self.q * sin + 2.0 * (self.s * cos2 - self.r * sin2),
            -first - 4.0 * second,
        ]
    }
}

/// Directions at which half a circle is cut, in the order of growing sines.
pub(crate) struct Cuts {
    pub cuts: [Direction; MOST_CUTS],
    pub count: usize,
}

impl Cuts {
    /// Cuts the half of the circle with positive cosines where it crosses lines of the grid and so that no arc
    /// is too long. None where there are too many lines.
    pub fn of(circle: &Circle) -> Option<Self> {
        let mut cuts = Self { cuts: [Direction { sin: 1.0, cos: 0.0 }; MOST_CUTS], count: 0 };
        cuts.add(Direction { sin: -1.0, cos: 0.0 })?;
        for k in 0..2 {
            let (h, u, centre) = (circle.forward[k], circle.up[k], circle.centre[k]);
            let size = length([h, u]);
            if size < 1e-12 {
                continue; // along a line of the grid
            }
            let (p, q) = (h / size, u / size);
            // p sin t - q cos t = w there, and p cos t + q sin t = v.
            let mut line = (centre - size).ceil();
            while line <= centre + size {
                let w = (line - centre) / size;
                let v = (1.0 - w * w).max(0.0).sqrt();
                for v in [v, -v] {
                    let at = Direction { sin: w * p + v * q, cos: v * p - w * q };
                    if at.cos > 0.0 {
                        cuts.add(at)?;
                    }
                }
                line += 1.0;
            }
        }
        cuts.sort();
        cuts.add(Direction { sin: 1.0, cos: 0.0 })?;
        Some(cuts)
    }

    fn add(&mut self, at: Direction) -> Option<()> {
        *self.cuts.get_mut(self.count)? = at;
        self.count += 1;
        Some(())
    }

    fn sort(&mut self) {
        self.cuts[..self.count].sort_unstable_by(|a, b| a.sin.total_cmp(&b.sin));
    }
}

/// A direction turned on by an angle below one radian.
pub(crate) fn turned(from: Direction, angle: f64) -> Direction {
    // Polynomials, put back on the circle: as good as sine and cosine where angles are small.
    let square = angle * angle;
    let sin = angle * (1.0 - square / 6.0 * (1.0 - square / 20.0));
    let cos = 1.0 - square / 2.0 * (1.0 - square / 12.0);
    normalized(Direction { sin: from.sin * cos + from.cos * sin, cos: from.cos * cos - from.sin * sin })
}

fn normalized(at: Direction) -> Direction {
    let scale = 1.0 / (at.sin * at.sin + at.cos * at.cos).sqrt();
    Direction { sin: at.sin * scale, cos: at.cos * scale }
}

/// Sine of the angle from one direction to another.
pub(crate) fn sine_between(from: Direction, to: Direction) -> f64 {
    cross2([from.cos, from.sin], [to.cos, to.sin])
}

/// A direction between two less than a quarter turn apart, at about this share of the way.
pub(crate) fn between(from: Direction, to: Direction, share: f64) -> Direction {
    normalized(Direction { sin: from.sin + share * (to.sin - from.sin), cos: from.cos + share * (to.cos - from.cos) })
}

/// A direction well inside the arc from one direction to another, up to half a turn on.
pub(crate) fn inside(from: Direction, to: Direction) -> Direction {
    if from.sin * to.sin + from.cos * to.cos >= 0.0 {
        return between(from, to, 0.5);
    }
    // A quarter turn on, however far the ends are apart.
    Direction { sin: from.cos, cos: -from.sin }
}

/// At least the angle between two directions up to half a radian apart: the chord is shorter by less than this.
pub(crate) fn angle(from: Direction, to: Direction) -> f64 {
    let chord = length([to.sin - from.sin, to.cos - from.cos]);
    chord * (1.0 + 0.05 * chord * chord)
}

/// Length of a vector none of whose numbers is huge.
pub(crate) fn length([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y).sqrt()
}
