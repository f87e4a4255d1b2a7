//! Setpoint of the steered wheels at the start of a cycle.

use nalgebra::{Matrix3, Vector3};

use super::drive::{REST, RolloutStart};
use super::limits::RoverLimits;
use crate::numbers::squares::square;
use six_wheel_numerics::simd::vec3::inner_product;

/// Largest error of steering angles that count as aligned for a motion [rad].
const ALIGNED: f64 = 0.02;
/// Share of the largest squared slip below which a motion counts as free of slip.
const NONE: f64 = 1e-12;

/// Sets the initial motion and steering setpoint of a cycle: the measured motion; the motion for which the steering
/// angles are aligned, if there is one; if there is none and the rover stands, the angles themselves.
pub(crate) fn initialize(bounds: &RoverLimits, motion: [f64; 3], steering: &[f64], to: &mut RolloutStart) {
    (to.motion, to.setpoint, to.steering_is_free) = (motion, motion, false);
    if bounds.joints.is_empty() || bounds.limits.steering_rate.is_infinite() {
        return;
    }
    let speed = square(&bounds.metric, &motion[..bounds.free]).max(0.0).sqrt();
    if let Some(setpoint) = aligned_motion(bounds, motion, steering) {
        to.setpoint = setpoint;
    } else if speed < REST {
        to.steering_is_free = true;
        to.angles.clear();
        to.angles.extend_from_slice(steering);
        // An arbitrary value: it is not used while the steering is free.
        to.setpoint[0] = 1.0;
    }
}

/// The motion for which all joints are aligned; of several the one nearest to the present motion.
fn aligned_motion(bounds: &RoverLimits, motion: [f64; 3], steering: &[f64]) -> Option<[f64; 3]> {
    let free = bounds.free;
    // Components times lengths: all are speeds.
    let lengths = Vector3::from_fn(|k, _| bounds.lengths.get(k).copied().unwrap_or(1.0));
    let mut slips = Matrix3::zeros();
    for (joint, angle) in bounds.joints.iter().zip(steering) {
        let (sin, cos) = (angle - joint.middle).sin_cos();
        let slip = |k: usize| cos * joint.across[k] - sin * joint.along[k];
        let row = Vector3::from_fn(|k, _| if k < free { slip(k) / lengths[k] } else { 0.0 });
        slips += row * row.transpose();
    }
    let most = slips.trace();
    if free == 2 {
        // The missing third component has the largest eigenvalue, so it is never the least.
        slips[(2, 2)] = 2.0 * most + 1.0;
    }
    let parts = slips.symmetric_eigen();
    let least = parts.eigenvalues.imin();
    let scaled = Vector3::from(motion).component_mul(&lengths);
    let mut found = Vector3::zeros();
    for (k, direction) in parts.eigenvectors.column_iter().enumerate() {
        if k == least || parts.eigenvalues[k] <= NONE * most {
            found += direction * direction.dot(&scaled);
        }
    }
    if found.amax() < REST {
        found = parts.eigenvectors.column(least).into_owned();
    }
    let found: [f64; 3] = found.component_div(&lengths).into();
    let moved = &found[..free];
    let size = square(&bounds.metric, moved).max(0.0).sqrt();
    let fits = bounds.joints.iter().zip(steering).all(|(joint, angle)| {
        let (along, across) = (inner_product(&joint.along, moved), inner_product(&joint.across, moved));
        // The direction of a pivot at rest is arbitrary.
        let rests = along.hypot(across) < REST * size;
        rests || ((across / along).atan() - (angle - joint.middle)).abs() <= ALIGNED
    });
    fits.then_some(found)
}
