//! Velocities of points of one rover, as functions of the rates.

use nalgebra::Vector3;

use super::contact_rows::{COLUMNS, velocity_rows};
use six_wheel_numerics::simd::level::{Kernel, Level};
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_terrain::suspension::kinematics::{LinkPose, MatrixPose};
use six_wheel_terrain::suspension::lanes::{all, splat};
use six_wheel_terrain::suspension::{Chain, MAX_STATE, Placed, PlanPose};

/// A chain in the axes of its own body. None where a differential does not reach.
pub(crate) fn in_body<'a>(chain: &'a Chain, joints: &[f64], steering: &[f64]) -> Option<Placed<'a>> {
    let mut state = [0.0; MAX_STATE];
    for (angle, joint) in state[3..].iter_mut().zip(joints) {
        *angle = *joint;
    }
    let origin = PlanPose { x: 0.0, y: 0.0, yaw: 0.0 };
    chain.place(origin, &state, steering)
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
    Level::Scalar.run_any(PointRows { placed, wheel, point, directions })
}

/// [`point_rows`] as a kernel.
struct PointRows<'a, const N: usize> {
    placed: &'a Placed<'a>,
    wheel: usize,
    point: Vector3<f64>,
    directions: [Vector3<f64>; N],
}

impl<const N: usize> Kernel for PointRows<'_, N> {
    type Output = ([Row; N], [f64; N]);

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Self::Output {
        let Self { placed, wheel, point, directions } = self;
        let lanes = |vector: Vector3<f64>| splat(simd, vector.into());
        let link = |axis, origin| MatrixPose::on_axis(lanes(axis), lanes(origin));
        let (point, directions) = (lanes(point), directions.map(lanes));
        let (mut rows, mut swivel) = ([[all(simd, 0.0); COLUMNS]; N], [0.0; N]);
        let movers = placed.free_axes(wheel).map(|(joint, axis, origin)| (link(axis, origin), joint));
        velocity_rows(movers, point, directions, &mut rows);
        if let Some((_, axis, origin)) = placed.steering_axes(wheel).next() {
            swivel = link(axis, origin).slopes(point, &directions).map(|part| part.last(simd));
        }
        (rows.map(|row| row.map(|part| part.last(simd))), swivel)
    }
}
