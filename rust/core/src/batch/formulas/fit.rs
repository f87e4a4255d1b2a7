//! Twists with the residuals of the wheels, where the least squares have a constant solution: every wheel alike, or the
//! unsteered ones alone. Rank and smallest singular value are constants of the rover then, because a steered wheel without
//! scrub and trail measures its pivot's whole velocity, whichever way it points. Robust fits start from there.

#[cfg(test)]
mod tests;

use super::inverse::all_within;
use super::{forward, robust};
use crate::batch::machine::lanes::Lanes;
use crate::batch::machine::level::{Kernel, Level};
use crate::batch::machine::polynomials::{LARGEST_ANGLE, sin_cos};
use crate::batch::machine::table::{Log, row, row_mut};
use crate::batch::machine::vector::Vector;
use crate::batch::machine::weave::{BLOCK, Column, unweave, weave, with_columns};
use crate::error::Error;
use crate::estimate::{Fit, Measured, Method, Reading, Unseen};
use crate::rover::{MAX_WHEELS, Mount, Rover};

/// What a wheel disagrees by is the length of two products with the twist, less what it rolled along the first.
#[derive(Clone, Copy, Debug)]
enum Part {
    /// Rolling and side-slip row.
    Fixed([[f64; 3]; 2]),
    /// Place of the pivot [m] and direction at steering angle 0 [rad].
    Steered { pivot: [f64; 2], heading: f64 },
    /// It measures nothing.
    Castor,
}

/// What the kernel needs to know of a rover and a method.
pub(crate) struct Plan<'a> {
    rover: &'a Rover,
    method: Method,
    unseen: Unseen,
    forward: forward::Plan<'a>,
    parts: Vec<(Part, f64)>,
    weights: Vec<f64>,
    rank: usize,
    sigma_min: f64,
    robust: Option<robust::Plan>,
}

/// Where the results go, one row per reading: see [`Fit`], and a number per wheel.
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
    pub(in crate::batch) fn one(
        &mut self,
        k: usize,
        wheels: usize,
        solve: impl FnOnce(&mut [f64], &mut [f64]) -> Result<Fit, Error>,
    ) -> Result<(), Error> {
        let (residual, weights) = (
            row_mut(self.residual, wheels, k),
            row_mut(self.weights, wheels, k),
        );
        let fit = solve(residual, weights)?;
        self.twists[k] = fit.twist.into();
        (self.ranks[k], self.sigmas[k]) = (fit.rank as i64, fit.sigma_min);
        Ok(())
    }
}

impl<'a> Plan<'a> {
    /// Nothing where the solution depends on the readings.
    pub fn new(rover: &'a Rover, method: Method, unseen: Unseen) -> Option<Self> {
        let solution = rover.solution?;
        let zeros = [0.0; MAX_WHEELS];
        let wheels = rover.wheels();
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
                rover
                    .estimate(readings, at_rest, method, unseen, &mut weights)
                    .ok()?;
                let normal = rover.normal(readings, |i| weights[i]);
                rover.solution(normal, unseen).ok()?
            }
        };
        let robust = match method {
            Method::Robust => Some(robust::Plan::new(rover, &solution)?),
            _ => None,
        };
        let (rank, sigma_min) = rover.singular_values(readings, &weights);
        let part = |(wheel, mount): (&crate::Wheel, &Mount)| {
            let part = match *mount {
                Mount::Castor(_) => Part::Castor,
                Mount::Fixed(rows) => Part::Fixed([rows.rolling.into(), rows.side_slip.into()]),
                Mount::Steered(..) => Part::Steered {
                    pivot: [wheel.x, wheel.y],
                    heading: wheel.heading,
                },
            };
            (part, wheel.radius)
        };
        Some(Self {
            rover,
            method,
            unseen,
            forward: forward::Plan::weighted(rover, solution, |i| weights[i])?,
            parts: wheels.iter().zip(&rover.mounts).map(part).collect(),
            weights,
            rank,
            sigma_min,
            robust,
        })
    }

    /// Fits every row; nothing where the level has no kernels.
    pub fn fit(
        &self,
        level: Level,
        log: Log<'_>,
        fits: &mut Fits<'_>,
    ) -> Option<Result<(), Error>> {
        let joints = self.rover.steered().len();
        with_columns(joints + 3 * self.parts.len(), |columns| {
            level.run(Solve {
                plan: self,
                log,
                fits,
                columns,
            })
        })
    }
}

struct Solve<'a, 'b> {
    plan: &'a Plan<'a>,
    log: Log<'a>,
    fits: &'a mut Fits<'b>,
    /// One per steering angle, and one per speed, residual and weight.
    columns: &'a mut [Column],
}

