//! Forward kinematics of whole registers of readings, for rovers whose least squares have a constant solution.

use std::ops::Range;

use nalgebra::Matrix3;

use super::inverse::all_within;
use crate::batch::machine::lanes::{Lanes, Mask};
use crate::batch::machine::level::{Kernel, Level};
use crate::batch::machine::polynomials::{LARGEST_ANGLE, sin_cos};
use crate::batch::machine::stream::{Output, fetch_ahead};
use crate::batch::machine::table::{Log, row};
use crate::batch::machine::vector::Vector;
use crate::batch::machine::weave::{BLOCK, Column, unweave, weave, with_columns};
use crate::error::Error;
use crate::estimate::{Measured, Unseen};
use crate::rover::{Mount, Rover};
use crate::wheels::Wheel;

/// Speeds up to here surely make a finite twist [rad/s]. NaN, of a wheel without encoder, is not one.
pub(in crate::batch) const LARGEST_SPEED: f64 = 1e100;

/// Bound of what the rover multiplies readings by.
pub(in crate::batch) const LARGEST_ROVER: f64 = 1e100;

/// What one wheel adds to the right-hand side of the normal equations.
#[derive(Clone, Copy, Debug)]
enum Part {
    /// A constant row times the speed.
    Fixed([f64; 3]),
    /// The rim velocity `radius * speed * (cos, sin)` and its moment about the centre.
    Steered {
        heading: f64,
        radius: f64,
        arm: [f64; 2],
    },
    /// It is steered and has no say.
    Unheard,
    /// It measures nothing.
    Castor,
}

/// What the kernel needs to know of a rover.
pub(crate) struct Plan<'a> {
    rover: &'a Rover,
    parts: Vec<Part>,
    joints: usize,
    /// From the right-hand side to the twist.
    solution: [[f64; 3]; 3],
}

impl<'a> Plan<'a> {
    /// Nothing where the solution depends on the readings.
    pub fn new(rover: &'a Rover) -> Option<Self> {
        Self::weighted(rover, rover.solution?, |_| 1.0)
    }

    /// Wheels with a say of 1 or 0, and the solution of their normal equations.
    pub fn weighted(
        rover: &'a Rover,
        solution: Matrix3<f64>,
        weight: impl Fn(usize) -> f64,
    ) -> Option<Self> {
        let turned = |wheel: &Wheel| wheel.heading.abs() > LARGEST_ANGLE / 2.0;
        if rover.reading_bound > LARGEST_ROVER || rover.wheels().iter().any(turned) {
            return None;
        }
        let (size, centre) = (rover.size, rover.centre);
        let part = |(i, (wheel, mount)): (usize, (&Wheel, &Mount))| match *mount {
            Mount::Steered(..) if weight(i) == 0.0 => Part::Unheard,
            _ if weight(i) == 0.0 => Part::Castor,
            Mount::Castor(_) => Part::Castor,
            Mount::Fixed(rows) => Part::Fixed((rover.shifted(&rows.rolling) * wheel.radius).into()),
            Mount::Steered(..) => Part::Steered {
                heading: wheel.heading,
                radius: wheel.radius,
                arm: [(wheel.x - centre.x) / size, (wheel.y - centre.y) / size],
            },
        };
        // Back from the scaled unknowns about the centre of the pivots to the twist.
        let omega = solution.row(2) / size;
        let rows = [
            solution.row(0) + omega * centre.y,
            solution.row(1) - omega * centre.x,
            omega,
        ];
        Some(Self {
            rover,
            parts: (rover.wheels().iter().zip(&rover.mounts).enumerate())
                .map(part)
                .collect(),
            joints: rover.steered().len(),
            solution: rows.map(|row| [row.x, row.y, row.z]),
        })
    }

    /// Fails at the first row that cannot be read.
    pub fn check(
        &self,
        level: Level,
        log: Log<'_>,
        rows: Range<usize>,
        unseen: Unseen,
    ) -> Result<(), Error> {
        let check = Check {
            plan: self,
            log,
            rows,
            unseen,
        };
        level.run(check).unwrap_or(Ok(()))
    }

    /// Solves rows that have been checked; `past` the caches, if what is written does not fit in.
    pub fn solve(
        &self,
        level: Level,
        log: Log<'_>,
        unseen: Unseen,
        twists: &mut [[f64; 3]],
        past: bool,
    ) -> Result<(), Error> {
        with_columns(self.joints + self.parts.len(), |columns| {
            let solve = Solve {
                plan: self,
                log,
                unseen,
                twists,
                past,
                columns,
            };
            level.run(solve).unwrap_or(Ok(()))
        })
    }

    /// What the plain core reads of a row.
    fn measured<'l>(&self, log: Log<'l>, k: usize) -> Measured<'l> {
        Measured {
            steering: row(log.steering, self.joints, k),
            speeds: row(log.speeds, self.parts.len(), k),
            steering_rates: None,
        }
    }
}

struct Check<'a> {
    plan: &'a Plan<'a>,
    log: Log<'a>,
    rows: Range<usize>,
    unseen: Unseen,
}

