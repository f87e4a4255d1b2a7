//! Settling of poses by rounds of Newton's method: a pose in every lane, those that have settled replaced by others, or one
//! pose alone with its wheels in the lanes. Both are one body, and give the same bits.
//!
//! A round searches whole rims where the gaps are large, and otherwise only the neighbourhood of the last contacts. A
//! pose counts as settled when every gap is closed and a search of whole rims has found no other contact within the
//! displacement since then. All other cases (unknown ground, the edge of the map, a joint past its stop, a step as high
//! as a wheel, too many rounds) are left to [`Settler::settle_near`].

pub(crate) mod pivots;
pub(crate) mod poses;
mod round;
pub(crate) mod scan;

use pulp::Scalar;

use self::pivots::{PivotOrder, solve};
use self::poses::{CHUNK, LEFT, Left, PoseBatch, ROUNDS, SettleRange, column, scatter};
use self::scan::{AllWheels, RimScan, Site, StateLanes, WheelByWheel};
use super::active_set::ActiveSet;
use super::rims::circles::{FAR, cells};
use super::rims::extent::Extent;
use super::settler::Settler;
use super::stand::Stand;
use crate::suspension::{MAX_STATE, MAX_WHEELS};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::level::Kernel;
use six_wheel_numerics::simd::vector::Vector;

/// Number of poses from which settling them in lanes is faster than one by one.
const WORTH_LANES: usize = 8;

/// Largest change of an angle in a round of [`initial_state`], and largest angle there [rad].
const START_TURN: f64 = 0.4;
const START_ANGLE: f64 = 0.8;

/// Settles poses of finite numbers, with or without steering angles. Returns the rows for [`Settler::settle_near`], for
/// which nothing is written: all rows of chains with more wheels than numbers of the state.
pub(crate) fn settle(
    settler: &Settler<'_>,
    poses: &[[f64; 3]],
    steering: &dyn Fn(usize) -> [f64; MAX_WHEELS],
    steered: bool,
    stands: &mut [Stand],
) -> Vec<Left> {
    let order = &PivotOrder::new(settler.chain, &ActiveSet::NONE);
    if !order.is_square {
        return (0..poses.len()).map(|row| (row, None)).collect();
    }
    let mut left = Vec::new();
    let range = SettleRange { settler, order, poses, steering, steered, stands, left: &mut left };
    if poses.len() < WORTH_LANES {
        settler.level.run_any(OneByOne(range));
    } else {
        settler.level.run_any(InLanes(range));
    }
    left
}

/// A pose in every lane.
struct InLanes<'a, 'b>(SettleRange<'a, 'b>);

/// One pose after another, its wheels in the lanes.
struct OneByOne<'a, 'b>(SettleRange<'a, 'b>);

impl Kernel for InLanes<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(mut self, simd: S) {
        let range = &mut self.0;
        let mut batch = Box::new(PoseBatch::<CHUNK>::EMPTY);
        for first in (0..range.poses.len()).step_by(CHUNK) {
            let count = CHUNK.min(range.poses.len() - first);
            range.begin(&mut batch, first, count);
            // By the part of the rims that their next round searches.
            let [mut next, mut now]: [[Vec<u16>; 4]; 2] =
                std::array::from_fn(|_| std::array::from_fn(|_| Vec::with_capacity(count)));
            now[0].extend(0..count as u16);
            for rows in now[0].chunks(S::F64_LANES) {
                range.start(simd, &mut batch, rows);
            }
            next[0].extend(now[0].iter().filter(|row| range.is_unsettled(&batch, first, **row)));
            while next.iter().any(|rows| !rows.is_empty()) {
                std::mem::swap(&mut next, &mut now);
                for (list, extent) in Extent::ALL.iter().enumerate() {
                    next[list].clear();
                    for rows in now[list].chunks(S::F64_LANES) {
                        range.round(simd, WheelByWheel, &mut batch, first, rows, *extent);
                    }
                }
                for &row in now.iter().flatten() {
                    let list = batch.states[row as usize].extent() as usize;
                    if range.is_unsettled(&batch, first, row) {
                        next[list].push(row);
                    }
                }
            }
        }
    }
}

