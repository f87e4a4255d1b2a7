//! Many poses at once: a pose in every lane, those that have settled replaced by others.
//!
//! Rounds of Newton's method look at whole rims where the gaps are large, and otherwise only at what is near the
//! last contacts. A pose counts as settled when every gap is closed and a look at whole rims has found nothing else
//! so near that the way from there could have closed it. Whatever is not as plain as that (unknown ground, the end
//! of the map, a joint past its stop, a wall as high as a wheel, no end of rounds) is for [`Settler`] alone.

use super::look::{Extent, Here, MARGIN, MOST, RimScan, UPPER};
use super::plan::{ChainConstants, Placing, Rows, solve};
use super::settler::{Settler, Status};
use super::stand::{Contact, Stand};
use crate::ground::rims::circles::{FAR, cells, floor, spread};
use crate::ground::rims::search::TIE;
use crate::suspension::{MAX_FREE, MAX_STATE, MAX_WHEELS, State};
use six_wheel_kinematics::wheels::Direction;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::level::Kernel;
use six_wheel_numerics::simd::vector::Vector;

/// Poses that are worked on together: their numbers stay in the second-level cache.
const CHUNK: usize = 512;

/// Rounds after which a pose is left to the plain way.
const ROUNDS: u8 = 24;

/// Largest turn of a step, and largest angle on the way [rad].
const LARGEST_TURN: f64 = 0.25;
const LARGEST_ANGLE: f64 = 1.3;

/// Gap below which whole rims are looked at once more [m].
const NEARLY: f64 = 2e-6;

/// Turn of a step above which they are [rad].
const FAR_AWAY: f64 = 0.06;

/// A way shorter than this share of [`MARGIN`] brings nothing else to the ground, on slopes up to 9.
const SHORT: f64 = 0.1;

/// Shorter arms than this have the points of a rim [m]: from a turn to a way.
const ARM: f64 = 3.0;

/// Nearest and farthest that a short look goes beyond the last contact [rad].
const LOOK: [f64; 2] = [0.02, 0.3];

/// State of the solution for a pose.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Phase {
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
const LOOKS: [Phase; 4] = [Phase::Far, Phase::Whole, Phase::Short, Phase::Both];

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
struct Chunk {
    columns: [[f64; CHUNK]; column::COUNT],
    rounds: [u8; CHUNK],
    phases: [Phase; CHUNK],
}

/// A row for the plain way, and where its gaps are closed if nothing else touches there.
pub(crate) type Left = (usize, Option<State>);

/// Settles poses of finite numbers, with or without steering angles; rows that are left have nothing written. None if the
/// chain or the level are not for lanes.
pub(crate) fn settle(
    settler: &Settler<'_>,
    poses: &[[f64; 3]],
    steering: &dyn Fn(usize) -> [f64; MAX_WHEELS],
    steered: bool,
    stands: &mut [Stand],
    left: &mut Vec<Left>,
) -> Option<()> {
    let plan = ChainConstants::new(settler.chain, steered)?;
    let job = SettleRange { settler, plan: &plan, poses, steering, steered, stands, left };
    settler.level.run(job)
}

struct SettleRange<'a, 'b> {
    settler: &'a Settler<'b>,
    plan: &'a ChainConstants,
    poses: &'a [[f64; 3]],
    steering: &'a dyn Fn(usize) -> [f64; MAX_WHEELS],
    steered: bool,
    stands: &'a mut [Stand],
    /// Rows for the plain way.
    left: &'a mut Vec<Left>,
}

