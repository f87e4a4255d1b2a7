//! One row of the inverse kinematics: the lanes of a register are the wheels, the steered ones first.

use std::array;

use super::constants::{InverseConstants, WheelGroup};
use crate::admissible::cone::AdmissibleCone;
use crate::kernels::safe_range::{MAX_SQUARABLE, MIN_SQUARABLE};
use crate::kernels::steered::direction_votes::{CommonDirection, DirectionTie, DirectionVotes};
use crate::kernels::steered::wheel::{SAFE_OVERSHOOT, WheelQuery};
use crate::kernels::wheel_lanes::{Eight, GROUP, padded};
use crate::rover_data::{Inputs, MAX_WHEELS};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::level::{Kernel, Level};
use six_wheel_numerics::simd::vector::Vector;

/// Groups of the largest rover.
const MAX_GROUPS: usize = MAX_WHEELS / GROUP;

impl InverseConstants {
    /// Steering angles and wheel speeds of one twist. With the admissible twists, nothing is written and the answer is false
    /// unless every input is finite and no wheel slides by more than half of what passes as none.
    #[inline]
    pub(crate) fn solve_row(
        &self,
        level: Level,
        twist: [f64; 3],
        inputs: Inputs<'_>,
        targets: [&mut [f64]; 2],
        cone: Option<&AdmissibleCone>,
    ) -> bool {
        let [vx, vy, omega] = twist;
        let twist = [vx + 0.0, vy, omega]; // no minus zero
        level.run_any(InverseRow { constants: self, twist, inputs, targets, cone })
    }

    /// Bound of the rounding of pivot velocities, twice over [m/s].
    fn rounding(&self, [vx, vy, omega]: [f64; 3]) -> f64 {
        let size = vx.abs() + vy.abs() + omega.abs();
        if (MIN_SQUARABLE..=MAX_SQUARABLE).contains(&size) {
            let [share, arm] = self.rounding;
            (vx.abs() + vy.abs()) * share + omega.abs() * arm
        } else {
            f64::INFINITY
        }
    }
}

struct InverseRow<'a> {
    constants: &'a InverseConstants,
    twist: [f64; 3],
    inputs: Inputs<'a>,
    /// Steering angles and wheel speeds.
    targets: [&'a mut [f64]; 2],
    /// The admissible twists, if these have to be kept to.
    cone: Option<&'a AdmissibleCone>,
}

/// Angles and speeds by lane, and the direction ties of the steered wheels.
struct WheelResults<const N: usize> {
    angles: [Eight; N],
    speeds: [Eight; N],
    /// 1 for a wheel of a tie, 1 for one that rolls backwards on its own, lead.
    ties: [[Eight; N]; 3],
    has_ties: bool,
}

impl Kernel for InverseRow<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> bool {
        // One group is the rule, and stays in registers.
        match self.constants.groups.len() {
            1 => self.solve::<S, 1>(simd),
            _ => self.solve::<S, MAX_GROUPS>(simd),
        }
    }
}

