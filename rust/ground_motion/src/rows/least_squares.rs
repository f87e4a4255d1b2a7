//! Small systems of equations in lanes: what `least_squares` does for one, and elimination where there are no more of them
//! than unknowns.

use super::settled_poses::Standing;
use crate::motion::FOLLOWING;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_terrain::suspension::MAX_WHEELS;
use six_wheel_terrain::suspension::lanes::{ChainConstants, all};

/// Most unknowns: rates that follow the ground.
pub(crate) const UNKNOWNS: usize = FOLLOWING.len();

/// Most right-hand sides: one motion in plan each, and what is known.
const RIGHTS: usize = 4;

/// Most equations: of every wheel, and of every rate that some lanes know.
const EQUATIONS: usize = MAX_WHEELS + UNKNOWNS;

/// An equation: its unknowns, then its right-hand sides.
pub(crate) type Equation<S> = [Lanes<S>; UNKNOWNS + RIGHTS];

/// Square of the product of the pivots over that of the lengths of the columns above which columns are sure not to depend
/// on each other: see [`Equations::solve`].
const INDEPENDENT: f64 = 1e-8;

/// Square of the shortest column over that of the longest one, likewise.
const SHORT: f64 = 1e-10;

/// Share of a pivot's equation that is taken from another one, from which on it is large.
const GROWN: f64 = 64.0;

/// Elimination order of the rates that follow the ground, for as many rates as wheels that all touch: each rate by the
/// equation of the wheel in which it has the largest part on level ground.
#[derive(Clone, Copy, Debug)]
pub struct Square {
    /// The wheels, in the order of the rates: see [`ChainConstants::rise`].
    pub wheels: [usize; UNKNOWNS],
    /// Bits of the equations after one's own that have a rate, when those before it are gone.
    others: [u32; UNKNOWNS],
}

impl Square {
    /// None where there are not as many.
    pub fn new(plan: &ChainConstants) -> Option<Self> {
        let mut rows: [_; UNKNOWNS] = std::array::from_fn(|wheel| (wheel, [0.0; UNKNOWNS]));
        if [plan.joints() + 3, plan.wheels()] != [UNKNOWNS; 2] {
            return None;
        }
        for (wheel, row) in &mut rows {
            *row = plan.rise(*wheel);
        }
        let mut others = [0; UNKNOWNS];
        for j in 0..UNKNOWNS {
            let size = |k: &usize| rows[*k].1[j].abs();
            let pivot = (j..UNKNOWNS).max_by(|a, b| size(a).total_cmp(&size(b)))?;
            rows.swap(j, pivot);
            let (_, from) = rows[j];
            for (_, row) in &mut rows[j + 1..] {
                let share = row[j] / from[j];
                (j..UNKNOWNS).for_each(|k| row[k] -= share * from[k]);
            }
        }
        let wheels = rows.map(|(wheel, _)| wheel);
        let mut bits = wheels.map(|wheel| plan.parts_in(wheel));
        for j in 0..UNKNOWNS {
            for k in j + 1..UNKNOWNS {
                if bits[k] >> j & 1 == 1 {
                    others[j] |= 1 << k;
                    bits[k] |= bits[j];
                }
            }
        }
        Some(Self { wheels, others })
    }
}

/// Equations in least squares, most of them of a few of the unknowns only.
pub(crate) struct Equations<S: Vector> {
    rows: [Equation<S>; EQUATIONS],
    /// Bits of the unknowns that an equation may be of.
    bits: [u32; EQUATIONS],
    count: usize,
}

