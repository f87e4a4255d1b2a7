//! One step of odometry: displacement, slip, covariance, fusion with a gyroscope, and the state at its end.
//!
//! Every wheel has two rows in the equations of a step ([`wheels`]). If the solution of the least squares is a constant
//! of the rover, so are the shares of the wheels in the displacement, at given steering angles; otherwise they are
//! fitted ([`fit`]). The equations after that are the same:
//!
//! ```text
//! d, cov(d) by the wheels, fused with the yaw increment of a gyroscope         (propagation)
//! x' = x ⊕ d,   e' = F e + L e_d                                               (propagation)
//! ```
//!
//! One sample has the wheels in the lanes of a register (here), a log successive steps ([`crate::log`]). Both evaluate the
//! same functions, and add up the wheels in the same order, so they come to the same bits on every level.

mod constants;
mod fit;
mod input;
pub(crate) mod sums;
pub(crate) mod terms;
pub(crate) mod wheels;

use nalgebra::Vector3;
use pulp::Scalar;

pub(crate) use self::constants::{StepConstants, StepScratch};
pub(crate) use self::fit::{WheelFit, shared_readings};
pub(crate) use self::input::{StepInput, StepOutput, WheelInput};
use self::sums::{
    excess_covariance, propagate_columns, shared_covariance, sum_displacement, sum_noise, write_residuals,
};
use self::terms::{NoiseTerms, gyroscope_deviation};
use crate::motion::Motion;
use crate::propagation::arc::{Arc, StepJacobian, propagate_error};
use crate::propagation::covariance::{Covariance3, lane, numbers};
use crate::propagation::fusion::{GyroscopeIncrement, KalmanGain, remaining_covariance, remaining_error};
use crate::settings::{Readings, Settings};
use crate::state::State;
use crate::uncertainty::{StepNoise, Uncertainty};
use six_wheel_kinematics::rover::Rover;
use six_wheel_numerics::error::{Error, HUGE, numbers as text};
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::Kernel;
use six_wheel_numerics::simd::polynomials::sin_cos;
use six_wheel_numerics::simd::vector::Vector;

/// Memory of a step, so that none is allocated while driving, and the results that are no part of the state.
#[derive(Clone, Debug)]
pub(crate) struct Workspace {
    pub constants: StepConstants,
    pub fit: WheelFit,
    pub noise: StepNoise,
    /// Displacement of the last step [m, m, rad].
    pub displacement: [f64; 3],
    /// Gain of a gyroscope in the last step.
    pub gain: [f64; 3],
}

impl Workspace {
    pub fn new(rover: &Rover, settings: &Settings) -> Self {
        let shared = shared_readings(rover, settings.readings == Readings::Speeds);
        Self {
            constants: StepConstants::new(settings, rover),
            fit: WheelFit::new(rover, settings, shared),
            noise: StepNoise {
                own: Covariance3::default(),
                ends: Covariance3::default(),
                constant_errors: vec![[0.0; 3]; settings.constant_error_count()],
            },
            displacement: [0.0; 3],
            gain: [0.0; 3],
        }
    }

    /// Integrates a step. Returns true if a wheel slides further than the noise explains; None if a reading has to be
    /// checked first, or squares of the result may not be finite.
    #[inline]
    pub fn step<'b>(&mut self, input: &StepInput<'b>, output: StepOutput<'b>) -> Option<bool> {
        let level = self.constants.level;
        level.run_any(Step { work: self, input, output })
    }

    /// Integrates a step by rotations that were checked, with constant or fitted equations. On failure the state has
    /// not changed.
    pub fn advance(
        &mut self,
        rover: &Rover,
        settings: &Settings,
        motion: Motion<'_>,
        bound: f64,
        state: Option<&mut State>,
        residual: &mut [f64],
    ) -> Result<bool, Error> {
        let [before, after] = motion.steering;
        let too_large =
            || Error::value("wheel_angles", "be small enough for a finite pose and covariance", text(motion.turned));
        let increments = before.iter().zip(after).map(|(before, after)| after - before);
        if !motion.turned.iter().copied().chain(increments).all(|value| value.abs() < HUGE || value.is_nan()) {
            return Err(too_large());
        }
        let is_complete = motion.turned.iter().all(|turned| !turned.is_nan());
        let wheels = if self.constants.is_constant && is_complete {
            WheelInput::Rotations { turned: motion.turned, steering: motion.steering }
        } else {
            self.fit.solve(rover, settings, motion, &mut self.constants)?;
            WheelInput::Fitted
        };
        let Motion { dt, from_rates, gyro_turn, bias_variance, .. } = motion;
        let input = StepInput { settings, wheels, dt, from_rates, gyro_turn, bias_variance, bound };
        self.step(&input, StepOutput { angles: &mut [], residual, state }).ok_or_else(too_large)
    }
}

