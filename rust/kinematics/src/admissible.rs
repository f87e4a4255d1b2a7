//! Admissible twists of a rover: no side slip, and every steering angle inside its range.
//!
//! In twist space the fixed wheels leave a subspace. Each steered wheel whose range is narrower than half
//! a turn leaves a double wedge of it, between the two planes on which it rolls exactly at an end of its
//! range. The admissible set is their intersection: a union of polyhedral cones.

pub(crate) mod check;
pub mod cone;
pub(crate) mod faces;
pub(crate) mod projection;
pub(crate) mod rows;

use nalgebra::Vector3;

use crate::admissible::cone::AdmissibleCone;
pub use crate::admissible::cone::SLIP_TOLERANCE;
use crate::geometry::Direction;
use crate::geometry::Twist;
use crate::rover_data::RoverData;
use crate::steering::SteeringRange;
use crate::wheels::Wheel;

/// Limits of the turning radius closer together than this are one limit [share of the size].
const SAME_RADIUS: f64 = 1e-9;

/// Part of a twist that a projection preserves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keep {
    /// Forward speed and yaw rate, hence the turning radius; past the limits neither grows.
    Curvature,
    /// Forward speed.
    Speed,
    /// Yaw rate.
    YawRate,
    /// The twist, with the least root mean square change of the pivots' velocities.
    Nearest,
}

named_values! {
    Keep as "keep": "curvature" => Curvature, "speed" => Speed, "yaw_rate" => YawRate, "nearest" => Nearest
}

impl RoverData {
    /// `(joint, wheel)` of the steered wheels that may slide sideways: those with trail, or at an end of their range.
    fn at_an_end<'a>(&'a self, steering: &'a [f64]) -> impl Iterator<Item = (usize, usize)> + 'a {
        let steered = self.steered().iter().copied().enumerate();
        steered.filter(|&(joint, i)| {
            let wheel = &self.wheels()[i];
            let inside = |range: SteeringRange| range.lower < steering[joint] && steering[joint] < range.upper;
            wheel.trail != 0.0 || !wheel.steering().is_some_and(inside)
        })
    }

    /// Largest side slip of a wheel at the steering angles of [`crate::rover::Rover::solve`] [m/s]: 0 if the rover can
    /// make the twist.
    pub fn scrub(&self, twist: Twist, steering: &[f64]) -> f64 {
        let vector = Vector3::from(twist);
        let fixed = self.banks.iter().map(|bank| bank.row.dot(&vector).abs());
        let slip = |(joint, i): (usize, usize)| {
            let wheel: &Wheel = &self.wheels()[i];
            wheel.side_slip(steering[joint], twist, 0.0).abs()
        };
        let steered = self.at_an_end(steering).map(slip);
        fixed.chain(steered).fold(0.0, f64::max)
    }

    /// Sets the speeds [rad/s] of wheels that slide sideways to the part of their contact's velocity along the heading.
    pub fn slow_down(&self, twist: Twist, steering: &[f64], speeds: &mut [f64]) {
        for (joint, i) in self.at_an_end(steering) {
            let wheel = &self.wheels()[i];
            let direction = Direction::from(wheel.heading + steering[joint]);
            let rolling = wheel.rows(direction).rolling;
            speeds[i] = rolling.dot(&Vector3::from(twist)) / wheel.radius;
        }
    }

    /// The planes on which a steered wheel rolls exactly at an end of its range, with its joint.
    fn limit_planes(&self) -> Vec<(usize, [Vector3<f64>; 2])> {
        let ends = |(joint, &i): (usize, &usize)| {
            let wheel = &self.wheels()[i];
            let range =
                wheel.steering().filter(|range| !range.is_full() || wheel.trail != 0.0 && !range.is_endless())?;
            let row = |angle: f64| wheel.rows(Direction::from(wheel.heading + angle)).side_slip;
            Some((joint, [row(range.lower), row(range.upper)]))
        };
        self.steered().iter().enumerate().filter_map(ends).collect()
    }

    fn limit_rows(&self) -> Vec<Vector3<f64>> {
        let planes = self.limit_planes();
        planes.into_iter().flat_map(|(_, rows)| rows).collect()
    }

    /// `(min_radius, spin_radius)` [m]: the smallest radius from which on every turn is possible, and the largest up to
    /// which every turn is.
    pub(crate) fn turning_limits(&self, cone: &AdmissibleCone) -> (f64, f64) {
        let line = match self.banks.as_slice() {
            [] => Vector3::new(0.0, 1.0, 0.0),
            [bank] => bank.row,
            _ => return (f64::INFINITY, 0.0),
        };
        // A turn of radius R at 1 rad/s is `spin + R straight`: `spin` turns about the foot P of the origin on the line
        // of the axle, `straight` has speed 1.
        let straight = Vector3::new(line.y, -line.x, 0.0);
        let spin = Vector3::new(-line.z * line.x, -line.z * line.y, 1.0);
        let possible = |twist: Vector3<f64>| cone.is_possible(twist.into());
        let mut ends: Vec<f64> = self.limit_rows().iter().map(|row| -row.dot(&spin) / row.dot(&straight)).collect();
        for wheel in self.steered().iter().map(|&i| &self.wheels()[i]) {
            ends.extend(trail_radii(wheel, straight.into(), spin.into()));
        }
        ends.retain(|radius| radius.is_finite());
        ends.sort_by(f64::total_cmp);
        ends.dedup_by(|b, a| (*b - *a).abs() <= SAME_RADIUS * self.size);
        let (Some(&first), Some(&last)) = (ends.first(), ends.last()) else {
            let all = possible(straight) && possible(spin);
            return if all { (0.0, f64::INFINITY) } else { (f64::INFINITY, 0.0) };
        };
        // The line of radii, cut at the limits, closes at infinity: its two outermost pieces meet in the straight line.
        let beyond = first.abs().max(last.abs()) + self.size;
        let straight_on = [-beyond, beyond].map(|radius| possible(spin + straight * radius));
        let mut min_radius: f64 = 0.0;
        let mut spin_radius = f64::INFINITY;
        for pair in ends.windows(2) {
            if !possible(spin + straight * f64::midpoint(pair[0], pair[1])) {
                min_radius = min_radius.max(pair[0].abs()).max(pair[1].abs());
                let holds_zero = pair[0] < 0.0 && pair[1] > 0.0;
                let inner = if holds_zero { 0.0 } else { pair[0].abs().min(pair[1].abs()) };
                spin_radius = spin_radius.min(inner);
            }
        }
        for (end, possible) in [(first, straight_on[0]), (-last, straight_on[1])] {
            if !possible {
                min_radius = f64::INFINITY;
                spin_radius = spin_radius.min((-end).max(0.0));
            }
        }
        (min_radius, spin_radius)
    }
}

/// Radii at which the pivot of a wheel with trail moves as fast as its contact turns about it, `|u| = |trail omega|`:
/// between them no steering angle is without side slip.
fn trail_radii(wheel: &Wheel, straight: Twist, spin: Twist) -> [f64; 2] {
    if wheel.trail == 0.0 {
        return [f64::NAN; 2];
    }
    // |spin + R straight| = trail at the pivot, and |straight| = 1.
    let (along, about) = (straight.at(wheel.x, wheel.y), spin.at(wheel.x, wheel.y));
    let middle = -along.dot(&about);
    let distance = about - along * along.dot(&about);
    let half_width = (wheel.trail * wheel.trail - distance.norm_squared()).sqrt();
    [middle - half_width, middle + half_width]
}
