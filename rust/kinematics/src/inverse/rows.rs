//! Inverse kinematics of many rows: the lanes of a register are rows.

use super::constants::{InverseConstants, WheelKind};
use crate::admissible::cone::{AdmissibleCone, Rates};
use crate::kernels::safe_range::{MAX_SQUARABLE, MIN_SQUARABLE, all_within};
use crate::kernels::steered::direction_votes::{CommonDirection, DirectionTie, DirectionVotes};
use crate::kernels::steered::wheel::WheelQuery;
use crate::rover_data::{Inputs, RoverData};
use six_wheel_numerics::columns::{BLOCK, Column, load, transpose_to_columns, transpose_to_rows, with_columns};
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::level::{Kernel, Level, run_rarely};
use six_wheel_numerics::simd::vec3::row_times as dot;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::stream::{Output, prefetch_ahead};

/// Fails at the first row that the rover cannot make; rows of the error count from `first`.
pub(crate) fn check(
    rover: &RoverData,
    cone: &AdmissibleCone,
    level: Level,
    twists: &[[f64; 3]],
    inputs: Inputs<'_>,
    first: usize,
) -> Result<(), Error> {
    let has_rates = cone.depends_on_rates() && inputs.steering_rates.is_some();
    with_columns(if has_rates { rover.steered().len() } else { 0 }, |rates| {
        level.run_any(CheckRange { rover, cone, twists, inputs, first, rates })
    })
}

struct CheckRange<'a> {
    rover: &'a RoverData,
    cone: &'a AdmissibleCone,
    twists: &'a [[f64; 3]],
    inputs: Inputs<'a>,
    first: usize,
    /// One per steering joint if rates are given and matter, otherwise none.
    rates: &'a mut [Column],
}

impl Kernel for CheckRange<'_> {
    type Output = Result<(), Error>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Self::Output {
        let (joints, wheels) = (self.rover.steered().len(), self.rover.wheels().len());
        let Inputs { previous, previous_speeds, steering_rates } = self.inputs;
        let mut columns = [Column::ZERO; 3];
        for (b, rows) in self.twists.chunks(BLOCK).enumerate() {
            let first = b * BLOCK;
            let of = |values, width| block(values, width, first, rows.len());
            let mut passes = Mask::splat(simd, true);
            for values in [of(previous, joints), of(previous_speeds, wheels), of(steering_rates, joints)] {
                if !all_within(simd, values, f64::MAX) {
                    passes = Mask::splat(simd, false);
                }
            }
            if !self.rates.is_empty() {
                transpose_to_columns(simd, of(steering_rates, joints), self.rates);
            }
            prefetch_ahead(simd, rows.as_flattened(), 0, 1);
            if rows.len() == BLOCK {
                let groups = rows.as_flattened().chunks_exact(3 * S::F64_LANES);
                for (k, rows) in groups.enumerate() {
                    let rates = Rates::Columns(self.rates, k);
                    passes =
                        passes & self.cone.admissibility(simd, Lanes::deinterleave3(simd, rows), rates).is_possible;
                }
            } else {
                transpose_to_columns(simd, rows.as_flattened(), &mut columns);
                for k in 0..rows.len().div_ceil(S::F64_LANES) {
                    let rates = Rates::Columns(self.rates, k);
                    passes = passes & self.cone.admissibility(simd, load(simd, &columns, k), rates).is_possible;
                }
            }
            if (!passes).any() {
                // Row by row, for the error of the first one that fails.
                for (k, twist) in rows.iter().enumerate() {
                    let inputs = self.inputs.row(self.rover, first + k);
                    let checked = inputs
                        .check()
                        .and_then(|()| self.cone.check(self.rover, (*twist).into(), inputs.steering_rates));
                    checked.map_err(|error| error.at_row(self.first + first + k))?;
                }
            }
        }
        Ok(())
    }
}

impl InverseConstants {
    /// Solves rows that have been checked; writes past the caches if `non_temporal`.
    pub fn solve_rows(
        &self,
        level: Level,
        twists: &[[f64; 3]],
        inputs: Inputs<'_>,
        steering: &mut [f64],
        speeds: &mut [f64],
        non_temporal: bool,
    ) {
        let joints = |given: Option<&[f64]>| given.map_or(0, |_| self.joints);
        let rolling = inputs.previous_speeds.map_or(0, |_| self.wheels.len());
        let beside = joints(inputs.previous) + joints(inputs.steering_rates) + rolling;
        with_columns(self.joints + self.wheels.len() + beside, |columns| {
            level.run_any(SolveRange { constants: self, twists, inputs, steering, speeds, non_temporal, columns });
        });
    }
}

