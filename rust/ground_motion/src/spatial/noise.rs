//! Errors of the displacement over one step, and the correction by a gyroscope.

use nalgebra::{Matrix6, Vector3, Vector6};

use super::readings::{StepReadings, TiltPair, WheelMotion};
use super::spread::{Columns, GYROSCOPE, JOINTS, RATES, STEERING, StepNoise, TILT};
use crate::AVERAGING_LENGTH;
use six_wheel_odometry::gyroscope::mean_rate;
use six_wheel_odometry::motion::{ROUNDING, SUSPICIOUS};
use six_wheel_odometry::preintegrated::space::stack;
use six_wheel_odometry::settings::Readings as Kind;
use six_wheel_terrain::suspension::MAX_WHEELS;

/// Elimination of the yaw from derivatives of a displacement by a quantity that also changes the yaw, and with it the
/// turn between the measured tilts.
struct YawClosure {
    /// Derivative of the displacement by the yaw, where the attitude has no yaw of its own; else 0.
    by_yaw: Vector6<f64>,
    /// Derivative of the yaw equation by the yaw: the vertical part of the turn less that of the displacement.
    slope: f64,
    /// The vertical in the body in the middle of the step.
    up: Vector3<f64>,
}

impl YawClosure {
    fn new(motion: &WheelMotion, tilt: &TiltPair) -> Self {
        let up = tilt.up;
        let by_yaw = match tilt.yaw {
            Some(_) => Vector6::zeros(),
            None => {
                let [by_x, by_y] = motion.response.by_tilting.map(Vector6::from);
                by_x * up.x + by_y * up.y
            }
        };
        Self { slope: up.z - by_yaw[5], by_yaw, up }
    }

    /// Derivative of the displacement, from that at a constant yaw and that of the measured turn.
    fn eliminate_yaw(&self, by: Vector6<f64>, turn: &Vector3<f64>) -> Vector6<f64> {
        let yaw = (by[5] - turn.z) / self.slope;
        let moved = by + self.by_yaw * yaw;
        let about = turn + self.up * yaw;
        stack(&Vector3::new(moved[0], moved[1], moved[2]), &about)
    }
}

/// A step with the terms of its noise.
struct NoisyStep<'a> {
    step: &'a StepReadings<'a>,
    motion: &'a WheelMotion,
    closure: Option<YawClosure>,
    /// Variance of the distance that a wheel rolled, as read [m²].
    reading_variance: f64,
    /// Standard deviation of a steering angle [rad].
    steering_deviation: f64,
    /// Standard deviation of the distance that a wheel's centre moved across the ground, 0 where that was not measured
    /// [m].
    centre_deviation: f64,
    /// Distance of every contact along its rim and to its left [m].
    distances: [[f64; 2]; MAX_WHEELS],
}

impl<'a> NoisyStep<'a> {
    fn new(step: &'a StepReadings<'a>, motion: &'a WheelMotion, tilt: Option<&TiltPair>) -> Self {
        let noise = &step.settings.common.noise;
        let sharing = noise.sharing(step.dt);
        let is_measured = tilt.is_some() || step.after.joints.iter().any(|joint| !joint.is_nan());
        Self {
            closure: tilt.map(|tilt| YawClosure::new(motion, tilt)),
            reading_variance: sharing * (noise.speed * step.dt).powi(2),
            steering_deviation: sharing.sqrt() * noise.steering,
            centre_deviation: if is_measured { step.centre_deviation } else { 0.0 },
            distances: std::array::from_fn(|wheel| {
                let [along, aside] = motion.slid[wheel];
                let rolled = step.radii[wheel] * step.turned[wheel];
                [along + if rolled.is_nan() { 0.0 } else { rolled }, aside]
            }),
            step,
            motion,
        }
    }

    /// Derivative of the displacement by a quantity on which the measured turn does not depend, from that at a constant
    /// yaw.
    fn eliminate_yaw(&self, by: [f64; 6]) -> Vector6<f64> {
        match &self.closure {
            Some(closure) => closure.eliminate_yaw(Vector6::from(by), &Vector3::zeros()),
            None => Vector6::from(by),
        }
    }

