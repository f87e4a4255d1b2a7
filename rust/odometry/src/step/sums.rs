//! Sums over the wheels of one step, which are in the lanes of a register.
//!
//! Every sum has [`PARTS`] parts, one for every lane of the level with most lanes: wheels whose places differ by a multiple of
//! it are in the same part. The parts are added in the same order on every level.

use super::constants::{StepConstants, StepScratch};
use super::fit::WheelFit;
use super::input::WheelInput;
use super::terms::NoiseTerms;
use super::wheels::{LaneSource, Register, accumulate_displacement, accumulate_noise, steering_error};
use crate::motion::{ROUNDING, SUSPICIOUS};
use crate::propagation::arc::StepJacobian;
use crate::propagation::covariance::Covariance3;
use crate::propagation::fusion::{KalmanGain, remaining_error};
use nalgebra::Vector3;
use pulp::Scalar;
use six_wheel_kinematics::kernels::wheel_lanes::{Eight, GROUP, padded};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;

/// Parts of a sum over wheels.
pub(crate) const PARTS: usize = 4;

/// Part that register `k` of a group is added to.
#[inline(always)]
fn part<S: Vector>(k: usize) -> usize {
    (k * S::F64_LANES % PARTS) / S::F64_LANES
}

/// Pairwise sum of the parts.
#[inline(always)]
pub(crate) fn add_parts<S: Vector, const N: usize>(
    mut sums: [[Lanes<S>; N]; PARTS],
    mut parts: usize,
) -> [Lanes<S>; N] {
    while parts > 1 {
        parts /= 2;
        for i in 0..parts {
            let others = sums[i + parts];
            for (sum, other) in sums[i].iter_mut().zip(others) {
                *sum = *sum + other;
            }
        }
    }
    sums[0]
}

#[inline(always)]
fn total<S: Vector>(sums: [Covariance3<Lanes<S>>; PARTS]) -> Covariance3 {
    let mut numbers: [Lanes<S>; 6] = sums[0].into();
    if S::F64_LANES < PARTS {
        let mut parts = [numbers; PARTS];
        for (part, sum) in parts.iter_mut().zip(sums) {
            *part = sum.into();
        }
        numbers = add_parts(parts, PARTS / S::F64_LANES);
    }
    Covariance3::from(numbers).total()
}

/// Writes as many lanes as `numbers` holds.
#[inline(always)]
fn write_lanes<S: Vector>(lanes: Lanes<S>, numbers: &mut [f64]) {
    if let ([register, ..], _) = S::as_mut_simd_f64s(numbers) {
        lanes.store(std::slice::from_mut(register), 0);
        return;
    }
    let mut whole = [0.0; GROUP];
    lanes.store(S::as_mut_simd_f64s(&mut whole).0, 0);
    for (number, lane) in numbers.iter_mut().zip(whole) {
        *number = lane;
    }
}

/// Loads the numbers of these wheels; 0 in lanes without a wheel.
#[inline(always)]
fn gather<S: Vector>(simd: S, numbers: &[f64], wheels: &[usize]) -> Lanes<S> {
    let mut lanes: Eight = [0.0; GROUP];
    for (lane, &i) in lanes.iter_mut().zip(wheels) {
        *lane = numbers.get(i).copied().unwrap_or(0.0);
    }
    Lanes::load(simd, S::as_simd_f64s(&lanes).0, 0)
}

/// The least-squares displacement in body axes [m, m, rad]. None if running totals have to be checked.
#[inline(always)]
pub(crate) fn sum_displacement<S: Vector>(
    simd: S,
    constants: &mut StepConstants,
    input: &WheelInput<'_>,
    terms: &NoiseTerms<S>,
    angles: &mut [f64],
) -> Option<[f64; 3]> {
    let zero = Lanes::splat(simd, 0.0);
    let mut is_fine = Mask::splat(simd, true);
    let mut sums = [[zero; 3]; PARTS];
    let mut joint = 0;
    for (group, scratch) in constants.groups.iter().zip(&mut constants.scratch) {
        for k in 0..group.registers(S::F64_LANES) {
            let wheels = &group.wheels[k * S::F64_LANES..][..S::F64_LANES];
            let pick = Register(simd, k);
            let is_steered = k * S::F64_LANES < group.steered;
            let (turned, ends) = match *input {
                WheelInput::Totals { wheels: [before, after], steering, angles: starts } => {
                    let counts = gather(simd, after, wheels) - gather(simd, before, wheels);
                    let mut ends = [zero; 2];
                    if is_steered {
                        let start = padded(simd, &starts[joint..]);
                        let [before, after] = steering.map(|all| padded(simd, &all[joint..]));
                        let end = (after - before) * pick.of(&group.per_count[1]) + start;
                        write_lanes(end, &mut angles[joint..]);
                        ends = [start, end];
                    }
                    (counts * pick.of(&group.per_count[0]), ends)
                }
                WheelInput::Rotations { turned, steering: [start, end] } if is_steered => {
                    (gather(simd, turned, wheels), [padded(simd, &start[joint..]), padded(simd, &end[joint..])])
                }
                WheelInput::Rotations { turned, .. } => (gather(simd, turned, wheels), [zero; 2]),
                WheelInput::Fitted => return None,
            };
            let mut steered = None;
            if is_steered {
                joint += S::F64_LANES;
                let [start, end] = ends;
                steered = Some([(start + end) * Lanes::splat(simd, 0.5), end - start]);
            }
            let sum = &mut sums[part::<S>(k)];
            let wheel = (group, pick);
            is_fine = is_fine & accumulate_displacement(simd, wheel, turned, steered, terms, sum, (scratch, k));
        }
    }
    if matches!(input, WheelInput::Totals { .. }) && (!is_fine).any() {
        return None;
    }
    let sum = if S::F64_LANES < PARTS { add_parts(sums, PARTS / S::F64_LANES) } else { sums[0] };
    Some([sum[0].sum(), sum[1].sum(), sum[2].sum()])
}

