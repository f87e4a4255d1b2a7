//! Inverse kinematics of whole registers of twists. What the kernel is not sure of, it leaves to the plain core, row by
//! row.

mod solve;
#[cfg(test)]
mod tests;

use pulp::Simd;

use super::choice::Asked;
use super::cone::Cone;
use super::steered::{EITHER, ONLY, Reach, Steered, absolute, load};
use crate::batch::machine::lanes::{Lanes, Mask};
use crate::batch::machine::level::{Kernel, Level};
use crate::batch::machine::stream::fetch_ahead;
use crate::batch::machine::vector::Vector;
use crate::batch::machine::weave::{BLOCK, Column, unweave, with_columns};
use crate::error::Error;
use crate::geometry::Twist;
use crate::rover::{Inputs, Mount, Rover};
use crate::wheels::Wheel;
use solve::Solve;

/// Sizes of twists whose squares neither overflow nor lose digits. Beyond them, the plain core.
pub(in crate::batch) const SMALLEST: f64 = 1e-100;
pub(in crate::batch) const LARGEST: f64 = 1e100;

/// Sizes of rovers with which that holds at every pivot.
pub(in crate::batch) const SIZES: std::ops::RangeInclusive<f64> = 1e-20..=1e20;

#[derive(Clone, Copy, Debug)]
pub(crate) enum Part {
    Fixed([f64; 3]),
    Castor(Steered),
    Steered(Steered),
}

/// What the kernel needs to know of a rover.
pub(crate) struct Plan<'a> {
    rover: &'a Rover,
    cone: &'a Cone,
    /// Every wheel with one over its radius.
    pub parts: Vec<(Part, f64)>,
    joints: usize,
    pub banks: Vec<[f64; 3]>,
    /// Whether every wheel can be steered without a second thought, but for resting ones and such.
    is_simple: bool,
    /// Whether there is only one way of making a motion, wherever the wheels are, unless they rest.
    is_inner: bool,
    /// Whether some wheels may have to ask the others which of two ways to go.
    asks: bool,
}

impl<'a> Plan<'a> {
    /// Nothing where sizes are extreme.
    pub fn new(rover: &'a Rover) -> Option<Self> {
        let cone = rover.cone.as_ref()?;
        let part = |(wheel, mount): (&Wheel, &Mount)| {
            let part = match (*mount, Steered::new(wheel, *mount)) {
                (Mount::Castor(_), Some(steered)) => Part::Castor(steered),
                (_, Some(steered)) => Part::Steered(steered),
                (Mount::Fixed(rows), None) => Part::Fixed(rows.rolling.into()),
                (_, None) => return None,
            };
            Some((part, 1.0 / wheel.radius))
        };
        let wheels = rover.wheels();
        let parts: Option<Vec<_>> = wheels.iter().zip(&rover.mounts).map(part).collect();
        let parts = parts?;
        let all = |holds: &dyn Fn(&Reach) -> bool| {
            parts.iter().all(|(part, _)| match part {
                Part::Steered(steered) => steered.reach.as_ref().is_some_and(holds),
                Part::Fixed(_) | Part::Castor(_) => true,
            })
        };
        Some(Self {
            rover,
            cone,
            is_simple: all(&|_| true),
            is_inner: all(&|reach| reach.ways == ONLY),
            asks: !all(&|reach| reach.ways != EITHER),
            parts,
            joints: rover.steered().len(),
            banks: rover.banks.iter().map(|bank| bank.row.into()).collect(),
        })
    }

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

    /// Row by row; `row` is the first of the twists among those of the inputs, `first` among those of the batch.
    fn check_rows(&self, twists: &[[f64; 3]], inputs: Inputs<'_>, row: usize, first: usize) -> Result<(), Error> {
        for (k, twist) in twists.iter().enumerate() {
            let inputs = inputs.row(self.rover, row + k);
            let checked = inputs.check().and_then(|()| self.rover.check(Twist::from(*twist), inputs.steering_rates));
            checked.map_err(|error| error.at_row(first + row + k))?;
        }
        Ok(())
    }