    /// Adds the errors of a wheel. Returns its derivative by a steering angle, and true if it slid further than the noise
    /// and the rounding of the farthest distance explain; none in the air.
    fn add_wheel(&self, wheel: usize, farthest: f64, errors: &mut StepNoise) -> Option<(Vector6<f64>, bool)> {
        let Self { step, motion, distances, .. } = self;
        let (noise, response) = (&step.settings.common.noise, &motion.response);
        let [[ahead, left], [along_slid, aside]] = [distances[wheel], motion.slid[wheel]];
        if aside.is_nan() {
            return None;
        }
        let is_read = !along_slid.is_nan();
        let distance = ahead.hypot(left);
        // The error of a slope s is constant over L = AVERAGING_LENGTH deviation: variance (L s / AVERAGING_LENGTH)²
        // per L.
        let climbed = motion.slopes[wheel].powi(2) * distance * step.centre_deviation / AVERAGING_LENGTH;
        let along = noise.slip * noise.slip * distance + climbed;
        let across = noise.side_slip * noise.side_slip * distance;
        let by_distance = self.eliminate_yaw(response.by_speed[wheel]) / step.radii[wheel];
        let by_side = self.eliminate_yaw(response.by_side[wheel]);
        let mut own = along + self.reading_variance;
        if step.settings.common.readings == Kind::Speeds {
            let half = by_distance * (self.reading_variance.sqrt() / 2.0);
            (errors.old[RATES + wheel], errors.new[RATES + wheel]) = (half, half);
            own = along;
        }
        errors.own += by_distance * by_distance.transpose() * own + by_side * by_side.transpose() * across;
        let mut variance = across + self.centre_deviation * self.centre_deviation;
        if is_read {
            variance += along + self.reading_variance;
        }
        if motion.contacts.wheels[wheel].steering.is_some() {
            variance += (self.steering_deviation * ahead).powi(2);
        }
        let slid = size_of_slip(motion.slid[wheel]);
        let bound = match step.settings.common.slip_threshold {
            Some(threshold) => threshold * step.dt,
            None => SUSPICIOUS * variance.sqrt() + ROUNDING * farthest,
        };
        // Rotated by an angle, a displacement (ahead, left) changes by (-left, ahead) per angle.
        let by_angle = (by_side * ahead - by_distance * left) * motion.at[wheel].cos;
        Some((by_angle, slid > bound))
    }

    /// Adds the errors of the measured tilt at both ends.
    fn add_tilt(&self, tilt: &TiltPair, closure: &YawClosure, turn: &Vector3<f64>, errors: &mut StepNoise) {
        let [by_x, by_y] = self.motion.response.by_tilting.map(Vector6::from);
        let [old, new] = tilt.by_ends(turn, self.step);
        let deviation = self.step.settings.attitude_noise;
        let moved = |by: Vector3<f64>| closure.eliminate_yaw(by_x * by.x + by_y * by.y, &by) * deviation;
        for axis in 0..2 {
            errors.old[TILT + axis] = moved(old[axis]);
            errors.new[TILT + axis] = moved(new[axis]);
        }
    }
}

/// Size of the slip of a contact along its rim and to its left; that to the left alone of a wheel without an encoder,
/// whose slip along its rim is NaN.
#[inline]
pub fn size_of_slip([along, aside]: [f64; 2]) -> f64 {
    if along.is_nan() { aside.abs() } else { along.hypot(aside) }
}

