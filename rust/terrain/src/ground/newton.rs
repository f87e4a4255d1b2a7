//! Closing the gaps of the wheels that touch: Newton's method with step control.

use super::settler::Settler;
use super::touch::WheelContacts;
use crate::ground::rims::contact::RimSegment;
use crate::suspension::{MAX_FREE, MAX_STATE, MAX_WHEELS, PlanPose, State};
use crate::terrain::{Interpolation, Sample};

/// Largest turn of any joint or of the body in one step [rad].
const LARGEST_TURN: f64 = 0.3;

/// Angles beyond this are no way to stand [rad].
pub(crate) const LARGEST_ANGLE: f64 = 1.35;

/// A gap is closed if it is at most the first [m] and the second times the height: some roundings of heights of that size.
pub(crate) const CLOSED_GAP: [f64; 2] = [2e-12, 2e-15];

/// Steps of one attempt.
const STEPS: usize = 40;

/// Steps that may close no gap before another start is tried.
const STALLS: usize = 5;

/// The active set: joints held at an angle, and wheels in the air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActiveSet {
    /// Angles of the joints that are held.
    pub joints: [Option<f64>; MAX_FREE],
    /// Bits of the wheels that are left in the air.
    pub hanging: u32,
}

impl ActiveSet {
    /// Nothing held, nothing in the air.
    pub const NONE: Self = Self { joints: [None; MAX_FREE], hanging: 0 };

    /// True if a wheel touches.
    #[inline]
    pub fn touches(&self, wheel: usize) -> bool {
        self.hanging >> wheel & 1 == 0
    }
}

/// As many equations as unknowns, of which there are at most six, and up to three right-hand sides.
pub(crate) struct NewtonSystem<const RIGHT: usize> {
    /// Rows of coefficients.
    pub rows: [[f64; MAX_STATE]; MAX_WHEELS],
    /// Right-hand sides, row by row.
    pub right: [[f64; RIGHT]; MAX_WHEELS],
    /// Number of both.
    pub count: usize,
}

impl<const RIGHT: usize> NewtonSystem<RIGHT> {
    #[inline]
    pub fn empty() -> Self {
        Self { rows: [[0.0; MAX_STATE]; MAX_WHEELS], right: [[0.0; RIGHT]; MAX_WHEELS], count: 0 }
    }

    /// Adds an equation.
    #[inline]
    pub fn push(&mut self, row: [f64; MAX_STATE], right: [f64; RIGHT]) {
        self.rows[self.count] = row;
        self.right[self.count] = right;
        self.count += 1;
    }

    /// Solves by elimination with row exchanges: the solutions in place of the right-hand sides. None if it is
    /// singular.
    #[inline]
    pub fn solve(mut self) -> Option<[[f64; RIGHT]; MAX_WHEELS]> {
        let n = self.count;
        for k in 0..n {
            let largest = (k..n).max_by(|&a, &b| self.rows[a][k].abs().total_cmp(&self.rows[b][k].abs()))?;
            self.rows.swap(k, largest);
            self.right.swap(k, largest);
            let pivot = self.rows[k][k];
            if pivot.abs() < 1e-10 || !pivot.is_finite() {
                return None;
            }
            let (above, below) = self.rows.split_at_mut(k + 1);
            let (right_above, right_below) = self.right.split_at_mut(k + 1);
            for (row, right) in below.iter_mut().zip(right_below).take(n - k - 1) {
                let factor = row[k] / pivot;
                for (x, y) in row.iter_mut().zip(&above[k]).take(n).skip(k) {
                    *x -= factor * y;
                }
                for (x, y) in right.iter_mut().zip(&right_above[k]) {
                    *x -= factor * y;
                }
            }
        }
        for k in (0..n).rev() {
            for c in 0..RIGHT {
                let known: f64 = (k + 1..n).map(|j| self.rows[k][j] * self.right[j][c]).sum();
                self.right[k][c] = (self.right[k][c] - known) / self.rows[k][k];
            }
        }
        Some(self.right)
    }
}

/// The columns of the state that may move, in their order.
pub(crate) fn free_columns(count: usize, hold: &ActiveSet) -> impl Iterator<Item = usize> {
    let joints = hold.joints;
    (0..count).filter(move |&k| k < 3 || joints[k - 3].is_none())
}

