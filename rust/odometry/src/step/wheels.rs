//! Equations of the wheels in a step. The lanes of a register are the wheels of one step, or one wheel in successive steps.
//!
//! Wheel i rolled the distance `s_i` along its heading in the middle of the step. With its rows `a_i` (rolling) and `b_i`
//! (side slip), the displacement d and the shares `A_i = (Σ a aᵀ + b bᵀ)⁻¹ a_i`, `B_i` likewise:
//!
//! ```text
//! d = Σ A_i s_i                         residuals   a_i · d - s_i,   b_i · d
//! cov(d) = Σ A_i A_iᵀ var(s_i) + B_i B_iᵀ var(slip across) + (B_i s_i) (B_i s_i)ᵀ var(steering angle)
//! ```

use super::constants::{Group, StepScratch, Triple, WheelRows};
use super::terms::{LARGEST_ROTATION, NoiseTerms, ROUNDED_DOWN};
use crate::motion::SUSPICIOUS;
use crate::propagation::arc::chord_ratio;
use crate::propagation::covariance::Covariance3;
use six_wheel_kinematics::kernels::wheel_lanes::Eight;
use six_wheel_kinematics::se2::angles::sin_cos_any;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vec3::dot;
use six_wheel_numerics::simd::vector::Vector;

/// Source of the lanes: the numbers of register `k` of a group, or the number of one wheel in all lanes.
pub(crate) trait LaneSource<S: Vector>: Copy {
    fn of(self, numbers: &Eight) -> Lanes<S>;

    #[inline(always)]
    fn three(self, triple: &Triple) -> [Lanes<S>; 3] {
        let [x, y, z] = triple;
        [self.of(x), self.of(y), self.of(z)]
    }
}

#[derive(Clone, Copy)]
pub(crate) struct Register<S: Vector>(pub S, pub usize);

#[derive(Clone, Copy)]
pub(crate) struct Broadcast<S: Vector>(pub S, pub usize);

impl<S: Vector> LaneSource<S> for Register<S> {
    #[inline(always)]
    fn of(self, numbers: &Eight) -> Lanes<S> {
        Lanes::load(self.0, S::as_simd_f64s(numbers).0, self.1)
    }
}

impl<S: Vector> LaneSource<S> for Broadcast<S> {
    #[inline(always)]
    fn of(self, numbers: &Eight) -> Lanes<S> {
        Lanes::splat(self.0, numbers[self.1])
    }
}

/// Stores to register `k` of columns.
#[inline(always)]
pub(crate) fn store<S: Vector, const N: usize>(lanes: [Lanes<S>; N], columns: &mut [Eight; N], k: usize) {
    for (lanes, column) in lanes.into_iter().zip(columns) {
        lanes.store(S::as_mut_simd_f64s(column).0, k);
    }
}

/// Adds the shares of these wheels to the least-squares displacement [m, m, rad], by their rotations and the middle
/// angle and increment of their joints [rad]. Returns the lanes whose readings need no check.
#[inline(always)]
pub(crate) fn accumulate_displacement<S: Vector, P: LaneSource<S>>(
    simd: S,
    (group, pick): (&Group, P),
    turned: Lanes<S>,
    joint: Option<[Lanes<S>; 2]>,
    terms: &NoiseTerms<S>,
    displacement: &mut [Lanes<S>; 3],
    (scratch, k): (&mut StepScratch, usize),
) -> Mask<S> {
    let splat = |number| Lanes::splat(simd, number);
    let [most_rolled, most_steered] = terms.checked_above;
    let mut rolled = turned * pick.of(&group.radius);
    let mut is_fine = rolled.abs().le(most_rolled) & turned.abs().le(splat(LARGEST_ROTATION));
    let [along, across] = &group.shares;
    let mut shares = [pick.three(along), pick.three(across)];
    let mut measured = [rolled, splat(0.0)];
    if let Some([middle, increment]) = joint {
        is_fine = is_fine & increment.abs().le(most_steered);
        // The pivot of a wheel that steers by `increment` moves along an arc in body axes: its chord.
        rolled = rolled * chord_ratio(simd, increment * splat(0.5));
        let (sin, cos) = sin_cos_any(simd, middle + pick.of(&group.heading));
        measured = [rolled * cos, rolled * sin];
        let [along, across] = shares;
        for part in 0..3 {
            shares[0][part] = cos.mul_add(along[part], sin * across[part]);
            shares[1][part] = cos.mul_add(across[part], -(sin * along[part]));
        }
    }
    for (sum, along) in displacement.iter_mut().zip(shares[0]) {
        *sum = rolled.mul_add(along, *sum);
    }
    for (share, target) in shares.into_iter().zip(&mut scratch.shares) {
        store(share, target, k);
    }
    store([rolled], std::array::from_mut(&mut scratch.rolled), k);
    store(measured, &mut scratch.measured, k);
    is_fine
}