    /// Whether the plain core would surely let a twist pass.
    #[inline(always)]
    fn passes<S: Simd>(&self, simd: S, twist: [Lanes<S>; 3], rates: &[Column], k: usize) -> Mask<S> {
        let mut passes = self.cone.judge(simd, twist).yes;
        if self.cone.is_whole {
            return passes;
        }
        let zero = Lanes::splat(simd, 0.0);
        let mut joint = 0;
        for (part, _) in &self.parts {
            let Part::Steered(steered) = part else {
                continue;
            };
            if steered.trail != 0.0 {
                let rate = rates.get(joint).map_or(zero, |rates| rates.load(simd, k));
                let mut fits = steered.reaches(simd, twist, rate);
                if (!fits).any() {
                    let asked = Asked { twist, before: zero, rate };
                    let chosen = steered.choose(simd, asked, None);
                    fits = fits | (chosen.inside & chosen.sure);
                }
                passes = passes & fits;
            }
            joint += 1;
        }
        passes
    }
}

/// Whether a twist is surely finite, and its squares are too.
#[inline(always)]
pub(crate) fn usual<S: Simd>(simd: S, twist: [Lanes<S>; 3]) -> Mask<S> {
    let [vx, vy, omega] = absolute(twist);
    let size = vx + vy + omega;
    let fits = size.at_most(Lanes::splat(simd, LARGEST));
    let zero = size.at_most(Lanes::splat(simd, 0.0));
    fits & (zero | Lanes::splat(simd, SMALLEST).at_most(size))
}

/// Whether the squares of a wheel's sizes neither overflow nor lose digits.
pub(crate) fn is_usual(wheel: &Wheel) -> bool {
    let usual = |length: f64| length == 0.0 || SIZES.contains(&length);
    let lengths = [wheel.radius, wheel.x.abs(), wheel.y.abs()];
    let offsets = [wheel.scrub.abs(), wheel.trail.abs()];
    lengths.into_iter().all(usual) && offsets.iter().all(|offset| offset < SIZES.end())
}

/// Two pivots far apart.
pub(in crate::batch) fn pivots_apart(wheels: &[Wheel]) -> [[f64; 2]; 2] {
    let first = [wheels[0].x, wheels[0].y];
    let mut other = first;
    let distance = |[x, y]: [f64; 2]| (x - first[0]).abs() + (y - first[1]).abs();
    for wheel in wheels {
        if distance([wheel.x, wheel.y]) > distance(other) {
            other = [wheel.x, wheel.y];
        }
    }
    [first, other]
}

/// The rows of a block out of those of a batch.
fn block(values: Option<&[f64]>, width: usize, first: usize, count: usize) -> &[f64] {
    values.map_or(&[], |values| &values[first * width..(first + count) * width])
}

/// Whether all numbers are surely at most so large, by the sum of their squares. False for NaN.
#[inline(always)]
pub(crate) fn all_within<S: Vector>(simd: S, values: &[f64], largest: f64) -> bool {
    let mut sums = [Lanes::splat(simd, 0.0); 4];
    let (registers, rest) = S::as_simd_f64s(values);
    let (quads, singles) = registers.as_chunks::<4>();
    for quad in quads {
        for (j, sum) in sums.iter_mut().enumerate() {
            let value = Lanes::load(simd, quad, j);
            *sum = value.mul_add(value, *sum);
        }
    }
    for k in 0..singles.len() {
        let value = Lanes::load(simd, singles, k);
        sums[0] = value.mul_add(value, sums[0]);
    }
    let sum = ((sums[0] + sums[1]) + (sums[2] + sums[3])).total();
    let sum = sum + rest.iter().map(|value| value * value).sum::<f64>();
    sum <= (largest * largest).min(f64::MAX)
}

struct Check<'a> {
    plan: &'a Plan<'a>,
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