impl<S: Vector> Equations<S> {
    /// None yet.
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        Self { rows: [[all(simd, 0.0); UNKNOWNS + RIGHTS]; EQUATIONS], bits: [0; EQUATIONS], count: 0 }
    }

    #[inline(always)]
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// One more, of these unknowns; whatever was there before is to be written over.
    #[inline(always)]
    pub fn add(&mut self, bits: u32) -> &mut Equation<S> {
        let place = self.count % EQUATIONS;
        self.count += 1;
        self.bits[place] = bits;
        &mut self.rows[place]
    }

    /// Nothing is said by wheels in the air; of these equations so many numbers.
    #[inline(always)]
    pub fn limit(&mut self, standing: &Standing<S>, wheels: usize, width: usize) {
        if standing.all_touch {
            return;
        }
        for (row, touching) in self.rows.iter_mut().zip(standing.touching).take(wheels) {
            for cell in &mut row[..width] {
                *cell = *cell * touching;
            }
        }
    }

    /// Nothing is missing of an unknown where this is 1.
    #[inline(always)]
    pub fn know(&mut self, simd: S, unknown: usize, here: Lanes<S>) {
        let zero = all(simd, 0.0);
        for row in &mut self.rows[..self.count.min(EQUATIONS)] {
            row[unknown] = row[unknown] * (all(simd, 1.0) - here);
        }
        let row = self.add(1 << unknown);
        *row = [zero; UNKNOWNS + RIGHTS];
        row[unknown] = here;
    }

    /// Solves for all unknowns by elimination, of the equations of these wheels in their order. Says where no share of an
    /// equation that is taken from another one is large, and the test of [`Self::solve`] holds.
    #[inline(always)]
    pub fn eliminate<const RIGHT: usize>(
        &mut self,
        simd: S,
        square: &Square,
    ) -> ([[Lanes<S>; RIGHT]; UNKNOWNS], Mask<S>) {
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
            inverses[j] = one.quotient(from[j]);
            for k in j + 1..UNKNOWNS {
                if square.others[j] >> k & 1 == 0 {
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
        let apart = (all(simd, INDEPENDENT) * product).below(pivoted * pivoted);
        let sure = apart & (all(simd, SHORT) * longest).below(shortest);
        (solution, sure & largest.below(all(simd, GROWN)))
    }

    /// Solves for the first `used` unknowns, by Householder reflections of the equations that have one, and says where the
    /// plain way does not find that they depend on each other.
    ///
    /// With columns of the lengths `c` and pivots `p` the smallest singular value of the columns at length 1 is more than
    /// `0.6 product(p / c)`, by the inequality of the geometric and the arithmetic mean of the others' squares. So the
    /// plain way's pivots, whatever its order, are more than that times the smallest `c`.
    #[inline(always)]
    pub fn solve<const RIGHT: usize>(&mut self, simd: S, used: usize) -> ([[Lanes<S>; RIGHT]; UNKNOWNS], Mask<S>) {
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        let used = used.min(UNKNOWNS);
        let (mut inverses, mut above) = ([zero; UNKNOWNS], [zero; UNKNOWNS]);
        let mut pivots = [0; UNKNOWNS];
        let (mut pivoted, mut lengths) = (one, one);
        let (mut shortest, mut longest) = (all(simd, f64::MAX), zero);
        let mut left = (1_u32 << self.count) - 1;
        for j in 0..used {
            // The equations that have the unknown, the pivot's first.
            let (mut of, mut count, mut bits) = ([0; EQUATIONS], 0, 0);
            for row in 0..self.count.min(EQUATIONS) {
                if left >> row & self.bits[row] >> j & 1 == 1 {
                    of[count] = row;
                    count += 1;
                    bits |= self.bits[row];
                }
            }
            let Some((&pivot, others)) = of[..count].split_first() else {
                // Nothing is said of it.
                return ([[zero; RIGHT]; UNKNOWNS], zero.below(zero));
            };
            left &= !(1 << pivot);
            pivots[j] = pivot;
            let head = self.rows[pivot][j];
            let mut square = head * head;
            for row in others {
                let cell = self.rows[*row][j];
                square = cell.mul_add(cell, square);
                self.bits[*row] = bits;
            }
            self.bits[pivot] = bits;
            let size = square.sqrt();
            let image = zero.below(head).select(-size, size);
            let half = image * (image - head);
            let empty = square.at_most(zero);
            let inverse = empty.select(zero, one.quotient(empty.select(one, half)));
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
                let cell = share.mul_add(lead, self.rows[pivot][k]);
                self.rows[pivot][k] = cell;
                for row in others {
                    let cells = &mut self.rows[*row];
                    cells[k] = share.mul_add(cells[j], cells[k]);
                }
                if k < used {
                    above[k] = cell.mul_add(cell, above[k]);
                }
            }
            inverses[j] = one.quotient(image);
            let length = above[j] + square;
            (pivoted, lengths) = (pivoted * square, lengths * length);
            (shortest, longest) = (shortest.min(length), longest.max(length));
        }
        let mut solution = [[zero; RIGHT]; UNKNOWNS];
        for j in (0..used).rev() {
            let cells = &self.rows[pivots[j]];
            let bits = self.bits[pivots[j]];
            for k in 0..RIGHT {
                let mut rest = cells[used + k];
                for i in j + 1..used {
                    if bits >> i & 1 == 1 {
                        rest = (-cells[i]).mul_add(solution[i][k], rest);
                    }
                }
                solution[j][k] = rest * inverses[j];
            }
        }
        let apart = (all(simd, INDEPENDENT) * lengths).below(pivoted);
        (solution, apart & (all(simd, SHORT) * longest).below(shortest))
    }
}

/// Product of the pivots of normal equations over that of their diagonal above which they are solved as well as the equations
/// themselves: at columns of length 1 the ratio of the singular values is then less than 90.
const UPRIGHT: f64 = 1e-3;

/// Normal equations of the motion in plan.
#[derive(Clone, Copy)]
pub(crate) struct Normal<S: Vector> {
    /// On and above the diagonal, row after row.
    cells: [Lanes<S>; 6],
    right: [Lanes<S>; 3],
}

impl<S: Vector> Normal<S> {
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        Self { cells: [all(simd, 0.0); 6], right: [all(simd, 0.0); 3] }
    }

    /// One more equation, `columns . motion = -left`.
    #[inline(always)]
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

    /// Sets the last rate to its known value in lanes where this is 1: nothing is missing of it, and its column is
    /// empty.
    #[inline(always)]
    pub fn know_last(&mut self, here: Lanes<S>) {
        self.cells[5] = self.cells[5] + here;
    }

    /// The motion, and where it is sure to be as good as that of the plain way.
    #[inline(always)]
    pub fn solve(&self, simd: S) -> ([Lanes<S>; 3], Mask<S>) {
        let one = all(simd, 1.0);
        let [a, b, c, d, e, f] = self.cells;
        let [x, y, z] = self.right;
        let first = one.quotient(a);
        let (ba, ca) = (b * first, c * first);
        let (d2, e2) = ((-ba).mul_add(b, d), (-ba).mul_add(c, e));
        let second = one.quotient(d2);
        let ed = e2 * second;
        let f2 = (-ed).mul_add(e2, (-ca).mul_add(c, f));
        let y2 = (-ba).mul_add(x, y);
        let z2 = (-ed).mul_add(y2, (-ca).mul_add(x, z));
        let turn = z2.quotient(f2);
        let aside = (-ed).mul_add(turn, y2 * second);
        let ahead = (-ca).mul_add(turn, (-ba).mul_add(aside, x * first));
        let upright = (all(simd, UPRIGHT) * d * f).below(d2 * f2);
        let (shortest, longest) = (a.min(d).min(f), a.max(d).max(f));
        let sure = upright & (all(simd, SHORT) * longest).below(shortest);
        ([ahead, aside, turn], sure)
    }
}
