//! Pose, motion and their uncertainty, one step at a time.

use nalgebra::{Matrix3, Vector3};

use super::arithmetic::Apart;
use super::step::{Motion, Rules, Workspace, bend, step_jacobian};
use super::uncertainty::{StepNoise, Uncertainty};
use crate::error::{Error, HUGE, finite, numbers};
use crate::geometry::{Pose, Twist, Walk, wrap_angle};
use crate::rover::Rover;

/// What changes from sample to sample and is taken back when a late pose comes.
#[derive(Clone, Debug)]
pub(crate) struct State {
    pub walk: Walk,
    pub twist: Twist,
    pub velocity: Option<Twist>,
    pub uncertainty: Uncertainty,
}

impl State {
    pub fn copy_from(&mut self, other: &Self) {
        self.walk = other.walk;
        self.twist = other.twist;
        self.velocity = other.velocity;
        self.uncertainty.copy_from(&other.uncertainty);
    }

    pub fn pose(&self) -> Pose {
        Pose { x: self.walk.x.value(), y: self.walk.y.value(), yaw: self.walk.yaw.value() }
    }

    /// Goes along the chord of a step, in world axes.
    #[inline(always)]
    pub fn go(&mut self, shift: [f64; 2], turn: f64) {
        self.walk.shift(shift[0], shift[1]);
        self.walk.turn(turn);
    }

    /// The mean twist over a step, and what its filter makes of it.
    #[inline(always)]
    pub fn hold(&mut self, twist: Twist, dt: f64, smoothing: f64) {
        self.twist = twist;
        self.velocity = Some(match self.velocity.filter(|_| smoothing > 0.0) {
            None => twist,
            Some(before) => {
                let share = -(-dt / smoothing).exp_m1();
                Twist {
                    vx: before.vx + share * (twist.vx - before.vx),
                    vy: before.vy + share * (twist.vy - before.vy),
                    omega: before.omega + share * (twist.omega - before.omega),
                }
            }
        });
    }

    /// Moves the pose by a correction.
    pub fn shift(&mut self, by: &Vector3<f64>) {
        self.walk.shift(by.x, by.y);
        self.walk.turn(by.z);
    }
}

/// One step of the state. On failure it has not changed.
pub(super) fn advance(
    rover: &Rover,
    rules: &Rules,
    motion: Motion<'_>,
    work: &mut Workspace,
    state: &mut State,
    habits: [f64; 2],
) -> Result<(), Error> {
    let kept = [work.noise.own, work.noise.ends];
    let found = work
        .displacement(rover, motion, rules)
        .and_then(|found| check_step(found, motion, &work.noise))
        .and_then(|found| {
            let lasting = work.find_lasting(rover, motion, rules.method);
            lasting.map(|()| found)
        });
    match found {
        Ok(displacement) => {
            follow(displacement, motion, work, state, habits);
            Ok(())
        }
        Err(error) => {
            // The covariance of the twist is that of the last step that was made.
            [work.noise.own, work.noise.ends] = kept;
            Err(error)
        }
    }
}

/// The displacement, if squares of it and of its noise are finite.
fn check_step(found: Twist, motion: Motion<'_>, noise: &StepNoise) -> Result<Twist, Error> {
    let step = <[f64; 3]>::from(found);
    let finite = step.iter().all(|part| part.abs() < HUGE)
        && noise.total().is_below(HUGE)
        && step.iter().all(|part| (part / motion.dt).is_finite());
    if finite {
        return Ok(found);
    }
    let rule = "be small enough for a finite pose and covariance";
    Err(Error::value("wheel_angles", rule, numbers(motion.turned)))
}

/// Goes along the displacement that a workspace has just found.
pub(super) fn follow(
    displacement: Twist,
    motion: Motion<'_>,
    work: &Workspace,
    state: &mut State,
    [smoothing, walk]: [f64; 2],
) {
    let (sin, cos) = state.walk.heading.value().sin_cos();
    let bend = bend(Apart, displacement.omega / 2.0);
    let jacobian = step_jacobian(Apart, displacement.into(), bend, [sin, cos]);
    state.uncertainty.propagate(&jacobian, &work.noise);
    let (gain, wandered) = (work.fusion().gain, walk * walk * motion.dt);
    state.uncertainty.lean_on_bias(&jacobian, &gain, motion.dt, wandered);
    state.go(jacobian.shift, displacement.omega);
    let twist = <[f64; 3]>::from(displacement).map(|part| part / motion.dt);
    state.hold(twist.into(), motion.dt, smoothing);
}

/// Takes in an absolute yaw; the first one tells where the sensor's zero is.
pub(super) fn meet_yaw(state: &mut State, yaw: f64, deviation: f64) {
    let (predicted, variance) = (state.walk.yaw.value(), deviation * deviation);
    match state.uncertainty.yaw_offset {
        None => state.uncertainty.set_yaw_offset(yaw - predicted, variance),
        Some(offset) => {
            let gain = state.uncertainty.correct_yaw(offset, variance);
            state.shift(&(gain * wrap_angle(yaw - predicted - offset.value)));
        }
    }
}

/// A pose from outside is one that sums of squares can be made of.
pub(super) fn check_pose(pose: &[f64]) -> Result<(), Error> {
    finite("pose", pose)?;
    if pose.iter().all(|part| part.abs() < HUGE) {
        return Ok(());
    }
    let rule = format!("be smaller than {HUGE:e} in every part");
    Err(Error::value("pose", rule, numbers(pose)))
}

/// A variance from outside: one that sums of squares cannot be made of says nothing, like an infinite one.
pub(super) fn read_variance(value: f64) -> f64 {
    if value < HUGE { value } else { value * f64::INFINITY }
}

/// A covariance that is symmetric and has no negative variance; infinite ones say nothing of a direction.
pub(super) fn check_covariance(covariance: [[f64; 3]; 3]) -> Result<Matrix3<f64>, Error> {
    let mut matrix = Matrix3::from(covariance);
    for k in 0..3 {
        matrix[(k, k)] = read_variance(matrix[(k, k)]);
    }
    let refused = |rule| Err(Error::value("covariance", rule, numbers(matrix.as_slice())));
    let finite = matrix.map(|value| if value.is_finite() { value } else { 0.0 });
    let diagonal = matrix.diagonal();
    if matrix.iter().any(|value| value.is_nan())
        || matrix.iter().enumerate().any(|(k, value)| k % 4 != 0 && value.abs() >= HUGE)
        || diagonal.iter().any(|value| *value < 0.0)
    {
        return refused("hold variances on its diagonal and finite covariances beside it");
    }
    let scale = |i: usize, k: usize| (finite[(i, i)] * finite[(k, k)]).sqrt();
    for (i, k) in [(0, 1), (0, 2), (1, 2)] {
        let known = diagonal[i].is_finite() && diagonal[k].is_finite();
        if (finite[(i, k)] - finite[(k, i)]).abs() > 1e-9 * scale(i, k) {
            return refused("be symmetric");
        }
        if known && finite[(i, k)].abs() > scale(i, k) * (1.0 + 1e-9) {
            return refused("have no negative variance in any direction");
        }
    }
    let symmetric = (finite + finite.transpose()) / 2.0;
    if symmetric.symmetric_eigenvalues().min() < -1e-9 * symmetric.trace() {
        return refused("have no negative variance in any direction");
    }
    Ok((matrix + matrix.transpose()) / 2.0)
}