impl Kernel for SettleRange<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(mut self, simd: S) {
        let mut chunk = Box::new(Chunk {
            columns: [[0.0; CHUNK]; column::COUNT],
            rounds: [0; CHUNK],
            phases: [Phase::Whole; CHUNK],
        });
        for first in (0..self.poses.len()).step_by(CHUNK) {
            let count = CHUNK.min(self.poses.len() - first);
            self.begin(&mut chunk, first, count);
            // By what their next look is.
            let [mut next, mut now]: [[Vec<u16>; 4]; 2] =
                std::array::from_fn(|_| std::array::from_fn(|_| Vec::with_capacity(count)));
            next[0].extend(0..count as u16);
            for rows in next[0].chunks(S::F64_LANES) {
                self.guess(simd, &mut chunk, rows);
            }
            while next.iter().any(|rows| !rows.is_empty()) {
                std::mem::swap(&mut next, &mut now);
                for (list, phase) in LOOKS.iter().enumerate() {
                    next[list].clear();
                    for rows in now[list].chunks(S::F64_LANES) {
                        self.round(simd, &mut chunk, first, rows, *phase);
                    }
                }
                for &row in now.iter().flatten() {
                    let list = match chunk.phases[row as usize] {
                        Phase::Far => 0,
                        Phase::Whole => 1,
                        Phase::Sure | Phase::Short => 2,
                        Phase::Both => 3,
                    };
                    if chunk.rounds[row as usize] < ROUNDS {
                        next[list].push(row);
                    } else if chunk.rounds[row as usize] < LEFT {
                        self.left.push((first + row as usize, None));
                    }
                }
            }
        }
    }
}

/// Number of rounds of a pose whose gaps are closed: nothing else touches, or that is not sure.
const DONE: u8 = u8::MAX;
const LEFT: u8 = DONE - 1;

/// A number of so many rows.
#[inline(always)]
fn gather<S: Vector>(simd: S, column: &[f64; CHUNK], rows: &[u16]) -> Lanes<S> {
    let mut values = [0.0; MOST];
    for lane in 0..S::F64_LANES {
        values[lane] = column[rows[lane.min(rows.len() - 1)] as usize % CHUNK];
    }
    Lanes::load(simd, S::as_simd_f64s(&values).0, 0)
}

