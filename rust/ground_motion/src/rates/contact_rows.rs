//! Contacts in lanes: velocities of the touching points as functions of the rates.

use crate::lanes::columns::inverse_length;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_terrain::suspension::kinematics::{LinkPose, PlanarLink, slopes_about};
use six_wheel_terrain::suspension::lanes::{Turned, Vectors, all, along, cross, less, splat};
use six_wheel_terrain::suspension::{MAX_FREE, MAX_WHEELS};

/// Rates: the body's `vx, vy, vz, wx, wy, wz` and those of the free angles.
pub const COLUMNS: usize = 6 + MAX_FREE;

/// Derivatives of a velocity by the rates, in lanes.
pub(crate) type Row<S> = [Lanes<S>; COLUMNS];

/// Velocity of a wheel's touching point along the normal, along the rim and to the left [m/s], as a function of the rates.
#[derive(Clone, Copy)]
pub(crate) struct Contact<S: Vector> {
    /// Derivatives by the rates. Along the rim of `v_c . T - r w . axle`, the velocity of a wheel that does not turn
    /// against its link.
    pub rows: [Row<S>; 3],
    /// Velocities that the rate of the wheel's own steering adds [m/s].
    pub swivel: [Lanes<S>; 3],
}

/// Contacts of all wheels.
pub(crate) type Contacts<S> = [Contact<S>; MAX_WHEELS];

impl<S: Vector> Contact<S> {
    /// A contact whose point never moves.
    #[inline(always)]
    pub fn zero(simd: S) -> Self {
        Self { rows: [[all(simd, 0.0); COLUMNS]; 3], swivel: [all(simd, 0.0); 3] }
    }
}

/// Tangent and contact point of a wheel.
#[derive(Clone, Copy)]
pub(crate) struct RimPoint<S: Vector> {
    pub tangent: Vectors<S>,
    pub point: Vectors<S>,
}

impl<S: Vector> RimPoint<S> {
    /// At a contact angle t, of a wheel on this link with this centre, turned about its steering axis: the tangent is
    /// `T = h cos t + u sin t`, the point `c + r (h sin t - u cos t)`.
    #[inline(always)]
    pub fn new(
        link: &PlanarLink<S>,
        centre: Vectors<S>,
        radius: Lanes<S>,
        steered: Option<Turned<S>>,
        (sin, cos): Turned<S>,
    ) -> Self {
        let zero = all(sin.simd(), 0.0);
        let (mut tangent, mut spoke) = ([cos, zero, sin], [sin, zero, -cos]);
        if let Some((s, c)) = steered {
            (tangent, spoke) = ([cos * c, cos * s, sin], [sin * c, sin * s, -cos]);
        }
        Self { tangent: link.rotated(tangent), point: along(centre, radius, link.rotated(spoke)) }
    }
}

/// Derivatives by the rates of the velocities of a point of a wheel's carrier along some directions: the direction d for
/// the velocity of the body, `p x d` for its rotation, `(axis x arm) . d` for the joint of each link that carries the wheel.
#[inline(always)]
pub(crate) fn velocity_rows<S: Vector, const N: usize>(
    movers: impl Iterator<Item = (impl LinkPose<S>, usize)>,
    point: Vectors<S>,
    directions: [Vectors<S>; N],
    rows: &mut [Row<S>; N],
) {
    for (row, direction) in rows.iter_mut().zip(directions) {
        row[..3].copy_from_slice(&direction);
        row[3..6].copy_from_slice(&cross(point, direction));
    }
    let mut filled = 0_u32;
    for (link, joint) in movers {
        let again = filled >> joint & 1 == 1;
        filled |= 1 << joint;
        let slopes = link.slopes(point, &directions);
        for (row, slope) in rows.iter_mut().zip(slopes) {
            row[6 + joint] = if again { row[6 + joint] + slope } else { slope };
        }
    }
}

/// Velocity of a point along some directions per rate of the wheel's own steering, about the upward axis of its link through
/// a pivot [m/rad].
#[inline(always)]
pub(crate) fn steering_velocity<S: Vector>(
    link: &PlanarLink<S>,
    pivot: Vectors<S>,
    point: Vectors<S>,
    directions: [Vectors<S>; 3],
) -> [Lanes<S>; 3] {
    let upwards = link.rotated(splat(point[0].simd(), [0.0, 0.0, 1.0]));
    slopes_about(upwards, less(point, pivot), &directions)
}

/// The sign bit where the touching point is on the far side of the rim, seen from the plane on which the wheel stands:
/// that of a wheel at an edge steeper than the lean of its disc. The plane's normal is given along the wheel's forward
/// and upward axes.
#[inline(always)]
pub(crate) fn rim_side<S: Vector>([ahead, up]: [Lanes<S>; 2], (sin, cos): Turned<S>) -> Lanes<S> {
    let zero = all(sin.simd(), 0.0);
    // The vector from the centre to the touching point has a positive part along the normal.
    (up * cos).lt(ahead * sin).select(-zero, zero)
}

/// Sine and cosine of the contact angle of a wheel on a plane, on this side of its rim, from the plane's normal along its
/// forward and upward axes; angle 0 where the normal is along the axle.
#[inline(always)]
pub(crate) fn angle_on_plane<S: Vector>([ahead, up]: [Lanes<S>; 2], side: Lanes<S>) -> Turned<S> {
    let simd = side.simd();
    let square = ahead.mul_add(ahead, up * up);
    let inverse = inverse_length(simd, square).xor_sign(side);
    let flat = square.le(all(simd, 0.0));
    (-(ahead * inverse), flat.select(all(simd, 1.0), up * inverse))
}
