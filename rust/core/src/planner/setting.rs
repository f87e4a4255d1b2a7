//! What the steered wheels are set for where a cycle begins.

use nalgebra::DMatrix;

use super::drive::{Begin, REST};
use super::facts::{Facts, dot, square};

/// Angles by which joints may miss a motion and still be set for it [rad].
const ALIGNED: f64 = 0.02;

/// Motion, setting and loose joints of a cycle: the motion there is; what the angles are set for, if they are for any
/// motion at all; where they are, if the rover stands and they are not.
pub(crate) fn begin(facts: &Facts, motion: &[f64], steering: &[f64], to: &mut Begin) {
    to.motion.clear();
    to.motion.extend_from_slice(motion);
    to.setting.clear();
    to.setting.extend_from_slice(motion);
    to.loose = None;
    if facts.joints.is_empty() || facts.limits.steering_rate.is_infinite() {
        return;
    }
    let speed = square(&facts.metric, motion).max(0.0).sqrt();
    if let Some(setting) = set_for(facts, motion, steering) {
        to.setting.clone_from(&setting);
    } else if speed < REST {
        to.loose = Some(steering.to_vec());
        // Any will do: it is not looked at.
        to.setting[0] = 1.0;
    }
}

/// The motion all joints are set for, that next to the present one if there are several.
fn set_for(facts: &Facts, motion: &[f64], steering: &[f64]) -> Option<Vec<f64>> {
    let free = facts.free;
    let mut slips = DMatrix::zeros(free, free);
    for (joint, angle) in facts.joints.iter().zip(steering) {
        let (sin, cos) = (angle - joint.middle).sin_cos();
        // In lengths, so that all components count alike.
        let row: Vec<f64> =
            (0..free).map(|k| (cos * joint.across[k] - sin * joint.along[k]) / facts.lengths[k]).collect();
        for i in 0..free {
            for j in 0..free {
                slips[(i, j)] += row[i] * row[j];
            }
        }
    }
    let parts = slips.symmetric_eigen();
    let most = parts.eigenvalues.max();
    let mut least = 0;
    for k in 0..free {
        if parts.eigenvalues[k] < parts.eigenvalues[least] {
            least = k;
        }
    }
    let scaled: Vec<f64> = (0..free).map(|k| motion[k] * facts.lengths[k]).collect();
    let mut found = vec![0.0; free];
    for k in (0..free).filter(|&k| k == least || parts.eigenvalues[k] <= 1e-12 * most) {
        let direction: Vec<f64> = parts.eigenvectors.column(k).iter().copied().collect();
        let share = dot(&direction, &scaled);
        for (sum, part) in found.iter_mut().zip(&direction) {
            *sum += share * part;
        }
    }
    if found.iter().map(|part| part.abs()).fold(0.0, f64::max) < REST {
        found = parts.eigenvectors.column(least).iter().copied().collect();
    }
    for (part, length) in found.iter_mut().zip(&facts.lengths) {
        *part /= length;
    }
    let size = square(&facts.metric, &found).max(0.0).sqrt();
    let fits = facts.joints.iter().zip(steering).all(|(joint, angle)| {
        let (along, across) = (dot(&joint.along, &found), dot(&joint.across, &found));
        // A pivot that rests points anywhere.
        along.hypot(across) < REST * size || ((across / along).atan() - (angle - joint.middle)).abs() <= ALIGNED
    });
    fits.then_some(found)
}