struct Step<'a, 'b> {
    work: &'a mut Workspace,
    input: &'a StepInput<'b>,
    output: StepOutput<'b>,
}

/// Displacement in body axes [m, m, rad] and its covariance, by the wheels, or fused with a gyroscope.
#[derive(Clone, Copy)]
struct BodyStep {
    displacement: [Lanes<Scalar>; 3],
    /// Covariance by errors of this step alone.
    own: Covariance3<Lanes<Scalar>>,
    /// Covariances by readings at its start and at its end that the neighbouring steps share, without the gyroscope's.
    shared: [Covariance3<Lanes<Scalar>>; 2],
    gyroscope: Option<GyroscopeError>,
}

/// Gain of a gyroscope, and the error of the displacement by the deviation of its reading at one end.
#[derive(Clone, Copy)]
struct GyroscopeError {
    gain: KalmanGain<Scalar>,
    column: [Lanes<Scalar>; 3],
}

impl Kernel for Step<'_, '_> {
    type Output = Option<bool>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Option<bool> {
        let Self { work, input, output } = self;
        let (settings, dt) = (input.settings, input.dt);
        let terms = NoiseTerms::new(settings, Lanes::splat(simd, dt), input.from_rates);
        let is_fitted = matches!(input.wheels, WheelInput::Fitted);
        let displacement = match is_fitted {
            true => work.fit.displacement.into(),
            false => sum_displacement(simd, &mut work.constants, &input.wheels, &terms, output.angles)?,
        };
        let (mut own, slips) = sum_noise(simd, &mut work.constants, is_fitted, &terms, displacement);
        if settings.inflate {
            own = own.and(excess_covariance(&work.constants, is_fitted, &work.fit.weights));
        }
        let fitted = is_fitted.then_some(&work.fit);
        let shared = shared_covariance(simd, &work.constants, fitted, &terms);
        let mut step = BodyStep {
            displacement: lane(displacement),
            own: own.lane(),
            shared: shared.map(Covariance3::lane),
            gyroscope: None,
        };
        if let Some(turn) = input.gyro_turn {
            step = step.fuse(settings, dt, turn, input.bias_variance);
        }
        let displacement = numbers(step.displacement);
        let mut ends = step.shared[0].and(step.shared[1]);
        if let Some(GyroscopeError { column, .. }) = step.gyroscope {
            ends = ends.and_square(column).and_square(column);
        }
        let (own, ends) = (step.own.total(), ends.total());
        let is_finite = displacement.iter().all(|part| part.abs() < input.bound && (part / dt).is_finite())
            && own.and(ends).is_below(input.bound);
        if !is_finite {
            return None;
        }
        write_residuals(simd, &work.constants, dt, output.residual);
        (work.noise.own, work.noise.ends) = (own, ends);
        work.displacement = displacement;
        work.gain = step.gyroscope.map_or([0.0; 3], |gyroscope| numbers(gyroscope.gain));
        if let Some(state) = output.state {
            propagate(simd, work, input, &terms, &step, state);
        }
        Some(slips)
    }
}

impl BodyStep {
    /// Fuses the yaw increment of a gyroscope [rad].
    #[inline(always)]
    fn fuse(self, settings: &Settings, dt: f64, turn: f64, bias_variance: f64) -> Self {
        let Self { displacement, own, shared: [old, new], .. } = self;
        let dt = Lanes::splat(Scalar, dt);
        let gyroscope = GyroscopeIncrement {
            is_read: Lanes::splat(Scalar, 1.0),
            turn: Lanes::splat(Scalar, turn),
            deviation: gyroscope_deviation(settings, dt),
            bias_variance: Lanes::splat(Scalar, bias_variance),
        };
        let gain = gyroscope.kalman_gain(own.and(old.and(new)), dt);
        Self {
            displacement: gyroscope.posterior_displacement(gain, displacement),
            own: remaining_covariance(gain, own),
            shared: [remaining_covariance(gain, old), remaining_covariance(gain, new)],
            gyroscope: Some(GyroscopeError { gain, column: gyroscope.error(gain) }),
        }
    }
}

