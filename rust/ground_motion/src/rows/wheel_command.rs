//! Command of a wheel from the velocity of its centre, and the vertical speed of the body.

use crate::driving::Lift;
use crate::lanes::columns::{angle_of, is_number, polar};
use crate::rates::constants::MotionConstants;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_terrain::suspension::MAX_WHEELS;
use six_wheel_terrain::suspension::kinematics::{LinkVelocity, PlanarLink};
use six_wheel_terrain::suspension::lanes::{Turned, Vectors, all, from_turned};

/// Velocities across the link above which a wheel counts as off the ground.
#[derive(Clone, Copy)]
pub(crate) struct LiftLimits {
    /// Least velocity that counts [m/s].
    speed: f64,
    /// Square of the steepest slope, a ratio.
    square: f64,
}

impl LiftLimits {
    pub fn new(lift: Lift) -> Self {
        let slope = lift.slope();
        Self { speed: lift.speed, square: slope * slope }
    }
}

/// The velocity of a wheel's centre along and across its link, without the body's vertical speed [m/s].
#[derive(Clone, Copy)]
pub(crate) struct CentreVelocity<S: Vector> {
    pub along: Lanes<S>,
    pub across: Lanes<S>,
    /// Both velocities per vertical speed of the body [1].
    pub vertical: [Lanes<S>; 2],
    /// Rate of the link about the axle [rad/s].
    pub turn: Lanes<S>,
    /// One over the wheel's radius [1/m].
    pub inverse_radius: Lanes<S>,
}

/// Command of a wheel.
pub(crate) struct WheelCommand<S: Vector> {
    /// Speed of the wheel against its link [rad/s].
    pub speed: Lanes<S>,
    /// Contact angle [rad].
    pub contact_angle: Lanes<S>,
    /// Lanes in which the wheel counts as off the ground: see [`LiftLimits`].
    pub lifted: Mask<S>,
}

#[inline_always]
impl<S: Vector> CentreVelocity<S> {
    /// The velocity of a wheel on a link, `turned` about its steering axis, for this motion of the body.
    pub fn new(
        body: &LinkVelocity<S>,
        link: &PlanarLink<S>,
        centre: Vectors<S>,
        turned: Turned<S>,
        inverse_radius: Lanes<S>,
    ) -> Self {
        let [along, _, across] = from_turned(turned, link.in_own_axes(link.velocity(body, centre)));
        let [_, turn, _] = from_turned(turned, link.in_own_axes(link.angular_velocity(body)));
        let (zero, one) = (all(along.simd(), 0.0), all(along.simd(), 1.0));
        let [ahead, _, up] = from_turned(turned, link.in_own_axes([zero, zero, one]));
        Self { along, across, vertical: [ahead, up], turn, inverse_radius }
    }

    fn at(&self, vertical: Lanes<S>) -> [Lanes<S>; 2] {
        [self.vertical[0].mul_add(vertical, self.along), self.vertical[1].mul_add(vertical, self.across)]
    }

    /// The vertical speed at which the centre moves along its link [m/s].
    pub fn closing_speed(&self, simd: S) -> Lanes<S> {
        all(simd, 0.0) - (self.across / self.vertical[1])
    }

    /// The command at this vertical speed, for the commanded velocity of the centre in plan: the wheel rolls along the
    /// velocity of its centre, forwards or backwards, whichever is along its link.
    pub fn command(&self, simd: S, vertical: Lanes<S>, [x, y]: [Lanes<S>; 2], lift: LiftLimits) -> WheelCommand<S> {
        let velocity = self.at(vertical);
        let [_, across] = velocity;
        let rolled = polar(velocity);
        // Squares are compared: a square root would take as long as everything else here.
        let slope = all(simd, lift.square) * x.mul_add(x, y * y);
        WheelCommand {
            speed: rolled.length.xor_sign(rolled.sign) * self.inverse_radius - self.turn,
            contact_angle: angle_of(simd, rolled.turned),
            lifted: all(simd, lift.speed).lt(across.abs()) & slope.lt(across * across),
        }
    }
}

