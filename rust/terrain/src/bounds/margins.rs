//! Derivatives of tilt, joint margins, tip-over angle and clearance of settled poses, by the pose or by dimensions.
//!
//! The derivatives of the state keep all gaps closed ([`crate::ground::by_pose`]). A contact moves with its rim, and
//! along it so that its gap stays the least: inside a cell by the second derivatives of the gap, on a crease with the
//! crease.

use nalgebra::Vector3;

use super::belly::{Belly, Lowest};
use super::stability::tip_over_edge;
use crate::ground::{DIMENSIONS, Stand, by_dimension, by_pose, shift_by_dimension};
use crate::suspension::{Chain, Dimensions, MAX_FREE, MAX_STATE, Placed, PointSlopes};
use crate::terrain::{Interpolation, Sample, Terrain};

/// A contact nearer to a line of the grid than this is on it [columns or rows].
const ON_A_LINE: f64 = 1e-8;

/// Derivatives of the margins of one pose; NaN for a margin without derivatives.
#[derive(Clone, Copy, Debug)]
pub struct MarginSlopes<const N: usize> {
    /// Derivatives of the angle between the body's z axis and the vertical.
    pub tilt: [f64; N],
    /// Derivatives of the angle of every free joint to its nearer stop; 0 where it has none.
    pub joints: [[f64; N]; MAX_FREE],
    /// Derivatives of [`super::tip_over_angle`].
    pub tip_over_angle: [f64; N],
    /// Derivatives of the clearance of the belly.
    pub clearance: [f64; N],
}

/// The variables of the derivatives.
#[derive(Clone, Copy)]
enum By<'a> {
    Pose,
    Dimension(&'a Dimensions),
}

/// A settled pose with the derivatives of its state.
#[derive(Clone, Copy)]
struct SettledJacobian<'a, const N: usize> {
    ground: &'a Terrain,
    chain: &'a Chain,
    stand: &'a Stand,
    placed: &'a Placed<'a>,
    by: By<'a>,
    state: [[f64; N]; MAX_STATE],
}

/// Derivatives by x, y and yaw. None where the state is not determined.
pub fn margins_by_pose(
    ground: &Terrain,
    chain: &Chain,
    stand: &Stand,
    placed: &Placed<'_>,
    centre: [f64; 3],
    belly: Option<Belly>,
) -> Option<MarginSlopes<3>> {
    let state = by_pose(chain, placed, stand)?;
    let by = By::Pose;
    let answer = SettledJacobian { ground, chain, stand, placed, by, state };
    Some(answer.margins(centre, belly))
}

/// Derivatives by the dimensions of a rocker-bogie, in the order of [`crate::ground::by_dimension`], at constant centre
/// of mass and belly. None where the state is not determined.
pub fn margins_by_dimension(
    ground: &Terrain,
    (chain, of): (&Chain, &Dimensions),
    stand: &Stand,
    placed: &Placed<'_>,
    centre: [f64; 3],
    belly: Option<Belly>,
) -> Option<MarginSlopes<DIMENSIONS>> {
    let state = by_dimension(chain, of, placed, stand)?;
    let by = By::Dimension(of);
    let answer = SettledJacobian { ground, chain, stand, placed, by, state };
    Some(answer.margins(centre, belly))
}

