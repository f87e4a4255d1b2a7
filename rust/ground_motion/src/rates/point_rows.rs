//! Velocities of points of one rover, as functions of the rates.

use nalgebra::Vector3;
use pulp::Scalar;

use super::contact_rows::{COLUMNS, velocity_rows};
use six_wheel_numerics::simd::level::run_scalar;
use six_wheel_terrain::suspension::kinematics::{LinkPose, MatrixPose};
use six_wheel_terrain::suspension::lanes::{all, splat};
use six_wheel_terrain::suspension::{Chain, MAX_STATE, Placed};

/// A chain in the axes of its own body. None where a differential does not reach.
pub(crate) fn in_body<'a>(chain: &'a Chain, joints: &[f64], steering: &[f64]) -> Option<Placed<'a>> {
    let mut state = [0.0; MAX_STATE];
    for (angle, joint) in state[3..].iter_mut().zip(joints) {
        *angle = *joint;
    }
    chain.place([0.0; 3].into(), &state, steering)
}

/// Derivatives of a velocity by the rates.
pub type Row = [f64; COLUMNS];

/// Derivatives of the velocities along some directions of a point that moves with the link of a wheel, of a chain in
/// the axes of its body: by the rates, and by the rate of the wheel's own steering [m/rad].
pub(crate) fn point_rows<const N: usize>(
    placed: &Placed<'_>,
    wheel: usize,
    point: Vector3<f64>,
    directions: [Vector3<f64>; N],
) -> ([Row; N], [f64; N]) {
    run_scalar(lane_rows, (placed, wheel, point, directions))
}

/// See [`point_rows`].
#[inline(always)]
fn lane_rows<const N: usize>(
    (placed, wheel, point, directions): (&Placed<'_>, usize, Vector3<f64>, [Vector3<f64>; N]),
) -> ([Row; N], [f64; N]) {
    let lanes = |vector: Vector3<f64>| splat(Scalar, vector.into());
    let link = |axis, origin| MatrixPose::on_axis(lanes(axis), lanes(origin));
    let (point, directions) = (lanes(point), directions.map(lanes));
    let (mut rows, mut swivel) = ([[all(Scalar, 0.0); COLUMNS]; N], [0.0; N]);
    let movers = placed.free_axes(wheel).map(|(joint, axis, origin)| (link(axis, origin), joint));
    velocity_rows(movers, point, directions, &mut rows);
    if let Some((_, axis, origin)) = placed.steering_axes(wheel).next() {
        swivel = link(axis, origin).slopes(point, &directions).map(|part| part.last(Scalar));
    }
    (rows.map(|row| row.map(|part| part.last(Scalar))), swivel)
}
