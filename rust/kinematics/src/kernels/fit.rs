//! Twists with the residuals of the wheels, where the least squares have a constant solution: every wheel alike, or the
//! unsteered ones alone. Rank and smallest singular value are constants of the rover then, because a steered wheel without
//! scrub and trail measures its pivot's whole velocity, whichever way it points. Robust fits start from there.

#[cfg(test)]
mod tests;

use super::readings::{self, FitColumns, Rows, solve_block};
use super::robust::{self, Block, EARLY, LATE};
use super::row::{dot, load};
use crate::estimate::{Fit, Measured, Method, Reading, Unseen};
use crate::rover_data::{MAX_WHEELS, RoverData};
use crate::table::{Log, row_mut};
use six_wheel_numerics::columns::{BLOCK, Column, transpose_to_rows, with_columns};
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::{Kernel, Level};
use six_wheel_numerics::simd::vector::Vector;

/// Constants of a rover and a method for the kernel.
pub(crate) struct FitConstants<'a> {
    rover: &'a RoverData,
    method: Method,
    unseen: Unseen,
    forward: readings::ForwardConstants<'a>,
    robust: Option<robust::RobustConstants>,
    /// A say of 1 or 0, to begin with.
    weights: Vec<f64>,
    rank: usize,
    sigma_min: f64,
}

/// Output of fits, one row per reading: see [`Fit`], and a number per wheel.
pub struct Fits<'a> {
    /// Estimates.
    pub twists: &'a mut [[f64; 3]],
    /// Numbers of independent directions.
    pub ranks: &'a mut [i64],
    /// Smallest singular values.
    pub sigmas: &'a mut [f64],
    /// Residuals [m/s].
    pub residual: &'a mut [f64],
    /// Say of each wheel.
    pub weights: &'a mut [f64],
}

impl Fits<'_> {
    /// The result of one row, and room for what it says of its wheels.
    pub fn one(
        &mut self,
        k: usize,
        wheels: usize,
        solve: impl FnOnce(&mut [f64], &mut [f64]) -> Result<Fit, Error>,
    ) -> Result<(), Error> {
        let (residual, weights) = (row_mut(self.residual, wheels, k), row_mut(self.weights, wheels, k));
        let fit = solve(residual, weights)?;
        self.twists[k] = fit.twist.into();
        (self.ranks[k], self.sigmas[k]) = (fit.rank as i64, fit.sigma_min);
        Ok(())
    }
}

impl<'a> FitConstants<'a> {
    /// Nothing where the solution depends on the readings.
    pub fn new(rover: &'a RoverData, method: Method, unseen: Unseen) -> Option<Self> {
        let solution = rover.solution?;
        let (wheels, zeros) = (rover.wheels(), [0.0; MAX_WHEELS]);
        let at_rest = Measured {
            steering: &zeros[..rover.steered().len()],
            speeds: &zeros[..wheels.len()],
            steering_rates: None,
        };
        let mut readings = [Reading::NONE; MAX_WHEELS];
        let readings = rover.read(at_rest, &mut readings);
        let mut weights = vec![1.0; wheels.len()];
        let solution = match method {
            Method::LeastSquares | Method::Robust => solution,
            Method::MiddleWheels => {
                rover.estimate(readings, at_rest, method, unseen, &mut weights).ok()?;
                let normal = rover.normal(readings, |i| weights[i]);
                rover.solution(normal, unseen).ok()?
            }
        };
        let (rank, sigma_min) = rover.singular_values(readings, &weights);
        let forward = readings::ForwardConstants::weighted(rover, Some(solution), |i| weights[i])?;
        let robust = match method {
            Method::Robust => Some(robust::RobustConstants::new(rover, &forward)?),
            _ => None,
        };
        Some(Self { rover, method, unseen, forward, robust, weights, rank, sigma_min })
    }

    /// Fits every row.
    pub fn fit(&self, level: Level, log: Log<'_>, fits: &mut Fits<'_>) -> Result<(), Error> {
        let (joints, wheels) = (self.rover.steered().len(), self.weights.len());
        with_columns(joints + 4 * wheels, |columns| {
            if self.robust.is_none() {
                return level.run_any(Solve::<false> { plan: self, log, fits, columns, late: &mut [] });
            }
            with_columns(3 * wheels, |late| level.run_any(Solve::<true> { plan: self, log, fits, columns, late }))
        })
    }
}

