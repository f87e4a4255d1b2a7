//! Poses along logs of twists, a register of steps at a time.
//!
//! Inside a register the steps are summed plainly, from zero; from register to register in compensated sums,
//! with the heading kept within half a turn. Rounding therefore grows with the length of a few steps, not
//! with that of the log.

use super::lanes::Lanes;
use super::level::{Kernel, Level};
use super::polynomials::{sin_cos, sinc_of_square};
use super::vector::Vector;
use super::weave::{BLOCK, Column};
use crate::geometry::{Steps, Sum, Walk, integrate_log};

/// Half of a step's turn up to which the chord is a polynomial [rad].
const LARGEST_HALF_TURN: f64 = std::f64::consts::FRAC_PI_4;

/// Half a turn and what rounding adds: a heading beyond it has turned so far in one step that it has no digits.
const LARGEST_HEADING: f64 = 4.0;

/// Way and turn of a log that are surely finite.
const LARGEST_TOTAL: f64 = 1e300;

/// Whether the poses of a log surely stay finite; its durations have been checked.
pub(crate) fn stays_finite(
    level: Level,
    twists: &[[f64; 3]],
    steps: Steps<'_>,
    start: [f64; 3],
) -> bool {
    let longest = match steps {
        Steps::Constant(dt) => dt,
        Steps::Each(dts) => dts.iter().fold(0.0, |a: f64, b| a.max(*b)),
    };
    let bound = start.iter().map(|value| value.abs()).sum::<f64>();
    let sum = level.run(SumOfSizes(twists.as_flattened()));
    // False where the sum is NaN.
    sum.is_some_and(|sum| bound + sum * longest * 2.0 <= LARGEST_TOTAL)
}

struct SumOfSizes<'a>(&'a [f64]);

impl Kernel for SumOfSizes<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> f64 {
        let (registers, rest) = S::as_simd_f64s(self.0);
        let mut sums = [Lanes::splat(simd, 0.0); 4];
        let (quads, singles) = registers.as_chunks::<4>();
        for quad in quads {
            for (j, sum) in sums.iter_mut().enumerate() {
                *sum = *sum + Lanes::load(simd, quad, j).abs();
            }
        }
        for k in 0..singles.len() {
            sums[0] = sums[0] + Lanes::load(simd, singles, k).abs();
        }
        let sum = (sums[0] + sums[1]) + (sums[2] + sums[3]);
        sum.total() + rest.iter().map(|value| value.abs()).sum::<f64>()
    }
}

/// Poses of a log that has been checked: its start, and one after every step.
pub(crate) fn log(
    level: Level,
    twists: &[[f64; 3]],
    steps: Steps<'_>,
    start: [f64; 3],
    poses: &mut [[f64; 3]],
) {
    if level == Level::Plain {
        return integrate_log(twists, steps, start, poses);
    }
    level.run(Integrate {
        twists,
        steps,
        start,
        poses,
    });
}

struct Integrate<'a> {
    twists: &'a [[f64; 3]],
    steps: Steps<'a>,
    start: [f64; 3],
    poses: &'a mut [[f64; 3]],
}

impl Kernel for Integrate<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) {
        let Some((first, poses)) = self.poses.split_first_mut() else {
            return;
        };
        *first = self.start;
        let mut walk = Walk::new(self.start);
        let mut block = Block::new();
        let blocks = self.twists.chunks(BLOCK).zip(poses.chunks_mut(BLOCK));
        for (k, (twists, poses)) in blocks.enumerate() {
            let first = k * BLOCK;
            let steps = match self.steps {
                Steps::Constant(dt) => Steps::Constant(dt),
                Steps::Each(dts) => Steps::Each(&dts[first..first + twists.len()]),
            };
            let before = walk;
            let mut done = twists.len() - twists.len() % S::F64_LANES;
            if block.turn(simd, &twists[..done], steps, &mut walk) {
                block.shift(simd, done);
                block.place(simd, &mut poses[..done], &mut walk);
            } else {
                walk = before;
                done = 0;
            }
            for (k, (twist, pose)) in twists.iter().zip(poses).enumerate().skip(done) {
                *pose = walk.step(*twist, steps.get(k));
            }
        }
    }
}

/// What is known of a block of steps on the way to its poses. Three short loops instead of a long one: the
/// processor then works on many registers of steps at once.
struct Block {
    /// Way ahead and to the left at constant heading [m].
    way: [Column; 2],
    /// Half of the turn [rad].
    half: Column,
    /// Heading along the chord [rad].
    heading: Column,
    /// Yaw after the step, with all turns [rad].
    yaw: Column,
    /// Chord in world axes [m].
    shift: [Column; 2],
}

