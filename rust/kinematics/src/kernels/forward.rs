//! Forward kinematics of whole registers of readings.

use std::ops::Range;

pub(crate) use super::readings::ForwardConstants;
use super::readings::{FitColumns, LARGEST_SPEED, solve, solve_block};
use super::safe_range::all_within;
use crate::estimate::Unseen;
use crate::table::Log;
use six_wheel_numerics::columns::{BLOCK, Column, transpose_to_columns, transpose_to_rows, with_columns};
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::{Kernel, Level};
use six_wheel_numerics::simd::polynomials::LARGEST_ANGLE;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::stream::{Output, prefetch_ahead};

impl ForwardConstants<'_> {
    /// Fails at the first row that cannot be read.
    #[inline]
    pub fn check(&self, level: Level, log: Log<'_>, rows: Range<usize>, unseen: Unseen) -> Result<(), Error> {
        let joints = if self.solution.is_none() { self.joints } else { 0 };
        with_columns(joints, |steering| {
            let check = Check { plan: self, log, rows, unseen, steering };
            level.run_any(check)
        })
    }

    /// Solves rows that have been checked; `past` the caches, if what is written does not fit in.
    #[inline]
    pub fn solve(
        &self,
        level: Level,
        log: Log<'_>,
        unseen: Unseen,
        twists: &mut [[f64; 3]],
        non_temporal: bool,
    ) -> Result<(), Error> {
        with_columns(self.joints + self.wheels.len() + self.rates(log), |columns| {
            let solve = Solve { plan: self, log, unseen, twists, non_temporal, columns };
            level.run_any(solve)
        })
    }
}

struct Check<'a> {
    plan: &'a ForwardConstants<'a>,
    log: Log<'a>,
    rows: Range<usize>,
    unseen: Unseen,
    /// One per steering angle, where the solution depends on them.
    steering: &'a mut [Column],
}

impl Kernel for Check<'_> {
    type Output = Result<(), Error>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Self::Output {
        let (plan, log) = (self.plan, self.log);
        let (joints, wheels) = (plan.joints, plan.wheels.len());
        for first in self.rows.clone().step_by(BLOCK) {
            let end = self.rows.end.min(first + BLOCK);
            let steering = &log.steering[first * joints..end * joints];
            let speeds = &log.speeds[first * wheels..end * wheels];
            let rates = log.steering_rates.unwrap_or_default();
            let rates = rates.get(first * joints..end * joints).unwrap_or_default();
            prefetch_ahead(simd, steering, 0, 1);
            prefetch_ahead(simd, speeds, 0, 1);
            let mut pass = all_within(simd, steering, LARGEST_ANGLE / 2.0)
                && all_within(simd, speeds, LARGEST_SPEED)
                && all_within(simd, rates, LARGEST_SPEED);
            if pass && !self.steering.is_empty() {
                transpose_to_columns(simd, steering, self.steering);
                let one = Lanes::splat(simd, 1.0);
                let mut determined = one.le(one);
                for k in 0..BLOCK / S::F64_LANES {
                    let (_, surely) = solve(simd, plan.normal(simd, self.steering, k), [one; 3]);
                    determined = determined & surely;
                }
                pass = !(!determined).any();
            }
            if pass {
                continue;
            }
            for k in first..end {
                let measured = log.row(plan.rover, k);
                let solvable = if measured.is_complete() && plan.solution.is_some() {
                    plan.rover.check_readings(measured)
                } else {
                    plan.rover.forward(measured, self.unseen).map(drop)
                };
                solvable.map_err(|error| error.at_row(k))?;
            }
        }
        Ok(())
    }
}

struct Solve<'a> {
    plan: &'a ForwardConstants<'a>,
    log: Log<'a>,
    unseen: Unseen,
    twists: &'a mut [[f64; 3]],
    non_temporal: bool,
    /// One per steering angle, one per speed, and one per rate that matters.
    columns: &'a mut [Column],
}

impl Kernel for Solve<'_> {
    type Output = Result<(), Error>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Self::Output {
        let (plan, log) = (self.plan, self.log);
        let mut twists = [Column::ZERO; 3];
        let mut kept = FitColumns::new(&mut []);
        let count = self.twists.len();
        let numbers = self.twists.as_flattened_mut();
        let mut output = Output::new(simd, numbers, 3 * BLOCK, self.non_temporal);
        for first in (0..count).step_by(BLOCK) {
            let end = count.min(first + BLOCK);
            let log = log.rows(plan.rover, first..end);
            let heard = plan.load_readings(simd, log, self.columns);
            let usual = solve_block::<S, false>(simd, plan, heard, &mut twists, &mut kept, log);
            let rows = output.next(3 * (end - first));
            transpose_to_rows(simd, &twists, rows);
            if usual {
                continue;
            }
            for (k, twist) in rows.as_chunks_mut::<3>().0.iter_mut().enumerate() {
                if kept.doubts.0[k] != 0.0 {
                    let measured = log.row(plan.rover, k);
                    *twist = plan.rover.forward(measured, self.unseen)?.into();
                }
            }
        }
        Ok(())
    }
}
