//! One step of the state: its displacement found, checked and followed.

use crate::arithmetic::Unfused;
use crate::motion::Motion;
use crate::settings::Rules;
use crate::state::State;
use crate::step::{Workspace, bend, step_jacobian};
use crate::uncertainty::StepNoise;
use six_wheel_kinematics::geometry::{Twist, wrap_angle};
use six_wheel_kinematics::rover::Rover;
use six_wheel_numerics::error::{Error, HUGE, numbers};

/// One step of the state. On failure it has not changed.
pub(crate) fn advance(
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
pub(crate) fn follow(
    displacement: Twist,
    motion: Motion<'_>,
    work: &Workspace,
    state: &mut State,
    [smoothing, walk]: [f64; 2],
) {
    let (sin, cos) = state.walk.heading.value().sin_cos();
    let bend = bend(Unfused, displacement.omega / 2.0);
    let jacobian = step_jacobian(Unfused, displacement.into(), bend, [sin, cos]);
    state.uncertainty.propagate(&jacobian, &work.noise);
    let (gain, wandered) = (work.fusion().gain, walk * walk * motion.dt);
    state.uncertainty.lean_on_bias(&jacobian, &gain, motion.dt, wandered);
    state.go(jacobian.shift, displacement.omega);
    let twist = <[f64; 3]>::from(displacement).map(|part| part / motion.dt);
    state.hold(twist.into(), motion.dt, smoothing);
}

/// Takes in an absolute yaw; the first one tells where the sensor's zero is.
pub(crate) fn meet_yaw(state: &mut State, yaw: f64, deviation: f64) {
    let (predicted, variance) = (state.walk.yaw.value(), deviation * deviation);
    match state.uncertainty.yaw_offset {
        None => state.uncertainty.set_yaw_offset(yaw - predicted, variance),
        Some(offset) => {
            let gain = state.uncertainty.correct_yaw(offset, variance);
            state.shift(&(gain * wrap_angle(yaw - predicted - offset.value)));
        }
    }
}