/// A state, and the largest gap of the wheels that touch there [m].
struct Trial {
    state: State,
    worst: f64,
}

/// A chain that stands, or the best that an attempt came to.
pub struct NewtonResult<'a> {
    pub state: State,
    pub touches: WheelContacts<'a>,
    pub closed: bool,
}

impl<'a> Settler<'a> {
    /// Largest gap of the wheels that touch [m]; infinite where one has no known ground.
    fn worst(&self, touches: &WheelContacts<'_>, hold: &ActiveSet) -> f64 {
        let wheels = (0..self.chain.wheels().len()).filter(|&wheel| hold.touches(wheel));
        wheels.fold(0.0, |worst: f64, wheel| {
            let gap = touches.wheels[wheel].gap.abs();
            if gap.is_nan() { f64::INFINITY } else { worst.max(gap) }
        })
    }

    /// Gap that counts as none [m].
    fn tolerance(&self, state: &State) -> f64 {
        CLOSED_GAP[0] + CLOSED_GAP[1] * state[0].abs()
    }

    /// The wheels at a state. None where the differential does not reach.
    pub fn touches(
        &self,
        pose: PlanPose,
        state: &State,
        steering: &[f64],
        part: RimSegment,
    ) -> Option<WheelContacts<'a>> {
        let mut touches = WheelContacts::nowhere(self.chain);
        self.look(&mut touches, pose, state, steering, part).map(|()| touches)
    }

    /// The same, written over what is there.
    fn look(
        &self,
        touches: &mut WheelContacts<'a>,
        pose: PlanPose,
        state: &State,
        steering: &[f64],
        part: RimSegment,
    ) -> Option<()> {
        let (ground, chain) = (self.ground, self.chain);
        touches.put(ground, chain, pose, state, steering, part, self.level)
    }

    /// Closes the gaps from a start. None where the differential does not reach.
    pub fn close(&self, pose: PlanPose, steering: &[f64], start: State, hold: &ActiveSet) -> Option<NewtonResult<'a>> {
        let (mut part, mut stalls) = (RimSegment::Lower, 0);
        let mut state = start;
        for (angle, held) in state[3..].iter_mut().zip(hold.joints) {
            *angle = held.unwrap_or(*angle);
        }
        // Where the chain is, the best trial, and where it is tried: written over, and never moved.
        let room = || WheelContacts::nowhere(self.chain);
        let [first, second, third] = &mut [room(), room(), room()];
        let mut rooms = [first, second, third];
        self.look(rooms[0], pose, &state, steering, part)?;
        let mut worst = self.worst(rooms[0], hold);
        for _ in 0..STEPS {
            let tolerance = self.tolerance(&state);
            if worst <= tolerance {
                // Only the whole rim says that nothing else touches.
                if part == RimSegment::Lower && rooms[0].look_up(self.ground, self.chain, self.level) {
                    part = RimSegment::Whole;
                    worst = self.worst(rooms[0], hold);
                }
                if worst <= tolerance {
                    return Some(NewtonResult { state, touches: rooms[0].clone(), closed: true });
                }
            }
            let step = worst.is_finite().then(|| self.step(rooms[0], hold)).flatten();
            let Some(step) = step else {
                break;
            };
            let here = Trial { state, worst };
            let Some(trial) = self.line_search((pose, steering, part), hold, &here, &step, &mut rooms)? else {
                break;
            };
            if trial.worst >= worst {
                if worst < 1e-10 {
                    // Rounding: there is nothing left to close.
                    return self.accept(pose, steering, state, hold);
                }
                stalls += 1;
                if stalls > STALLS {
                    break;
                }
            }
            (state, worst) = (trial.state, trial.worst);
            rooms.swap(0, 1);
        }
        Some(NewtonResult { state, touches: rooms[0].clone(), closed: false })
    }

    /// The best of a step and its halves, up to the first that closes the gaps enough; its wheels are in the second of `rooms`.
    /// None outside where the differential does not reach, None inside where every trial is at angles at which nothing stands.
    fn line_search(
        &self,
        (pose, steering, part): (PlanPose, &[f64], RimSegment),
        hold: &ActiveSet,
        here: &Trial,
        step: &State,
        rooms: &mut [&mut WheelContacts<'a>; 3],
    ) -> Option<Option<Trial>> {
        let (mut found, mut share): (Option<Trial>, f64) = (None, 1.0);
        while share > 0.01 {
            let state: State = std::array::from_fn(|k| here.state[k] + share * step[k]);
            if state[1..].iter().all(|angle| angle.abs() < LARGEST_ANGLE) {
                self.look(rooms[2], pose, &state, steering, part)?;
                let worst = self.worst(rooms[2], hold);
                if found.as_ref().is_none_or(|found| worst < found.worst) {
                    found = Some(Trial { state, worst });
                    rooms.swap(1, 2);
                }
                if worst < here.worst * (1.0 - 0.3 * share) || worst <= self.tolerance(&here.state) {
                    break;
                }
            }
            share *= 0.5;
        }
        Some(found)
    }

    /// A state whose gaps are as small as rounding lets them be, looked at once more all along the rims.
    fn accept(&self, pose: PlanPose, steering: &[f64], state: State, hold: &ActiveSet) -> Option<NewtonResult<'a>> {
        let touches = self.touches(pose, &state, steering, RimSegment::Whole)?;
        let closed = self.worst(&touches, hold) < 1e-10;
        Some(NewtonResult { state, touches, closed })
    }

    /// Newton's step, no longer than [`LARGEST_TURN`].
    fn step(&self, touches: &WheelContacts<'_>, hold: &ActiveSet) -> Option<State> {
        let count = self.chain.state_count();
        let mut system = NewtonSystem::<1>::empty();
        for wheel in (0..self.chain.wheels().len()).filter(|&wheel| hold.touches(wheel)) {
            let (_, slopes) = touches.slopes(wheel);
            let mut row = [0.0; MAX_STATE];
            for (target, k) in row.iter_mut().zip(free_columns(count, hold)) {
                *target = slopes[k];
            }
            system.push(row, [-touches.wheels[wheel].gap]);
        }
        let solution = system.solve()?;
        let mut step = [0.0; MAX_STATE];
        for (value, k) in solution.iter().zip(free_columns(count, hold)) {
            step[k] = value[0];
        }
        let turn = step[1..].iter().fold(0.0, |most: f64, turn| most.max(turn.abs()));
        if turn > LARGEST_TURN {
            step = step.map(|value| value * (LARGEST_TURN / turn));
        }
        Some(step)
    }

    /// A state to start from: every wheel's centre one radius above the ground below it.
    pub(crate) fn initial_state(
        &self,
        pose: PlanPose,
        steering: &[f64],
        mut state: State,
        hold: &ActiveSet,
    ) -> Option<State> {
        let count = self.chain.state_count();
        for (angle, held) in state[3..].iter_mut().zip(hold.joints) {
            *angle = held.unwrap_or(*angle);
        }
        let mut placed = self.chain.nowhere();
        for round in 0..3 {
            placed.put(pose, &state, steering)?;
            let mut system = NewtonSystem::<1>::empty();
            let (mut missing, mut mean) = (0.0, 0.0);
            for wheel in (0..self.chain.wheels().len()).filter(|&wheel| hold.touches(wheel)) {
                let (centre, radius) = (placed.wheel(wheel).centre, self.chain.wheels()[wheel].radius);
                let sample = self.ground.sample_offset(centre.x, centre.y, Interpolation::Bilinear);
                let Sample::Known { height, .. } = sample else {
                    missing += 1.0;
                    continue;
                };
                mean += height + radius - centre.z;
                let slopes = placed.point_slopes(wheel, centre);
                let mut row = [0.0; MAX_STATE];
                for (target, k) in row.iter_mut().zip(free_columns(count, hold)) {
                    *target = slopes[3 + k].z;
                }
                system.push(row, [height + radius - centre.z]);
            }
            if missing > 0.0 || round == 0 {
                // The height first; and nothing else where some ground is not known.
                state[0] += mean / (system.count as f64).max(1.0);
                if missing > 0.0 {
                    return Some(state);
                }
                continue;
            }
            let Some(solution) = system.solve() else {
                return Some(state);
            };
            for (value, k) in solution.iter().zip(free_columns(count, hold)) {
                let limit = if k == 0 { f64::INFINITY } else { 0.4 };
                state[k] += value[0].clamp(-limit, limit);
                if k > 0 {
                    state[k] = state[k].clamp(-0.8, 0.8);
                }
            }
        }
        Some(state)
    }
}
