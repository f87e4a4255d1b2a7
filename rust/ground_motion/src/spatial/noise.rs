//! Errors of the displacement over one step, and the correction by a gyroscope.

use nalgebra::{Matrix6, Vector3, Vector6};

use super::spread::{Columns, GYROSCOPE, JOINTS, RATES, STEERING, StepNoise, TILT, whole};
use super::way::{Tilt, Way, WheelMotion};
use crate::MEMORY;
use six_wheel_odometry::motion::{ROUNDING, SUSPICIOUS};
use six_wheel_odometry::settings::Readings as Kind;
use six_wheel_terrain::suspension::MAX_WHEELS;

/// Elimination of the yaw: derivatives of a displacement by something that the yaw, and with it the measured turn,
/// depends on as well.
struct Closing {
    /// Of the displacement by the yaw that it does not measure itself.
    by_yaw: Vector6<f64>,
    /// Derivative of the yaw equation by the yaw: the vertical part of the turn less that of the displacement.
    spread: f64,
    up: Vector3<f64>,
}

impl Closing {
    fn of(told: &WheelMotion, tilt: &Tilt) -> Self {
        let up = tilt.up;
        let by_yaw = match tilt.yaw {
            Some(_) => Vector6::zeros(),
            None => {
                let [by_x, by_y] = told.response.by_tilting.map(Vector6::from);
                by_x * up.x + by_y * up.y
            }
        };
        Self { spread: up.z - by_yaw[5], by_yaw, up }
    }

    /// The displacement's derivative, given that at a held yaw, and that of the measured turn.
    fn close(&self, by: Vector6<f64>, turn: &Vector3<f64>) -> Vector6<f64> {
        let yaw = (by[5] - turn.z) / self.spread;
        let moved = by + self.by_yaw * yaw;
        let about = turn + self.up * yaw;
        whole(&Vector3::new(moved[0], moved[1], moved[2]), &about)
    }
}

/// Fills in what the displacement may be off by. Whether a contact slid further than that explains.
pub(crate) fn errors(way: &Way<'_>, told: &WheelMotion, tilt: Option<&Tilt>, into: &mut StepNoise) -> bool {
    let noise = &way.settings.common.noise;
    let (chain, response) = (way.chain, &told.response);
    let count = chain.wheels().len();
    let sharing = noise.sharing(way.dt);
    let reading_variance = sharing * (noise.speed * way.dt).powi(2);
    let steering_deviation = sharing.sqrt() * noise.steering;
    let from_rates = way.settings.common.readings == Kind::Speeds;
    let closing = tilt.map(|tilt| Closing::of(told, tilt));
    let still = Vector3::zeros();
    let close = |by: [f64; 6]| match &closing {
        Some(closing) => closing.close(Vector6::from(by), &still),
        None => Vector6::from(by),
    };
    let doubt = match tilt.is_some() || way.after.joints.iter().any(|joint| !joint.is_nan()) {
        true => way.doubt,
        false => 0.0,
    };
    let ways: [[f64; 2]; MAX_WHEELS] = std::array::from_fn(|wheel| {
        let [along, aside] = told.slid[wheel];
        let rolled = way.radii[wheel] * way.turned[wheel];
        [along + if rolled.is_nan() { 0.0 } else { rolled }, aside]
    });
    let furthest = ways[..count].iter().fold(0.0_f64, |most, [ahead, _]| most.max(ahead.abs()));
    let mut slips = false;
    let mut steering = [Vector6::zeros(); MAX_WHEELS];
    for (wheel, &[ahead, left]) in ways.iter().enumerate().take(count) {
        let [along_slid, aside] = told.slid[wheel];
        if aside.is_nan() {
            continue; // in the air
        }
        let radius = way.radii[wheel];
        let read = !along_slid.is_nan();
        let distance = ahead.hypot(left);
        // The noise of a slope stays the same over the way it is averaged over.
        let climbed = told.slopes[wheel].powi(2) * distance * way.doubt / MEMORY;
        let along = noise.slip * noise.slip * distance + climbed;
        let across = noise.side_slip * noise.side_slip * distance;
        let by_way = close(response.by_speed[wheel]) / radius;
        let by_side = close(response.by_side[wheel]);
        let own = match from_rates {
            true => {
                let half = by_way * (reading_variance.sqrt() / 2.0);
                (into.old[RATES + wheel], into.new[RATES + wheel]) = (half, half);
                along
            }
            false => along + reading_variance,
        };
        into.own += by_way * by_way.transpose() * own + by_side * by_side.transpose() * across;
        let mut variance = across + doubt * doubt;
        if read {
            variance += along + reading_variance;
        }
        if let Some(joint) = told.contacts.wheels[wheel].steering {
            // A steering angle turns the rim towards its left.
            let tilted = told.at[wheel].cos;
            steering[joint] += (by_side * ahead - by_way * left) * tilted;
            variance += (steering_deviation * ahead).powi(2);
        }
        let slid = if read { along_slid.hypot(aside) } else { aside.abs() };
        let bound = match way.settings.common.slip_threshold {
            Some(threshold) => threshold * way.dt,
            None => SUSPICIOUS * variance.sqrt() + ROUNDING * furthest,
        };
        slips |= slid > bound;
    }
    for (joint, by_angle) in steering[..chain.steering().len()].iter().enumerate() {
        let half = by_angle * (steering_deviation / 2.0);
        let change = close(response.by_steering_rate[joint]) * steering_deviation;
        (into.old[STEERING + joint], into.new[STEERING + joint]) = (half - change, half + change);
    }
    for joint in 0..chain.joints().len() {
        let by = close(response.by_joint_rate[joint]) * way.settings.joint_noise;
        (into.old[JOINTS + joint], into.new[JOINTS + joint]) = (-by, by);
    }
    if let (Some(tilt), Some(closing), Some(turn)) = (tilt, &closing, &told.turn) {
        let [by_x, by_y] = response.by_tilting.map(Vector6::from);
        let [old, new] = tilt.by_ends(turn, way);
        let moved = |by: Vector3<f64>| closing.close(by_x * by.x + by_y * by.y, &by) * way.settings.attitude_noise;
        for axis in 0..2 {
            into.old[TILT + axis] = moved(old[axis]);
            into.new[TILT + axis] = moved(new[axis]);
        }
    }
    slips
}

