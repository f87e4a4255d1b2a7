//! Poses along logs, one log after the other: a register holds successive steps, and poses are prefix sums over its
//! lanes.

use std::f64::consts::PI;

use super::logs::Logs;
use super::tile::LANES;
use crate::geometry::Steps;
use crate::se2::accumulate::{PoseAccumulator, Sum};
use crate::se2::angles::reduce_lanes;
use crate::se2::maps::{LARGEST_HALF_TURN, chord_ratio};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::level::{Kernel, Level};
use six_wheel_numerics::simd::polynomials::{direction, sinc_of_square};
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::stream::{Output, prefetch_ahead};

/// Registers of steps in lockstep, which hide the latency of prefix sums.
const ABREAST: usize = 4;

/// Sums of magnitudes up to this are finite in every order of summation.
pub(crate) const LARGEST_TOTAL: f64 = 1e300;

/// Integrates further steps of a log that has been checked; writes the pose after every step.
pub(crate) fn integrate_steps(
    level: Level,
    twists: &[[f64; 3]],
    steps: Steps<'_>,
    poses: &mut [[f64; 3]],
    non_temporal: bool,
    accumulator: &mut PoseAccumulator,
) {
    level.run_any(PoseIntegrator { twists, steps, poses, non_temporal, accumulator });
}

struct PoseIntegrator<'a> {
    twists: &'a [[f64; 3]],
    steps: Steps<'a>,
    poses: &'a mut [[f64; 3]],
    non_temporal: bool,
    accumulator: &'a mut PoseAccumulator,
}

impl Kernel for PoseIntegrator<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) {
        let room = 3 * ABREAST * S::F64_LANES;
        let mut output = Output::new(simd, self.poses.as_flattened_mut(), room, self.non_temporal);
        along(simd, self.twists, self.steps, &mut output, self.accumulator);
    }
}

/// Integrates whole logs that have been checked: writes their starts, and one pose after every step.
pub(crate) fn integrate_logs(level: Level, logs: Logs<'_>, poses: &mut [[f64; 3]], non_temporal: bool) {
    level.run_any(IntegrateLogs { logs, poses, non_temporal });
}

/// The kernel of poses along whole logs, one log after the other.
pub struct IntegrateLogs<'a> {
    /// Logs that have been checked.
    pub logs: Logs<'a>,
    /// Their starts, and one pose after every step.
    pub poses: &'a mut [[f64; 3]],
    /// True where poses are written past the caches.
    pub non_temporal: bool,
}

impl Kernel for IntegrateLogs<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) {
        let Logs { count, steps, starts, .. } = self.logs;
        let room = 3 * ABREAST * S::F64_LANES;
        let logs = self.poses.len() / (count + 1);
        let mut output = Output::new(simd, self.poses.as_flattened_mut(), room, self.non_temporal);
        let mut accumulator = PoseAccumulator::new(starts[0]);
        let first = accumulator;
        for log in 0..logs {
            let start = match starts {
                [one] => *one,
                starts => starts[log],
            };
            accumulator = if start == starts[0] { first } else { PoseAccumulator::new(start) };
            output.next(3).copy_from_slice(&start);
            let twists = &self.logs.twists[log * count..(log + 1) * count];
            along(simd, twists, steps, &mut output, &mut accumulator);
        }
    }
}

/// All steps of a log, or of a piece of one.
#[inline(always)]
fn along<S: Vector>(
    simd: S,
    twists: &[[f64; 3]],
    steps: Steps<'_>,
    output: &mut Output<'_, S>,
    accumulator: &mut PoseAccumulator,
) {
    let (many, few) = (ABREAST * S::F64_LANES, S::F64_LANES);
    let mut first = 0;
    while first < twists.len() {
        let left = twists.len() - first;
        let size = if left >= many { many } else { few.min(left) };
        let twists = &twists[first..first + size];
        let steps = steps.of(first..first + size);
        let poses = output.next(3 * size);
        if size == many {
            prefetch_ahead(simd, twists.as_flattened(), 0, 1);
            step_lanes::<S, ABREAST>(simd, twists.as_flattened(), steps, poses, accumulator);
        } else if size == few {
            step_lanes::<S, 1>(simd, twists.as_flattened(), steps, poses, accumulator);
        } else {
            // The last steps, padded with steps without motion.
            let mut padded = [[0.0; 3]; LANES];
            let mut dts = [0.0; LANES];
            padded[..size].copy_from_slice(twists);
            for (k, dt) in dts.iter_mut().enumerate().take(size) {
                *dt = steps.get(k);
            }
            let mut placed = [0.0; 3 * LANES];
            step_lanes::<S, 1>(simd, padded.as_flattened(), Steps::Each(&dts), &mut placed, accumulator);
            poses.copy_from_slice(&placed[..3 * size]);
        }
        first += size;
    }
}

/// `N` registers of steps.
#[inline(always)]
fn step_lanes<S: Vector, const N: usize>(
    simd: S,
    twists: &[f64],
    steps: Steps<'_>,
    poses: &mut [f64],
    accumulator: &mut PoseAccumulator,
) {
    if !try_step_lanes::<S, N, false>(simd, twists, steps, poses, accumulator) {
        try_step_lanes::<S, N, true>(simd, twists, steps, poses, accumulator);
    }
}

