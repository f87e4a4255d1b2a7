//! Angles of steering joints inside their ranges, and the errors of those that have none.

use std::f64::consts::PI;

use crate::lanes::columns::{Span, direction_of};
use six_wheel_kinematics::steering::{ANGLE_TOLERANCE, SteeringRange};
use six_wheel_numerics::error::{Error, ErrorKind, number};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_terrain::suspension::lanes::{Column, MOST, Turned, all};
use six_wheel_terrain::suspension::{Chain, MAX_WHEELS};

/// Angle of a joint, and the lanes in which it has none.
#[derive(Clone, Copy)]
pub(crate) struct JointAngle<S: Vector> {
    /// Sine and cosine of the rotation from the axes in which the wheels are given.
    pub turned: Turned<S>,
    pub angle: Lanes<S>,
    /// Lanes in which its wheels slip at every angle.
    pub(super) slips: Mask<S>,
    /// Lanes in which neither the angle nor that half a turn from it is inside the range.
    outside: Mask<S>,
}

/// The angles of all joints; None for joints without a wheel.
pub(crate) type JointAngles<S> = [Option<JointAngle<S>>; MAX_WHEELS];

/// The angles in numbers, 0 where there is none [rad].
#[inline(always)]
pub(crate) fn values<S: Vector>(simd: S, angles: &JointAngles<S>) -> [Lanes<S>; MAX_WHEELS] {
    let mut values = [all(simd, 0.0); MAX_WHEELS];
    for (value, angle) in values.iter_mut().zip(angles) {
        if let Some(angle) = angle {
            *value = angle.angle;
        }
    }
    values
}

/// The angle of the joint that steers a wheel.
#[inline(always)]
pub(crate) fn of_wheel<'a, S: Vector>(
    chain: &Chain,
    angles: &'a JointAngles<S>,
    wheel: usize,
) -> Option<&'a JointAngle<S>> {
    let joint = chain.steering_joint(wheel)?;
    angles[joint % MAX_WHEELS].as_ref()
}

#[inline_always]
impl<S: Vector> JointAngle<S> {
    /// A given angle; `from` is that of the axes in which the wheels are given.
    pub fn given(simd: S, angle: Lanes<S>, from: Lanes<S>) -> Self {
        let no = Mask::splat(simd, false);
        Self { turned: direction_of(simd, angle - from), angle, slips: no, outside: no }
    }

    /// An angle with this rotation, or half a turn from it, inside a range.
    pub fn in_range(simd: S, range: SteeringRange, angle: Lanes<S>, turned: Turned<S>) -> Self {
        let half = all(simd, PI);
        let (lower, upper) = (all(simd, range.lower), all(simd, range.upper));
        let (least, most) = (all(simd, range.lower - ANGLE_TOLERANCE), all(simd, range.upper + ANGLE_TOLERANCE));
        let (back, on) = (angle - half, angle + half);
        let stays = least.le(angle) & angle.le(most);
        let goes_back = least.le(back) & back.le(most);
        let goes_on = least.le(on) & on.le(most);
        let found = stays.select(angle, goes_back.select(back, on)).max(lower).min(upper);
        let flip = stays.select(all(simd, 0.0), all(simd, -0.0));
        let outside = !(stays | goes_back | goes_on);
        // An angle outside its range stays as it was, for the message.
        let angle = outside.select(angle, found);
        Self {
            turned: (turned.0.xor_sign(flip), turned.1.xor_sign(flip)),
            angle,
            slips: Mask::splat(simd, false),
            outside,
        }
    }

    /// Lanes in which there is no angle.
    pub fn failed(&self) -> Mask<S> {
        self.slips | self.outside
    }

    /// This angle in some lanes, the other one in the rest.
    pub(super) fn where_in(self, lanes: Mask<S>, other: Self) -> Self {
        Self {
            turned: (lanes.select(self.turned.0, other.turned.0), lanes.select(self.turned.1, other.turned.1)),
            angle: lanes.select(self.angle, other.angle),
            slips: (self.slips & lanes) | (other.slips & !lanes),
            outside: (self.outside & lanes) | (other.outside & !lanes),
        }
    }
}

/// Fails if a joint has no angle in one of these lanes, for the first of the rows from `first` on.
#[inline(always)]
pub(crate) fn check<S: Vector>(
    simd: S,
    chain: &Chain,
    span: Span,
    angles: &JointAngles<S>,
    touching: &[Lanes<S>; MAX_WHEELS],
    known: Mask<S>,
) -> Result<(), Error> {
    let mut failed = Mask::splat(simd, false);
    for angle in angles.iter().flatten() {
        failed = failed | angle.failed();
    }
    if !(failed & known).any() {
        return Ok(());
    }
    let mut failures = [([false; MOST], [false; MOST], [0.0; MOST]); MAX_WHEELS];
    let mut touches = [[false; MOST]; MAX_WHEELS];
    for k in 0..MAX_WHEELS {
        touches[k] = all(simd, 0.0).lt(touching[k]).booleans();
        if let Some(angle) = &angles[k] {
            let (slips, outside) = ((angle.slips & known).booleans(), (angle.outside & known).booleans());
            failures[k] = (slips, outside, Column::of(angle.angle).0);
        }
    }
    first_error(chain, span, &failures, &touches).map_or(Ok(()), Err)
}

/// The lanes in which the wheels of a joint slip at every angle, those in which its angle is out of range, and the angles
/// [rad].
type Failures = ([bool; MOST], [bool; MOST], [f64; MOST]);

/// Error of the first row in which a joint has no angle, with the name of its first touching wheel, or of its first
/// wheel if none touches.
#[cold]
fn first_error(chain: &Chain, span: Span, failures: &[Failures], touching: &[[bool; MOST]]) -> Option<Error> {
    for lane in 0..span.count {
        for (joint, (slips, outside, angles)) in failures.iter().enumerate() {
            let of = |wheel: &usize| chain.steering_joint(*wheel) == Some(joint);
            let wheels = (0..chain.wheels().len()).filter(of);
            let first = wheels.clone().find(|wheel| touching[*wheel][lane]);
            let Some(wheel) = first.or(wheels.min()) else { continue };
            let name = &chain.wheels()[wheel].name;
            let error = if slips[lane] {
                let rule = format!("let {name} roll at some angle");
                Error::value("command", rule, "one at which it slips at any")
            } else if outside[lane] {
                let SteeringRange { lower, upper } = chain.steering()[joint];
                let rule = format!("let {name} steer within ({lower:?}, {upper:?})");
                Error::value("command", rule, number(angles[lane]))
            } else {
                continue;
            };
            return Some(error.of_kind(ErrorKind::Infeasible).at_row(span.first + lane));
        }
    }
    None
}