struct SolveRange<'a> {
    constants: &'a InverseConstants,
    twists: &'a [[f64; 3]],
    inputs: Inputs<'a>,
    steering: &'a mut [f64],
    speeds: &'a mut [f64],
    non_temporal: bool,
    /// One per steering angle, one per speed, and one per number of the inputs.
    columns: &'a mut [Column],
}

/// Rows of a block, column by column. Arguments that are not given are empty.
struct InputColumns<'a> {
    twists: [Column; 3],
    /// Twice the bound of the rounding error of pivot velocities [m/s].
    rounding: Column,
    previous: &'a mut [Column],
    previous_speeds: &'a mut [Column],
    rates: &'a mut [Column],
}

impl Kernel for SolveRange<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) {
        let constants = self.constants;
        let (joints, wheels) = (constants.joints, constants.wheels.len());
        let Inputs { previous, previous_speeds, steering_rates } = self.inputs;
        let (steering, rest) = self.columns.split_at_mut(joints);
        let (speeds, rest) = rest.split_at_mut(wheels);
        let (held, rest) = rest.split_at_mut(previous.map_or(0, |_| joints));
        let (rolling, rates) = rest.split_at_mut(previous_speeds.map_or(0, |_| wheels));
        let mut input = InputColumns {
            twists: [Column::ZERO; 3],
            rounding: Column::ZERO,
            previous: held,
            previous_speeds: rolling,
            rates,
        };
        let output = |target, width| Output::new(simd, target, width * BLOCK, self.non_temporal);
        let mut all_steering = output(self.steering, joints);
        let mut all_speeds = output(self.speeds, wheels);
        for (b, rows) in self.twists.chunks(BLOCK).enumerate() {
            let of = |values, width| block(values, width, b * BLOCK, rows.len());
            prefetch_ahead(simd, rows.as_flattened(), 0, 1);
            transpose_to_columns(simd, rows.as_flattened(), &mut input.twists);
            transpose_to_columns(simd, of(previous, joints), input.previous);
            transpose_to_columns(simd, of(previous_speeds, wheels), input.previous_speeds);
            transpose_to_columns(simd, of(steering_rates, joints), input.rates);
            let registers = rows.len().div_ceil(S::F64_LANES);
            input.prepare(simd, constants, registers);
            let mut block = SolveBlock { constants, input: &input, steering, speeds, registers };
            if !block.first_solutions(simd) {
                run_rarely(simd, block);
            }
            transpose_to_rows(simd, steering, all_steering.next(rows.len() * joints));
            transpose_to_rows(simd, speeds, all_speeds.next(rows.len() * wheels));
        }
    }
}

#[inline_always]
impl InputColumns<'_> {
    /// Computes the bounds of rounding, and replaces forward speeds of minus zero by zero.
    fn prepare<S: Vector>(&mut self, simd: S, constants: &InverseConstants, registers: usize) {
        let [share, arm] = constants.rounding.map(|number| Lanes::splat(simd, number));
        let [min, max] = [MIN_SQUARABLE, MAX_SQUARABLE].map(|size| Lanes::splat(simd, size));
        for k in 0..registers {
            let [vx, vy, omega] = load(simd, &self.twists, k);
            self.twists[0].store(k, vx + Lanes::splat(simd, 0.0));
            let (linear, omega) = (vx.abs() + vy.abs(), omega.abs());
            let size = linear + omega;
            let is_safe = min.le(size) & size.le(max);
            let rounding = linear * share + omega * arm;
            self.rounding.store(k, is_safe.select(rounding, Lanes::splat(simd, f64::INFINITY)));
        }
    }

    /// Present angles [rad] and rates [rad/s] of a joint, if given.
    fn joint(&self, joint: usize) -> [Option<&Column>; 2] {
        [self.previous.get(joint), self.rates.get(joint)]
    }

    /// Input of a steered wheel in register `k`.
    fn query<S: Vector>(&self, simd: S, [previous, rate]: [Option<&Column>; 2], k: usize) -> WheelQuery<S> {
        WheelQuery {
            twist: load(simd, &self.twists, k),
            rounding: self.rounding.load(simd, k),
            previous: previous.map(|column| column.load(simd, k)),
            rate: rate.map(|column| column.load(simd, k)),
        }
    }
}