impl Kernel for Check<'_> {
    type Output = Result<(), Error>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Self::Output {
        let (plan, log) = (self.plan, self.log);
        let (joints, wheels) = (plan.joints, plan.parts.len());
        for first in self.rows.clone().step_by(BLOCK) {
            let end = self.rows.end.min(first + BLOCK);
            let steering = &log.steering[first * joints..end * joints];
            let speeds = &log.speeds[first * wheels..end * wheels];
            fetch_ahead(simd, steering, 0, 1);
            fetch_ahead(simd, speeds, 0, 1);
            if all_within(simd, steering, LARGEST_ANGLE / 2.0)
                && all_within(simd, speeds, LARGEST_SPEED)
            {
                continue;
            }
            for k in first..end {
                let measured = plan.measured(log, k);
                let solvable = if measured.is_complete() {
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
    plan: &'a Plan<'a>,
    log: Log<'a>,
    unseen: Unseen,
    twists: &'a mut [[f64; 3]],
    past: bool,
    /// One per steering angle and one per speed.
    columns: &'a mut [Column],
}

impl Kernel for Solve<'_> {
    type Output = Result<(), Error>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Self::Output {
        let (plan, log) = (self.plan, self.log);
        let (joints, wheels) = (plan.joints, plan.parts.len());
        let (steering, speeds) = self.columns.split_at_mut(joints);
        let mut twists = [Column::ZERO; 3];
        let count = self.twists.len();
        let numbers = self.twists.as_flattened_mut();
        let mut output = Output::new(simd, numbers, 3 * BLOCK, self.past);
        for first in (0..count).step_by(BLOCK) {
            let end = count.min(first + BLOCK);
            let rows = [
                &log.steering[first * joints..end * joints],
                &log.speeds[first * wheels..end * wheels],
            ];
            unweave(simd, rows[0], steering);
            unweave(simd, rows[1], speeds);
            let usual = solve_block(simd, plan, steering, speeds, &mut twists, rows);
            let rows = output.next(3 * (end - first));
            weave(simd, &twists, rows);
            if usual {
                continue;
            }
            for (k, twist) in rows.as_chunks_mut::<3>().0.iter_mut().enumerate() {
                let within = |column: &Column, largest| column.0[k].abs() <= largest;
                let usual = steering[..joints]
                    .iter()
                    .all(|column| within(column, LARGEST_ANGLE / 2.0))
                    && speeds[..wheels]
                        .iter()
                        .all(|column| within(column, LARGEST_SPEED));
                if !usual {
                    let measured = plan.measured(log, first + k);
                    *twist = plan.rover.forward(measured, self.unseen)?.into();
                }
            }
        }
        Ok(())
    }
}

/// Solves a block, `rows` taken apart. Whether all of its readings are surely of a usual size.
#[inline(always)]
pub(super) fn solve_block<S: Vector>(
    simd: S,
    plan: &Plan<'_>,
    steering: &[Column],
    speeds: &[Column],
    twists: &mut [Column; 3],
    rows: [&[f64]; 2],
) -> bool {
    let zero = Lanes::splat(simd, 0.0);
    let [largest_angle, largest_speed] =
        [LARGEST_ANGLE / 2.0, LARGEST_SPEED].map(|largest| Lanes::splat(simd, largest * largest));
    let mut usual: Mask<S> = zero.at_most(zero);
    for k in 0..BLOCK / S::F64_LANES {
        for rows in rows {
            fetch_ahead(simd, rows, k, BLOCK / S::F64_LANES);
        }
        let [mut x, mut y, mut z] = [zero; 3];
        // Sums of squares say as well whether all are of a usual size, or one of them is not a number.
        let [mut angles, mut rates] = [zero; 2];
        let mut joint = 0;
        for (part, speeds) in plan.parts.iter().zip(speeds) {
            let speed = Lanes::load(simd, S::as_simd_f64s(&speeds.0).0, k);
            rates = speed.mul_add(speed, rates);
            match *part {
                Part::Fixed([along, across, moment]) => {
                    x = speed.mul_add(Lanes::splat(simd, along), x);
                    y = speed.mul_add(Lanes::splat(simd, across), y);
                    z = speed.mul_add(Lanes::splat(simd, moment), z);
                }
                Part::Steered {
                    heading,
                    radius,
                    arm: [arm_x, arm_y],
                } => {
                    let angle = Lanes::load(simd, S::as_simd_f64s(&steering[joint].0).0, k);
                    joint += 1;
                    angles = angle.mul_add(angle, angles);
                    let (sin, cos) = sin_cos(simd, angle + Lanes::splat(simd, heading));
                    let rim_speed = speed * Lanes::splat(simd, radius);
                    let (u, v) = (rim_speed * cos, rim_speed * sin);
                    x = x + u;
                    y = y + v;
                    z = v.mul_add(Lanes::splat(simd, arm_x), z);
                    z = u.mul_add(Lanes::splat(simd, -arm_y), z);
                }
                Part::Unheard => joint += 1,
                Part::Castor => {}
            }
        }
        usual = usual & rates.at_most(largest_speed) & angles.at_most(largest_angle);
        for (column, [a, b, c]) in twists.iter_mut().zip(plan.solution) {
            let sum = x * Lanes::splat(simd, a);
            let sum = y.mul_add(Lanes::splat(simd, b), sum);
            let sum = z.mul_add(Lanes::splat(simd, c), sum);
            sum.store(S::as_mut_simd_f64s(&mut column.0).0, k);
        }
    }
    !(!usual).any()
}
