//! Small systems of equations in lanes: elimination where there are as many equations as unknowns, Householder reflections
//! and Givens rotations elsewhere.
//!
//! (G. Golub, C. Van Loan, Matrix Computations, 4th ed., 5.1, 5.3.)

use super::constants::{MotionConstants, PivotOrder, UNKNOWNS};
use crate::lanes::pose_lanes::Touching;
use six_wheel_numerics::least_squares::{DEPENDENT, shortest};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_terrain::suspension::MAX_WHEELS;
use six_wheel_terrain::suspension::lanes::{Column, all};

/// Most right-hand sides: one planar motion each, and the known rates.
const RIGHTS: usize = 4;

/// Most equations: of every wheel, and of every rate that is known in some lanes.
const EQUATIONS: usize = MAX_WHEELS + UNKNOWNS;

/// An equation: its unknowns, then its right-hand sides.
pub(crate) type Equation<S> = [Lanes<S>; UNKNOWNS + RIGHTS];

/// Rank test of elimination. The columns count as independent if `prod(r_kk^2) / prod(|a_k|^2) > 1e-8` (r: pivots of the
/// elimination, a: columns).
const RANK_TOLERANCE: f64 = 1e-8;

/// Least square of the shortest column over that of the longest one, for elimination.
const COLUMN_TOLERANCE: f64 = 1e-10;

/// Largest multiplier of a pivot's equation in elimination.
const PIVOT_GROWTH_LIMIT: f64 = 64.0;

/// Solutions for all right-hand sides, one row per unknown, and the lanes in which the equations determine them.
pub(crate) type Solution<S, const RIGHT: usize> = ([[Lanes<S>; RIGHT]; UNKNOWNS], Mask<S>);

/// Equations in least squares, most of them of a few of the unknowns only.
pub(crate) struct DenseLeastSquares<S: Vector> {
    rows: [Equation<S>; EQUATIONS],
    /// Bits of the unknowns whose coefficients in an equation may differ from 0.
    bits: [u32; EQUATIONS],
    count: usize,
}

#[inline_always]
impl<S: Vector> DenseLeastSquares<S> {
    /// No equation yet.
    pub fn new(simd: S) -> Self {
        Self { rows: [[all(simd, 0.0); UNKNOWNS + RIGHTS]; EQUATIONS], bits: [0; EQUATIONS], count: 0 }
    }

    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// One more equation in these unknowns (bits); the caller writes all of its numbers.
    pub fn add(&mut self, bits: u32) -> &mut Equation<S> {
        let place = self.count % EQUATIONS;
        self.count += 1;
        self.bits[place] = bits;
        &mut self.rows[place]
    }

    /// Sets the first `width` numbers of the equations of wheels in the air to 0.
    pub fn limit(&mut self, simd: S, constants: &MotionConstants, touching: &Touching<S>, width: usize) {
        if touching.all {
            return;
        }
        let zero = all(simd, 0.0);
        for (row, touching) in self.rows.iter_mut().zip(touching.wheels).take(constants.wheels) {
            let touches = zero.lt(touching);
            for cell in &mut row[..width] {
                *cell = touches.select(*cell, zero);
            }
        }
    }

    /// Removes an unknown where `here` is 1: it is 0 there.
    pub fn set_known(&mut self, simd: S, unknown: usize, here: Lanes<S>) {
        let zero = all(simd, 0.0);
        for row in &mut self.rows[..self.count.min(EQUATIONS)] {
            row[unknown] = row[unknown] * (all(simd, 1.0) - here);
        }
        let row = self.add(1 << unknown);
        *row = [zero; UNKNOWNS + RIGHTS];
        row[unknown] = here;
    }

    /// Solves for all unknowns by elimination, of the equations of these wheels in their order. The mask is that of the lanes
    /// in which the pivots are large and the multipliers small: elsewhere reflections lose fewer digits.
    pub fn eliminate<const RIGHT: usize>(&mut self, simd: S, order: &PivotOrder) -> Solution<S, RIGHT> {
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        let rows = &mut self.rows;
        let (mut product, mut shortest, mut longest) = (one, all(simd, f64::MAX), zero);
        for k in 0..UNKNOWNS {
            let mut length = rows[0][k] * rows[0][k];
            for row in &rows[1..UNKNOWNS] {
                length = row[k].mul_add(row[k], length);
            }
            product = product * length;
            (shortest, longest) = (shortest.min(length), longest.max(length));
        }
        let mut inverses = [zero; UNKNOWNS];
        let (mut pivoted, mut largest) = (one, zero);
        for j in 0..UNKNOWNS {
            let (from, after) = rows.split_at_mut(j + 1);
            let from = &from[j];
            pivoted = pivoted * from[j];
            inverses[j] = one / from[j];
            for k in j + 1..UNKNOWNS {
                if order.others[j] >> k & 1 == 0 {
                    continue;
                }
                let row = &mut after[k - j - 1];
                let share = -(row[j] * inverses[j]);
                largest = largest.max(share.abs());
                for i in j + 1..UNKNOWNS + RIGHT {
                    row[i] = share.mul_add(from[i], row[i]);
                }
            }
        }
        let mut solution = [[zero; RIGHT]; UNKNOWNS];
        for j in (0..UNKNOWNS).rev() {
            for k in 0..RIGHT {
                let mut rest = rows[j][UNKNOWNS + k];
                for i in j + 1..UNKNOWNS {
                    rest = (-rows[j][i]).mul_add(solution[i][k], rest);
                }
                solution[j][k] = rest * inverses[j];
            }
        }
        let independent = (all(simd, RANK_TOLERANCE) * product).lt(pivoted * pivoted);
        let even = (all(simd, COLUMN_TOLERANCE) * longest).lt(shortest);
        (solution, independent & even & largest.lt(all(simd, PIVOT_GROWTH_LIMIT)))
    }