/// Adds the shares of these wheels to the covariance of the displacement, and stores their residuals [m] and variances
/// [m²]. Returns the lanes that slid further than the noise explains, rounding not counted.
#[inline(always)]
pub(crate) fn accumulate_noise<S: Vector, P: LaneSource<S>>(
    simd: S,
    (group, rows, pick): (&Group, &WheelRows, P),
    displacement: [Lanes<S>; 3],
    terms: &NoiseTerms<S>,
    covariance: &mut Covariance3<Lanes<S>>,
    (scratch, k): (&mut StepScratch, usize),
) -> Mask<S> {
    let splat = |number| Lanes::splat(simd, number);
    let here = Register(simd, k);
    let [rolling, side_slip] = &rows.rows;
    let along = dot(pick.three(rolling), displacement) - here.of(&scratch.measured[0]);
    let across = dot(pick.three(side_slip), displacement) - here.of(&scratch.measured[1]);
    let square = along.mul_add(along, across * across);
    let slid = square.sqrt();
    let [mut own, mut sides] = [terms.own_variance, splat(0.0)];
    if terms.slip_variances != [0.0; 2] {
        let [px, py] = [pick.of(&group.pivot[0]), pick.of(&group.pivot[1])];
        let x = displacement[0] - displacement[2] * py;
        let y = displacement[1] + displacement[2] * px;
        let distance = x.mul_add(x, y * y).sqrt() * pick.of(&group.slip_factor);
        sides = distance * splat(terms.slip_variances[1]);
        own = own + distance * splat(terms.slip_variances[0]);
        own = pick.of(&group.passed_on).mul_add(sides, own);
        *covariance = covariance.and_scaled_square(here.three(&scratch.shares[1]), sides);
    }
    *covariance = covariance.and_scaled_square(here.three(&scratch.shares[0]), own);
    let rolled = here.of(&scratch.rolled);
    let steered = terms.steering_variance * pick.of(&group.steers) * (rolled * rolled);
    let [has_rolling, has_side_slip] = [pick.of(&rows.has[0]), pick.of(&rows.has[1])];
    let variance = has_rolling.mul_add(own + terms.shared_variance, has_side_slip * (sides + steered));
    store([slid], std::array::from_mut(&mut scratch.slid), k);
    store([variance], std::array::from_mut(&mut scratch.variance), k);
    match terms.slip_bound {
        Some(bound) => bound.lt(slid),
        None => (variance * splat(ROUNDED_DOWN * SUSPICIOUS * SUSPICIOUS)).lt(square),
    }
}

/// Error of the displacement by half the deviation of a steering angle [m, m, rad].
#[inline(always)]
pub(crate) fn steering_error<S: Vector, P: LaneSource<S>>(
    simd: S,
    (group, pick): (&Group, P),
    terms: &NoiseTerms<S>,
    (scratch, k): (&StepScratch, usize),
) -> [Lanes<S>; 3] {
    let here = Register(simd, k);
    let error = here.of(&scratch.rolled) * pick.of(&group.steers) * terms.half_deviation;
    let [x, y, z] = here.three(&scratch.shares[1]);
    [x * error, y * error, z * error]
}
