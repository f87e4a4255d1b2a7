//! Newton's step for the gaps of a chain, a pose in every lane.

use crate::ground::active_set::ActiveSet;
use crate::suspension::{Chain, MAX_STATE, MAX_WHEELS};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;

/// The linear system of Newton's step: for every wheel a row `d gap / d state`, and the gap on the right-hand side [m].
pub(crate) type Rows<S> = [([Lanes<S>; MAX_STATE], Lanes<S>); MAX_WHEELS];

/// A system with a pivot below this is singular.
pub(crate) const SMALLEST_PIVOT: f64 = 1e-10;

/// The columns of the system in the order of elimination, each with the bits of the wheels in whose rows it is not 0.
/// Wheels in the air have no row, held joints no column.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PivotOrder {
    /// Bits of the wheels that touch.
    touching: u32,
    /// Number of wheels of the chain.
    wheels: usize,
    columns: [(usize, u32); MAX_STATE],
    count: usize,
    /// True if there are as many touching wheels as columns, and every column can be given a wheel of its own.
    pub is_square: bool,
}

impl PivotOrder {
    /// Equations of the touching wheels of a chain, for the angles that are not held.
    pub fn new(chain: &Chain, hold: &ActiveSet) -> Self {
        let wheels = chain.wheels().len();
        let touching = ((1_u32 << wheels) - 1) & !hold.hanging;
        let moved = |wheel: usize, k: usize| chain.mount(wheel).movers.iter().any(|(_, joint)| 3 + joint == k);
        let bits =
            |k: usize| (0..wheels).filter(|&wheel| k < 3 || moved(wheel, k)).fold(0, |bits, wheel| bits | 1 << wheel);
        let (mut columns, mut count) = ([(0, 0); MAX_STATE], 0);
        for k in hold.free_columns(chain.state_count()) {
            columns[count] = (k, bits(k) & touching);
            count += 1;
        }
        columns[..count].sort_by_key(|(_, wheels)| wheels.count_ones());
        let mut order = Self { touching, wheels, columns, count, is_square: touching.count_ones() as usize == count };
        let mut left = touching;
        for (_, wheels) in &columns[..count] {
            order.is_square &= left & wheels != 0;
            left &= !(1_u32.unbounded_shl((left & wheels).trailing_zeros()));
        }
        order
    }

    /// Indices of the numbers of the state that may change, with the bits of their wheels.
    #[inline(always)]
    pub fn columns(&self) -> &[(usize, u32)] {
        &self.columns[..self.count]
    }

    /// True if a wheel touches.
    #[inline(always)]
    pub fn touches(&self, wheel: usize) -> bool {
        self.touching >> wheel & 1 == 1
    }
}

/// Solves by elimination with row exchanges in every lane: the solution, 0 for held numbers, and the smallest pivot. In
/// lanes with a singular system the solution is huge or not finite. The order has to be square.
#[inline(always)]
pub(crate) fn solve<S: Vector>(simd: S, order: &PivotOrder, rows: &mut Rows<S>) -> ([Lanes<S>; MAX_STATE], Lanes<S>) {
    let mut left = order.touching;
    let mut pivots = [0; MAX_STATE];
    let mut smallest = Lanes::splat(simd, f64::INFINITY);
    for (step, (column, wheels)) in order.columns().iter().enumerate() {
        // Earlier columns are eliminated from the remaining rows. By the order of the columns, the elimination makes no
        // entry of this column other than 0 that was 0 before.
        let those = left & wheels;
        let pivot = those.trailing_zeros() as usize % MAX_WHEELS;
        pivots[step] = pivot;
        left &= !(1 << pivot);
        let rest = those & left;
        for row in (0..order.wheels).filter(|row| rest >> row & 1 == 1) {
            let larger = rows[pivot].0[*column].abs().lt(rows[row].0[*column].abs());
            for k in 0..MAX_STATE {
                exchange(larger, rows, [pivot, row], |row| &mut row.0[k]);
            }
            exchange(larger, rows, [pivot, row], |row| &mut row.1);
        }
        smallest = smallest.min(rows[pivot].0[*column].abs());
        let inverse = Lanes::splat(simd, 1.0) / rows[pivot].0[*column];
        for row in (0..order.wheels).filter(|row| rest >> row & 1 == 1) {
            let factor = -(rows[row].0[*column] * inverse);
            for (after, _) in &order.columns()[step + 1..] {
                rows[row].0[*after] = factor.mul_add(rows[pivot].0[*after], rows[row].0[*after]);
            }
            rows[row].1 = factor.mul_add(rows[pivot].1, rows[row].1);
        }
    }
    let mut solution = [Lanes::splat(simd, 0.0); MAX_STATE];
    for (step, (column, _)) in order.columns().iter().enumerate().rev() {
        let (row, mut right) = rows[pivots[step]];
        for (after, _) in &order.columns()[step + 1..] {
            right = right - row[*after] * solution[*after];
        }
        solution[*column] = right / row[*column];
    }
    (solution, smallest)
}

/// Swaps a number of two rows where the mask says.
#[inline(always)]
fn exchange<S: Vector>(
    mask: Mask<S>,
    rows: &mut Rows<S>,
    [a, b]: [usize; 2],
    number: impl Fn(&mut ([Lanes<S>; MAX_STATE], Lanes<S>)) -> &mut Lanes<S>,
) {
    let (first, second) = (*number(&mut rows[a]), *number(&mut rows[b]));
    *number(&mut rows[a]) = mask.select(second, first);
    *number(&mut rows[b]) = mask.select(first, second);
}
