//! Setpoint of the steered wheels at the start of a cycle.

use nalgebra::{Matrix3, Vector3};

use super::drive::{REST, RolloutStart};
use super::limits::RoverLimits;
use crate::numbers::squares::square;
use six_wheel_numerics::simd::vec3::inner_product;

/// Angles by which joints may miss a motion and still be set for it [rad].
const ALIGNED: f64 = 0.02;
/// Share of the largest slip below which a motion has none.
const NONE: f64 = 1e-12;

/// Initial motion and steering setpoint of a cycle: the measured motion; the motion the steering angles are set for, if
/// there is one; the angles themselves if the rover stands and there is none.
pub(crate) fn initialize(bounds: &RoverLimits, motion: [f64; 3], steering: &[f64], to: &mut RolloutStart) {
    (to.motion, to.setpoint, to.steering_is_free) = (motion, motion, false);
    if bounds.joints.is_empty() || bounds.limits.steering_rate.is_infinite() {
        return;
    }
    let speed = square(&bounds.metric, &motion[..bounds.free]).max(0.0).sqrt();
    if let Some(setpoint) = set_for(bounds, motion, steering) {
        to.setpoint = setpoint;
    } else if speed < REST {
        to.steering_is_free = true;
        to.angles.clear();
        to.angles.extend_from_slice(steering);
        // Any will do: it is not looked at.
        to.setpoint[0] = 1.0;
    }
}

/// The motion all joints are set for, that next to the present one if there are several.
fn set_for(bounds: &RoverLimits, motion: [f64; 3], steering: &[f64]) -> Option<[f64; 3]> {
    let free = bounds.free;
    // In lengths, so that all components count alike.
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
        // A missing motion is the worst of all.
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
        // A pivot that rests points anywhere.
        let rests = along.hypot(across) < REST * size;
        rests || ((across / along).atan() - (angle - joint.middle)).abs() <= ALIGNED
    });
    fits.then_some(found)
}
