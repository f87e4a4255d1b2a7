//! Twists with the residuals of the wheels. Where the least squares have a constant solution, whole registers of rows are
//! fitted: a steered wheel without scrub and trail measures its pivot's whole velocity, whichever way it points, so that rank
//! and smallest singular value are constants of the rover. Robust fits start from there.

use super::normal_equations::{ForwardConstants, LARGEST_SPEED};
use super::readings::{FitColumns, ReadingColumns, solve_block};
use super::robust::{Block, EARLY, LATE, RobustConstants};
use super::safe_range::all_within;
use crate::estimate::{Measured, Method, Reading, Unseen};
use crate::rover_data::{MAX_WHEELS, RoverData};
use crate::table::{Log, row_mut};
use six_wheel_numerics::columns::{BLOCK, Column, load, store, transpose_to_rows, with_columns};
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::level::{Kernel, Level};
use six_wheel_numerics::simd::vector::Vector;

/// Constants of a rover and a method for fits.
#[derive(Clone, Debug)]
pub(crate) struct FitConstants {
    method: Method,
    unseen: Unseen,
    /// None where the equations depend on the readings, or sizes are extreme.
    block: Option<BlockConstants>,
    /// Without a `block`, least squares take the twist of the forward kinematics, to the bit.
    forward: Option<ForwardConstants>,
}

/// Constants of whole registers of rows.
#[derive(Clone, Debug)]
struct BlockConstants {
    forward: ForwardConstants,
    robust: Option<RobustConstants>,
    /// Initial weights of the wheels, 1 or 0.
    weights: Vec<f64>,
    rank: usize,
    sigma_min: f64,
}

/// Output of fits, one row per reading: see [`crate::estimate::Fit`], and a number per wheel.
pub struct Fits<'a> {
    /// Estimates.
    pub twists: &'a mut [[f64; 3]],
    /// Numbers of independent directions.
    pub ranks: &'a mut [i64],
    /// Smallest singular values.
    pub sigmas: &'a mut [f64],
    /// Residuals [m/s].
    pub residual: &'a mut [f64],
    /// Weight of each wheel, 0 to 1.
    pub weights: &'a mut [f64],
}

impl BlockConstants {
    fn new(rover: &RoverData, method: Method, unseen: Unseen) -> Option<Self> {
        let mut solution = rover.solution?;
        let (wheels, zeros) = (rover.wheels(), [0.0; MAX_WHEELS]);
        let at_rest = Measured { steering: &zeros, speeds: &zeros, steering_rates: None };
        let mut readings = [Reading::NONE; MAX_WHEELS];
        let readings = rover.read(at_rest, &mut readings);
        let mut weights = vec![1.0; wheels.len()];
        if method == Method::MiddleWheels {
            rover.initial_weights(method, &mut weights).ok()?;
            solution = rover.solution(rover.normal(readings, |i| weights[i]), unseen).ok()?;
        }
        let (rank, sigma_min) = rover.singular_values(readings, &weights);
        let forward = ForwardConstants::weighted(rover, Some(solution), |i| weights[i]);
        let robust = match method {
            Method::Robust => Some(RobustConstants::new(rover, &forward)?),
            _ => None,
        };
        forward.is_regular.then_some(Self { forward, robust, weights, rank, sigma_min })
    }
}

impl FitConstants {
    /// The constants of a rover.
    pub fn new(rover: &RoverData, method: Method, unseen: Unseen) -> Self {
        let block = BlockConstants::new(rover, method, unseen);
        let has_forward = block.is_none() && method == Method::LeastSquares;
        Self { method, unseen, block, forward: has_forward.then(|| ForwardConstants::new(rover)) }
    }