    /// Solves for the first `used` unknowns in least squares, by Householder reflections of the equations that have one. They
    /// are determined if every pivot is more than [`DEPENDENT`] times the largest.
    pub fn solve<const RIGHT: usize>(&mut self, simd: S, used: usize) -> Solution<S, RIGHT> {
        let zero = all(simd, 0.0);
        let used = used.min(UNKNOWNS);
        let mut images = [zero; UNKNOWNS];
        let mut pivots = [0; UNKNOWNS];
        let (mut least, mut most) = (all(simd, f64::MAX), zero);
        let mut left = (1_u32 << self.count) - 1;
        for j in 0..used {
            let Some((pivot, image)) = self.reflect::<RIGHT>(simd, j, used, left) else {
                // No equation has the unknown.
                return ([[zero; RIGHT]; UNKNOWNS], Mask::splat(simd, false));
            };
            left &= !(1 << pivot);
            (pivots[j], images[j]) = (pivot, image);
            (least, most) = (least.min(image.abs()), most.max(image.abs()));
        }
        let mut solution = [[zero; RIGHT]; UNKNOWNS];
        for j in (0..used).rev() {
            let (cells, bits) = (&self.rows[pivots[j]], self.bits[pivots[j]]);
            let inverse = all(simd, 1.0) / images[j];
            for k in 0..RIGHT {
                let mut rest = cells[used + k];
                for i in j + 1..used {
                    if bits >> i & 1 == 1 {
                        rest = (-cells[i]).mul_add(solution[i][k], rest);
                    }
                }
                solution[j][k] = rest * inverse;
            }
        }
        (solution, (all(simd, DEPENDENT) * most).lt(least))
    }

    /// Householder reflection of the equations in `left` (bits) that contain unknown `j`: afterwards only the first of
    /// them contains it. Returns that equation and its new coefficient; None if no equation contains it.
    fn reflect<const RIGHT: usize>(&mut self, simd: S, j: usize, used: usize, left: u32) -> Option<(usize, Lanes<S>)> {
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        let (mut of, mut count, mut bits) = ([0; EQUATIONS], 0, 0);
        for row in 0..self.count.min(EQUATIONS) {
            if left >> row & self.bits[row] >> j & 1 == 1 {
                of[count] = row;
                count += 1;
                bits |= self.bits[row];
            }
        }
        let (&pivot, others) = of[..count].split_first()?;
        let head = self.rows[pivot][j];
        let mut square = head * head;
        for row in others {
            let cell = self.rows[*row][j];
            square = cell.mul_add(cell, square);
            self.bits[*row] = bits;
        }
        self.bits[pivot] = bits;
        let size = square.sqrt();
        let image = zero.lt(head).select(-size, size);
        // v = column - image e_j, and v . v / 2 = image (image - head).
        let half = image * (image - head);
        let empty = square.le(zero);
        let inverse = empty.select(zero, one / empty.select(one, half));
        let lead = head - image;
        for k in j + 1..used + RIGHT {
            if k < used && bits >> k & 1 == 0 {
                continue;
            }
            let mut along = lead * self.rows[pivot][k];
            for row in others {
                let cells = &self.rows[*row];
                along = cells[j].mul_add(cells[k], along);
            }
            let share = -(along * inverse);
            self.rows[pivot][k] = share.mul_add(lead, self.rows[pivot][k]);
            for row in others {
                let cells = &mut self.rows[*row];
                cells[k] = share.mul_add(cells[j], cells[k]);
            }
        }
        Some((pivot, image))
    }
}

/// Product of the pivots of normal equations over that of their diagonal above which they are solved as well as the equations
/// themselves: at columns of length 1 the ratio of the singular values is then less than 90.
const UPRIGHT: f64 = 1e-3;

