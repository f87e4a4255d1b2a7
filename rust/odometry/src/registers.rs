//! Steps of odometry with their covariance.
//!
//! Every wheel has two rows, each a constant times the cosine and the sine of where it points; for a wheel that is
//! not steered these are 1 and 0. Where the normal equations are the same for all readings, so are the rows times
//! their inverse: what a metre of rolling is of the displacement. Displacement, residuals and errors are sums of these.
//!
//! One sample has the wheels in the lanes of a register (here), a log successive steps ([`log`]). Both go through the same
//! operations in the same order, so they come to the same bits.

pub(crate) mod log;
mod plan;
pub(crate) mod terms;
mod wheels;

use crate::arithmetic::Fused;
use crate::motion::{ROUNDING, SUSPICIOUS};
use crate::spread::Covariance3;
use crate::state::State;
use crate::step::{bend, step_jacobian};
use crate::uncertainty::{
    GyroscopeIncrement, StepJacobian, StepNoise, fused_displacement, gain, propagate_error, remaining_covariance,
    remaining_error,
};
pub(crate) use plan::StepConstants;
use plan::StepScratch;
use six_wheel_kinematics::kernels::wheel_lanes::{Eight, GROUP, padded};
use six_wheel_numerics::error::HUGE;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::Kernel;
use six_wheel_numerics::simd::polynomials::sin_cos;
use six_wheel_numerics::simd::vector::Vector;
use terms::NoiseTerms;
use wheels::{InLanes, LaneSource, Register, Squares, accumulate_displacement, accumulate_noise, steering_error};

impl StepConstants {
    /// Makes one step; true if a wheel slides further than the noise explains. Returns None where the plain core has to
    /// make it; only the angles at the end have changed then.
    #[inline]
    pub fn step<'b>(&mut self, given: &StepInput<'b>, targets: &mut StepOutput<'b>) -> Option<bool> {
        let level = self.level;
        level.run(Step { plan: self, given, targets })?
    }
}

/// Input of a step: the state at its start and its readings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepInput<'a> {
    /// Readings of the wheels at its start and end.
    pub wheels: [&'a [f64]; 2],
    /// Readings of the steering joints at its start and end.
    pub steering: [&'a [f64]; 2],
    /// Steering angles at its start [rad].
    pub angles: &'a [f64],
    pub terms: NoiseTerms<f64>,
    pub turned: Option<GyroscopeIncrement<f64>>,
    /// Variance that the bias of a gyroscope wanders by [rad²/s²].
    pub wandered: f64,
}

/// Output of a step.
#[derive(Debug)]
pub(crate) struct StepOutput<'a> {
    /// Steering angles at the end [rad].
    pub angles: &'a mut [f64],
    /// Speed at which each contact slid [m/s].
    pub residual: &'a mut [f64],
    /// Changed at the very end.
    pub state: &'a mut State,
    pub noise: &'a mut StepNoise,
}

struct Step<'a, 'b> {
    plan: &'a mut StepConstants,
    given: &'a StepInput<'b>,
    targets: &'a mut StepOutput<'b>,
}

impl<S: Vector> Squares<S> {
    #[inline(always)]
    fn total(self) -> Covariance3 {
        let [xx, xy, xz, yy, yz, zz] = self.0;
        Covariance3::from([xx.total(), xy.total(), xz.total(), yy.total(), yz.total(), zz.total()])
    }
}

/// As many numbers as there is room for.
#[inline(always)]
fn put<S: Vector>(lanes: Lanes<S>, numbers: &mut [f64]) {
    if let ([register, ..], _) = S::as_mut_simd_f64s(numbers) {
        lanes.store(std::slice::from_mut(register), 0);
        return;
    }
    let mut room = [0.0; GROUP];
    lanes.store(S::as_mut_simd_f64s(&mut room).0, 0);
    for (number, lane) in numbers.iter_mut().zip(room) {
        *number = lane;
    }
}

