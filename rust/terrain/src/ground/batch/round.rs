//! A round of Newton's method for as many poses as there are lanes.

use super::pivots::solve;
use super::poses::{DONE, LEFT, LOOK, PoseBatch, ROUNDS, SettleRange, SolveState, column, gather, scatter};
use super::scan::{RimScan, StateLanes, UPPER, WheelSearch};
use crate::ground::active_set::CLOSED_GAP;
use crate::ground::rims::circles::{FAR, RIMS, spread};
use crate::ground::rims::extent::{Extent, MARGIN};
use crate::ground::rims::interval::TIE;
use crate::ground::settler::Status;
use crate::ground::stand::{Contact, Stand};
use crate::suspension::{MAX_FREE, MAX_STATE, MAX_WHEELS};
use six_wheel_kinematics::geometry::Direction;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;

/// Largest change of an angle in a step, and largest angle [rad]: rounds have no line search, so both are less than
/// those of [`crate::ground::newton`].
const LARGEST_TURN: f64 = 0.25;
const LARGEST_ANGLE: f64 = 1.3;

/// Largest gap up to which whole rims are searched again [m].
const NEARLY: f64 = 2e-6;

/// Change of an angle in a step above which the next search is about sampled points [rad].
const FAR_AWAY: f64 = 0.06;

/// A displacement below this share of [`MARGIN`] makes no other contact, on slopes up to 9.
const SHORT: f64 = 0.1;

/// Upper bound of the distance of a rim's point from the axes of rotation [m]: from an angle to a displacement.
const ARM: f64 = 3.0;

/// Newton's step, damped.
struct NewtonStep<S: Vector> {
    /// The state after it.
    state: [Lanes<S>; MAX_STATE],
    /// Damping factor of the step, and its largest change of an angle [rad].
    share: Lanes<S>,
    turn: Lanes<S>,
    /// True where the gaps are closed, where the step is finite, and where it is too short for another contact.
    is_closed: Mask<S>,
    is_finite: Mask<S>,
    is_short: Mask<S>,
}

#[inline_always]
impl SettleRange<'_, '_> {
    /// A round of Newton's method for as many poses as there are lanes, or fewer.
    pub(super) fn round<S: Vector, const N: usize>(
        &mut self,
        simd: S,
        search: impl WheelSearch<S>,
        batch: &mut PoseBatch<N>,
        first: usize,
        rows: &[u16],
        extent: Extent,
    ) {
        let here = self.here(simd, batch, rows);
        let [reach] = gather(simd, &batch.columns[column::LOOK..], rows);
        let mut scan = search.scan(simd, &self.site(), &here, extent, reach);
        let (whole, _) = solve(simd, self.order, &mut scan.rows);
        let step = self.step(simd, batch, rows, &here, &scan, &whole);
        let (goes_on, settles) = self.next_states(batch, rows, extent, &scan, &step);
        if settles {
            self.write_settled(batch, first, rows, &here, &scan);
        }
        let goes_on = Lanes::splat(simd, 0.0).lt(Lanes::from_slice(simd, &goes_on));
        for (k, number) in step.state.into_iter().enumerate() {
            let number = goes_on.select(number, here.state[k]);
            scatter(&mut batch.columns[column::STATE + k], rows, number);
        }
        for wheel in 0..self.settler.chain.wheels().len() {
            for k in 0..2 {
                let number = goes_on.select(scan.found[wheel].at[k], here.contacts[wheel][k]);
                scatter(&mut batch.columns[column::CONTACT + 2 * wheel + k], rows, number);
            }
        }
    }

    /// The step with a damping factor: half the last one where the largest gap has increased, otherwise twice the last
    /// one.
    fn step<S: Vector, const N: usize>(
        &self,
        simd: S,
        batch: &PoseBatch<N>,
        rows: &[u16],
        here: &StateLanes<S>,
        scan: &RimScan<S>,
        whole: &[Lanes<S>; MAX_STATE],
    ) -> NewtonStep<S> {
        let zero = Lanes::splat(simd, 0.0);
        let mut turn = whole[1].abs();
        for number in &whole[2..] {
            turn = turn.max(number.abs());
        }
        let [before, last] = gather(simd, &batch.columns[column::WORST..], rows);
        let (half, double) = (Lanes::splat(simd, 0.5), Lanes::splat(simd, 2.0));
        let share = before
            .lt(scan.worst)
            .select((last * half).max(Lanes::splat(simd, 0.25)), (last * double).min(Lanes::splat(simd, 1.0)));
        let most = Lanes::splat(simd, LARGEST_TURN);
        let scale = share * (most / turn.max(most));
        let way = whole[0].abs() + turn * Lanes::splat(simd, ARM);
        let limit = Lanes::splat(simd, LARGEST_ANGLE);
        let mut state = here.state;
        state[0] = scale.mul_add(whole[0], state[0]);
        for k in 1..MAX_STATE {
            state[k] = scale.mul_add(whole[k], state[k]).min(limit).max(-limit);
        }
        let [absolute, relative] = [Lanes::splat(simd, CLOSED_GAP[0]), Lanes::splat(simd, CLOSED_GAP[1])];
        NewtonStep {
            state,
            share,
            turn: turn * scale,
            is_closed: scan.worst.le(here.state[0].abs().mul_add(relative, absolute)),
            // False for NaN.
            is_finite: zero.le(way) & way.lt(Lanes::splat(simd, FAR)),
            is_short: way.lt(Lanes::splat(simd, SHORT * MARGIN)),
        }
    }