impl InverseRow<'_> {
    #[inline(always)]
    fn solve<S: Vector, const N: usize>(self, simd: S) -> bool {
        let constants = self.constants;
        let mut results = WheelResults::<N> {
            angles: [[0.0; GROUP]; N],
            speeds: [[0.0; GROUP]; N],
            ties: [[[0.0; GROUP]; N]; 3],
            has_ties: false,
        };
        let are_safe = self.all_wheels(simd, &mut results, None);
        if let Some(cone) = self.cone {
            let twist = self.twist.map(|part| Lanes::splat(simd, part));
            let speeds = self.inputs.previous_speeds.unwrap_or_default();
            let is_safe =
                are_safe && cone.banks_roll(simd, twist).any() && speeds.iter().all(|speed| speed.is_finite());
            if !is_safe {
                return false;
            }
        }
        if results.has_ties {
            let common = self.common_direction(simd, &results);
            if common[0].any() {
                self.all_wheels(simd, &mut results, Some(common));
            }
        }
        let [steering, speeds] = self.targets;
        for (target, angle) in steering.iter_mut().zip(results.angles.as_flattened()) {
            *target = *angle;
        }
        for (&i, speed) in constants.order.iter().zip(results.speeds.as_flattened()) {
            if let Some(target) = speeds.get_mut(i) {
                *target = *speed;
            }
        }
        true
    }

    /// Solves all wheels. Returns true if the present angles and the rates are finite, and every steered wheel reaches its angle.
    #[inline(always)]
    fn all_wheels<S: Vector, const N: usize>(
        &self,
        simd: S,
        results: &mut WheelResults<N>,
        common: CommonDirection<S>,
    ) -> bool {
        let splat = |number| Lanes::splat(simd, number);
        let zero = splat(0.0);
        let twist = self.twist.map(splat);
        let rounding = splat(self.constants.rounding(self.twist));
        let mut is_safe = zero.at_most(zero);
        let mut rows =
            [self.inputs.previous, self.inputs.steering_rates].map(|row| row.map(|row| row.chunks(S::F64_LANES)));
        for (g, group) in self.constants.groups.iter().enumerate().take(N) {
            let speeds = S::as_mut_simd_f64s(&mut results.speeds[g]).0;
            let angles = S::as_mut_simd_f64s(&mut results.angles[g]).0;
            for k in 0..GROUP / S::F64_LANES {
                if g * GROUP + k * S::F64_LANES >= self.constants.order.len() {
                    break;
                }
                let mut speed = roll(simd, group, k, twist);
                if k * S::F64_LANES < group.steered {
                    let [previous, rate] =
                        array::from_fn(|j| rows[j].as_mut().map(|row| padded(simd, row.next().unwrap_or_default())));
                    for given in [previous, rate].into_iter().flatten() {
                        is_safe = is_safe & given.abs().at_most(splat(f64::MAX));
                    }
                    let query = WheelQuery { twist, rounding, previous, rate };
                    let wheels = group.load(simd, k);
                    let is_steered = zero.below(load(simd, &group.is_steered, k));
                    let first = wheels.first_solution(simd, &query);
                    let (mut angle, mut rim_speed) = (first.angle, first.rim_speed);
                    if (is_steered & !first.is_final).any() {
                        let motion = wheels.solve(simd, &query, &first, common);
                        (angle, rim_speed) = (motion.angle, motion.rim_speed);
                        is_safe = is_safe & (motion.overshoot.at_most(splat(SAFE_OVERSHOOT)) | !is_steered);
                        let DirectionTie { is_tie, is_backwards, lead } = motion.tie;
                        if common.is_none() && (is_tie & is_steered).any() {
                            results.has_ties = true;
                            let one = splat(1.0);
                            let marks = [is_tie.select(one, zero), is_backwards.select(one, zero), lead];
                            for (mark, ties) in marks.into_iter().zip(&mut results.ties) {
                                mark.store(S::as_mut_simd_f64s(&mut ties[g]).0, k);
                            }
                        }
                    }
                    speed = is_steered.select(rim_speed * load(simd, &group.per_radius, k), speed);
                    angle.store(angles, k);
                }
                speed.store(speeds, k);
            }
            for (lane, castor) in &group.castors {
                let rim_speed = castor.broadcast(simd).castor_rim_speed(simd, twist).last(simd);
                results.speeds[g][*lane] = rim_speed * group.per_radius[*lane];
            }
        }
        !(!is_safe).any()
    }

    /// The common direction of the wheels of a tie, wheel after wheel: rounding is that of a row of a batch.
    #[inline(always)]
    fn common_direction<S: Vector, const N: usize>(&self, simd: S, results: &WheelResults<N>) -> [Mask<S>; 2] {
        let splat = |number| Lanes::splat(simd, number);
        let [marks, backwards, leads] = results.ties.each_ref().map(|ties| ties.as_flattened());
        let mut votes = DirectionVotes::none(simd);
        for (joint, &i) in self.constants.order.iter().enumerate().take(self.constants.joints) {
            let is_true = |mark: f64| splat(0.0).below(splat(mark));
            let (is_tie, is_backwards) = (is_true(marks[joint]), is_true(backwards[joint]));
            let tie = DirectionTie { is_tie, is_backwards, lead: splat(leads[joint]) };
            let speed = self.inputs.previous_speeds.map_or(0.0, |speeds| speeds[i]);
            votes = votes.with(&tie, splat(speed));
        }
        votes.common_direction(simd)
    }
}

/// Register `k` of the numbers of a group.
#[inline(always)]
fn load<S: Vector>(simd: S, numbers: &Eight, k: usize) -> Lanes<S> {
    Lanes::load(simd, S::as_simd_f64s(numbers).0, k)
}

/// Speeds of wheels that are not steered [rad/s].
#[inline(always)]
fn roll<S: Vector>(simd: S, group: &WheelGroup, k: usize, [vx, vy, omega]: [Lanes<S>; 3]) -> Lanes<S> {
    let [a, b, c] = group.row.each_ref().map(|row| load(simd, row, k));
    ((vx * a + vy * b) + omega * c) * load(simd, &group.per_radius, k)
}