impl Kernel for Step<'_, '_> {
    type Output = Option<bool>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Option<bool> {
        let Self { plan, given, targets } = self;
        let heading = targets.state.walk.heading.value();
        let (sin, cos) = sin_cos(simd, Lanes::splat(simd, heading));
        let terms = given.terms.broadcast(simd);
        let mut displacement = displace(simd, plan, given, &terms, targets)?;
        let dt = given.terms.dt;
        let (mut own, slips) = step_noise(simd, plan, &terms, displacement);
        let mut shared = None;
        if let Some(turned) = &given.turned {
            let ends = ends(simd, plan, &terms);
            let (gain, variance) = gain(Fused, turned, own.and(ends.and(ends)), dt);
            if variance.is_nan() || variance <= 0.0 {
                return None;
            }
            displacement = fused_displacement(Fused, gain, displacement, turned.turn);
            own = remaining_covariance(Fused, gain, own);
            let column = gain.map(|part| part * turned.deviation);
            let ends = remaining_covariance(Fused, gain, ends).and_square(Fused, column);
            shared = Some((gain, ends, column));
        }
        let twist = displacement.map(|part| part / dt);
        let is_usual = displacement.iter().all(|part| part.abs() < HUGE) && twist.iter().all(|part| part.is_finite());
        if !is_usual {
            return None;
        }
        let jacobian =
            step_jacobian(Fused, displacement, bend(Fused, displacement[2] / 2.0), [sin.last(simd), cos.last(simd)]);
        if !own.is_below(HUGE) {
            return None;
        }
        report(simd, plan, 1.0 / dt, targets.residual);
        let StepOutput { state, noise, .. } = targets;
        let uncertainty = &mut state.uncertainty;
        let by_gyroscope = shared.map(|(gain, ..)| gain);
        let carried = &mut uncertainty.carried;
        let [mut ends, mut whole] = carry(simd, plan, &terms, carried, &jacobian, by_gyroscope);
        let (by, lever) = (&jacobian.by_displacement, jacobian.lever());
        if let Some(column) = carried.last_mut()
            && (shared.is_some() || *column != [0.0; 3])
        {
            let mut end = [0.0; 3];
            if let Some((_, fused, column)) = shared {
                ends = fused;
                end = jacobian.ended(Fused, column);
            }
            whole = whole.and_square(Fused, propagate_error(Fused, lever, *column, end));
            *column = end;
        }
        let mut added = own.displaced(Fused, by).and(whole);
        if let Some(bias) = &mut uncertainty.bias {
            let by_bias = by_gyroscope.unwrap_or_default().map(|part| part * -dt);
            let by_bias = jacobian.ended(Fused, by_bias);
            added = added.and(bias.propagate(Fused, lever, by_bias, given.wandered));
        }
        let settled = uncertainty.settled.swung(Fused, lever).and(added);
        uncertainty.settle(settled, ends.displaced(Fused, by));
        uncertainty.carry_yaw_offset(lever);
        (noise.own, noise.ends) = (own, ends.and(ends));
        state.go(jacobian.shift, displacement[2]);
        state.hold(twist.into(), dt, given.terms.smoothing);
        Some(slips)
    }
}

/// The displacement in body axes; none where a reading is not of a usual size.
#[inline(always)]
fn displace<S: Vector>(
    simd: S,
    plan: &mut StepConstants,
    given: &StepInput<'_>,
    terms: &NoiseTerms<Lanes<S>>,
    targets: &mut StepOutput<'_>,
) -> Option<[f64; 3]> {
    let zero = Lanes::splat(simd, 0.0);
    let [before, after] = given.wheels;
    let mut usual = zero.at_most(zero);
    let mut said = [zero; 3];
    let mut joints = 0;
    for (group, room) in plan.groups.iter().zip(&mut plan.rooms) {
        for k in 0..group.registers(S::F64_LANES) {
            let wheels = &group.wheels[k * S::F64_LANES..][..S::F64_LANES];
            let pick = Register(simd, k);
            let gather = |all: &[f64]| {
                let mut room = [0.0; GROUP];
                for (place, &i) in room.iter_mut().zip(wheels) {
                    *place = all.get(i).copied().unwrap_or(0.0);
                }
                Lanes::load(simd, S::as_simd_f64s(&room).0, 0)
            };
            let counts = gather(after) - gather(before);
            let mut joint = None;
            if k * S::F64_LANES < group.steered {
                let rest = joints..given.angles.len();
                joints += S::F64_LANES;
                let [before, after] = given.steering.map(|all| padded(simd, &all[rest.clone()]));
                let start = padded(simd, &given.angles[rest.clone()]);
                let end = (after - before) * pick.of(&group.per_count[1]) + start;
                put(end, &mut targets.angles[rest]);
                joint = Some([(start + end) * Lanes::splat(simd, 0.5), end - start]);
            }
            let wheel = (group, pick);
            usual = usual & accumulate_displacement(simd, wheel, counts, joint, terms.most, &mut said, (room, k));
        }
    }
    if (!usual).any() {
        return None;
    }
    Some(said.map(Lanes::total))
}