    /// Sets the next state of the solution for every pose. Returns 1 for the poses that take their step, and true if
    /// one has settled.
    fn next_states<S: Vector, const N: usize>(
        &self,
        batch: &mut PoseBatch<N>,
        rows: &[u16],
        extent: Extent,
        scan: &RimScan<S>,
        step: &NewtonStep<S>,
    ) -> ([f64; RIMS], bool) {
        let whole = matches!(extent, Extent::Whole | Extent::Both);
        let moves = (scan.touches & step.is_finite).booleans();
        let (closed, near) = (step.is_closed.booleans(), step.is_short.booleans());
        let (clear, worst) = (spread(scan.clear), spread(scan.worst));
        let (turn, share) = (spread(step.turn), spread(step.share));
        let (mut goes_on, mut settles) = ([0.0; RIMS], false);
        for (lane, &row) in rows.iter().enumerate() {
            let row = row as usize;
            batch.rounds[row] += 1;
            if !moves[lane] {
                if whole {
                    batch.rounds[row] = ROUNDS;
                }
                batch.states[row] = SolveState::Whole;
                continue;
            }
            if closed[lane] {
                if extent == Extent::Whole && clear[lane] == UPPER {
                    batch.states[row] = SolveState::Both;
                } else if whole && clear[lane] <= TIE {
                    batch.rounds[row] = LEFT;
                } else if whole || batch.states[row] == SolveState::Sure {
                    batch.rounds[row] = DONE;
                } else {
                    batch.states[row] = SolveState::Whole;
                }
                settles |= batch.rounds[row] >= LEFT;
                continue;
            }
            goes_on[lane] = 1.0;
            batch.columns[column::WORST][row] = worst[lane];
            batch.columns[column::SHARE][row] = share[lane];
            batch.columns[column::LOOK][row] = (LOOK[0] + 2.0 * turn[lane]).min(LOOK[1]);
            let stays = batch.states[row] == SolveState::Sure && near[lane];
            let becomes = whole && clear[lane] > MARGIN && near[lane];
            batch.states[row] = if stays || becomes {
                SolveState::Sure
            } else if turn[lane] > FAR_AWAY {
                SolveState::Far
            } else if !whole && worst[lane] < NEARLY {
                SolveState::Whole
            } else {
                SolveState::Short
            };
        }
        (goes_on, settles)
    }

    /// Writes lanes that have settled; lanes with a joint past its stop or another possible contact are left.
    fn write_settled<S: Vector, const N: usize>(
        &mut self,
        batch: &PoseBatch<N>,
        first: usize,
        rows: &[u16],
        here: &StateLanes<S>,
        scan: &RimScan<S>,
    ) {
        let mut states = [[0.0; RIMS]; MAX_STATE];
        for (numbers, lanes) in states.iter_mut().zip(here.state) {
            *numbers = spread(lanes);
        }
        let mut contacts = [[[0.0; RIMS]; 5]; MAX_WHEELS];
        for (numbers, found) in contacts.iter_mut().zip(&scan.found) {
            let ([sin, cos], [along, across]) = (found.at, found.slope);
            for (number, lanes) in numbers.iter_mut().zip([found.gap, sin, cos, along, across]) {
                *number = spread(lanes);
            }
        }
        for (lane, &row) in rows.iter().enumerate() {
            let rounds = batch.rounds[row as usize];
            if rounds < LEFT {
                continue;
            }
            let (row, state) = (first + row as usize, states.map(|numbers| numbers[lane]));
            if rounds == LEFT || self.settler.past(&state) != [0; MAX_FREE] {
                self.left.push((row, Some(state)));
                continue;
            }
            let stand = &mut self.stands[row];
            *stand = Stand::nothing(Status::Settled);
            stand.state = state;
            let wheels = stand.wheels.iter_mut().zip(&contacts);
            for (contact, numbers) in wheels.take(self.settler.chain.wheels().len()) {
                let [gap, sin, cos, along, across] = numbers.map(|numbers| numbers[lane]);
                *contact = Contact::new(self.settler.ground, gap, Direction { sin, cos }, [along, across]);
            }
        }
    }
}