impl Kernel for OneByOne<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(mut self, simd: S) {
        let range = &mut self.0;
        for first in 0..range.poses.len() {
            let mut batch = PoseBatch::<1>::EMPTY;
            range.begin(&mut batch, first, 1);
            range.start(Scalar, &mut batch, &[0]);
            while range.is_unsettled(&batch, first, 0) {
                let extent = batch.states[0].extent();
                range.round(Scalar, AllWheels(simd), &mut batch, first, &[0], extent);
            }
        }
    }
}

#[inline_always]
impl SettleRange<'_, '_> {
    /// True if a pose takes another round. After too many rounds it is left.
    fn is_unsettled<const N: usize>(&mut self, batch: &PoseBatch<N>, first: usize, row: u16) -> bool {
        let rounds = batch.rounds[row as usize];
        if (ROUNDS..LEFT).contains(&rounds) {
            self.left.push((first + row as usize, None));
        }
        rounds < ROUNDS
    }

    /// Sets the initial states of poses. Those over unknown ground take no round.
    fn start<S: Vector, const N: usize>(&self, simd: S, batch: &mut PoseBatch<N>, rows: &[u16]) {
        let mut here = self.here(simd, batch, rows);
        let known = initial_state(simd, &self.site(), &mut here).booleans();
        for k in 0..MAX_STATE {
            scatter(&mut batch.columns[column::STATE + k], rows, here.state[k]);
        }
        for (lane, &row) in rows.iter().enumerate() {
            if !known[lane] {
                batch.rounds[row as usize] = ROUNDS;
            }
        }
    }
}

/// Sets states in which every wheel's centre is one radius above the ground below it. False in the lanes where that
/// ground is unknown or the system is singular: there only the height is set, by the mean of the known ground.
#[inline(always)]
pub(crate) fn initial_state<S: Vector>(simd: S, site: &Site<'_>, here: &mut StateLanes<S>) -> Mask<S> {
    let (zero, unit) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let spacing = site.per_metre(simd);
    let mut goes_on = zero.lt(unit);
    for _ in 0..2 {
        let poses = here.poses(simd, site.chain);
        let mut scan = RimScan::empty(simd, poses.links.reaches);
        let (mut sum, mut count) = (zero, zero);
        for wheel in (0..site.chain.wheels().len().min(MAX_WHEELS)).filter(|&wheel| site.order.touches(wheel)) {
            let centre = poses.wheel(simd, wheel).centre;
            let u = (here.origin[0] + centre[0]) * spacing[0];
            let v = (here.origin[1] + centre[1]) * spacing[1];
            let corner = [u.floor(), v.floor()];
            let cell = cells(simd, site.ground, corner[0], corner[1]);
            let (a, b) = (u - corner[0], v - corner[1]);
            let height = cell.height(a, b) + Lanes::splat(simd, site.chain.wheels()[wheel].radius);
            let missing = height - (here.state[0] + centre[2]);
            let is_known = missing.abs().lt(Lanes::splat(simd, FAR));
            sum = is_known.select(sum + missing, sum);
            count = is_known.select(count + unit, count);
            scan.touches = scan.touches & is_known;
            scan.rows[wheel] = (poses.gap_slopes(simd, wheel, centre, [zero; 2]), missing);
        }
        let lifted = here.state[0] + sum / count.max(unit);
        if !site.order.is_square {
            here.state[0] = lifted;
            return Mask::splat(simd, false);
        }
        let (step, smallest) = solve(simd, site.order, &mut scan.rows);
        let is_solved = scan.touches & Lanes::splat(simd, pivots::SMALLEST_PIVOT).le(smallest);
        let moves = goes_on & is_solved;
        for &(k, _) in site.order.columns() {
            let (most, limit) = (Lanes::splat(simd, START_TURN), Lanes::splat(simd, START_ANGLE));
            let next = match k {
                0 => here.state[0] + step[0],
                _ => (here.state[k] + step[k].min(most).max(-most)).min(limit).max(-limit),
            };
            let stays = if k == 0 { (goes_on & !is_solved).select(lifted, here.state[0]) } else { here.state[k] };
            here.state[k] = moves.select(next, stays);
        }
        goes_on = moves;
    }
    goes_on
}