/// Covariance of the displacement by errors of this step alone, and true if a wheel slid further than the noise
/// explains.
#[inline(always)]
pub(crate) fn sum_noise<S: Vector>(
    simd: S,
    constants: &mut StepConstants,
    is_fitted: bool,
    terms: &NoiseTerms<S>,
    [x, y, yaw]: [f64; 3],
) -> (Covariance3, bool) {
    let displacement = [Lanes::splat(simd, x), Lanes::splat(simd, y), Lanes::splat(simd, yaw)];
    let mut sums = [Covariance3::zero(simd); PARTS];
    let mut suspects = Mask::splat(simd, false);
    let StepConstants { groups, fitted, scratch, .. } = constants;
    for ((group, fitted), scratch) in groups.iter().zip(fitted).zip(&mut *scratch) {
        let rows = if is_fitted { &*fitted } else { &group.constant };
        for k in 0..group.registers(S::F64_LANES) {
            let wheel = (group, rows, Register(simd, k));
            let sum = &mut sums[part::<S>(k)];
            suspects = suspects | accumulate_noise(simd, wheel, displacement, terms, sum, (scratch, k));
        }
    }
    let is_certain = terms.slip_bound.is_some() || !suspects.any();
    let slips = if is_certain { suspects.any() } else { is_slip(scratch) };
    (total(sums), slips)
}

/// True if a wheel slid further than the noise and the rounding of the others' fit explain.
#[inline(never)]
fn is_slip(scratch: &[StepScratch]) -> bool {
    let furthest = scratch.iter().flat_map(|wheels| wheels.rolled).fold(0.0_f64, |most, rolled| most.max(rolled.abs()));
    scratch.iter().any(|wheels| {
        let mut pairs = wheels.slid.iter().zip(&wheels.variance);
        pairs.any(|(slid, variance)| *slid > SUSPICIOUS * variance.sqrt() + ROUNDING * furthest)
    })
}

/// Covariance of the displacement by residuals beyond the noise. Their mean excess variance, `Σ w r² / (rows - 3) - Σ w
/// σ² / rows`, is that of additional noise of every row.
#[inline(never)]
pub(crate) fn excess_covariance(constants: &StepConstants, is_fitted: bool, weights: &[f64]) -> Covariance3 {
    let (mut observed, mut explained, mut rows) = (0.0, 0.0, 0.0);
    for ((group, fitted), scratch) in constants.groups.iter().zip(&constants.fitted).zip(&constants.scratch) {
        let [has_rolling, has_side_slip] = if is_fitted { &fitted.has } else { &group.constant.has };
        for (lane, &i) in group.wheels[..group.count].iter().enumerate() {
            observed += weights[i] * scratch.slid[lane] * scratch.slid[lane];
            explained += weights[i] * scratch.variance[lane];
            rows += has_rolling[lane] + has_side_slip[lane];
        }
    }
    let mut covariance = Covariance3::default();
    if rows > 3.0 {
        let excess = (observed / (rows - 3.0) - explained / rows).max(0.0);
        for (group, scratch) in constants.groups.iter().zip(&constants.scratch) {
            for (lane, [x, y, z]) in
                (0..group.count).flat_map(|lane| scratch.shares.each_ref().map(|share| (lane, share)))
            {
                covariance.add(&Vector3::new(x[lane], y[lane], z[lane]), excess);
            }
        }
    }
    covariance
}

