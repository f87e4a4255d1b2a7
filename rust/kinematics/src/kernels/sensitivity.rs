//! Derivatives of the twist of whole registers of readings.
//!
//! They are sums of products of the readings with constants of the rover: see [`crate::estimate::gradients`].

use super::normal_equations::{ForwardConstants, LARGEST_SPEED, solve};
use super::readings::{FitColumns, ReadingColumns, solve_block};
use super::safe_range::all_within;
use crate::estimate::gradients::{GIVEN, Gradients, PRODUCTS, Sum};
use crate::estimate::sensitivity::{LinearisedFit, Quantity};
use crate::estimate::{Measured, Method, Reading, Unseen};
use crate::rover_data::{MAX_WHEELS, Mount, RoverData};
use crate::table::{Log, row_mut};
use six_wheel_numerics::columns::{BLOCK, Column, store, transpose_tiles_to_rows, transpose_to_rows};
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::Kernel;
use six_wheel_numerics::simd::polynomials::sin_cos;
use six_wheel_numerics::simd::vector::Vector;

/// Registers in lockstep.
const QUAD: usize = 4;

/// A quantity, the wheels with a derivative by it, and the output of these: three rows of wheels for every row of
/// readings.
pub(crate) type Target<'a> = (Quantity, &'a [usize], &'a mut [f64]);

/// Input and output of the sensitivities of a log.
pub(crate) struct SensitivityQuery<'a, 'b> {
    pub rover: &'a RoverData,
    pub constants: &'a ForwardConstants,
    pub log: Log<'a>,
    pub twists: &'a mut [[f64; 3]],
    pub targets: &'a mut [Target<'b>],
    /// The products of each target.
    pub gradients: &'a [&'a Gradients],
}

impl Kernel for SensitivityQuery<'_, '_> {
    type Output = Result<(), Error>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Self::Output {
        let (rover, constants) = (self.rover, self.constants);
        let (joints, wheels) = (rover.steered().len(), rover.wheels().len());
        let readings = wheels + self.log.steering_rates.map_or(joints, |_| 2 * joints);
        // Allocated once for all rows.
        let mut memory = vec![Column::ZERO; readings + 3 * wheels];
        let (readings, derivatives) = memory.split_at_mut(readings);
        let mut products = vec![[simd.splat_f64s(0.0); QUAD]; PRODUCTS * wheels];
        let turning = self.log.steering_rates.is_some();
        let mut twists = [Column::ZERO; 3];
        let mut kept = FitColumns::new(&mut []);
        let mut inverse = [Column::ZERO; 9];
        for first in (0..self.twists.len()).step_by(BLOCK) {
            let end = self.twists.len().min(first + BLOCK);
            let log = self.log.rows(rover, first..end);
            let columns = ReadingColumns::load(simd, constants, log, readings);
            let mut none_rare = solve_block::<S, false>(simd, constants, (columns, BLOCK), &mut twists, &mut kept, log);
            let rates = log.steering_rates.unwrap_or_default();
            if !all_within(simd, rates, LARGEST_SPEED) {
                (none_rare, kept.rare) = (false, Column([1.0; BLOCK]));
            }
            transpose_to_rows(simd, &twists, self.twists[first..end].as_flattened_mut());
            for quad in (0..BLOCK / S::F64_LANES).step_by(QUAD) {
                let rows = first + quad * S::F64_LANES..end.min(first + (quad + QUAD) * S::F64_LANES);
                if rows.is_empty() {
                    break;
                }
                multiply(simd, rover, columns, &twists, quad, &mut products);
                if constants.solution.is_none() {
                    invert(simd, constants, columns.steering, quad, &mut inverse);
                }
                for ((_, of, target), gradients) in self.targets.iter_mut().zip(self.gradients) {
                    let width = of.len();
                    for (column, &i) in of.iter().enumerate() {
                        let products = &products[PRODUCTS * i..PRODUCTS * (i + 1)];
                        let sums = gradients.of(i, turning);
                        let mut derivative = summed(simd, sums, products);
                        if constants.solution.is_none() {
                            derivative = product(simd, &derivative, &inverse);
                        }
                        for (part, registers) in derivative.iter().enumerate() {
                            for (k, register) in registers.iter().enumerate() {
                                derivatives[part * width + column].store(k, *register);
                            }
                        }
                    }
                    let (derivatives, width) = (&derivatives[..3 * width], 3 * width);
                    let rows = &mut target[rows.start * width..rows.end * width];
                    transpose_tiles_to_rows(simd, derivatives, rows);
                }
            }
            for k in (0..end - first).filter(|k| !none_rare && kept.rare.0[*k] != 0.0) {
                let (twist, targets) = (&mut self.twists[first + k], &mut *self.targets);
                let done = write_row(rover, log, k, first + k, twist, targets);
                done.map_err(|error| error.at_row(first + k))?;
            }
        }
        Ok(())
    }
}