impl<const N: usize> SettledJacobian<'_, N> {
    fn margins(&self, centre: [f64; 3], belly: Option<Belly>) -> MarginSlopes<N> {
        let nothing = [f64::NAN; N];
        MarginSlopes {
            tilt: self.tilt(),
            joints: self.joints(),
            tip_over_angle: self.tip_over_angle(centre).unwrap_or(nothing),
            clearance: belly.and_then(|belly| self.clearance(&belly)).unwrap_or(nothing),
        }
    }

    fn tilt(&self) -> [f64; N] {
        let up = self.placed.origin + self.placed.rotation.column(2);
        // d cos(tilt) = -sin(tilt) d tilt, the derivative of the height of the end of the body's z axis.
        let [_, by_roll, by_pitch] = self.placed.body_slopes(up);
        let axis = self.placed.rotation.column(2);
        let sine = axis.x.hypot(axis.y);
        std::array::from_fn(|k| {
            let sinks = by_roll.z * self.state[1][k] + by_pitch.z * self.state[2][k];
            -sinks / sine
        })
    }

    fn joints(&self) -> [[f64; N]; MAX_FREE] {
        let mut answers = [[0.0; N]; MAX_FREE];
        let joints = self.chain.joints().iter().zip(&self.stand.state[3..]);
        for (k, (joint, angle)) in joints.enumerate() {
            let [below, above] = [angle - joint.range.lower, joint.range.upper - angle];
            let sign = match below.min(above) {
                margin if margin == f64::INFINITY => 0.0,
                margin if margin == below => 1.0,
                _ => -1.0,
            };
            answers[k] = self.state[3 + k].map(|turn| sign * turn);
        }
        answers
    }

    /// Derivatives of a point: `moved`, those at a constant state, plus `slopes` times the derivatives of the state.
    fn with_state(&self, mut moved: [Vector3<f64>; N], slopes: &[Vector3<f64>]) -> [Vector3<f64>; N] {
        for (slope, state) in slopes.iter().zip(&self.state) {
            for (point, by) in moved.iter_mut().zip(state) {
                *point += slope * *by;
            }
        }
        moved
    }

    /// Derivatives of a point fixed to the body [m].
    fn body(&self, point: Vector3<f64>) -> [Vector3<f64>; N] {
        let arm = point - self.placed.origin;
        let mut moved = [Vector3::zeros(); N];
        if let (By::Pose, [x, y, yaw, ..]) = (self.by, &mut moved[..]) {
            *x = Vector3::x();
            *y = Vector3::y();
            *yaw = Vector3::new(-arm.y, arm.x, 0.0);
        }
        self.with_state(moved, &self.placed.body_slopes(point))
    }

    /// Derivatives of a point fixed to the carrier of a wheel, and of a direction from there.
    fn carried(&self, wheel: usize, point: Vector3<f64>, direction: Vector3<f64>) -> [[Vector3<f64>; N]; 2] {
        let here = self.placed.point_slopes(wheel, point);
        let there = self.placed.point_slopes(wheel, point + direction);
        let turns: PointSlopes = std::array::from_fn(|k| there[k] - here[k]);
        let (mut moved, mut turned) = ([Vector3::zeros(); N], [Vector3::zeros(); N]);
        match self.by {
            By::Pose => {
                for k in 0..N.min(3) {
                    (moved[k], turned[k]) = (here[k], turns[k]);
                }
            }
            By::Dimension(of) => {
                let shift = shift_by_dimension(of, self.placed, wheel);
                moved[..N.min(DIMENSIONS - 1)].copy_from_slice(&shift[..N.min(DIMENSIONS - 1)]);
            }
        }
        [self.with_state(moved, &here[3..]), self.with_state(turned, &turns[3..])]
    }

    /// Derivatives of the touching point of a wheel.
    fn contact(&self, wheel: usize) -> Option<[Vector3<f64>; N]> {
        let (frame, contact) = (self.placed.wheel(wheel), &self.stand.wheels[wheel]);
        let (radius, at) = (self.chain.wheels()[wheel].radius, contact.at);
        let (spoke, tangent) = (frame.spoke(at), frame.tangent(at));
        let point = frame.centre + spoke * radius;
        let [mut moved, turned] = self.carried(wheel, point, tangent);
        if let (By::Dimension(_), Some(by_radius)) = (self.by, moved.last_mut()) {
            *by_radius += spoke;
        }
        let [u, v] = self.ground.placement().grid_from_offset(point.x, point.y);
        let on_line = [u, v].map(|place| (place - place.round()).abs() < ON_A_LINE);
        let upwards = contact.upwards();
        let along = self.in_grid(tangent);
        let [rows, columns] = self.ground.shape();
        let on_grid = self.ground.on_grid(u, v);
        let place = on_grid.then_some([(u as usize).min(columns - 2), (v as usize).min(rows - 2)]);
        let cell = place.map(|[column, row]| self.ground.cell(column, row))?;
        for (point, turn) in moved.iter_mut().zip(turned) {
            let shift = self.in_grid(*point);
            let way = match on_line {
                [true, _] => -shift[0] / along[0],
                [_, true] => -shift[1] / along[1],
                _ => {
                    let bend = cell.twist * (along[0] * shift[1] + along[1] * shift[0]);
                    let curve = 2.0 * radius * cell.twist * along[0] * along[1];
                    let changes = turn.dot(&upwards) - bend;
                    -changes / (-spoke.dot(&upwards) - curve) * radius
                }
            };
            *point += tangent * way;
        }
        Some(moved)
    }

    /// A direction, in columns and rows.
    fn in_grid(&self, direction: Vector3<f64>) -> [f64; 2] {
        let [dx, dy] = self.ground.placement().spacing();
        let [u, v] = self.ground.placement().grid_axes([direction.x, direction.y]);
        [u / dx, v / dy]
    }

    fn tip_over_angle(&self, centre: [f64; 3]) -> Option<[f64; N]> {
        let edge = tip_over_edge(self.chain, self.stand, self.placed, centre)?;
        let weight = self.placed.origin + self.placed.rotation * Vector3::from(centre);
        let [from, to] = edge.wheels.map(|wheel| self.contact(wheel));
        let (from, to, falls) = (from?, to?, self.body(weight));
        let (way, line) = (edge.points[1] - edge.points[0], edge.points[0] - weight);
        let (length, down) = (way.norm(), -Vector3::z());
        let axis = way / length;
        let across = axis.dot(&line.cross(&down));
        let below = line.dot(&down) - line.dot(&axis) * down.dot(&axis);
        Some(std::array::from_fn(|k| {
            let turn = to[k] - from[k];
            let turn = (turn - axis * axis.dot(&turn)) / length;
            let shift = from[k] - falls[k];
            let across_by = turn.dot(&line.cross(&down)) + axis.dot(&shift.cross(&down));
            let below_by = shift.dot(&down)
                - (shift.dot(&axis) + line.dot(&turn)) * down.dot(&axis)
                - line.dot(&axis) * down.dot(&turn);
            (below * across_by - across * below_by) / (below * below + across * across)
        }))
    }

    fn clearance(&self, belly: &Belly) -> Option<[f64; N]> {
        let (_, lowest) = belly.lowest(self.ground, self.placed.origin, &self.placed.rotation)?;
        match lowest {
            Lowest::Node { point } => {
                let up = self.placed.rotation.column(2);
                let moved = self.body(point);
                Some(moved.map(|moved| moved.dot(&up) / up.z))
            }
            Lowest::Edge { point, way, line } => {
                let Sample::Known { gradient, .. } =
                    self.ground.sample_offset(point.x, point.y, Interpolation::Bilinear)
                else {
                    return None;
                };
                let upwards = Vector3::new(-gradient[0], -gradient[1], 1.0);
                Some(self.body(point).map(|moved| {
                    let along = line.map_or(0.0, |axis| -self.in_grid(moved)[axis] / self.in_grid(way)[axis]);
                    (moved + way * along).dot(&upwards)
                }))
            }
        }
    }
}
