//! Many poses at once: a pose in every lane, those that have settled replaced by others.
//!
//! Rounds of Newton's method look at whole rims where the gaps are large, and otherwise only at what is near the
//! last contacts. A pose counts as settled when every gap is closed and a look at whole rims has found nothing else
//! so near that the way from there could have closed it. Whatever is more than that (unknown ground, the end
//! of the map, a joint past its stop, a wall as high as a wheel, no end of rounds) is for [`Settler`] alone.

mod look;
mod round;
mod solve;

use self::look::Here;
use self::round::LOOK;
use self::solve::{PivotOrder, Rows, solve};
use super::rims::circles::{FAR, RIMS, cells, floor, spread};
use super::settler::Settler;
use super::stand::Stand;
use crate::suspension::{MAX_STATE, MAX_WHEELS, State};
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::Kernel;
use six_wheel_numerics::simd::vector::Vector;

/// Poses that are worked on together: their numbers stay in the second-level cache.
const CHUNK: usize = 512;

/// Rounds after which a pose is left to [`Settler::settle_near`].
const ROUNDS: u8 = 24;

/// State of the solution for a pose.
#[derive(Clone, Copy, PartialEq, Eq)]
enum SolveState {
    /// It is not near: its next look is about the lowest of some points.
    Far,
    /// Its next look goes along whole rims, as far as they may touch.
    Whole,
    /// It is there, and what the upper halves do is not known.
    Both,
    /// It is nearly there, and nothing else is near.
    Sure,
    /// Its next look is a short one.
    Short,
}

/// States in which a pose is looked at.
const LOOKS: [SolveState; 4] = [SolveState::Far, SolveState::Whole, SolveState::Short, SolveState::Both];

/// Numbers of the poses, column by column.
mod column {
    use crate::suspension::{MAX_STATE, MAX_WHEELS};

    pub const X: usize = 0;
    pub const Y: usize = 1;
    pub const SIN: usize = 2;
    pub const COS: usize = 3;
    /// Largest gap of the last round [m].
    pub const WORST: usize = 4;
    /// Share of the step that is taken.
    pub const SHARE: usize = 5;
    /// Range of the next short look to either side of the last contacts [rad].
    pub const LOOK: usize = 6;
    pub const STATE: usize = 7;
    /// Sine and cosine of the contact angle of every wheel.
    pub const CONTACT: usize = STATE + MAX_STATE;
    /// Of every steering angle.
    pub const STEERING: usize = CONTACT + 2 * MAX_WHEELS;
    pub const COUNT: usize = STEERING + 2 * MAX_WHEELS;
}

/// Poses on their way.
struct PoseBatch {
    columns: [[f64; CHUNK]; column::COUNT],
    rounds: [u8; CHUNK],
    states: [SolveState; CHUNK],
}

/// Number of rounds of a pose whose gaps are closed: nothing else touches, or that is not sure.
const DONE: u8 = u8::MAX;
const LEFT: u8 = DONE - 1;

/// A row for [`Settler::settle_near`], and where its gaps are closed if nothing else touches there.
pub(crate) type Left = (usize, Option<State>);

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

struct SettleRange<'a, 'b> {
    settler: &'a Settler<'b>,
    order: &'a PivotOrder,
    poses: &'a [[f64; 3]],
    steering: &'a dyn Fn(usize) -> [f64; MAX_WHEELS],
    steered: bool,
    stands: &'a mut [Stand],
    /// Rows for [`Settler::settle_near`].
    left: &'a mut Vec<Left>,
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
                self.guess(simd, &mut batch, rows);
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

/// A number of so many rows.
#[inline(always)]
fn gather<S: Vector>(simd: S, column: &[f64; CHUNK], rows: &[u16]) -> Lanes<S> {
    let mut values = [0.0; RIMS];
    for lane in 0..S::F64_LANES {
        values[lane] = column[rows[lane.min(rows.len() - 1)] as usize % CHUNK];
    }
    Lanes::load(simd, S::as_simd_f64s(&values).0, 0)
}

/// Writes a number of so many rows.
#[inline(always)]
fn scatter<S: Vector>(column: &mut [f64; CHUNK], rows: &[u16], lanes: Lanes<S>) {
    let values = spread(lanes);
    for (&row, value) in rows.iter().zip(values) {
        column[row as usize % CHUNK] = value;
    }
}

impl SettleRange<'_, '_> {
    fn begin(&self, batch: &mut PoseBatch, first: usize, count: usize) {
        let ground = self.settler.ground;
        let turn = ground.turn();
        for row in 0..count {
            let [x, y, yaw] = self.poses[first + row];
            let [x0, y0] = ground.origin();
            let place = ground.grid_axes([x - x0, y - y0]);
            let (sin, cos) = yaw.sin_cos();
            let heading = [sin * turn.cos - cos * turn.sin, cos * turn.cos + sin * turn.sin];
            let numbers = [place[0], place[1], heading[0], heading[1], FAR, 1.0, LOOK[1]];
            for (column, number) in batch.columns.iter_mut().zip(numbers) {
                column[row] = number;
            }
            if self.steered {
                for (joint, angle) in (self.steering)(first + row).into_iter().enumerate() {
                    let (sin, cos) = angle.sin_cos();
                    batch.columns[column::STEERING + 2 * joint][row] = sin;
                    batch.columns[column::STEERING + 2 * joint + 1][row] = cos;
                }
            }
        }
        batch.columns[column::STATE..column::CONTACT].as_flattened_mut().fill(0.0);
        for wheel in 0..MAX_WHEELS {
            batch.columns[column::CONTACT + 2 * wheel].fill(0.0);
            batch.columns[column::CONTACT + 2 * wheel + 1].fill(1.0);
        }
        batch.rounds.fill(0);
        batch.states.fill(SolveState::Far);
    }

    #[inline(always)]
    fn here<S: Vector>(&self, simd: S, batch: &PoseBatch, rows: &[u16]) -> Here<S> {
        let columns = &batch.columns;
        let zero = Lanes::splat(simd, 0.0);
        let mut here = Here {
            origin: [gather(simd, &columns[column::X], rows), gather(simd, &columns[column::Y], rows)],
            yaw: (gather(simd, &columns[column::SIN], rows), gather(simd, &columns[column::COS], rows)),
            state: [zero; MAX_STATE],
            steering: None,
            contacts: [[zero; 2]; MAX_WHEELS],
        };
        for (k, contact) in here.contacts.iter_mut().enumerate() {
            *contact = [
                gather(simd, &columns[column::CONTACT + 2 * k], rows),
                gather(simd, &columns[column::CONTACT + 2 * k + 1], rows),
            ];
        }
        for (k, number) in here.state.iter_mut().enumerate() {
            *number = gather(simd, &columns[column::STATE + k], rows);
        }
        if self.steered {
            let mut steering = [(zero, zero); MAX_WHEELS];
            for (k, turned) in steering.iter_mut().enumerate() {
                *turned = (
                    gather(simd, &columns[column::STEERING + 2 * k], rows),
                    gather(simd, &columns[column::STEERING + 2 * k + 1], rows),
                );
            }
            here.steering = Some(steering);
        }
        here
    }

    /// A state to start from: every wheel's centre one radius above the ground below it.
    #[inline(always)]
    fn guess<S: Vector>(&self, simd: S, batch: &mut PoseBatch, rows: &[u16]) {
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