#[inline(always)]
fn truths<S: Vector>(simd: S, mask: Mask<S>) -> [f64; MOST] {
    spread(mask.select(Lanes::splat(simd, 1.0), Lanes::splat(simd, 0.0)))
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
    fn begin(&self, chunk: &mut Chunk, first: usize, count: usize) {
        let ground = self.settler.ground;
        let turn = ground.turn();
        for row in 0..count {
            let [x, y, yaw] = self.poses[first + row];
            let [x0, y0] = ground.origin();
            let place = ground.grid_axes([x - x0, y - y0]);
            let (sin, cos) = yaw.sin_cos();
            let heading = [sin * turn.cos - cos * turn.sin, cos * turn.cos + sin * turn.sin];
            let numbers = [place[0], place[1], heading[0], heading[1], FAR, 1.0, LOOK[1]];
            for (column, number) in chunk.columns.iter_mut().zip(numbers) {
                column[row] = number;
            }
            if self.steered {
                for (joint, angle) in (self.steering)(first + row).into_iter().enumerate() {
                    let (sin, cos) = angle.sin_cos();
                    chunk.columns[column::STEERING + 2 * joint][row] = sin;
                    chunk.columns[column::STEERING + 2 * joint + 1][row] = cos;
                }
            }
        }
        chunk.columns[column::STATE..column::CONTACT].as_flattened_mut().fill(0.0);
        for wheel in 0..MAX_WHEELS {
            chunk.columns[column::CONTACT + 2 * wheel].fill(0.0);
            chunk.columns[column::CONTACT + 2 * wheel + 1].fill(1.0);
        }
        chunk.rounds.fill(0);
        chunk.phases.fill(Phase::Far);
    }

    #[inline(always)]
    fn here<S: Vector>(&self, simd: S, chunk: &Chunk, rows: &[u16]) -> Here<S> {
        let columns = &chunk.columns;
        let zero = Lanes::splat(simd, 0.0);
        let mut here = Here {
            origin: [gather(simd, &columns[column::X], rows), gather(simd, &columns[column::Y], rows)],
            yaw: (gather(simd, &columns[column::SIN], rows), gather(simd, &columns[column::COS], rows)),
            state: [zero; MAX_STATE],
            steering: [(zero, zero); MAX_WHEELS],
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
            for (k, turned) in here.steering.iter_mut().enumerate() {
                *turned = (
                    gather(simd, &columns[column::STEERING + 2 * k], rows),
                    gather(simd, &columns[column::STEERING + 2 * k + 1], rows),
                );
            }
        }
        here
    }

    /// A state to start from: every wheel's centre one radius above the ground below it.
    #[inline(always)]
    fn guess<S: Vector>(&self, simd: S, chunk: &mut Chunk, rows: &[u16]) {
        let (plan, ground) = (self.plan, self.settler.ground);
        let zero = Lanes::splat(simd, 0.0);
        let mut here = self.here(simd, chunk, rows);
        let spacing = ground.spacing();
        for _ in 0..2 {
            let placing = Placing::new(simd, plan, here.yaw, &here.state, &here.steering);
            let mut system: Rows<S> = [([zero; MAX_STATE], zero); MAX_WHEELS];
            for (wheel, row) in system.iter_mut().enumerate().take(plan.wheels()) {
                let centre = placing.wheels[wheel].centre;
                let u = (here.origin[0] + centre[0]) * Lanes::splat(simd, 1.0 / spacing[0]);
                let v = (here.origin[1] + centre[1]) * Lanes::splat(simd, 1.0 / spacing[1]);
                let corner = [floor(simd, u), floor(simd, v)];
                let cell = cells(simd, ground, corner[0], corner[1]);
                let (a, b) = (u - corner[0], v - corner[1]);
                let height = cell.h00
                    + cell.along * a
                    + (cell.across + cell.twist * a) * b
                    + Lanes::splat(simd, plan.radius(wheel));
                let missing = height - (here.state[0] + centre[2]);
                *row = (placing.slopes(simd, wheel, centre, [zero; 2]), missing);
            }
            let step = solve(simd, plan, &mut system);
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
                let column = &mut chunk.columns[column::STATE + k];
                column[row as usize] = values[lane];
                if !values[lane].is_finite() {
                    chunk.rounds[row as usize] = ROUNDS;
                }
            }
        }
    }

    /// A round of Newton's method for as many poses as there are lanes, or fewer.
    #[inline(always)]
    fn round<S: Vector>(&mut self, simd: S, chunk: &mut Chunk, first: usize, rows: &[u16], phase: Phase) {
        let here = self.here(simd, chunk, rows);
        let extent = match phase {
            Phase::Far => Extent::Sampled,
            Phase::Whole => Extent::Whole,
            Phase::Both => Extent::Both,
            Phase::Sure | Phase::Short => Extent::Near(gather(simd, &chunk.columns[column::LOOK], rows)),
        };
        let whole = matches!(extent, Extent::Whole | Extent::Both);
        let mut look = here.look(simd, self.plan, self.settler.ground, &extent);
        let step = solve(simd, self.plan, &mut look.rows);
        let zero = Lanes::splat(simd, 0.0);
        let mut turn = step[1].abs();
        for number in &step[2..] {
            turn = turn.max(number.abs());
        }
        let (before, mut share) =
            (gather(simd, &chunk.columns[column::WORST], rows), gather(simd, &chunk.columns[column::SHARE], rows));
        let (half, double) = (Lanes::splat(simd, 0.5), Lanes::splat(simd, 2.0));
        share = before
            .below(look.worst)
            .select((share * half).max(Lanes::splat(simd, 0.25)), (share * double).min(Lanes::splat(simd, 1.0)));
        let most = Lanes::splat(simd, LARGEST_TURN);
        let scale = share * most.quotient(turn.max(most));
        let way = step[0].abs() + turn * Lanes::splat(simd, ARM);
        let (turn, limit) = (turn * scale, Lanes::splat(simd, LARGEST_ANGLE));
        let mut state = here.state;
        state[0] = scale.mul_add(step[0], state[0]);
        for k in 1..MAX_STATE {
            state[k] = scale.mul_add(step[k], state[k]).min(limit).max(-limit);
        }
        let tolerance = here.state[0].abs().mul_add(Lanes::splat(simd, 2e-15), Lanes::splat(simd, 2e-12));
        let closed = truths(simd, look.worst.at_most(tolerance));
        let touches = truths(simd, look.touches);
        let clear = spread(look.clear);
        // Also false where a number is not.
        let moves = truths(simd, zero.at_most(way) & way.below(Lanes::splat(simd, FAR)));
        let near = truths(simd, way.below(Lanes::splat(simd, SHORT * MARGIN)));
        let (worst, turn, share) = (spread(look.worst), spread(turn), spread(share));
        let (mut goes_on, mut settles) = ([0.0; MOST], false);
        for (lane, &row) in rows.iter().enumerate() {
            let row = row as usize;
            chunk.rounds[row] += 1;
            if touches[lane] == 0.0 || moves[lane] == 0.0 {
                if whole {
                    chunk.rounds[row] = ROUNDS;
                }
                chunk.phases[row] = Phase::Whole;
                continue;
            }
            if closed[lane] != 0.0 {
                if phase == Phase::Whole && clear[lane] == UPPER {
                    chunk.phases[row] = Phase::Both;
                } else if whole && clear[lane] <= TIE {
                    chunk.rounds[row] = LEFT;
                } else if whole || chunk.phases[row] == Phase::Sure {
                    chunk.rounds[row] = DONE;
                } else {
                    chunk.phases[row] = Phase::Whole;
                }
                settles |= chunk.rounds[row] >= LEFT;
                continue;
            }
            goes_on[lane] = 1.0;
            chunk.columns[column::WORST][row] = worst[lane];
            chunk.columns[column::SHARE][row] = share[lane];
            chunk.columns[column::LOOK][row] = (LOOK[0] + 2.0 * turn[lane]).min(LOOK[1]);
            let stays = chunk.phases[row] == Phase::Sure && near[lane] != 0.0;
            let becomes = whole && clear[lane] > MARGIN && near[lane] != 0.0;
            chunk.phases[row] = if stays || becomes {
                Phase::Sure
            } else if turn[lane] > FAR_AWAY {
                Phase::Far
            } else if !whole && worst[lane] < NEARLY {
                Phase::Whole
            } else {
                Phase::Short
            };
        }
        if settles {
            self.settled(simd, chunk, first, rows, &here, &look);
        }
        let goes_on = zero.below(Lanes::load(simd, S::as_simd_f64s(&goes_on).0, 0));
        for (k, number) in state.into_iter().enumerate() {
            let number = goes_on.select(number, here.state[k]);
            scatter(&mut chunk.columns[column::STATE + k], rows, number);
        }
        for wheel in 0..self.plan.wheels() {
            for k in 0..2 {
                let number = goes_on.select(look.found[wheel].at[k], here.contacts[wheel][k]);
                let column = column::CONTACT + 2 * wheel + k;
                scatter(&mut chunk.columns[column], rows, number);
            }
        }
    }

    /// Writes lanes that have just settled; those with a joint past its stop, and those that are not sure, are left.
    #[inline(always)]
    fn settled<S: Vector>(
        &mut self,
        _: S,
        chunk: &Chunk,
        first: usize,
        rows: &[u16],
        here: &Here<S>,
        look: &RimScan<S>,
    ) {
        let mut states = [[0.0; MOST]; MAX_STATE];
        for (numbers, lanes) in states.iter_mut().zip(here.state) {
            *numbers = spread(lanes);
        }
        let mut contacts = [[[0.0; MOST]; 5]; MAX_WHEELS];
        for (numbers, found) in contacts.iter_mut().zip(&look.found) {
            let ([sin, cos], [along, across]) = (found.at, found.slope);
            for (number, lanes) in numbers.iter_mut().zip([found.gap, sin, cos, along, across]) {
                *number = spread(lanes);
            }
        }
        let ground = self.settler.ground;
        let [dx, dy] = ground.spacing();
        for (lane, &row) in rows.iter().enumerate() {
            let rounds = chunk.rounds[row as usize];
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
            for (contact, numbers) in wheels.take(self.plan.wheels()) {
                let [gap, sin, cos, along, across] = numbers.map(|numbers| numbers[lane]);
                *contact = Contact {
                    gap,
                    at: Direction { sin, cos },
                    gradient: ground.world_axes([along / dx, across / dy]),
                    next: f64::NAN,
                };
            }
        }
    }
}