    /// Fits every row.
    pub fn fit(&self, level: Level, rover: &RoverData, log: Log<'_>, fits: &mut Fits<'_>) -> Result<(), Error> {
        let Some(constants) = &self.block else {
            return (0..fits.twists.len()).try_for_each(|k| self.solve_row(rover, log, k, fits));
        };
        let input = FitInput { fit: self, constants, rover };
        let (joints, wheels) = (rover.steered().len(), constants.weights.len());
        with_columns(joints + 4 * wheels, |columns| {
            if constants.robust.is_none() {
                return level.run_any(Solve::<false> { input, log, fits, columns, late: &mut [] });
            }
            with_columns(3 * wheels, |late| level.run_any(Solve::<true> { input, log, fits, columns, late }))
        })
    }

    /// One row on its own.
    fn solve_row(&self, rover: &RoverData, log: Log<'_>, row: usize, fits: &mut Fits<'_>) -> Result<(), Error> {
        let measured = log.row(rover, row);
        let wheels = rover.wheels().len();
        let (residual, weights) = (row_mut(fits.residual, wheels, row), row_mut(fits.weights, wheels, row));
        let fit = rover.fit_rarely(measured, (self.method, self.unseen), residual, weights);
        let fit = fit.map_err(|error| error.at_row(row))?;
        fits.twists[row] = match &self.forward {
            Some(forward) => forward.solve_row(rover, measured, self.unseen)?.into(),
            None => fit.twist.into(),
        };
        (fits.ranks[row], fits.sigmas[row]) = (fit.rank as i64, fit.sigma_min);
        Ok(())
    }
}

/// Constants of whole registers and of rare rows, and the rover.
#[derive(Clone, Copy)]
struct FitInput<'a> {
    fit: &'a FitConstants,
    constants: &'a BlockConstants,
    rover: &'a RoverData,
}

/// Kernel of fits. Those that are not robust are compiled on their own: in one kernel with the rounds of robust ones
/// they took 14 % more instructions.
struct Solve<'a, 'b, const ROBUST: bool> {
    input: FitInput<'a>,
    log: Log<'a>,
    fits: &'a mut Fits<'b>,
    /// One per steering angle; per wheel one for its speed and then its residual, one for its weight, two for its
    /// readings along its rows.
    columns: &'a mut [Column],
    /// Per wheel one for its weight and two for its readings, for rows of robust fits that need many rounds.
    late: &'a mut [Column],
}

impl<const ROBUST: bool> Kernel for Solve<'_, '_, ROBUST> {
    type Output = Result<(), Error>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Self::Output {
        let FitInput { fit, constants, rover } = self.input;
        let (joints, wheels) = (rover.steered().len(), constants.weights.len());
        let (readings, rest) = self.columns.split_at_mut(joints + wheels);
        let (weights, kept) = rest.split_at_mut(wheels);
        let mut twists = [Column::ZERO; 3];
        let mut sigmas = Column([constants.sigma_min; BLOCK]);
        for (weights, weight) in weights.iter_mut().zip(&constants.weights) {
            weights.0.fill(*weight);
        }
        let mut now = Block::new(kept.as_chunks_mut().0, weights);
        let (weights, kept) = self.late.split_at_mut(self.late.len() / 3);
        let mut late = SlowRows { block: Block::new(kept.as_chunks_mut().0, weights), rows: [0; BLOCK] };
        let rows = self.fits.twists.len();
        let mut done = Ok(());
        for first in (0..rows).step_by(BLOCK) {
            let count = BLOCK.min(rows - first);
            let at = first..first + count;
            let of_wheels = first * wheels..(first + count) * wheels;
            let log = self.log.rows(rover, at.clone());
            let (forward, kept) = (&constants.forward, &mut now.kept);
            let columns = ReadingColumns::load(simd, forward, log, readings);
            let mut none_rare = solve_block::<S, true>(simd, forward, (columns, count), &mut twists, kept, log);
            if !all_within(simd, log.steering_rates.unwrap_or_default(), LARGEST_SPEED) {
                (none_rare, kept.rare) = (false, Column([1.0; BLOCK]));
            }
            // The speeds are no longer needed: their columns take the residuals.
            let residuals = &mut readings[joints..];
            if let Some(robust) = constants.robust.as_ref().filter(|_| ROBUST) {
                now.begin(simd, robust, count);
                now.iterate(simd, robust, &EARLY);
                if late.block.left + now.left > BLOCK {
                    late.settle(simd, self.input, self.log, self.fits, residuals)?;
                }
                for k in 0..now.left {
                    late.rows[late.block.left % BLOCK] = first + now.row(k);
                    late.block.take(&now, k);
                }
                none_rare = now.finish(simd, robust, count, &mut sigmas) && none_rare;
            }
            constants.results::<S, ROBUST>(simd, count, &now.kept, &mut twists, residuals);
            let target = self.fits.twists[at.clone()].as_flattened_mut();
            transpose_to_rows(simd, &twists, target);
            transpose_to_rows(simd, residuals, &mut self.fits.residual[of_wheels.clone()]);
            transpose_to_rows(simd, now.weights, &mut self.fits.weights[of_wheels]);
            self.fits.ranks[at.clone()].fill(constants.rank as i64);
            self.fits.sigmas[at].copy_from_slice(&sigmas.0[..count]);
            let mut rare = (0..count).filter(|k| !none_rare && now.kept.rare.0[*k] != 0.0);
            done = rare.try_for_each(|k| fit.solve_row(rover, self.log, first + k, self.fits));
            if done.is_err() {
                break;
            }
        }
        // A row before the one that failed may fail here, and its error counts.
        if ROBUST {
            late.settle(simd, self.input, self.log, self.fits, &mut readings[joints..])?;
        }
        done
    }
}

