//! Angles of steering joints: the root of the mean sideways velocity of a joint's wheels ([`SideSlip`]) inside the
//! range of the joint.
//!
//! Newton's method with the second derivative starts at the direction of the touching points' velocity; where its steps
//! do not shrink the root is bracketed. For wheels on their axis the angle half a turn from a root is a root too.

use std::f64::consts::PI;

use super::joint_angle::{JointAngle, JointAngles};
use super::side_slip::{SideSlip, WheelAxes};
use crate::lanes::columns::{angle_of, direction_of, polar, roots};
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::polynomials::direction;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_terrain::suspension::lanes::{Turned, Vectors, all};
use six_wheel_terrain::suspension::{Chain, MAX_WHEELS};

/// Steps after which a root is bracketed instead.
const MAX_NEWTON_STEPS: usize = 12;

/// Newton's method is accepted while `|step_k| <= 0.5 |step_(k-1)|`, with `|step_0| = 0.5` rad.
const MIN_STEP_REDUCTION: f64 = 0.5;

/// A step shorter than this [rad] is the last one: the error after it is about its square.
const CONVERGED_STEP: f64 = 1e-8;

/// The same where the second derivative is known too: the error is about its cube.
const CONVERGED_BENT_STEP: f64 = 2e-6;

/// Rounding of the sideways velocity, as a share of the speeds that it is a sum of, and of an angle [rad].
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// A derivative below this share of the speeds that it is a sum of means a nearly double root.
const FLAT: f64 = 0.02;

/// Steps of a search for a bracket, over half a turn to either side.
const BRACKET_STEPS: u32 = 48;

/// Halvings and Newton steps inside a bracket: twice what an interval of doubles takes.
const HALVINGS: usize = 128;

/// Steered wheels in their axes, and their joints.
pub(crate) struct SteeringInput<'a, S: Vector> {
    pub chain: &'a Chain,
    /// Range of every joint.
    pub ranges: &'a [SteeringRange],
    /// Axes of every wheel at the angles `from` of the joints [rad].
    pub axes: &'a [WheelAxes<S>],
    pub from: &'a [Lanes<S>; MAX_WHEELS],
    /// Angles for joints whose wheels rest [rad].
    pub held: &'a [Lanes<S>; MAX_WHEELS],
    /// 1 where a wheel touches.
    pub touching: &'a [Lanes<S>; MAX_WHEELS],
    /// Lanes that need angles.
    pub known: Mask<S>,
}

/// Angle of every joint at which its wheels have no sideways velocity: of the two, rolling forwards and backwards, the
/// one nearer to `from`. None for joints without a wheel.
#[inline(always)]
pub(crate) fn steer<S: Vector>(simd: S, input: &SteeringInput<'_, S>) -> JointAngles<S> {
    let slip = SideSlip::new(simd, input.chain, input.axes, input.touching);
    let no = Mask::splat(simd, false);
    let zero = all(simd, 0.0);
    let straight = (zero, all(simd, 1.0));
    let mut searches = [RootSearch::new(simd, straight, no); MAX_WHEELS];
    let mut rests = [no; MAX_WHEELS];
    for (k, (search, joint)) in searches.iter_mut().zip(&slip.joints).enumerate() {
        if joint.any() {
            let start = polar(joint.velocity);
            rests[k] = start.is_zero;
            *search = RootSearch::new(simd, start.turned, input.known & !start.is_zero);
            if joint.is_offset {
                search.start = angle_of(simd, start.turned);
            }
        }
    }
    let mut angles = [None; MAX_WHEELS];
    // For wheels beside their axis the angle half a turn from a root need not be one: the second search starts there.
    for _ in 0..2 {
        find_roots(simd, &slip, &mut searches);
        let (mut again, mut any) = ([no; MAX_WHEELS], no);
        for (k, (angle, search)) in angles.iter_mut().zip(&searches).enumerate() {
            let joint = &slip.joints[k];
            if !joint.any() {
                continue;
            }
            let (root, turned) = search.root(simd, joint.is_offset);
            let asked = input.from[k] + root;
            let mut found = JointAngle::in_range(simd, input.ranges[k], asked, turned);
            found.slips = search.failed;
            if rests[k].any() {
                let held = input.held[k];
                let turned = direction_of(simd, held - input.from[k]);
                found = JointAngle::in_range(simd, input.ranges[k], held, turned).where_in(rests[k], found);
            }
            if let Some(before) = angle {
                found = found.where_in(search.searched, *before);
            }
            *angle = Some(found);
            if joint.is_offset {
                let stays = (found.angle - asked).abs().le(zero);
                again[k] = search.searched & !(stays | found.failed());
                any = any | again[k];
            }
        }
        if !any.any() {
            break;
        }
        for (k, (angle, search)) in angles.iter().zip(&mut searches).enumerate() {
            if let Some(angle) = angle {
                *search = RootSearch::new(simd, angle.turned, again[k]);
                search.start = angle.angle - input.from[k];
            }
        }
    }
    angles
}