impl Block {
    fn new() -> Self {
        let zero = Column::ZERO;
        Self {
            way: [zero; 2],
            half: zero,
            heading: zero,
            yaw: zero,
            shift: [zero; 2],
        }
    }

    /// Turns step by step. False where one turns too far for the polynomials; `walk` is then of no use.
    #[inline(always)]
    fn turn<S: Vector>(
        &mut self,
        simd: S,
        twists: &[[f64; 3]],
        steps: Steps<'_>,
        walk: &mut Walk,
    ) -> bool {
        if walk.heading.sum.abs() > LARGEST_HEADING {
            return false;
        }
        let largest = Lanes::splat(simd, LARGEST_HALF_TURN);
        let mut near = largest.at_most(largest);
        let groups = S::as_simd_f64s(twists.as_flattened()).0.as_chunks::<3>().0;
        for (k, group) in groups.iter().enumerate() {
            let dt = match steps {
                Steps::Constant(dt) => Lanes::splat(simd, dt),
                Steps::Each(dts) => Lanes::load(simd, S::as_simd_f64s(dts).0, k),
            };
            let twists = simd.unbraid(*group);
            for (j, way) in self.way.iter_mut().enumerate() {
                (Lanes::load(simd, &twists, j) * dt).store(registers::<S>(way), k);
            }
            let turn = Lanes::load(simd, &twists, 2) * dt;
            let half = turn * Lanes::splat(simd, 0.5);
            near = near & half.abs().at_most(largest);
            half.store(registers::<S>(&mut self.half), k);
            let turned = running_sum(simd, turn);
            // Along the chord, which leaves at half the turn.
            let since = Lanes::shift::<0>(simd, turned) + half;
            beyond(simd, &walk.heading, since).store(registers::<S>(&mut self.heading), k);
            beyond(simd, &walk.yaw, turned).store(registers::<S>(&mut self.yaw), k);
            walk.turn(turned.last(simd));
        }
        !(!near).any()
    }

    /// Chords of the steps in world axes.
    #[inline(always)]
    fn shift<S: Vector>(&mut self, simd: S, steps: usize) {
        for k in 0..steps / S::F64_LANES {
            let [ahead, left] = &self.way;
            let (ahead, left) = (load(simd, ahead, k), load(simd, left, k));
            let (half, heading) = (load(simd, &self.half, k), load(simd, &self.heading, k));
            let (sin, cos) = sin_cos(simd, heading);
            let length = sinc_of_square(simd, half * half);
            let (ahead, left) = (ahead * length, left * length);
            let [x, y] = &mut self.shift;
            (cos * ahead - sin * left).store(registers::<S>(x), k);
            sin.mul_add(ahead, cos * left).store(registers::<S>(y), k);
        }
    }

    /// The poses.
    #[inline(always)]
    fn place<S: Vector>(&self, simd: S, poses: &mut [[f64; 3]], walk: &mut Walk) {
        let groups = S::as_mut_simd_f64s(poses.as_flattened_mut()).0;
        for (k, group) in groups.as_chunks_mut::<3>().0.iter_mut().enumerate() {
            let [x, y] = &self.shift;
            let x = running_sum(simd, load(simd, x, k));
            let y = running_sum(simd, load(simd, y, k));
            let yaw = load(simd, &self.yaw, k);
            let (east, north) = (beyond(simd, &walk.x, x), beyond(simd, &walk.y, y));
            *group = simd.braid([
                east.into_register(),
                north.into_register(),
                yaw.into_register(),
            ]);
            walk.shift(x.last(simd), y.last(simd));
        }
    }
}

#[inline(always)]
fn load<S: Vector>(simd: S, column: &Column, k: usize) -> Lanes<S> {
    Lanes::load(simd, S::as_simd_f64s(&column.0).0, k)
}

#[inline(always)]
fn registers<S: Vector>(column: &mut Column) -> &mut [S::f64s] {
    S::as_mut_simd_f64s(&mut column.0).0
}

/// So much more than a sum.
#[inline(always)]
fn beyond<S: Vector>(simd: S, sum: &Sum, more: Lanes<S>) -> Lanes<S> {
    Lanes::splat(simd, sum.sum) + (Lanes::splat(simd, sum.lost) + more)
}

/// Every lane plus all before it.
#[inline(always)]
fn running_sum<S: Vector>(simd: S, terms: Lanes<S>) -> Lanes<S> {
    let mut sum = terms + Lanes::shift::<0>(simd, terms);
    if S::F64_LANES > 2 {
        sum = sum + Lanes::shift::<1>(simd, sum);
    }
    if S::F64_LANES > 4 {
        sum = sum + Lanes::shift::<2>(simd, sum);
    }
    sum
}