/// Corrects the displacement by a gyroscope, or by the yaw of an attitude: the turn is the mean of both, weighted by
/// their noise.
pub(crate) fn share(
    way: &Way<'_>,
    told: &WheelMotion,
    tilt: Option<&Tilt>,
    noise: &mut StepNoise,
) -> Option<Vector6<f64>> {
    let known = tilt.and_then(|tilt| tilt.yaw.map(|yaw| tilt.turn(yaw).z));
    let turn = match (way.after.yaw_rate, known) {
        (Some(rate), _) => f64::midpoint(way.before.yaw_rate.unwrap_or(rate), rate) * way.dt,
        (None, Some(turn)) => turn,
        (None, None) => return None,
    };
    let told_by = &way.settings.common.noise;
    // The reading at each end counts for half the step.
    let deviation = told_by.yaw_rate * told_by.sharing(way.dt).sqrt() * way.dt / 2.0;
    let of_wheels = StepNoise { own: noise.own, old: wheels_only(&noise.old), new: wheels_only(&noise.new) };
    let total = of_wheels.total();
    let spread = total[(5, 5)] + 2.0 * deviation * deviation;
    let mut gain = if spread > 0.0 { total.column(5) / spread } else { Vector6::new(0.0, 0.0, 0.0, 0.0, 0.0, 1.0) };
    if let Some(tilt) = tilt {
        // Tilt at the ends is as it was measured: the body turns about the vertical.
        gain[3] = gain[5] * tilt.up.x / tilt.up.z;
        gain[4] = gain[5] * tilt.up.y / tilt.up.z;
    }
    let mut rest = Matrix6::identity();
    for k in 0..6 {
        rest[(k, 5)] -= gain[k];
    }
    noise.own = rest * noise.own * rest.transpose();
    // The yaw of an attitude turns with its tilt.
    let by_tilt = match (tilt, &told.turn, way.after.yaw_rate) {
        (Some(tilt), Some(turn), None) => {
            let [old, new] = tilt.by_ends(turn, way);
            [old, new].map(|ends| ends.map(|by| by.z * way.settings.attitude_noise))
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
    Some(gain * (turn - told.twist[5]))
}

/// Columns of what the wheels err by.
fn wheels_only(columns: &Columns) -> Columns {
    let mut wheels = *columns;
    wheels[JOINTS..].fill(Vector6::zeros());
    wheels
}
