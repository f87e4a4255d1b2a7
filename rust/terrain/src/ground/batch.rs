//! Many poses at once: a pose in every lane, those that have settled replaced by others.
//!
//! Rounds of Newton's method look at whole rims where the gaps are large, and otherwise only at what is near the
//! last contacts. A pose counts as settled when every gap is closed and a look at whole rims has found nothing else
//! so near that the way from there could have closed it. Whatever is more than that (unknown ground, the end
//! of the map, a joint past its stop, a wall as high as a wheel, no end of rounds) is for [`Settler`] alone.

mod look;
mod poses;
mod round;
mod solve;

pub(crate) use self::poses::Left;
use self::poses::{CHUNK, LEFT, LOOKS, PoseBatch, ROUNDS, SettleRange, SolveState, column};
use self::solve::{PivotOrder, Rows, solve};
use super::rims::circles::{cells, floor, spread};
use super::settler::Settler;
use super::stand::Stand;
use crate::suspension::{MAX_STATE, MAX_WHEELS};
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::Kernel;
use six_wheel_numerics::simd::vector::Vector;

/// Settles poses of finite numbers, with or without steering angles; rows that are left have nothing written. None for
/// chains with more wheels than can touch.
pub(crate) fn settle(
    settler: &Settler<'_>,
    poses: &[[f64; 3]],
    steering: &dyn Fn(usize) -> [f64; MAX_WHEELS],
    steered: bool,
    stands: &mut [Stand],
    left: &mut Vec<Left>,
) -> Option<()> {
    if settler.chain.wheels().len() != settler.chain.state_count() {
        return None;
    }
    let order = &PivotOrder::new(settler.chain);
    settler.level.run_any(SettleRange { settler, order, poses, steering, steered, stands, left });
    Some(())
}

impl Kernel for SettleRange<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(mut self, simd: S) {
        let mut batch = Box::new(PoseBatch {
            columns: [[0.0; CHUNK]; column::COUNT],
            rounds: [0; CHUNK],
            states: [SolveState::Whole; CHUNK],
        });
        for first in (0..self.poses.len()).step_by(CHUNK) {
            let count = CHUNK.min(self.poses.len() - first);
            self.begin(&mut batch, first, count);
            // By what their next look is.
            let [mut next, mut now]: [[Vec<u16>; 4]; 2] =
                std::array::from_fn(|_| std::array::from_fn(|_| Vec::with_capacity(count)));
            next[0].extend(0..count as u16);
            for rows in next[0].chunks(S::F64_LANES) {
                self.initial_state(simd, &mut batch, rows);
            }
            while next.iter().any(|rows| !rows.is_empty()) {
                std::mem::swap(&mut next, &mut now);
                for (list, state) in LOOKS.iter().enumerate() {
                    next[list].clear();
                    for rows in now[list].chunks(S::F64_LANES) {
                        self.round(simd, &mut batch, first, rows, *state);
                    }
                }
                for &row in now.iter().flatten() {
                    let list = match batch.states[row as usize] {
                        SolveState::Far => 0,
                        SolveState::Whole => 1,
                        SolveState::Sure | SolveState::Short => 2,
                        SolveState::Both => 3,
                    };
                    if batch.rounds[row as usize] < ROUNDS {
                        next[list].push(row);
                    } else if batch.rounds[row as usize] < LEFT {
                        self.left.push((first + row as usize, None));
                    }
                }
            }
        }
    }
}

impl SettleRange<'_, '_> {
    /// A state to start from: every wheel's centre one radius above the ground below it.
    #[inline(always)]
    fn initial_state<S: Vector>(&self, simd: S, batch: &mut PoseBatch, rows: &[u16]) {
        let (chain, ground) = (self.settler.chain, self.settler.ground);
        let zero = Lanes::splat(simd, 0.0);
        let mut here = self.here(simd, batch, rows);
        let spacing = ground.spacing();
        for _ in 0..2 {
            let poses = here.poses(simd, chain);
            let mut system: Rows<S> = [([zero; MAX_STATE], zero); MAX_WHEELS];
            for (wheel, row) in system.iter_mut().enumerate().take(chain.wheels().len()) {
                let centre = poses.wheel(simd, wheel).centre;
                let u = (here.origin[0] + centre[0]) * Lanes::splat(simd, 1.0 / spacing[0]);
                let v = (here.origin[1] + centre[1]) * Lanes::splat(simd, 1.0 / spacing[1]);
                let corner = [floor(simd, u), floor(simd, v)];
                let cell = cells(simd, ground, corner[0], corner[1]);
                let (a, b) = (u - corner[0], v - corner[1]);
                let height = cell.h00
                    + cell.along * a
                    + (cell.across + cell.twist * a) * b
                    + Lanes::splat(simd, chain.wheels()[wheel].radius);
                let missing = height - (here.state[0] + centre[2]);
                *row = (poses.gap_slopes(simd, wheel, centre, [zero; 2]), missing);
            }
            let step = solve(simd, self.order, &mut system);
            here.state[0] = here.state[0] + step[0];
            for (k, step) in step.into_iter().enumerate().skip(1) {
                let (most, limit) = (Lanes::splat(simd, 0.4), Lanes::splat(simd, 0.8));
                let angle = here.state[k] + step.min(most).max(-most);
                here.state[k] = angle.min(limit).max(-limit);
            }
        }
        for k in 0..MAX_STATE {
            let values = spread(here.state[k]);
            for (lane, &row) in rows.iter().enumerate() {
                let column = &mut batch.columns[column::STATE + k];
                column[row as usize] = values[lane];
                if !values[lane].is_finite() {
                    batch.rounds[row as usize] = ROUNDS;
                }
            }
        }
    }
}