/// Roots of the sideways velocities of all joints: Newton's method, then brackets.
#[inline(always)]
fn find_roots<S: Vector>(simd: S, slip: &SideSlip<'_, S>, searches: &mut [RootSearch<S>; MAX_WHEELS]) {
    for _ in 0..MAX_NEWTON_STEPS {
        let mut open = Mask::splat(simd, false);
        for (k, search) in searches.iter_mut().enumerate() {
            if search.open.any() {
                let joint = &slip.joints[k];
                let last = if joint.is_offset { CONVERGED_STEP } else { CONVERGED_BENT_STEP };
                search.step(simd, slip.at(simd, k, search.turned), joint.size, last);
                open = open | search.open;
            }
        }
        if !open.any() {
            break;
        }
    }
    for (k, search) in searches.iter_mut().enumerate() {
        let lost = search.failed | search.open;
        if lost.any() {
            search.bracket(simd, slip, k, lost);
        }
    }
}

/// Search for the root of one joint.
#[derive(Clone, Copy)]
struct RootSearch<S: Vector> {
    /// Start angle for wheels beside their axis [rad], its direction, and the direction of the present iterate.
    start: Lanes<S>,
    from: Turned<S>,
    turned: Turned<S>,
    /// Length of the last step [rad].
    last: Lanes<S>,
    /// Lanes that are searched, those in which the root is not found yet, and those in which there is none.
    searched: Mask<S>,
    open: Mask<S>,
    failed: Mask<S>,
    /// Lanes in which the root was bracketed, and the root [rad].
    bracketed: Mask<S>,
    root: Lanes<S>,
}

#[inline_always]
impl<S: Vector> RootSearch<S> {
    fn new(simd: S, from: Turned<S>, searched: Mask<S>) -> Self {
        let (zero, no) = (all(simd, 0.0), Mask::splat(simd, false));
        Self {
            start: zero,
            from,
            turned: from,
            last: all(simd, 0.5),
            searched,
            open: searched,
            failed: no,
            bracketed: no,
            root: zero,
        }
    }

    /// A step of Newton's method in the open lanes; lanes that have converged keep their angle, so that no lane depends
    /// on another.
    fn step(&mut self, simd: S, [value, by, bend]: Vectors<S>, size: Lanes<S>, last: f64) {
        let inverse = all(simd, 1.0) / by;
        let newton = -(value * inverse);
        let step = (bend * inverse * (newton * newton)).mul_add(all(simd, -0.5), newton);
        let length = step.abs();
        let is_root = value.abs().le(all(simd, ROUNDING) * size);
        let shrinks = length.le(all(simd, MIN_STEP_REDUCTION) * self.last);
        let is_steep = (all(simd, FLAT) * size).lt(by.abs());
        let shortest = is_steep.select(all(simd, last), all(simd, ROUNDING));
        let moves = self.open & shrinks & !is_root;
        self.failed = self.failed | (self.open & !(shrinks | is_root));
        self.open = moves & shortest.lt(length);
        self.last = length;
        let (sin, cos) = self.turned;
        let (s, c) = (step.mul_add(cos, sin), cos - step * sin);
        let [inverse, _] = roots(simd, step.mul_add(step, all(simd, 1.0)));
        self.turned = (moves.select(s * inverse, sin), moves.select(c * inverse, cos));
    }