/// Plain fits have a kernel of their own: beside the rounds of robust ones theirs took 14 % more instructions.
struct Solve<'a, 'b, const ROBUST: bool> {
    plan: &'a FitConstants<'a>,
    log: Log<'a>,
    fits: &'a mut Fits<'b>,
    /// One per steering angle; per wheel one for its speed and then its residual, one for its weight, two for what it reads.
    columns: &'a mut [Column],
    /// Per wheel one for its weight and two for what it reads, of robust fits that take long.
    late: &'a mut [Column],
}

impl<const ROBUST: bool> Kernel for Solve<'_, '_, ROBUST> {
    type Output = Result<(), Error>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Self::Output {
        let plan = self.plan;
        let (joints, wheels) = (plan.rover.steered().len(), plan.weights.len());
        let (readings, rest) = self.columns.split_at_mut(joints + wheels);
        let (weights, seen) = rest.split_at_mut(wheels);
        let mut twists = [Column::ZERO; 3];
        let mut sigmas = Column([plan.sigma_min; BLOCK]);
        for (weights, weight) in weights.iter_mut().zip(&plan.weights) {
            weights.0.fill(*weight);
        }
        let mut now = Block::new(seen.as_chunks_mut().0, weights);
        let (weights, seen) = self.late.split_at_mut(self.late.len() / 3);
        let mut late = SlowRows { block: Block::new(seen.as_chunks_mut().0, weights), rows: [0; BLOCK] };
        let rows = self.fits.twists.len();
        let mut done = Ok(());
        for first in (0..rows).step_by(BLOCK) {
            let count = BLOCK.min(rows - first);
            let at = first..first + count;
            let of_wheels = first * wheels..(first + count) * wheels;
            let log = self.log.rows(plan.rover, at.clone());
            let (by, heard) = (&plan.forward, plan.forward.load_readings(simd, log, readings));
            let mut sure = solve_block::<S, true>(simd, by, heard, &mut twists, &mut now.kept, log);
            // No longer needed: room for the residuals.
            let residuals = &mut readings[joints..];
            if let Some(robust) = plan.robust.as_ref().filter(|_| ROBUST) {
                now.begin(simd, robust, count);
                now.go_on(simd, robust, &EARLY);
                if late.block.left + now.left > BLOCK {
                    late.settle(simd, plan, self.log, self.fits, residuals)?;
                }
                for k in 0..now.left {
                    late.rows[late.block.left % BLOCK] = first + now.row(k);
                    late.block.take(&now, k);
                }
                sure = now.finish(simd, robust, count, &mut sigmas) && sure;
            }
            plan.results::<S, ROBUST>(simd, &now.kept, &mut twists, residuals);
            let target = self.fits.twists[at.clone()].as_flattened_mut();
            transpose_to_rows(simd, &twists, target);
            transpose_to_rows(simd, residuals, &mut self.fits.residual[of_wheels.clone()]);
            transpose_to_rows(simd, now.weights, &mut self.fits.weights[of_wheels]);
            self.fits.ranks[at.clone()].fill(plan.rank as i64);
            self.fits.sigmas[at].copy_from_slice(&sigmas.0[..count]);
            let mut doubts = (0..count).filter(|k| !sure && now.kept.doubts.0[*k] != 0.0);
            done = doubts.try_for_each(|k| plan.solve_row(self.log, first + k, self.fits));
            if done.is_err() {
                break;
            }
        }
        // A row before the one that failed may fail only now.
        if ROBUST {
            late.settle(simd, plan, self.log, self.fits, &mut readings[joints..])?;
        }
        done
    }
}

/// Rows of robust fits that take long, of many blocks.
struct SlowRows<'a> {
    block: Block<'a>,
    /// Their indices among all rows.
    rows: [usize; BLOCK],
}