/// Normal equations of the planar motion.
#[derive(Clone, Copy)]
pub(crate) struct NormalEquations<S: Vector> {
    /// Entries on and above the diagonal, row after row.
    cells: [Lanes<S>; 6],
    right: [Lanes<S>; 3],
}

#[inline_always]
impl<S: Vector> NormalEquations<S> {
    /// No equation yet.
    pub fn new(simd: S) -> Self {
        Self { cells: [all(simd, 0.0); 6], right: [all(simd, 0.0); 3] }
    }

    /// One more equation, `columns . motion = -left`.
    pub fn add(&mut self, columns: [Lanes<S>; 3], left: Lanes<S>, weight: Lanes<S>) {
        let [a, b, c] = columns;
        let weighted = [a * weight, b * weight, c * weight];
        let [x, y, z] = weighted;
        let pairs = [(x, a), (x, b), (x, c), (y, b), (y, c), (z, c)];
        for (cell, (by, column)) in self.cells.iter_mut().zip(pairs) {
            *cell = by.mul_add(column, *cell);
        }
        for (right, by) in self.right.iter_mut().zip(weighted) {
            *right = (-by).mul_add(left, *right);
        }
    }

    /// Sets the last rate to 0 in lanes where `here` is 1 and its column 0.
    pub fn set_last_known(&mut self, here: Lanes<S>) {
        self.cells[5] = self.cells[5] + here;
    }

    /// The motion, and the lanes in which no digits are lost in the squares.
    pub fn solve(&self, simd: S) -> ([Lanes<S>; 3], Mask<S>) {
        let one = all(simd, 1.0);
        let [a, b, c, d, e, f] = self.cells;
        let [x, y, z] = self.right;
        let first = one / a;
        let (ba, ca) = (b * first, c * first);
        let (d2, e2) = ((-ba).mul_add(b, d), (-ba).mul_add(c, e));
        let second = one / d2;
        let ed = e2 * second;
        let f2 = (-ed).mul_add(e2, (-ca).mul_add(c, f));
        let y2 = (-ba).mul_add(x, y);
        let z2 = (-ed).mul_add(y2, (-ca).mul_add(x, z));
        let turn = z2 / f2;
        let aside = (-ed).mul_add(turn, y2 * second);
        let ahead = (-ca).mul_add(turn, (-ba).mul_add(aside, x * first));
        let upright = (all(simd, UPRIGHT) * d * f).lt(d2 * f2);
        let (shortest, longest) = (a.min(d).min(f), a.max(d).max(f));
        let even = (all(simd, COLUMN_TOLERANCE) * longest).lt(shortest);
        ([ahead, aside, turn], upright & even)
    }
}

/// Triangle of the equations of the planar motion and their right-hand side, by Givens rotations.
pub(crate) struct PlanarTriangle<S: Vector>([[Lanes<S>; 4]; 3]);

#[inline_always]
impl<S: Vector> PlanarTriangle<S> {
    /// No equation yet.
    pub fn new(simd: S) -> Self {
        Self([[all(simd, 0.0); 4]; 3])
    }

    /// One more equation, `columns . motion = -left`.
    pub fn add(&mut self, simd: S, columns: [Lanes<S>; 3], left: Lanes<S>, weight: Lanes<S>) {
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        let scale = weight.sqrt();
        let [a, b, c] = columns;
        let mut row = [a * scale, b * scale, c * scale, -(left * scale)];
        for (k, from) in self.0.iter_mut().enumerate() {
            let length = from[k].mul_add(from[k], row[k] * row[k]).sqrt();
            let empty = length.le(zero);
            let inverse = one / empty.select(one, length);
            let (cos, sin) = (empty.select(one, from[k] * inverse), empty.select(zero, row[k] * inverse));
            for i in k..4 {
                let (up, down) = (from[i], row[i]);
                from[i] = cos.mul_add(up, sin * down);
                row[i] = cos.mul_add(down, -(sin * up));
            }
        }
    }

    /// The least-squares motion of least length in these lanes; the given motion in the others.
    pub fn solve(&self, simd: S, lanes: Mask<S>, motion: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
        let wanted = lanes.booleans();
        let (mut solution, mut cells) = ([Column::ZERO; 3], [[Column::ZERO; 4]; 3]);
        for (column, part) in solution.iter_mut().zip(motion) {
            *column = Column::of(part);
        }
        for (column, cell) in cells.as_flattened_mut().iter_mut().zip(self.0.as_flattened()) {
            *column = Column::of(*cell);
        }
        for lane in (0..S::F64_LANES).filter(|lane| wanted[*lane]) {
            let found = shortest(cells.map(|row| row.map(|cell| cell.0[lane])));
            for (column, value) in solution.iter_mut().zip(found) {
                column.0[lane] = value;
            }
        }
        [solution[0].load(simd), solution[1].load(simd), solution[2].load(simd)]
    }
}
