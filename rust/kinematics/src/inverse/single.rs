//! One row of the inverse kinematics: the lanes of a register are the wheels, the steered ones first.

use super::constants::{InverseConstants, WheelGroup};
use crate::admissible::cone::AdmissibleCone;
use crate::kernels::safe_range::{MAX_SQUARABLE, MIN_SQUARABLE};
use crate::kernels::steered::direction_votes::{CommonDirection, DirectionTie, DirectionVotes};
use crate::kernels::steered::wheel::{SAFE_OVERSHOOT, WheelQuery};
use crate::kernels::wheel_lanes::{Eight, GROUP, padded};
use crate::rover_data::{Inputs, MAX_WHEELS};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::level::{Kernel, Level, run_rarely};
use six_wheel_numerics::simd::vector::Vector;

/// Groups of the largest rover.
const MAX_GROUPS: usize = MAX_WHEELS / GROUP;

impl InverseConstants {
    /// Writes steering angles [rad] and wheel speeds [rad/s] of one twist. With `cone`, returns false and writes
    /// nothing unless every input is finite and no wheel slides by more than half of the tolerance.
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

    /// Twice the bound of the rounding error of pivot velocities [m/s].
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

/// One row in which every steered wheel takes its first solution. If that of one is not final, if there are castors or
/// more than eight wheels, [`RowOfBothSolutions`] solves the row.
struct InverseRow<'a> {
    constants: &'a InverseConstants,
    twist: [f64; 3],
    inputs: Inputs<'a>,
    /// Steering angles and wheel speeds.
    targets: [&'a mut [f64]; 2],
    /// The admissible twists, if the twist is to be checked.
    cone: Option<&'a AdmissibleCone>,
}

impl Kernel for InverseRow<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Vector>(mut self, simd: S) -> bool {
        let constants = self.constants;
        let group = match &constants.groups[..] {
            [group] if group.castors.is_empty() => group,
            _ => return run_rarely(simd, RowOfBothSolutions(self)),
        };
        let twist = self.twist.map(|part| Lanes::splat(simd, part));
        let rounding = Lanes::splat(simd, constants.rounding(self.twist));
        let (mut angles, mut speeds) = ([0.0; GROUP], [0.0; GROUP]);
        let mut passes = Mask::splat(simd, true);
        for k in 0..constants.order.len().div_ceil(S::F64_LANES) {
            let mut speed = roll(simd, group, k, twist);
            if k * S::F64_LANES < group.steered {
                let WheelInput { query, is_finite } = self.input(simd, k, twist, rounding);
                let first = group.load(simd, k).first_solution(simd, &query);
                let is_steered = is_steered(simd, group, k);
                passes = passes & is_finite & (first.is_final | !is_steered);
                speed = is_steered.select(first.rim_speed * load(simd, &group.per_radius, k), speed);
                first.angle.store(S::as_mut_simd_f64s(&mut angles).0, k);
            }
            speed.store(S::as_mut_simd_f64s(&mut speeds).0, k);
        }
        if (!passes).any() {
            return run_rarely(simd, RowOfBothSolutions(self));
        }
        if !self.is_admissible(simd, twist) {
            return false;
        }
        self.write(&angles, &speeds);
        true
    }
}

/// Input of the wheels of a register.
struct WheelInput<S: Vector> {
    query: WheelQuery<S>,
    /// True where present angles and rates are finite.
    is_finite: Mask<S>,
}

#[inline_always]
impl InverseRow<'_> {
    fn input<S: Vector>(&self, simd: S, register: usize, twist: [Lanes<S>; 3], rounding: Lanes<S>) -> WheelInput<S> {
        let mut is_finite = Mask::splat(simd, true);
        let mut given = [None; 2];
        for (lanes, row) in given.iter_mut().zip([self.inputs.previous, self.inputs.steering_rates]) {
            if let Some(row) = row {
                let numbers = padded(simd, row.get(register * S::F64_LANES..).unwrap_or_default());
                is_finite = is_finite & numbers.abs().le(Lanes::splat(simd, f64::MAX));
                *lanes = Some(numbers);
            }
        }
        let [previous, rate] = given;
        WheelInput { query: WheelQuery { twist, rounding, previous, rate }, is_finite }
    }

    /// True if the twist need not be checked, or the unsteered wheels roll and the present speeds are finite.
    fn is_admissible<S: Vector>(&self, simd: S, twist: [Lanes<S>; 3]) -> bool {
        let Some(cone) = self.cone else {
            return true;
        };
        let speeds = self.inputs.previous_speeds.unwrap_or_default();
        cone.banks_roll(simd, twist).any() && speeds.iter().all(|speed| speed.is_finite())
    }

    /// Writes angles [rad] and speeds [rad/s] of the lanes to the arrays of the wheels.
    fn write(&mut self, angles: &[f64], rotations: &[f64]) {
        let [steering, speeds] = &mut self.targets;
        for (target, angle) in steering.iter_mut().zip(angles) {
            *target = *angle;
        }
        for (&i, rotation) in self.constants.order.iter().zip(rotations) {
            if let Some(target) = speeds.get_mut(i) {
                *target = *rotation;
            }
        }
    }
}