impl Kernel for Solve<'_, '_> {
    type Output = Result<(), Error>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Self::Output {
        let (plan, log) = (self.plan, self.log);
        let (joints, wheels) = (plan.rover.steered().len(), plan.parts.len());
        let (steering, rest) = self.columns.split_at_mut(joints);
        let (speeds, rest) = rest.split_at_mut(wheels);
        let (residuals, says) = rest.split_at_mut(wheels);
        let mut twists = [Column::ZERO; 3];
        for (says, weight) in says.iter_mut().zip(&plan.weights) {
            says.0.fill(*weight);
        }
        let rows = self.fits.twists.len();
        for first in (0..rows).step_by(BLOCK) {
            let count = BLOCK.min(rows - first);
            let at = first..first + count;
            let of_wheels = first * wheels..(first + count) * wheels;
            let rows = [
                &log.steering[first * joints..(first + count) * joints],
                &log.speeds[first * wheels..(first + count) * wheels],
            ];
            unweave(simd, rows[0], steering);
            unweave(simd, rows[1], speeds);
            let [mut sigmas, mut doubts] = [Column([plan.sigma_min; BLOCK]), Column::ZERO];
            let mut sure = true;
            if let Some(robust) = &plan.robust {
                let mut found = robust::Found {
                    twists: &mut twists,
                    residuals,
                    weights: says,
                    sigma_min: &mut sigmas,
                    doubts: &mut doubts,
                };
                sure = robust::solve_block(simd, robust, steering, speeds, count, &mut found);
            } else {
                forward::solve_block(simd, &plan.forward, steering, speeds, &mut twists, rows);
                disagree(simd, plan, steering, speeds, &twists, residuals);
            }
            weave(
                simd,
                &twists,
                self.fits.twists[at.clone()].as_flattened_mut(),
            );
            weave(simd, residuals, &mut self.fits.residual[of_wheels.clone()]);
            weave(simd, says, &mut self.fits.weights[of_wheels]);
            self.fits.ranks[at.clone()].fill(plan.rank as i64);
            self.fits.sigmas[at].copy_from_slice(&sigmas.0[..count]);
            let usual = sure
                && all_within(simd, rows[0], LARGEST_ANGLE / 2.0)
                && all_within(simd, rows[1], forward::LARGEST_SPEED);
            if usual {
                continue;
            }
            for (k, doubt) in doubts.0.iter().enumerate().take(count) {
                let measured = Measured {
                    steering: row(rows[0], joints, k),
                    speeds: row(rows[1], wheels, k),
                    steering_rates: None,
                };
                let within =
                    |values: &[f64], largest| values.iter().all(|value| value.abs() <= largest);
                if *doubt == 0.0
                    && within(measured.steering, LARGEST_ANGLE / 2.0)
                    && within(measured.speeds, forward::LARGEST_SPEED)
                {
                    continue;
                }
                let solve = |residual: &mut [f64], weights: &mut [f64]| {
                    let (method, unseen) = (plan.method, plan.unseen);
                    plan.rover.fit(measured, method, unseen, residual, weights)
                };
                let solved = self.fits.one(first + k, wheels, solve);
                solved.map_err(|error| error.at_row(first + k))?;
            }
        }
        Ok(())
    }
}

/// Residuals of a block.
#[inline(always)]
fn disagree<S: Vector>(
    simd: S,
    plan: &Plan<'_>,
    steering: &[Column],
    speeds: &[Column],
    twists: &[Column; 3],
    residuals: &mut [Column],
) {
    let splat = |number| Lanes::splat(simd, number);
    let mut joint = 0;
    for (((part, radius), speeds), residuals) in plan.parts.iter().zip(speeds).zip(residuals) {
        let steering = steering.get(joint);
        for k in 0..BLOCK / S::F64_LANES {
            let twist = super::steered::load(simd, twists, k);
            let rolled = speeds.load(simd, k) * splat(*radius);
            let [along, across] = match (*part, steering) {
                (Part::Fixed(rows), _) => rows.map(|row| super::cone::dot(simd, &row, twist)),
                (Part::Steered { pivot, heading }, Some(steering)) => {
                    let [vx, vy, omega] = twist;
                    let ux = vx - omega * splat(pivot[1]);
                    let uy = vy + omega * splat(pivot[0]);
                    let (sin, cos) = sin_cos(simd, steering.load(simd, k) + splat(heading));
                    [cos * ux + sin * uy, cos * uy - sin * ux]
                }
                _ => [rolled, splat(0.0)],
            };
            let along = along - rolled;
            residuals.store(k, along.mul_add(along, across * across).sqrt());
        }
        if matches!(part, Part::Steered { .. }) {
            joint += 1;
        }
    }
}