    /// The angle of the root from where the search began, and its direction: for wheels on their axis that of a quarter
    /// turn at most.
    fn root(&self, simd: S, is_offset: bool) -> (Lanes<S>, Turned<S>) {
        let (sin, cos) = self.turned;
        if !is_offset {
            let behind = cos.sign_bit();
            let turned = (sin.xor_sign(behind), cos.xor_sign(behind));
            return (angle_of(simd, turned), turned);
        }
        let (s, c) = self.from;
        let step = (sin * c - cos * s, cos.mul_add(c, sin * s));
        (self.bracketed.select(self.root, self.start + angle_of(simd, step)), self.turned)
    }

    /// The root nearest to the start, by a search for a change of sign to either side of it. The sign half a turn away
    /// is the opposite one, except for wheels beside their axis: only these may have no root.
    fn bracket(&mut self, simd: S, slip: &SideSlip<'_, S>, joint: usize, lost: Mask<S>) {
        let zero = all(simd, 0.0);
        let start = match slip.joints[joint].is_offset {
            true => self.start,
            false => angle_of(simd, self.from),
        };
        let [value, ..] = slip.at(simd, joint, direction(simd, start));
        let mut ends = [zero.lt(value); 2];
        let (mut near, mut far, mut rises) = (start, start, ends[0]);
        let mut open = lost;
        for step in 1..=BRACKET_STEPS {
            for (end, sign) in ends.iter_mut().zip([1.0, -1.0]) {
                let width = sign * PI / f64::from(BRACKET_STEPS);
                let [from, to] = [step - 1, step].map(|k| start + all(simd, width * f64::from(k)));
                let [value, ..] = slip.at(simd, joint, direction(simd, to));
                let found = zero.lt(value);
                let differs = open & ((found & !*end) | (*end & !found));
                (near, far) = (differs.select(from, near), differs.select(to, far));
                rises = (differs & *end) | (rises & !differs);
                open = open & !differs;
                *end = found;
            }
            if !open.any() {
                break;
            }
        }
        self.failed = open;
        self.bracketed = lost & !open;
        self.root = root_in_bracket(simd, slip, joint, [near, far], rises, self.bracketed);
        let (sin, cos) = direction(simd, self.root);
        let (s, c) = self.turned;
        self.turned = (self.bracketed.select(sin, s), self.bracketed.select(cos, c));
    }
}

/// The root between two angles with different signs, positive at `near` where `positive`: Newton steps that more than
/// halve the interval, else bisection.
#[inline(always)]
fn root_in_bracket<S: Vector>(
    simd: S,
    slip: &SideSlip<'_, S>,
    joint: usize,
    [mut near, mut far]: [Lanes<S>; 2],
    positive: Mask<S>,
    mut open: Mask<S>,
) -> Lanes<S> {
    let (zero, half) = (all(simd, 0.0), all(simd, 0.5));
    let mut angle = half * (near + far);
    let mut before = (far - near).abs();
    let mut last = before;
    for _ in 0..HALVINGS {
        let [value, by, _] = slip.at(simd, joint, direction(simd, angle));
        open = open & !value.abs().le(zero);
        let above = zero.lt(value);
        let is_near = (above & positive) | !(above | positive);
        near = (open & is_near).select(angle, near);
        far = (open & !is_near).select(angle, far);
        let newton = angle - (value / by);
        let fits = ((newton - near) * (newton - far)).lt(zero);
        let halves = (newton - angle).abs().le(half * before);
        let next = (fits & halves).select(newton, half * (near + far));
        before = last;
        last = (next - angle).abs();
        angle = open.select(next, angle);
        open = open & all(simd, 2.0 * f64::EPSILON).lt(last);
        if !open.any() {
            break;
        }
    }
    angle
}
