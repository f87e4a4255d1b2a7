//! Newton's step for the gaps of a chain, a pose in every lane.

use crate::suspension::{Chain, MAX_STATE, MAX_WHEELS};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;

/// The system whose solution is Newton's step: a row of slopes for every wheel, and on its right what is missing.
pub(crate) type Rows<S> = [([Lanes<S>; MAX_STATE], Lanes<S>); MAX_WHEELS];

/// The columns of the system in the order of elimination, each with the bits of the wheels it is not 0 for.
#[derive(Clone, Debug)]
pub(crate) struct PivotOrder {
    wheels: usize,
    columns: Vec<(usize, u32)>,
}

impl PivotOrder {
    /// For a chain with as many wheels as numbers that the ground decides.
    pub fn new(chain: &Chain) -> Self {
        let wheels = chain.wheels().len();
        let all = (1_u32 << wheels) - 1;
        let moved = |wheel: usize, k: usize| chain.movers(wheel).iter().any(|(_, joint)| 3 + joint == k);
        let bits = |k: usize| (0..wheels).filter(|&wheel| moved(wheel, k)).fold(0, |bits, wheel| bits | 1 << wheel);
        let mut columns: Vec<_> = (0..chain.state_count()).map(|k| (k, if k < 3 { all } else { bits(k) })).collect();
        columns.sort_by_key(|(_, wheels)| wheels.count_ones());
        Self { wheels, columns }
    }
}

/// Solves by elimination with row exchanges, lane by lane. Where it is singular the numbers are not finite, or huge.
#[inline(always)]
pub(crate) fn solve<S: Vector>(simd: S, order: &PivotOrder, rows: &mut Rows<S>) -> [Lanes<S>; MAX_STATE] {
    let mut left = (1_u32 << order.wheels) - 1;
    let mut pivots = [0; MAX_STATE];
    for (step, (column, wheels)) in order.columns.iter().enumerate() {
        // Earlier columns are 0 or gone in all rows that are left; theirs filled no place that was 0 in this one
        // unless that is full anyway.
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
        let inverse = Lanes::splat(simd, 1.0) / rows[pivot].0[*column];
        for row in (0..order.wheels).filter(|row| rest >> row & 1 == 1) {
            let factor = -(rows[row].0[*column] * inverse);
            for (after, _) in &order.columns[step + 1..] {
                rows[row].0[*after] = factor.mul_add(rows[pivot].0[*after], rows[row].0[*after]);
            }
            rows[row].1 = factor.mul_add(rows[pivot].1, rows[row].1);
        }
    }
    let mut solution = [Lanes::splat(simd, 0.0); MAX_STATE];
    for (step, (column, _)) in order.columns.iter().enumerate().rev() {
        let (row, mut right) = rows[pivots[step]];
        for (after, _) in &order.columns[step + 1..] {
            right = right - row[*after] * solution[*after];
        }
        solution[*column] = right / row[*column];
    }
    solution
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