/// Covariances of the displacement by the readings at its start, and by those at its end, that the neighbouring steps
/// share.
#[inline(always)]
pub(crate) fn shared_covariance<S: Vector>(
    simd: S,
    constants: &StepConstants,
    fitted: Option<&WheelFit>,
    terms: &NoiseTerms<S>,
) -> [Covariance3; 2] {
    if let Some(fit) = fitted {
        let sum = |columns: &[[f64; 3]]| {
            let mut sum = Covariance3::default();
            for column in columns {
                sum.add(&Vector3::from(*column), 1.0);
            }
            sum
        };
        return [sum(&fit.old), sum(&fit.new)];
    }
    let mut sums = [Covariance3::zero(simd); PARTS];
    for (group, scratch) in constants.groups.iter().zip(&constants.scratch) {
        for k in 0..group.steered.div_ceil(S::F64_LANES) {
            let sum = &mut sums[part::<S>(k)];
            *sum = sum.and_square(steering_error(simd, (group, Register(simd, k)), terms, (scratch, k)));
        }
    }
    [total(sums); 2]
}

/// Propagates the columns of readings that two steps share, except the gyroscope's, which has this gain. Returns what
/// they add to the settled covariance at the end of the step.
#[inline(always)]
pub(crate) fn propagate_columns<S: Vector>(
    simd: S,
    constants: &StepConstants,
    fitted: Option<&WheelFit>,
    terms: &NoiseTerms<S>,
    carried: &mut [[f64; 3]],
    jacobian: &StepJacobian<Scalar>,
    gain: Option<KalmanGain<Scalar>>,
) -> Covariance3 {
    let propagate = Propagate {
        jacobian: jacobian.broadcast(Scalar, simd),
        gain: gain
            .map(|[x, y, z]| [Lanes::splat(simd, x.sum()), Lanes::splat(simd, y.sum()), Lanes::splat(simd, z.sum())]),
    };
    let mut sums = [Covariance3::zero(simd); PARTS];
    let width = 3 * S::F64_LANES;
    let mut columns = carried.as_flattened_mut().chunks_exact_mut(width);
    if let Some(fit) = fitted {
        let read = [&fit.old, &fit.new].map(|all| all.as_flattened().chunks_exact(width));
        let [old, new] = read;
        // The last column is the gyroscope's; on a level of one lane it is a register of its own.
        let shared = (fit.old.len() - 1) / S::F64_LANES;
        for (k, (columns, (old, new))) in columns.zip(old.zip(new)).enumerate().take(shared) {
            let [old, new] = [Lanes::deinterleave3(simd, old), Lanes::deinterleave3(simd, new)];
            let sum = &mut sums[part::<S>(k)];
            *sum = sum.and_square(propagate.column(simd, [old, new], columns));
        }
        return total(sums);
    }
    for (group, scratch) in constants.groups.iter().zip(&constants.scratch) {
        for k in 0..group.steered.div_ceil(S::F64_LANES) {
            let Some(columns) = columns.next() else { break };
            let half = steering_error(simd, (group, Register(simd, k)), terms, (scratch, k));
            let sum = &mut sums[part::<S>(k)];
            *sum = sum.and_square(propagate.column(simd, [half, half], columns));
        }
    }
    total(sums)
}

struct Propagate<S: Vector> {
    jacobian: StepJacobian<S>,
    gain: Option<KalmanGain<S>>,
}

impl<S: Vector> Propagate<S> {
    /// Replaces columns by the errors of the pose by the readings at the end of the step. Returns the complete errors
    /// by those at its start: `F carried + L old`.
    #[inline(always)]
    fn column(&self, simd: S, [mut old, mut new]: [[Lanes<S>; 3]; 2], columns: &mut [f64]) -> [Lanes<S>; 3] {
        if let Some(gain) = self.gain {
            [old, new] = [remaining_error(gain, old), remaining_error(gain, new)];
        }
        let whole = self.jacobian.propagate(Lanes::deinterleave3(simd, columns), old);
        Lanes::interleave3(self.jacobian.displacement_error(new), columns);
        whole
    }
}

/// Writes the residuals of a step of this duration, the speeds at which the contacts slid [m/s].
#[inline(always)]
pub(crate) fn write_residuals<S: Vector>(simd: S, constants: &StepConstants, dt: f64, residual: &mut [f64]) {
    let per_second = 1.0 / dt;
    let (rate, duration) = (Lanes::splat(simd, per_second), Lanes::splat(simd, dt));
    for (group, scratch) in constants.groups.iter().zip(&constants.scratch) {
        for k in 0..group.registers(S::F64_LANES) {
            let slid = Register(simd, k).of(&scratch.slid);
            let speed = if per_second.is_finite() { slid * rate } else { slid / duration };
            let mut speeds: Eight = [0.0; GROUP];
            speed.store(S::as_mut_simd_f64s(&mut speeds).0, 0);
            let wheels = &group.wheels[k * S::F64_LANES..][..S::F64_LANES];
            for (&i, speed) in wheels.iter().zip(speeds) {
                if let Some(target) = residual.get_mut(i) {
                    *target = speed;
                }
            }
        }
    }
}
