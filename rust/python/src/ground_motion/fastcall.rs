//! The quick ways of `Suspension.traction`, `Suspension.inverse` and `Suspension.forward`: one instant of a control loop.

use pyo3::prelude::*;
use six_wheel_ground_motion::{
    BodyMotions, Command, Commands, Drives, Driving, Lift, ReadingRows, Turns, View, forward_rows, inverse_rows,
    traction_rows,
};
use six_wheel_numerics::error::LARGEST;

use super::results::{Columns, CommandRow, GroundCommand, GroundMotion, MotionRow};
use super::traction::{Traction, TractionRow};
use crate::fastcall::{Answer, Arguments, Numbers, Object, float, three};
use crate::settle::Stand;
use crate::suspension::Suspension;
use crate::workers::workers;

fast_methods! {
    TractionCall<6>: Suspension, c"traction", [c"speed", c"curvature", c"angular_velocity", c"joints", c"joint_rates", c"yaw_rate"], 5, traction;
    InverseCall<2>: Suspension, c"inverse", [c"stand", c"command"], 2, inverse;
    ForwardCall<3>: Suspension, c"forward", [c"stand", c"steering", c"wheel_speeds"], 3, forward;
}

#[inline(always)]
fn traction<'py>(
    this: Borrowed<'_, 'py, Suspension>,
    [speed, curvature, turning, joints, rates, yaw_rate]: Arguments<'_, 'py, 6>,
) -> Answer<'py> {
    let (py, suspension) = (this.py(), this.get());
    let chain = &suspension.chain;
    let (wheels, free, steered) = (chain.wheels().len(), chain.joints().len(), chain.steering().len());
    let (curved, turn) = match (curvature, yaw_rate) {
        (Some(curvature), None) => (true, float(curvature)?),
        (None, Some(yaw_rate)) => (false, float(yaw_rate)?),
        _ => return None,
    };
    let (speed, turning) = (float(speed?)?, three(turning?)?);
    let mut rooms = [Numbers::new(), Numbers::new()];
    let [room, other] = &mut rooms;
    // SAFETY: nothing is written before everything has been read.
    let (joints, rates) = unsafe { (room.read(joints?, free)?, other.read(rates?, free)?) };
    let numbers = [speed, turn];
    let mut numbers = numbers.iter().chain(&turning).chain(joints).chain(rates);
    if !numbers.all(|number| number.is_finite()) {
        return None;
    }
    let mut one = TractionRow { wheels, steered, ..TractionRow::default() };
    let driving = Driving {
        speed: &[speed],
        turning: if curved { Turns::Curvature(&[turn]) } else { Turns::YawRate(&[turn]) },
        angular_velocity: &[turning],
        joints,
        joint_rates: rates,
        steering: None,
        wheel_speeds: None,
        lift: Lift::default(),
    };
    let drives = Drives {
        steering: &mut one.steering[..steered],
        speeds: &mut one.speeds[..wheels],
        contact_angles: &mut one.contact_angles[..wheels],
        lifted: &mut one.lifted[..wheels],
        vertical: std::slice::from_mut(&mut one.vertical),
    };
    let workers = workers(None, None).ok()?;
    traction_rows(chain, &suspension.motion, &driving, drives, workers).ok()?;
    let traction = Bound::new(py, Traction(Columns::Single(one))).ok()?;
    Some(traction.into_any())
}

/// A stand of this very suspension at one pose.
#[inline(always)]
fn one_pose<'a>(this: Borrowed<'_, '_, Suspension>, stand: Object<'a, '_>) -> Option<&'a Stand> {
    let stand = stand.cast::<Stand>().ok()?.get();
    (stand.suspension.as_ptr() == this.as_ptr() && stand.leading.is_empty()).then_some(stand)
}

#[inline(always)]
fn inverse<'py>(this: Borrowed<'_, 'py, Suspension>, [stand, command]: Arguments<'_, 'py, 2>) -> Answer<'py> {
    let (py, suspension) = (this.py(), this.get());
    let stand = one_pose(this, stand?)?;
    let mut room = Numbers::new();
    // SAFETY: nothing is written before it has been read.
    let &[speed, yaw_rate] = unsafe { room.read(command?, 2)? }.first_chunk()?;
    if !(speed.is_finite() && yaw_rate.is_finite()) {
        return None;
    }
    let chain = &suspension.chain;
    let mut one = CommandRow {
        wheels: chain.wheels().len(),
        joints: chain.joints().len(),
        steered: chain.steering().len(),
        scale: 1.0,
        ..CommandRow::default()
    };
    let how = Command { view: View::Body, offset: suspension.motion.offset, wheel_speed: f64::INFINITY };
    let commands = Commands {
        steering: &mut one.steering[..one.steered],
        speeds: &mut one.speeds[..one.wheels],
        twists: &mut one.twist,
        joint_rates: &mut one.joint_rates[..one.joints],
        scales: std::slice::from_mut(&mut one.scale),
    };
    let workers = workers(None, None).ok()?;
    inverse_rows(chain, &suspension.motion, &stand.footings(), &how, &[[speed, yaw_rate]], None, commands, workers)
        .ok()?;
    let command = Bound::new(py, GroundCommand(Columns::Single(one))).ok()?;
    Some(command.into_any())
}

#[inline(always)]
fn forward<'py>(this: Borrowed<'_, 'py, Suspension>, [stand, steering, speeds]: Arguments<'_, 'py, 3>) -> Answer<'py> {
    let (py, suspension) = (this.py(), this.get());
    let stand = one_pose(this, stand?)?;
    let chain = &suspension.chain;
    let wheels = chain.wheels().len();
    let mut rooms = [Numbers::new(), Numbers::new()];
    let [room, other] = &mut rooms;
    // SAFETY: nothing is written before everything has been read.
    let (steering, speeds) = unsafe { (room.read(steering?, chain.steering().len())?, other.read(speeds?, wheels)?) };
    let large = speeds.iter().any(|speed| speed.abs() >= LARGEST);
    if large || !steering.iter().all(|angle| angle.is_finite()) {
        return None;
    }
    let mut one = MotionRow { wheels, joints: chain.joints().len(), ..MotionRow::default() };
    let readings = ReadingRows {
        steering: Some(steering),
        speeds,
        steering_rates: None,
        joint_rates: None,
        angular_velocity: None,
        weights: None,
    };
    let motions = BodyMotions {
        twists: &mut one.twist,
        joint_rates: &mut one.joint_rates[..one.joints],
        residuals: one.residual[..wheels].as_flattened_mut(),
    };
    let workers = workers(None, None).ok()?;
    let prepared = &suspension.motion;
    forward_rows(chain, prepared, &stand.footings(), &readings, motions, workers).ok()?;
    let motion = Bound::new(py, GroundMotion(Columns::Single(one))).ok()?;
    Some(motion.into_any())
}
