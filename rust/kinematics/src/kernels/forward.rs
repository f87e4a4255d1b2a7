//! Forward kinematics of whole registers of readings.

use std::ops::Range;

use super::normal_equations::{ForwardConstants, LARGEST_SPEED, solve};
use super::readings::{FitColumns, ReadingColumns, solve_block};
use super::safe_range::all_within;
use crate::estimate::Unseen;
use crate::rover_data::RoverData;
use crate::table::Log;
use six_wheel_numerics::columns::{BLOCK, Column, transpose_to_columns, transpose_to_rows, with_columns};
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::level::{Kernel, Level};
use six_wheel_numerics::simd::polynomials::LARGEST_ANGLE;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::stream::{Output, prefetch_ahead};

impl ForwardConstants {
    /// Fails at the first row that cannot be read; rows of errors count from the log's first.
    #[inline]
    pub fn check(
        &self,
        level: Level,
        rover: &RoverData,
        log: Log<'_>,
        rows: Range<usize>,
        unseen: Unseen,
    ) -> Result<(), Error> {
        let joints = if self.solution.is_none() { self.joints } else { 0 };
        with_columns(joints, |steering| level.run_any(Check { constants: self, rover, log, rows, unseen, steering }))
    }

    /// Solves rows that have been checked; past the caches, if `non_temporal`.
    #[inline]
    pub fn solve_rows(
        &self,
        level: Level,
        rover: &RoverData,
        log: Log<'_>,
        unseen: Unseen,
        twists: &mut [[f64; 3]],
        non_temporal: bool,
    ) -> Result<(), Error> {
        if !self.is_regular {
            return twists.iter_mut().enumerate().try_for_each(|(k, twist)| {
                *twist = rover.forward_rarely(log.row(rover, k), unseen)?.into();
                Ok(())
            });
        }
        with_columns(self.joints + self.wheels.len() + self.rates(log), |columns| {
            level.run_any(Solve { constants: self, rover, log, unseen, twists, non_temporal, columns })
        })
    }
}

struct Check<'a> {
    constants: &'a ForwardConstants,
    rover: &'a RoverData,
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
        let (constants, rover, log) = (self.constants, self.rover, self.log);
        let (joints, wheels) = (constants.joints, constants.wheels.len());
        for first in self.rows.clone().step_by(BLOCK) {
            let end = self.rows.end.min(first + BLOCK);
            let steering = &log.steering[first * joints..end * joints];
            let speeds = &log.speeds[first * wheels..end * wheels];
            let rates = log.steering_rates.unwrap_or_default();
            let rates = rates.get(first * joints..end * joints).unwrap_or_default();
            prefetch_ahead(simd, steering, 0, 1);
            prefetch_ahead(simd, speeds, 0, 1);
            let mut pass = constants.is_regular
                && all_within(simd, steering, LARGEST_ANGLE / 2.0)
                && all_within(simd, speeds, LARGEST_SPEED)
                && all_within(simd, rates, LARGEST_SPEED);
            if pass && !self.steering.is_empty() {
                transpose_to_columns(simd, steering, self.steering);
                let one = Lanes::splat(simd, 1.0);
                let mut determined = Mask::splat(simd, true);
                for k in 0..BLOCK / S::F64_LANES {
                    let (_, surely) = solve(simd, constants.normal(simd, self.steering, k), [one; 3]);
                    determined = determined & surely;
                }
                pass = determined.all();
            }
            if pass {
                continue;
            }
            for k in first..end {
                let measured = log.row(rover, k);
                let checked = if measured.is_complete() && constants.solution.is_some() {
                    rover.check_readings(measured)
                } else {
                    rover.forward_rarely(measured, self.unseen).map(drop)
                };
                checked.map_err(|error| error.at_row(k))?;
            }
        }
        Ok(())
    }
}

struct Solve<'a> {
    constants: &'a ForwardConstants,
    rover: &'a RoverData,
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
        let (constants, rover, log) = (self.constants, self.rover, self.log);
        let mut twists = [Column::ZERO; 3];
        let mut kept = FitColumns::new(&mut []);
        let count = self.twists.len();
        let numbers = self.twists.as_flattened_mut();
        let mut output = Output::new(simd, numbers, 3 * BLOCK, self.non_temporal);
        for first in (0..count).step_by(BLOCK) {
            let end = count.min(first + BLOCK);
            let log = log.rows(rover, first..end);
            let columns = ReadingColumns::load(simd, constants, log, self.columns);
            let none_rare =
                solve_block::<S, false>(simd, constants, (columns, end - first), &mut twists, &mut kept, log);
            let rows = output.next(3 * (end - first));
            transpose_to_rows(simd, &twists, rows);
            if none_rare {
                continue;
            }
            for (k, twist) in rows.as_chunks_mut::<3>().0.iter_mut().enumerate() {
                if kept.rare.0[k] != 0.0 {
                    *twist = rover.forward_rarely(log.row(rover, k), self.unseen)?.into();
                }
            }
        }
        Ok(())
    }
}
