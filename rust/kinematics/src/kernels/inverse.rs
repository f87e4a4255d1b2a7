//! Inverse kinematics of whole registers of twists. What the kernel is not sure of, it leaves to the plain core, row by
//! row.

mod plan;
mod solve;
#[cfg(test)]
mod tests;

use self::plan::block;
pub use self::plan::{InverseConstants, WheelKind};
use self::solve::Solve;
use super::steered::load;
use super::usual::all_within;
use crate::rover_data::Inputs;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::{Kernel, Level};
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::stream::fetch_ahead;
use six_wheel_numerics::weave::{BLOCK, Column, unweave, with_columns};

impl InverseConstants<'_> {
    /// Fails at the first row that the rover cannot make; rows count from `first`.
    pub fn check(&self, level: Level, twists: &[[f64; 3]], inputs: Inputs<'_>, first: usize) -> Result<(), Error> {
        let swinging = !self.cone.is_whole && inputs.steering_rates.is_some();
        with_columns(if swinging { self.joints } else { 0 }, |rates| {
            let check = Check { plan: self, twists, inputs, first, rates };
            let checked = level.run(check);
            checked.unwrap_or_else(|| self.check_rows(twists, inputs, 0, first))
        })
    }

    /// Solves rows that have been checked; `past` the caches, if what is written does not fit in.
    pub fn solve(
        &self,
        level: Level,
        twists: &[[f64; 3]],
        inputs: Inputs<'_>,
        steering: &mut [f64],
        speeds: &mut [f64],
        past: bool,
    ) {
        let joints = |given: Option<&[f64]>| given.map_or(0, |_| self.joints);
        let rolling = inputs.previous_speeds.map_or(0, |_| self.parts.len());
        let beside = joints(inputs.previous) + joints(inputs.steering_rates) + rolling;
        with_columns(self.joints + self.parts.len() + beside, |columns| {
            level.run(Solve { plan: self, twists, inputs, steering, speeds, past, columns })
        });
    }
}

struct Check<'a> {
    plan: &'a InverseConstants<'a>,
    twists: &'a [[f64; 3]],
    inputs: Inputs<'a>,
    first: usize,
    /// One per rate, where they are part of the question.
    rates: &'a mut [Column],
}

impl Kernel for Check<'_> {
    type Output = Result<(), Error>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Self::Output {
        let plan = self.plan;
        let (joints, wheels) = (plan.joints, plan.parts.len());
        let Inputs { previous, previous_speeds, steering_rates } = self.inputs;
        let mut columns = [Column::ZERO; 3];
        for (b, rows) in self.twists.chunks(BLOCK).enumerate() {
            let first = b * BLOCK;
            let of = |values, width| block(values, width, first, rows.len());
            let beside = [of(previous, joints), of(previous_speeds, wheels), of(steering_rates, joints)];
            let mut pass = true;
            for values in beside {
                pass = pass && all_within(simd, values, f64::MAX);
            }
            if pass {
                fetch_ahead(simd, rows.as_flattened(), 0, 1);
                if !self.rates.is_empty() {
                    unweave(simd, of(steering_rates, joints), self.rates);
                }
                let zero = Lanes::splat(simd, 0.0);
                let mut passes = zero.at_most(zero);
                if rows.len() == BLOCK {
                    let groups = rows.as_flattened().chunks_exact(3 * S::F64_LANES);
                    for (k, rows) in groups.enumerate() {
                        let twist = Lanes::unbraid(simd, rows);
                        passes = passes & plan.passes(simd, twist, self.rates, k);
                    }
                } else {
                    unweave(simd, rows.as_flattened(), &mut columns);
                    for k in 0..BLOCK / S::F64_LANES {
                        let twist = load(simd, &columns, k);
                        passes = passes & plan.passes(simd, twist, self.rates, k);
                    }
                }
                pass = !(!passes).any();
            }
            if !pass {
                plan.check_rows(rows, self.inputs, first, self.first)?;
            }
        }
        Ok(())
    }
}