/// A block of rows, solved wheel after wheel.
struct SolveBlock<'a, 'b> {
    constants: &'a InverseConstants,
    input: &'a InputColumns<'b>,
    steering: &'a mut [Column],
    speeds: &'a mut [Column],
    /// Registers with rows in them.
    registers: usize,
}

#[inline_always]
impl SolveBlock<'_, '_> {
    /// Solves a block as if every steered wheel took its first solution. Returns true if every one does.
    fn first_solutions<S: Vector>(&mut self, simd: S) -> bool {
        let Self { constants, input, ref mut steering, ref mut speeds, registers } = *self;
        let mut are_final = Mask::splat(simd, true);
        let mut joint = 0;
        for ((kind, per_radius), speeds) in constants.wheels.iter().zip(speeds.iter_mut()) {
            let per_radius = Lanes::splat(simd, *per_radius);
            match kind {
                WheelKind::Fixed(row) => {
                    for k in 0..registers {
                        speeds.store(k, dot(simd, row, load(simd, &input.twists, k)) * per_radius);
                    }
                }
                WheelKind::Castor(castor) => {
                    let castor = castor.broadcast(simd);
                    for k in 0..registers {
                        let rim_speed = castor.castor_rim_speed(simd, load(simd, &input.twists, k));
                        speeds.store(k, rim_speed * per_radius);
                    }
                }
                WheelKind::Steered(wheel) => {
                    let (wheel, given) = (wheel.broadcast(simd), input.joint(joint));
                    let angles = &mut steering[joint];
                    for k in 0..registers {
                        let first = wheel.first_solution(simd, &input.query(simd, given, k));
                        are_final = are_final & first.is_final;
                        angles.store(k, first.angle);
                        speeds.store(k, first.rim_speed * per_radius);
                    }
                    joint += 1;
                }
            }
        }
        are_final.all()
    }

    /// Solves the steered wheels whose first solution is not final, with the common direction of direction ties, if
    /// known. Calls `in_tie` with every wheel's tie and index.
    fn both_solutions<S: Vector>(
        &mut self,
        simd: S,
        k: usize,
        common: CommonDirection<S>,
        mut in_tie: impl FnMut(&DirectionTie<S>, usize),
    ) {
        let mut joint = 0;
        for (i, ((kind, per_radius), speeds)) in self.constants.wheels.iter().zip(&mut *self.speeds).enumerate() {
            if let WheelKind::Steered(wheel) = kind {
                let wheel = wheel.broadcast(simd);
                let query = self.input.query(simd, self.input.joint(joint), k);
                let first = wheel.first_solution(simd, &query);
                if (!first.is_final).any() {
                    let motion = wheel.solve(simd, &query, &first, common);
                    in_tie(&motion.tie, i);
                    self.steering[joint].store(k, motion.angle);
                    speeds.store(k, motion.rim_speed * Lanes::splat(simd, *per_radius));
                }
                joint += 1;
            }
        }
    }
}

/// Both solutions of the steered wheels, register by register; registers with direction ties once more with the common
/// direction.
impl Kernel for SolveBlock<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(mut self, simd: S) {
        let input = self.input;
        for k in 0..self.registers {
            let mut common = None;
            // The second pass has the common direction, if there is one.
            for _ in 0..2 {
                let mut votes = DirectionVotes::none(simd);
                let mut has_ties = false;
                self.both_solutions(simd, k, common, |tie, i| {
                    let rolling = input.previous_speeds.get(i);
                    let rolling = rolling.map_or(Lanes::splat(simd, 0.0), |column| column.load(simd, k));
                    votes = votes.with(tie, rolling);
                    has_ties |= tie.is_tie.any();
                });
                let direction = votes.common_direction(simd);
                if !(has_ties && direction[0].any()) {
                    break;
                }
                common = Some(direction);
            }
        }
    }
}

/// The rows of a block from those of a batch.
fn block(values: Option<&[f64]>, width: usize, first: usize, count: usize) -> &[f64] {
    values.map_or(&[], |values| &values[first * width..(first + count) * width])
}