/// Propagates the state through a step.
#[inline(always)]
fn propagate<S: Vector>(
    simd: S,
    work: &mut Workspace,
    input: &StepInput<'_>,
    terms: &NoiseTerms<S>,
    step: &BodyStep,
    state: &mut State,
) {
    let (settings, dt) = (input.settings, input.dt);
    let half = step.displacement[2] * Lanes::splat(Scalar, 0.5);
    let (sin, cos) = sin_cos(Scalar, Lanes::splat(Scalar, state.pose_sums.heading.value()));
    let jacobian = StepJacobian::new(step.displacement, Arc::new(Scalar, half), [sin, cos]);
    let (by, lever) = (&jacobian.by_displacement, jacobian.yaw_lever());
    let uncertainty = &mut state.uncertainty;
    let gain = step.gyroscope.map(|gyroscope| gyroscope.gain);
    let fitted = matches!(input.wheels, WheelInput::Fitted).then_some(&work.fit);
    let carried = &mut uncertainty.carried;
    let mut whole = propagate_columns(simd, &work.constants, fitted, terms, carried, &jacobian, gain).lane();
    let mut open = step.shared[1];
    if let Some(column) = uncertainty.carried.last_mut()
        && (step.gyroscope.is_some() || *column != [0.0; 3])
    {
        let mut end = lane([0.0; 3]);
        if let Some(GyroscopeError { column, .. }) = step.gyroscope {
            open = open.and_square(column);
            end = jacobian.displacement_error(column);
        }
        whole = whole.and_square(propagate_error(lever, lane(*column), end));
        *column = numbers(end);
    }
    let mut added = step.own.displacement_image(by).and(whole);
    if let Some(bias) = &mut uncertainty.bias {
        let [x, y, z] = gain.unwrap_or(lane([0.0; 3]));
        let minus_dt = Lanes::splat(Scalar, -dt);
        let by_bias = jacobian.displacement_error([x * minus_dt, y * minus_dt, z * minus_dt]);
        added = added.and(bias.propagate(lever, by_bias, settings.bias_variance_increment(dt)));
    }
    let settled = uncertainty.settled.lane().propagate(lever).and(added);
    uncertainty.settle(settled.total(), open.displacement_image(by).total());
    uncertainty.propagate_yaw_offset(lever);
    if !uncertainty.constant_errors.is_empty() {
        propagate_constant_errors(work, input, gain, &jacobian, uncertainty);
    }
    let displacement = numbers(step.displacement);
    state.add_displacement(numbers(jacobian.shift), displacement[2]);
    state.hold_twist(displacement.map(|part| part / dt).into(), dt, settings.smoothing);
}

/// Propagates the errors of dimensions and of a gyroscope's scale, which are constant over the run.
#[inline(always)]
fn propagate_constant_errors(
    work: &mut Workspace,
    input: &StepInput<'_>,
    gain: Option<KalmanGain<Scalar>>,
    jacobian: &StepJacobian<Scalar>,
    uncertainty: &mut Uncertainty,
) {
    let errors = &mut work.noise.constant_errors;
    errors.copy_from_slice(&work.fit.constant_errors);
    if let Some(gain) = gain {
        for error in errors.iter_mut() {
            *error = numbers(remaining_error(gain, lane(*error)));
        }
        let scale_noise = input.settings.scale_noise();
        if scale_noise > 0.0
            && let Some(by_scale) = errors.last_mut()
        {
            let turn = input.gyro_turn.unwrap_or(0.0) * scale_noise;
            *by_scale = Vector3::from(numbers(gain)).scale(turn).into();
        }
    }
    for (pose_error, error) in uncertainty.constant_errors.iter_mut().zip(errors) {
        pose_error.pose = numbers(jacobian.propagate(lane(pose_error.pose.into()), lane(*error))).into();
    }
}