/// Covariance of the displacement by what errs in this step alone, and true if a wheel slid further than the noise
/// explains.
#[inline(always)]
fn step_noise<S: Vector>(
    simd: S,
    plan: &mut StepConstants,
    terms: &NoiseTerms<Lanes<S>>,
    displacement: [f64; 3],
) -> (Covariance3, bool) {
    let zero = Lanes::splat(simd, 0.0);
    let step = displacement.map(|part| Lanes::splat(simd, part));
    let mut squares = Squares::new(simd);
    let mut suspects = zero.below(zero);
    for (group, room) in plan.groups.iter().zip(&mut plan.rooms) {
        for k in 0..group.registers(S::F64_LANES) {
            let wheel = (group, Register(simd, k));
            suspects = suspects | accumulate_noise(simd, wheel, step, terms, &mut squares, (room, k));
        }
    }
    let is_sure = terms.slip_bound.is_some() || !suspects.any();
    let slips = if is_sure { suspects.any() } else { is_slip(&plan.rooms) };
    (squares.total(), slips)
}

/// Covariance of the displacement by the joints' readings at one end.
#[inline(always)]
fn ends<S: Vector>(simd: S, plan: &StepConstants, terms: &NoiseTerms<Lanes<S>>) -> Covariance3 {
    let mut ends = Squares::new(simd);
    for (group, room) in plan.groups.iter().zip(&plan.rooms) {
        for k in 0..group.steered.div_ceil(S::F64_LANES) {
            ends.add_square(steering_error(simd, (group, Register(simd, k)), terms, (room, k)));
        }
    }
    ends.total()
}

/// The residuals of a step that was made, `per` one over its duration [1/s].
#[inline(always)]
fn report<S: Vector>(simd: S, plan: &StepConstants, per: f64, residual: &mut [f64]) {
    let per = Lanes::splat(simd, per);
    for (group, room) in plan.groups.iter().zip(&plan.rooms) {
        for k in 0..group.registers(S::F64_LANES) {
            let slid = Register(simd, k).of(&room.slid);
            let mut speeds: Eight = [0.0; GROUP];
            (slid * per).store(S::as_mut_simd_f64s(&mut speeds).0, 0);
            let wheels = &group.wheels[k * S::F64_LANES..][..S::F64_LANES];
            for (&i, speed) in wheels.iter().zip(speeds) {
                if let Some(target) = residual.get_mut(i) {
                    *target = speed;
                }
            }
        }
    }
}

/// True if a wheel slid further than the noise and the rounding of the others' fit explain.
#[inline(never)]
fn is_slip(rooms: &[StepScratch]) -> bool {
    let furthest = rooms.iter().flat_map(|room| room.rolled).fold(0.0_f64, |most, rolled| most.max(rolled.abs()));
    rooms.iter().any(|room| {
        let wheels = room.slid.iter().zip(&room.variance);
        wheels.into_iter().any(|(slid, variance)| *slid > SUSPICIOUS * variance.sqrt() + ROUNDING * furthest)
    })
}

/// Takes the joints' errors along: what one end of the step adds to the displacement's covariance by the wheels, and what
/// the columns that were carried come to at its end, where a gyroscope shares the step with this gain.
#[inline(always)]
fn carry<S: Vector>(
    simd: S,
    plan: &StepConstants,
    terms: &NoiseTerms<Lanes<S>>,
    carried: &mut [[f64; 3]],
    jacobian: &StepJacobian,
    gain: Option<[f64; 3]>,
) -> [Covariance3; 2] {
    let by = InLanes(simd);
    let splat = |number| Lanes::splat(simd, number);
    let ([a, b], [[c, d, e], [f, g, h]]) = (jacobian.shift, jacobian.by_displacement);
    let jacobian = StepJacobian {
        shift: [splat(a), splat(b)],
        by_displacement: [[splat(c), splat(d), splat(e)], [splat(f), splat(g), splat(h)]],
    };
    let lever = jacobian.lever();
    let (mut ends, mut settled) = (Squares::new(simd), Squares::new(simd));
    let mut columns = carried.as_flattened_mut().chunks_exact_mut(3 * S::F64_LANES);
    for (group, room) in plan.groups.iter().zip(&plan.rooms) {
        for k in 0..group.steered.div_ceil(S::F64_LANES) {
            let Some(columns) = columns.next() else { break };
            let mut half = steering_error(simd, (group, Register(simd, k)), terms, (room, k));
            ends.add_square(half);
            if let Some([x, y, z]) = gain {
                half = remaining_error(by, [splat(x), splat(y), splat(z)], half);
            }
            let end = jacobian.ended(by, half);
            settled.add_square(propagate_error(by, lever, Lanes::unbraid(simd, columns), end));
            Lanes::braid(end, columns);
        }
    }
    [ends.total(), settled.total()]
}
