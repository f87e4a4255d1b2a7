//! The planar motion that fits the wheels' velocities best, in weighted least squares over the contacts.
//!
//! Of every touching wheel three velocities of its contact are 0 but for errors: along the normal, along the rim less
//! `r q`, and to the left. With the rates of the suspension as functions of the planar ones
//! ([`SuspensionRates`]) they are `columns . plan + left`.

use super::constants::{MotionConstants, PLAN};
use super::contact_rows::{Contact, Contacts, Row};
use super::least_squares::{DenseLeastSquares, NormalEquations, PlanarTriangle};
use super::suspension_rates::{KnownRate, KnownRates, SuspensionRates};
use crate::lanes::columns::is_number;
use crate::lanes::pose_lanes::Touching;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_terrain::suspension::MAX_WHEELS;
use six_wheel_terrain::suspension::lanes::{all, dot};

/// Contacts and measurements of some rows.
pub(crate) struct FitInput<'a, S: Vector> {
    pub contacts: &'a Contacts<S>,
    pub touching: &'a Touching<S>,
    pub known: KnownRates<S>,
    /// Speeds of the wheels [rad/s]; NaN where one was not measured.
    pub speeds: [Lanes<S>; MAX_WHEELS],
    /// Weight of every wheel, or two weights per wheel: those of its rolling and of its side slip.
    pub weights: Option<&'a [f64]>,
}

/// Rates, and the velocities of the touching points along the normal, along the rim and to the left [m/s]: NaN in the
/// air. All NaN where the contacts do not determine the rates.
pub(crate) struct FittedMotion<S: Vector> {
    pub rates: Row<S>,
    pub residuals: [Lanes<S>; 3 * MAX_WHEELS],
}

/// An equation of the planar motion, `columns . plan = -left`, and its weight.
#[derive(Clone, Copy)]
struct PlanarEquation<S: Vector> {
    columns: [Lanes<S>; 3],
    left: Lanes<S>,
    weight: Lanes<S>,
}

/// Fits the planar motion. `RIGHT` is the number of right-hand sides of the suspension's equations: 3 for the planar
/// rates, and one more where other rates are known.
#[inline(always)]
pub(crate) fn fit<S: Vector, const RIGHT: usize>(
    simd: S,
    constants: &MotionConstants,
    input: &FitInput<'_, S>,
    equations: &mut DenseLeastSquares<S>,
) -> FittedMotion<S> {
    let (zero, nan) = (all(simd, 0.0), all(simd, f64::NAN));
    let FitInput { contacts, touching, known, .. } = input;
    let suspension = SuspensionRates::new::<RIGHT>(simd, constants, touching, known, contacts, equations);
    let problem = PlanarProblem { constants, input, suspension: &suspension };
    let none = PlanarEquation { columns: [zero; 3], left: zero, weight: zero };
    let mut sliding = [[none; 2]; MAX_WHEELS];
    for (wheel, equations) in sliding.iter_mut().enumerate().take(constants.wheels) {
        *equations = problem.sliding_equations::<RIGHT>(simd, wheel);
    }
    let (plan, determined) = problem.solve::<RIGHT>(simd, &sliding);
    let mut rates = suspension.rates(plan);
    for rate in &mut rates {
        *rate = determined.select(*rate, nan);
    }
    let mut residuals = [nan; 3 * MAX_WHEELS];
    for (wheel, [roll, side]) in sliding.iter().enumerate().take(constants.wheels) {
        let touches = zero.lt(touching.wheels[wheel]) & determined;
        let Contact { rows, swivel } = &contacts[wheel];
        let mut lift = swivel[0];
        for (part, rate) in rows[0].iter().zip(rates) {
            lift = part.mul_add(rate, lift);
        }
        let rolled = dot(roll.columns, plan) + roll.left;
        let rolled = is_number(input.speeds[wheel]).select(rolled, nan);
        let aside = dot(side.columns, plan) + side.left;
        for (i, residual) in [lift, rolled, aside].into_iter().enumerate() {
            residuals[3 * wheel + i] = touches.select(residual, nan);
        }
    }
    FittedMotion { rates, residuals }
}

/// The least squares of the planar motion.
struct PlanarProblem<'a, S: Vector> {
    constants: &'a MotionConstants,
    input: &'a FitInput<'a, S>,
    suspension: &'a SuspensionRates<S>,
}

