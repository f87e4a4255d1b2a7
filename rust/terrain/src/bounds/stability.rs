//! Loads of the wheels in a settled pose, and its margin against tipping over.

use nalgebra::{Matrix6, Unit, Vector3, Vector6};

use crate::ground::Stand;
use crate::suspension::{Chain, MAX_WHEELS, Placed};

/// Shares of the weight that the wheels carry, with vertical forces at the contacts.
///
/// Virtual work: for every motion of the body in z, roll and pitch and of a free joint, the work of the loads is that
/// of the weight in `centre` of the body, which gives as many equations as wheels. A joint at its stop takes any
/// moment, and a wheel in the air has no load. None if the equations do not determine the loads. A negative load is a
/// force downwards.
pub fn loads(chain: &Chain, stand: &Stand, placed: &Placed<'_>, centre: [f64; 3]) -> Option<[f64; MAX_WHEELS]> {
    let count = chain.wheels().len();
    let weight = placed.origin + placed.rotation * Vector3::from(centre);
    let mut matrix = Matrix6::zeros();
    let mut right = Vector6::zeros();
    for (row, slope) in placed.body_slopes(weight).iter().enumerate() {
        right[row] = slope.z;
    }
    let states = chain.state_count();
    for wheel in (0..count).filter(|&wheel| stand.touches(wheel)) {
        let point = stand.point(chain, placed, wheel);
        // Derivatives by x, y, yaw, z, roll, pitch and the free angles.
        let slopes = placed.point_slopes(wheel, point);
        for state in 0..states {
            matrix[(state, wheel)] = slopes[3 + state].z;
        }
    }
    // For every wheel in the air, the equation of a joint at its stop is left out.
    let mut held: Vec<usize> = (0..states - 3).filter(|&joint| stand.stops[joint] != 0).collect();
    for wheel in (0..6).filter(|&wheel| wheel >= count || !stand.touches(wheel)) {
        let row = if wheel >= count || states < 6 && held.is_empty() {
            (states..6).find(|&row| matrix.row(row).iter().all(|value| *value == 0.0))
        } else {
            held.pop().map(|joint| 3 + joint)
        }?;
        matrix.row_mut(row).fill(0.0);
        matrix[(row, wheel)] = 1.0;
        right[row] = 0.0;
    }
    let found = matrix.lu().solve(&right)?;
    let shares: [f64; MAX_WHEELS] = std::array::from_fn(|wheel| found[wheel]);
    shares.iter().all(|share| share.is_finite()).then_some(shares)
}

/// The least angle of a rotation about a line through two contacts that brings the centre of mass above that line
/// [rad]; negative if it is beyond the line.
///
/// (E. Papadopoulos, D. Rey, A new measure of tipover stability margin for mobile manipulators, ICRA 1996, for a
/// rover at rest.)
pub fn tip_over_angle(chain: &Chain, stand: &Stand, placed: &Placed<'_>, centre: [f64; 3]) -> Option<f64> {
    tip_over_edge(chain, stand, placed, centre).map(|edge| edge.angle)
}

/// The line about which a rover tips over first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    /// See [`tip_over_angle`] [rad].
    pub angle: f64,
    /// The wheels whose contacts it goes through.
    pub wheels: [usize; 2],
    /// These contacts [m].
    pub points: [Vector3<f64>; 2],
}

/// See [`tip_over_angle`].
pub(super) fn tip_over_edge(chain: &Chain, stand: &Stand, placed: &Placed<'_>, centre: [f64; 3]) -> Option<Edge> {
    let weight = placed.origin + placed.rotation * Vector3::from(centre);
    let touching = (0..chain.wheels().len()).filter(|&wheel| stand.touches(wheel));
    let mut points: Vec<(Vector3<f64>, usize)> =
        touching.map(|wheel| (stand.point(chain, placed, wheel), wheel)).collect();
    let hull = hull(&mut points)?;
    let mut least: Option<Edge> = None;
    for (k, (from, first)) in hull.iter().enumerate() {
        let (to, second) = hull[(k + 1) % hull.len()];
        let edge = Unit::new_normalize(to - from);
        let across = |v: Vector3<f64>| v - edge.scale(v.dot(&edge));
        let (down, line) = (across(-Vector3::z()), across(from - weight));
        // Edges are counter-clockwise seen from above: the centre of mass is to the left of the edge.
        let angle = edge.dot(&line.cross(&down)).atan2(line.dot(&down));
        if least.is_none_or(|least| angle < least.angle) {
            least = Some(Edge { angle, wheels: [*first, second], points: [*from, to] });
        }
    }
    least.filter(|least| least.angle.is_finite())
}

/// The convex hull of points seen from above, counter-clockwise; None if they are on a line.
fn hull(points: &mut [(Vector3<f64>, usize)]) -> Option<Vec<(Vector3<f64>, usize)>> {
    points.sort_by(|(a, _), (b, _)| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let turns = |a: &Vector3<f64>, b: &Vector3<f64>, c: &Vector3<f64>| {
        (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) > 0.0
    };
    let chain = |points: &mut dyn Iterator<Item = &(Vector3<f64>, usize)>| {
        let mut chain: Vec<(Vector3<f64>, usize)> = Vec::new();
        for point in points {
            while let [.., a, b] = chain[..] {
                if turns(&a.0, &b.0, &point.0) {
                    break;
                }
                chain.pop();
            }
            chain.push(*point);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut points.iter());
    hull.extend(chain(&mut points.iter().rev()));
    (hull.len() >= 3).then_some(hull)
}

/// Angle to the nearer stop of every free joint [rad], infinite without stops.
pub fn joint_margins(chain: &Chain, stand: &Stand) -> impl Iterator<Item = f64> {
    let joints = chain.joints().iter().zip(&stand.state[3..]);
    joints.map(|(joint, angle)| (joint.range.upper - angle).min(angle - joint.range.lower))
}

/// Angle between the body's z axis and the vertical [rad].
#[inline]
pub fn tilt(placed: &Placed<'_>) -> f64 {
    let up = placed.rotation.column(2);
    up.x.hypot(up.y).atan2(up.z)
}

/// Largest distance, in the body, of a wheel below its position at angles 0 [m].
pub fn wheel_drop(chain: &Chain, placed: &Placed<'_>, level: &[f64; MAX_WHEELS]) -> f64 {
    let up = placed.rotation.column(2);
    let drops =
        (0..chain.wheels().len()).map(|wheel| level[wheel] - up.dot(&(placed.wheel(wheel).centre - placed.origin)));
    drops.fold(f64::NEG_INFINITY, f64::max)
}