/// Writes the derivatives of row `k` of the log to row `to` of the targets, by its own equations.
pub(crate) fn write_row(
    rover: &RoverData,
    log: Log<'_>,
    k: usize,
    to: usize,
    twist: &mut [f64; 3],
    targets: &mut [Target<'_>],
) -> Result<(), Error> {
    rover.sensitivity(log.row(rover, k), |linearised| {
        *twist = linearised.twist().into();
        for (quantity, of, target) in targets {
            let target = row_mut(target, 3 * of.len(), to);
            for (column, wheel) in of.iter().enumerate() {
                let derivative = linearised.derivative(*wheel, *quantity);
                for (row, value) in derivative.iter().enumerate() {
                    target[row * of.len() + column] = *value;
                }
            }
        }
    })
}

impl RoverData {
    /// Calls `evaluate` with the linearised fit of one instant's readings, all wheels with weight 1.
    pub fn sensitivity<T>(
        &self,
        measured: Measured<'_>,
        evaluate: impl FnOnce(&LinearisedFit<'_>) -> T,
    ) -> Result<T, Error> {
        self.check_readings(measured)?;
        let mut readings = [Reading::NONE; MAX_WHEELS];
        let readings = self.read(measured, &mut readings);
        let solution = self.solution_for(readings, measured, Unseen::Refuse)?;
        let mut weights = [1.0; MAX_WHEELS];
        let twist = self.estimate(readings, measured, Method::LeastSquares, Unseen::Refuse, &mut weights, &mut [])?;
        Ok(evaluate(&LinearisedFit { rover: self, readings, measured, solution, twist: twist.into(), weights: None }))
    }
}

/// The products of every wheel, of four registers from `quad` on.
#[inline(always)]
fn multiply<S: Vector>(
    simd: S,
    rover: &RoverData,
    columns: ReadingColumns<'_>,
    twists: &[Column; 3],
    quad: usize,
    products: &mut [[S::f64s; QUAD]],
) {
    let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let [vx, vy, omega] = twists;
    let mut joint = 0;
    for (i, products) in products.chunks_exact_mut(PRODUCTS).enumerate() {
        let is_steered = matches!(rover.mounts[i], Mount::Steered(..));
        for k in 0..QUAD {
            let at = quad + k;
            let given = [
                one,
                vx.load(simd, at),
                vy.load(simd, at),
                omega.load(simd, at),
                columns.speeds[i].load(simd, at),
                match columns.rates.get(joint) {
                    Some(rate) => rate.load(simd, at),
                    None => zero,
                },
            ];
            for (product, given) in products.iter_mut().zip(given) {
                given.store(product, k);
            }
            if is_steered {
                let heading = Lanes::splat(simd, rover.wheels()[i].heading);
                let (sin, cos) = sin_cos(simd, columns.steering[joint].load(simd, at) + heading);
                for (g, given) in given.into_iter().enumerate() {
                    (cos * given).store(&mut products[GIVEN + g], k);
                    (sin * given).store(&mut products[2 * GIVEN + g], k);
                }
            }
        }
        joint += usize::from(is_steered);
    }
}

/// Matrices that map gradients to twists, of four registers from `quad` on.
#[inline(always)]
fn invert<S: Vector>(
    simd: S,
    constants: &ForwardConstants,
    steering: &[Column],
    quad: usize,
    inverse: &mut [Column; 9],
) {
    let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    for k in 0..QUAD {
        let normal = constants.normal(simd, steering, quad + k);
        let mut unit = [one, zero, zero];
        for column in inverse.as_chunks_mut::<3>().0 {
            let (unknowns, _) = solve(simd, normal, unit);
            store(constants.twist_at_origin(unknowns), column, k);
            let [x, y, z] = unit;
            unit = [z, x, y];
        }
    }
}

/// Sums of products in four registers.
#[inline(always)]
fn summed<S: Vector>(simd: S, sums: &[Sum; 3], products: &[[S::f64s; QUAD]]) -> [[Lanes<S>; QUAD]; 3] {
    let mut parts = [[Lanes::splat(simd, 0.0); QUAD]; 3];
    for (part, sum) in parts.iter_mut().zip(sums) {
        for (place, share) in sum {
            let share = Lanes::splat(simd, *share);
            for (k, part) in part.iter_mut().enumerate() {
                *part = Lanes::load(simd, &products[*place], k).mul_add(share, *part);
            }
        }
    }
    parts
}

/// Product of the inverse and a gradient.
#[inline(always)]
fn product<S: Vector>(simd: S, gradient: &[[Lanes<S>; QUAD]; 3], inverse: &[Column; 9]) -> [[Lanes<S>; QUAD]; 3] {
    let mut derivative = [[Lanes::splat(simd, 0.0); QUAD]; 3];
    for (gradient, inverse) in gradient.iter().zip(inverse.as_chunks::<3>().0) {
        for (derivative, inverse) in derivative.iter_mut().zip(inverse) {
            for (k, part) in derivative.iter_mut().enumerate() {
                *part = inverse.load(simd, k).mul_add(gradient[k], *part);
            }
        }
    }
    derivative
}