impl SlowRows<'_> {
    /// Settles them and writes what they come to.
    #[inline(always)]
    fn settle<S: Vector>(
        &mut self,
        simd: S,
        plan: &FitConstants<'_>,
        log: Log<'_>,
        fits: &mut Fits<'_>,
        residuals: &mut [Column],
    ) -> Result<(), Error> {
        let (block, wheels) = (&mut self.block, plan.weights.len());
        let count = block.left;
        let Some(robust) = plan.robust.as_ref().filter(|_| count > 0) else {
            return Ok(());
        };
        let (mut twists, mut sigmas) = ([Column::ZERO; 3], Column::ZERO);
        block.go_on(simd, robust, &LATE);
        block.finish(simd, robust, count, &mut sigmas);
        block.left = 0;
        plan.results::<S, true>(simd, &block.kept, &mut twists, residuals);
        for (k, row) in self.rows.into_iter().enumerate().take(count) {
            if block.kept.doubts.0[k] != 0.0 {
                plan.solve_row(log, row, fits)?;
                continue;
            }
            fits.twists[row] = [0, 1, 2].map(|part: usize| twists[part].0[k]);
            (fits.ranks[row], fits.sigmas[row]) = (plan.rank as i64, sigmas.0[k]);
            let columns = [(&mut *fits.residual, &*residuals), (fits.weights, &*block.weights)];
            for (target, columns) in columns {
                for (number, column) in row_mut(target, wheels, row).iter_mut().zip(columns) {
                    *number = column.0[k];
                }
            }
        }
        Ok(())
    }
}

impl FitConstants<'_> {
    /// Residuals of a block, and of robust fits the twists.
    #[inline(always)]
    fn results<S: Vector, const ROBUST: bool>(
        &self,
        simd: S,
        kept: &FitColumns<'_>,
        twists: &mut [Column; 3],
        residuals: &mut [Column],
    ) {
        for k in 0..BLOCK / S::F64_LANES {
            let unknowns = load(simd, &kept.unknowns, k);
            if ROBUST {
                let parts = self.forward.unshifted(unknowns);
                for (column, part) in twists.iter_mut().zip(parts) {
                    column.store(k, part);
                }
            }
            let columns = kept.seen.iter().zip(residuals.iter_mut());
            for (wheel, ([u, v], residual)) in self.forward.wheels.iter().zip(columns) {
                let seen = [u.load(simd, k), v.load(simd, k)];
                residual.store(k, wheel.square(simd, seen, unknowns).sqrt());
            }
        }
    }

    /// One row in the plain core.
    fn solve_row(&self, log: Log<'_>, row: usize, fits: &mut Fits<'_>) -> Result<(), Error> {
        let measured = log.row(self.rover, row);
        let solve = |residual: &mut [f64], weights: &mut [f64]| {
            let (method, unseen) = (self.method, self.unseen);
            self.rover.fit(measured, method, unseen, residual, weights)
        };
        let solved = fits.one(row, self.weights.len(), solve);
        solved.map_err(|error| error.at_row(row))
    }
}

impl Rows {
    /// Contribution of the wheel to the right-hand side of the normal equations.
    #[inline(always)]
    pub fn moment<S: Vector>(&self, simd: S, seen: [Lanes<S>; 2]) -> [Lanes<S>; 3] {
        let mut moment = [seen[0]; 3];
        for (part, moment) in moment.iter_mut().enumerate() {
            let across = seen[1] * Lanes::splat(simd, self.rows[1][part]);
            *moment = seen[0].mul_add(Lanes::splat(simd, self.rows[0][part]), across);
        }
        moment
    }

    /// Half the slope of its squared residual.
    #[inline(always)]
    pub fn slope<S: Vector>(&self, simd: S, seen: [Lanes<S>; 2], unknowns: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
        self.moment(simd, self.residuals(simd, seen, unknowns))
    }

    /// Residuals of the wheel's two readings, predicted minus measured [m/s].
    #[inline(always)]
    fn residuals<S: Vector>(&self, simd: S, seen: [Lanes<S>; 2], unknowns: [Lanes<S>; 3]) -> [Lanes<S>; 2] {
        [dot(simd, &self.rows[0], unknowns) - seen[0], dot(simd, &self.rows[1], unknowns) - seen[1]]
    }

    /// Its squared residual.
    #[inline(always)]
    pub fn square<S: Vector>(&self, simd: S, seen: [Lanes<S>; 2], unknowns: [Lanes<S>; 3]) -> Lanes<S> {
        let [along, across] = self.residuals(simd, seen, unknowns);
        along.mul_add(along, across * across)
    }
}