/// Rows of many blocks whose robust fits need many rounds.
struct SlowRows<'a> {
    block: Block<'a>,
    /// Their indices among all rows.
    rows: [usize; BLOCK],
}

impl SlowRows<'_> {
    /// Iterates the rows until they have converged and writes the results.
    #[inline(always)]
    fn settle<S: Vector>(
        &mut self,
        simd: S,
        FitInput { fit, constants, rover }: FitInput<'_>,
        log: Log<'_>,
        fits: &mut Fits<'_>,
        residuals: &mut [Column],
    ) -> Result<(), Error> {
        let (block, wheels) = (&mut self.block, constants.weights.len());
        let count = block.left;
        let Some(robust) = constants.robust.as_ref().filter(|_| count > 0) else {
            return Ok(());
        };
        let (mut twists, mut sigmas) = ([Column::ZERO; 3], Column::ZERO);
        block.iterate(simd, robust, &LATE);
        block.finish(simd, robust, count, &mut sigmas);
        block.left = 0;
        constants.results::<S, true>(simd, count, &block.kept, &mut twists, residuals);
        for (k, row) in self.rows.into_iter().enumerate().take(count) {
            if block.kept.rare.0[k] != 0.0 {
                fit.solve_row(rover, log, row, fits)?;
                continue;
            }
            fits.twists[row] = [0, 1, 2].map(|part: usize| twists[part].0[k]);
            (fits.ranks[row], fits.sigmas[row]) = (constants.rank as i64, sigmas.0[k]);
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

impl BlockConstants {
    /// Residuals of the first `count` rows of a block, and of robust fits the twists.
    #[inline(always)]
    fn results<S: Vector, const ROBUST: bool>(
        &self,
        simd: S,
        count: usize,
        kept: &FitColumns<'_>,
        twists: &mut [Column; 3],
        residuals: &mut [Column],
    ) {
        for k in 0..count.min(BLOCK).div_ceil(S::F64_LANES) {
            let unknowns = load(simd, &kept.unknowns, k);
            if ROBUST {
                store(self.forward.twist_at_origin(unknowns), twists, k);
            }
            let columns = kept.readings.iter().zip(residuals.iter_mut());
            for (wheel, ([u, v], residual)) in self.forward.wheels.iter().zip(columns) {
                let readings = [u.load(simd, k), v.load(simd, k)];
                residual.store(k, wheel.rows.square(simd, readings, unknowns).sqrt());
            }
        }
    }
}