/// Writes the errors of the displacement. Returns true if a contact slid farther than they explain.
pub(crate) fn displacement_errors(
    step: &StepReadings<'_>,
    motion: &WheelMotion,
    tilt: Option<&TiltPair>,
    errors: &mut StepNoise,
) -> bool {
    let noisy = NoisyStep::new(step, motion, tilt);
    let (chain, response) = (step.chain, &motion.response);
    let count = chain.wheels().len();
    let farthest = noisy.distances[..count].iter().fold(0.0_f64, |most, [ahead, _]| most.max(ahead.abs()));
    let mut slips = false;
    let mut by_steering = [Vector6::zeros(); MAX_WHEELS];
    for wheel in 0..count {
        let Some((by_angle, slides)) = noisy.add_wheel(wheel, farthest, errors) else { continue };
        slips |= slides;
        if let Some(joint) = motion.contacts.wheels[wheel].steering {
            by_steering[joint] += by_angle;
        }
    }
    for (joint, by_angle) in by_steering[..chain.steering().len()].iter().enumerate() {
        let half = by_angle * (noisy.steering_deviation / 2.0);
        let change = noisy.eliminate_yaw(response.by_steering_rate[joint]) * noisy.steering_deviation;
        (errors.old[STEERING + joint], errors.new[STEERING + joint]) = (half - change, half + change);
    }
    for joint in 0..chain.joints().len() {
        let by = noisy.eliminate_yaw(response.by_joint_rate[joint]) * step.settings.joint_noise;
        (errors.old[JOINTS + joint], errors.new[JOINTS + joint]) = (-by, by);
    }
    if let (Some(tilt), Some(closure), Some(turn)) = (tilt, &noisy.closure, &motion.turn) {
        noisy.add_tilt(tilt, closure, turn, errors);
    }
    slips
}

/// Corrects the displacement by a gyroscope, or by the yaw of an attitude: the turn is the mean of both, weighted by
/// their noise.
pub(crate) fn fuse_yaw_increment(
    step: &StepReadings<'_>,
    motion: &WheelMotion,
    tilt: Option<&TiltPair>,
    noise: &mut StepNoise,
) -> Option<Vector6<f64>> {
    let known = tilt.and_then(|tilt| tilt.yaw.map(|yaw| tilt.turn(yaw).z));
    let turn = match (step.after.yaw_rate, known) {
        (Some(rate), _) => mean_rate(step.before.yaw_rate, rate) * step.dt,
        (None, Some(turn)) => turn,
        (None, None) => return None,
    };
    let deviations = &step.settings.common.noise;
    // The reading at each end counts for half the step.
    let deviation = deviations.yaw_rate * deviations.sharing(step.dt).sqrt() * step.dt / 2.0;
    let of_wheels = StepNoise { own: noise.own, old: wheels_only(&noise.old), new: wheels_only(&noise.new) };
    let total = of_wheels.total();
    let variance = total[(5, 5)] + 2.0 * deviation * deviation;
    let mut gain = if variance > 0.0 { total.column(5) / variance } else { Vector6::new(0.0, 0.0, 0.0, 0.0, 0.0, 1.0) };
    if let Some(tilt) = tilt {
        // With the tilt at both ends measured, the correction turns the body about the vertical.
        gain[3] = gain[5] * tilt.up.x / tilt.up.z;
        gain[4] = gain[5] * tilt.up.y / tilt.up.z;
    }
    let mut rest = Matrix6::identity();
    for k in 0..6 {
        rest[(k, 5)] -= gain[k];
    }
    noise.own = rest * noise.own * rest.transpose();
    // Errors of roll and pitch change the turn at a constant yaw of the attitude.
    let by_tilt = match (tilt, &motion.turn, step.after.yaw_rate) {
        (Some(tilt), Some(turn), None) => {
            let [old, new] = tilt.by_ends(turn, step);
            [old, new].map(|ends| ends.map(|by| by.z * step.settings.attitude_noise))
        }
        _ => [[0.0; 2]; 2],
    };
    for (columns, by_tilt) in [&mut noise.old, &mut noise.new].into_iter().zip(by_tilt) {
        for (k, column) in columns.iter_mut().enumerate() {
            *column = rest * *column;
            if (TILT..TILT + 2).contains(&k) {
                *column += gain * by_tilt[k - TILT];
            }
        }
        columns[GYROSCOPE] = gain * deviation;
    }
    Some(gain * (turn - motion.twist[5]))
}

/// Columns of readings of the wheels.
fn wheels_only(columns: &Columns) -> Columns {
    let mut wheels = *columns;
    wheels[JOINTS..].fill(Vector6::zeros());
    wheels
}