/// One row with both solutions of the wheels whose first one is not final.
struct RowOfBothSolutions<'a>(InverseRow<'a>);

/// Angles [rad] and speeds [rad/s] by lane, and the direction ties of the steered wheels.
struct WheelResults {
    angles: [Eight; MAX_GROUPS],
    speeds: [Eight; MAX_GROUPS],
    /// By lane: 1 for a wheel of a tie, 1 for a wheel whose own solution is backwards, and [`DirectionTie::lead`]
    /// [rad].
    ties: [[Eight; MAX_GROUPS]; 3],
    has_ties: bool,
}

impl Kernel for RowOfBothSolutions<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Vector>(mut self, simd: S) -> bool {
        let mut results = WheelResults {
            angles: [[0.0; GROUP]; MAX_GROUPS],
            speeds: [[0.0; GROUP]; MAX_GROUPS],
            ties: [[[0.0; GROUP]; MAX_GROUPS]; 3],
            has_ties: false,
        };
        let are_safe = self.all_wheels(simd, &mut results, None);
        let twist = self.0.twist.map(|part| Lanes::splat(simd, part));
        if self.0.cone.is_some() && !(are_safe && self.0.is_admissible(simd, twist)) {
            return false;
        }
        if results.has_ties {
            let common = self.common_direction(simd, &results);
            if common[0].any() {
                self.all_wheels(simd, &mut results, Some(common));
            }
        }
        self.0.write(results.angles.as_flattened(), results.speeds.as_flattened());
        true
    }
}

#[inline_always]
impl RowOfBothSolutions<'_> {
    /// Solves all wheels. Returns true if the present angles and the rates are finite and the range of every steered
    /// wheel holds its angle.
    fn all_wheels<S: Vector>(&self, simd: S, results: &mut WheelResults, common: CommonDirection<S>) -> bool {
        let row = &self.0;
        let splat = |number| Lanes::splat(simd, number);
        let zero = splat(0.0);
        let twist = row.twist.map(splat);
        let rounding = splat(row.constants.rounding(row.twist));
        let mut is_safe = Mask::splat(simd, true);
        let registers = GROUP / S::F64_LANES;
        for register in 0..row.constants.order.len().div_ceil(S::F64_LANES) {
            let (g, k) = (register / registers, register % registers);
            let group = &row.constants.groups[g];
            let mut speed = roll(simd, group, k, twist);
            if k * S::F64_LANES < group.steered {
                let WheelInput { query, is_finite } = row.input(simd, register, twist, rounding);
                is_safe = is_safe & is_finite;
                let wheels = group.load(simd, k);
                let is_steered = is_steered(simd, group, k);
                let first = wheels.first_solution(simd, &query);
                let (mut angle, mut rim_speed) = (first.angle, first.rim_speed);
                if (is_steered & !first.is_final).any() {
                    let motion = wheels.solve(simd, &query, &first, common);
                    (angle, rim_speed) = (motion.angle, motion.rim_speed);
                    is_safe = is_safe & (motion.overshoot.le(splat(SAFE_OVERSHOOT)) | !is_steered);
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
                angle.store(S::as_mut_simd_f64s(&mut results.angles[g]).0, k);
            }
            speed.store(S::as_mut_simd_f64s(&mut results.speeds[g]).0, k);
        }
        for (group, speeds) in row.constants.groups.iter().zip(&mut results.speeds) {
            for (lane, castor) in &group.castors {
                let rim_speed = castor.broadcast(simd).castor_rim_speed(simd, twist).last(simd);
                speeds[*lane] = rim_speed * group.per_radius[*lane];
            }
        }
        is_safe.all()
    }

    /// The common direction of the wheels of a tie, summed wheel by wheel, so that rounding is that of a row of a
    /// batch.
    fn common_direction<S: Vector>(&self, simd: S, results: &WheelResults) -> [Mask<S>; 2] {
        let splat = |number| Lanes::splat(simd, number);
        let [marks, backwards, leads] = results.ties.each_ref().map(|ties| ties.as_flattened());
        let mut votes = DirectionVotes::none(simd);
        let InverseRow { constants, inputs, .. } = &self.0;
        for (joint, &i) in constants.order.iter().enumerate().take(constants.joints) {
            let is_true = |mark: f64| splat(0.0).lt(splat(mark));
            let (is_tie, is_backwards) = (is_true(marks[joint]), is_true(backwards[joint]));
            let tie = DirectionTie { is_tie, is_backwards, lead: splat(leads[joint]) };
            let speed = inputs.previous_speeds.map_or(0.0, |speeds| speeds[i]);
            votes = votes.with(&tie, splat(speed));
        }
        votes.common_direction(simd)
    }
}

/// Lanes of register `k` with a steered wheel.
#[inline(always)]
fn is_steered<S: Vector>(simd: S, group: &WheelGroup, k: usize) -> Mask<S> {
    Lanes::splat(simd, 0.0).lt(load(simd, &group.is_steered, k))
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