/// The median over the wheels of the vertical speed at which a wheel moves along its link [m/s]. It minimises the sum
/// of the velocities across, and two wheels of six on rocks do not change it. NaN where a wheel's speed is NaN.
#[inline(always)]
pub(super) fn median_closing_speed<S: Vector>(simd: S, centres: &[CentreVelocity<S>]) -> Lanes<S> {
    let zero = all(simd, 0.0);
    let mut speeds = [zero; MAX_WHEELS];
    let mut sum = zero;
    for (speed, centre) in speeds.iter_mut().zip(centres) {
        *speed = centre.closing_speed(simd);
        sum = sum + *speed;
    }
    is_number(sum).select(median(simd, speeds, centres.len()), sum)
}

/// The median of the first `count` numbers, none of them NaN.
#[inline(always)]
pub(super) fn median<S: Vector>(simd: S, mut numbers: [Lanes<S>; MAX_WHEELS], count: usize) -> Lanes<S> {
    let count = count.min(MAX_WHEELS);
    // Partial selection sort, up to the middle.
    for k in 0..=count / 2 {
        for i in k + 1..count {
            let (a, b) = (numbers[k], numbers[i]);
            numbers[k] = a.min(b);
            numbers[i] = a.max(b);
        }
    }
    let middle = count / 2;
    match count % 2 {
        1 => numbers[middle],
        _ => all(simd, 0.5) * (numbers[(middle + MAX_WHEELS - 1) % MAX_WHEELS] + numbers[middle]),
    }
}

/// Most Newton steps: random speeds take seven on average.
const STEPS: usize = 20;

/// Step below which Newton's method has converged [m/s].
const FOUND: f64 = 1e-15;

/// Added to the second derivative, which is 0 on level ground: there the rolling speeds do not depend on the vertical
/// speed.
const DAMPING: f64 = 1e-3;

/// Least second derivative, as a share of its value without the negative terms: every step decreases the sum.
const LEAST_SECOND: f64 = 0.2;

/// The vertical speed z that fits the measured speeds of the wheels best, by Newton steps from a start [m/s]; lanes that
/// have found theirs wait for the others. With s(z) the speed of a centre, m = measured - s and n the derivative of the
/// velocity of the centre by z: minimum of sum m^2 / 2, s' = velocity . n / s, s'' = (n . n - s'^2) / s.
/// Without m s'' the steps do not converge where measured speeds are far from those that the ground allows.
#[inline(always)]
pub(super) fn fitted_vertical_speed<S: Vector>(
    simd: S,
    constants: &MotionConstants,
    centres: &[CentreVelocity<S>],
    measured: &[Lanes<S>; MAX_WHEELS],
    start: Lanes<S>,
) -> Lanes<S> {
    let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
    let mut vertical = start;
    let mut open = Mask::splat(simd, true);
    for _ in 0..STEPS {
        let (mut slope, mut second, mut bound) = (zero, zero, zero);
        for ((centre, measured), radius) in centres.iter().zip(measured).zip(constants.radii) {
            let [along, across] = centre.at(vertical);
            let speed = along.mul_add(along, across * across).sqrt();
            let [ahead, up] = centre.vertical;
            let moves = zero.lt(speed);
            let inverse = one / moves.select(speed, one);
            let derivative = along.mul_add(ahead, across * up) * inverse;
            let rolled = (all(simd, radius) * (*measured + centre.turn)).abs();
            let missing = moves.select(rolled - speed, zero);
            let square = moves.select(derivative * derivative, zero);
            let bend = missing * inverse * (ahead.mul_add(ahead, up * up) - square);
            slope = derivative.mul_add(missing, slope);
            second = second + (square - bend);
            bound = bound + (square - bend.min(zero));
        }
        let step = slope / (second.max(all(simd, LEAST_SECOND) * bound) + all(simd, DAMPING));
        vertical = open.select(vertical + step, vertical);
        open = open & all(simd, FOUND).le(step.abs());
        if !open.any() {
            break;
        }
    }
    vertical
}