#[inline_always]
impl<S: Vector> PlanarProblem<'_, S> {
    /// Equation of a wheel from the derivatives of a velocity and the part `beside` that no rate changes [m/s]; 0 in
    /// the air.
    fn equation<const RIGHT: usize>(
        &self,
        wheel: usize,
        row: &Row<S>,
        beside: Lanes<S>,
        weight: Lanes<S>,
    ) -> PlanarEquation<S> {
        let ([a, b, c], left) = self.suspension.planar_row::<RIGHT>(self.constants, wheel, row, beside);
        let numbers = [a, b, c, left, weight];
        let [a, b, c, left, weight] = self.input.touching.only(weight.simd(), wheel, numbers);
        PlanarEquation { columns: [a, b, c], left, weight }
    }

    /// Equations of a wheel along its rim and to the left.
    fn sliding_equations<const RIGHT: usize>(&self, simd: S, wheel: usize) -> [PlanarEquation<S>; 2] {
        let zero = all(simd, 0.0);
        let [roll, side] = weights(self.input.weights, self.constants.wheels, wheel);
        let Contact { rows, swivel } = &self.input.contacts[wheel];
        let speed = self.input.speeds[wheel];
        let measured = is_number(speed);
        let rolled = all(simd, self.constants.radii[wheel]) * measured.select(speed, zero);
        let weight = measured.select(all(simd, roll), zero);
        [
            self.equation::<RIGHT>(wheel, &rows[1], swivel[1] - rolled, weight),
            self.equation::<RIGHT>(wheel, &rows[2], swivel[2], all(simd, side)),
        ]
    }

    /// Equation of a wheel along the normal; 0 where the suspension follows the ground exactly.
    fn lifting_equation<const RIGHT: usize>(&self, simd: S, wheel: usize, exactly: Mask<S>) -> PlanarEquation<S> {
        let [roll, side] = weights(self.input.weights, self.constants.wheels, wheel);
        let Contact { rows, swivel } = &self.input.contacts[wheel];
        let measured = is_number(self.input.speeds[wheel]);
        let weight = measured.select(all(simd, roll.max(side)), all(simd, side));
        self.equation::<RIGHT>(wheel, &rows[0], swivel[0], exactly.select(all(simd, 0.0), weight))
    }

    /// The planar motion, and the lanes in which there is one: by normal equations where they lose no digits, else by
    /// rotations, and the shortest one where the equations leave a direction open.
    fn solve<const RIGHT: usize>(
        &self,
        simd: S,
        sliding: &[[PlanarEquation<S>; 2]; MAX_WHEELS],
    ) -> ([Lanes<S>; 3], Mask<S>) {
        let wheels = self.constants.wheels.min(MAX_WHEELS);
        let sliding = &sliding[..wheels];
        let exactly = self.suspension.exactly(simd, &self.input.known, wheels);
        let mut normal = NormalEquations::new(simd);
        for [roll, side] in sliding {
            normal.add(roll.columns, roll.left, roll.weight);
            normal.add(side.columns, side.left, side.weight);
        }
        // The equations along the normals come last, so that lanes without them have the same bits as a batch without
        // them.
        if (!exactly).any() {
            for wheel in 0..wheels {
                let lift = self.lifting_equation::<RIGHT>(simd, wheel, exactly);
                normal.add(lift.columns, lift.left, lift.weight);
            }
        }
        if let KnownRate::KnownWhere(here, _) = self.input.known[PLAN[2]] {
            normal.set_last_known(here);
        }
        let (mut plan, accurate) = normal.solve(simd);
        let determined = self.suspension.determined & !self.input.touching.none;
        let others = determined & !accurate;
        if others.any() {
            let mut triangle = PlanarTriangle::new(simd);
            for (wheel, [roll, side]) in sliding.iter().enumerate() {
                let lift = self.lifting_equation::<RIGHT>(simd, wheel, exactly);
                for equation in [roll, side, &lift] {
                    triangle.add(simd, equation.columns, equation.left, equation.weight);
                }
            }
            plan = triangle.solve(simd, others, plan);
        }
        (plan, determined & is_number(plan[0] + plan[1] + plan[2]))
    }
}

/// Weights of a wheel's rolling and of its side slip, of one weight or two for each of `count` wheels.
pub(crate) fn weights(weights: Option<&[f64]>, count: usize, wheel: usize) -> [f64; 2] {
    match weights {
        None => [1.0; 2],
        Some(each) if each.len() == count => [each[wheel]; 2],
        Some(both) => [both[2 * wheel], both[2 * wheel + 1]],
    }
}