/// `N` registers of steps, all of which turn by at most twice [`LARGEST_HALF_TURN`], or by any angle (`FAR`). Returns
/// false, with `accumulator` unchanged, if a step turns farther.
///
/// Sums of the registers of a call are plain, those over calls compensated: rounding grows with the length of a few
/// steps, not with that of the log.
#[inline(always)]
fn try_step_lanes<S: Vector, const N: usize, const FAR: bool>(
    simd: S,
    twists: &[f64],
    steps: Steps<'_>,
    poses: &mut [f64],
    accumulator: &mut PoseAccumulator,
) -> bool {
    let width = 3 * S::F64_LANES;
    let zero = Lanes::splat(simd, 0.0);
    let largest = Lanes::splat(simd, LARGEST_HALF_TURN);
    let mut near = Mask::splat(simd, true);
    let [mut ahead, mut left, mut turns, mut halves] = [[zero; N]; 4];
    let [mut headings, mut squares] = [Lanes::<S, f64, N>::constant(simd, 0.0); 2];
    let heading = Sums::splat(simd, &accumulator.heading);
    // Sums of the yaw increments, and of these reduced to half a turn to either side.
    let [mut turned, mut rotated] = [zero; 2];
    for m in 0..N {
        let [vx, vy, omega] = Lanes::deinterleave3(simd, &twists[width * m..]);
        let dt = match steps {
            Steps::Constant(dt) => Lanes::splat(simd, dt),
            Steps::Each(dts) => Lanes::load(simd, S::as_simd_f64s(dts).0, m),
        };
        (ahead[m], left[m]) = (vx * dt, vy * dt);
        let turn = omega * dt;
        let half = turn * Lanes::splat(simd, 0.5);
        near = near & half.abs().le(largest);
        halves[m] = half;
        squares.set_register(m, half * half);
        let upto = prefix_sums(simd, turn);
        turns[m] = turned + upto;
        // The direction of the chord is the heading at half the yaw increment.
        if FAR {
            let (turn, half) = (reduce_lanes(simd, turn, PI), reduce_lanes(simd, half, PI));
            let upto = prefix_sums(simd, turn);
            headings.set_register(m, heading.plus((rotated + upto) - (turn - half)));
            rotated = rotated + upto.broadcast_last(simd);
        } else {
            headings.set_register(m, heading.plus(turns[m] - half));
        }
        turned = turned + upto.broadcast_last(simd);
    }
    if !FAR && (!near).any() {
        return false;
    }
    let (sin, cos) = direction(simd, headings);
    let mut length = squares;
    if FAR {
        for (m, half) in halves.into_iter().enumerate() {
            length.set_register(m, chord_ratio(simd, half));
        }
    } else {
        length = sinc_of_square(simd, squares);
        rotated = turned;
    }
    let [x, y, yaw] = [&accumulator.x, &accumulator.y, &accumulator.yaw].map(|sum| Sums::splat(simd, sum));
    let [mut east, mut north] = [zero; 2];
    for m in 0..N {
        let (sin, cos, length) = (sin.register(m), cos.register(m), length.register(m));
        let (ahead, left) = (ahead[m] * length, left[m] * length);
        let easts = prefix_sums(simd, cos * ahead - sin * left);
        let norths = prefix_sums(simd, sin.mul_add(ahead, cos * left));
        let pose = [x.plus(east + easts), y.plus(north + norths), yaw.plus(turns[m])];
        Lanes::interleave3(pose, &mut poses[width * m..]);
        east = east + easts.broadcast_last(simd);
        north = north + norths.broadcast_last(simd);
    }
    accumulator.turn_by(turned.last(simd), rotated.last(simd));
    accumulator.shift(east.last(simd), north.last(simd));
    true
}

/// Compensated sums, one per lane.
#[derive(Clone, Copy)]
struct Sums<S: Vector> {
    sum: Lanes<S>,
    lost: Lanes<S>,
}

#[inline_always]
impl<S: Vector> Sums<S> {
    /// The same in every lane.
    fn splat(simd: S, sum: &Sum) -> Self {
        Self { sum: Lanes::splat(simd, sum.sum), lost: Lanes::splat(simd, sum.lost) }
    }

    /// The sum plus `more`.
    fn plus(&self, more: Lanes<S>) -> Lanes<S> {
        self.sum + (self.lost + more)
    }
}

/// Prefix sums over the lanes: each lane plus all lanes before it.
#[inline(always)]
fn prefix_sums<S: Vector>(simd: S, terms: Lanes<S>) -> Lanes<S> {
    let mut sum = terms + Lanes::shift::<0>(simd, terms);
    if S::F64_LANES > 2 {
        sum = sum + Lanes::shift::<1>(simd, sum);
    }
    if S::F64_LANES > 4 {
        sum = sum + Lanes::shift::<2>(simd, sum);
    }
    sum
}
