//! [`traction`](super::super::traction) for one row: the lanes of a register are the wheels.

use super::columns::{angle_of, finite, way, within};
use crate::driving::{Drives, Driving, Turns};
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::Kernel;
use six_wheel_numerics::simd::polynomials::direction;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_terrain::suspension::lanes::{ChainConstants, Column, LARGEST_TURN, MOST, all};
use six_wheel_terrain::suspension::{Chain, Differential, MAX_FREE, MAX_WHEELS};

/// Angles that turn limbs: the free ones, and the right-hand side of the differential.
const ANGLES: usize = MAX_FREE + 1;

/// Constants of a suspension in which at most two links, both turning about y, lie between body and wheel (rocker and
/// bogie). One lane per wheel; lanes without a wheel repeat the first.
#[derive(Clone, Debug)]
pub struct Instant {
    wheels: usize,
    /// The free angle that goes through a differential.
    across: (usize, Differential),
    /// Factors of each angle in that of the limb at the body, and in that of the limb it carries against it.
    limbs: [[Column; ANGLES]; 2],
    /// Origin of the first limb ahead and upwards, of the second in the first, and the wheel in the second [m].
    origins: [[Column; 2]; 3],
    /// To the left [m].
    left: Column,
    radius: Column,
    /// 1 where a wheel is steered.
    steers: Column,
    joints: [Option<usize>; MAX_WHEELS],
    range: SteeringRange,
}

impl Instant {
    /// None for other chains, and where steering joints differ or have several wheels, or some beside their axes.
    pub fn new(chain: &Chain, plan: &ChainConstants) -> Option<Self> {
        let range = chain.steering().first().copied().unwrap_or_default();
        let zero = Column::ZERO;
        let mut instant = Self {
            wheels: plan.wheels(),
            across: (0, Differential::Gear),
            limbs: [[zero; ANGLES]; 2],
            origins: [[zero; 2]; 3],
            left: zero,
            radius: zero,
            steers: zero,
            joints: [None; MAX_WHEELS],
            range,
        };
        if let Some((joint, across)) = plan.parts.iter().find_map(|part| Some((part.joint, part.across?))) {
            instant.across = (joint, across);
        }
        for lane in 0..MOST {
            let place = if lane < plan.wheels() { lane } else { 0 };
            let wheel = &plan.wheels[place];
            let [ahead, left, up] = wheel.offset;
            if wheel.movers.len() > 2 || [ahead, left] != [0.0; 2] {
                return None;
            }
            if let Some(joint) = wheel.steering.filter(|_| lane == place) {
                if instant.joints.contains(&Some(joint)) {
                    return None;
                }
                instant.joints[lane] = Some(joint);
            }
            instant.steers.0[lane] = f64::from(u8::from(wheel.steering.is_some()));
            instant.radius.0[lane] = wheel.radius;
            instant.left.0[lane] = wheel.pivot[1];
            instant.origins[2][0].0[lane] = wheel.pivot[0];
            instant.origins[2][1].0[lane] = wheel.pivot[2] + up;
            for (k, part) in wheel.movers.iter().rev().map(|&part| &plan.parts[part]).enumerate() {
                let angle = if part.across.is_some() { MAX_FREE } else { part.joint };
                if part.plane != 0 || part.across.is_some_and(|by| (part.joint, by) != instant.across) {
                    return None;
                }
                instant.limbs[k][angle].0[lane] = 1.0;
                instant.left.0[lane] += part.origin[1];
                instant.origins[k][0].0[lane] = part.origin[0];
                instant.origins[k][1].0[lane] = part.origin[2];
            }
        }
        let same = chain.steering().iter().all(|other| *other == range);
        same.then_some(instant)
    }
}

/// One row; whether it was for lanes.
pub(crate) struct OneRow<'a, 'b> {
    pub instant: &'a Instant,
    pub offset: f64,
    pub steepest: f64,
    pub driving: &'a Driving<'a>,
    pub drives: &'a mut Drives<'b>,
}

impl Kernel for OneRow<'_, '_> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> bool {
        let (instant, driving) = (self.instant, self.driving);
        if S::F64_LANES < instant.wheels || driving.wheel_speeds.is_some() {
            return false;
        }
        let &[speed] = driving.speed else {
            return false;
        };
        let yaw_rate = match driving.turning {
            Turns::Curvature(curvature) => speed * curvature[0],
            Turns::YawRate(yaw_rate) => yaw_rate[0],
        };
        let (mut angles, mut rates) = ([0.0; ANGLES], [0.0; ANGLES]);
        let mut largest: f64 = 0.0;
        for (k, (angle, rate)) in driving.joints.iter().zip(driving.joint_rates).enumerate().take(MAX_FREE) {
            (angles[k], rates[k]) = (*angle, *rate);
            largest = largest.max(angle.abs());
        }
        let (joint, across) = instant.across;
        let Some([right, slope]) = across.right(angles[joint % MAX_FREE]) else {
            return false;
        };
        (angles[MAX_FREE], rates[MAX_FREE]) = (right, slope * rates[joint % MAX_FREE]);
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        // Turns and rates of both limbs.
        let (mut turns, mut swings) = ([zero; 2], [zero; 2]);
        for (k, shares) in instant.limbs.iter().enumerate() {
            for (share, (angle, rate)) in shares.iter().zip(angles.iter().zip(rates)) {
                let share = share.load(simd);
                turns[k] = share.mul_add(all(simd, *angle), turns[k]);
                swings[k] = share.mul_add(all(simd, rate), swings[k]);
            }
        }
        let (s1, c1) = direction(simd, turns[0]);
        let (s2, c2) = direction(simd, turns[0] + turns[1]);
        let (body, knee, wheel) = (&instant.origins[0], &instant.origins[1], &instant.origins[2]);
        let (x, z) = (wheel[0].load(simd), wheel[1].load(simd));
        let arm = [x.mul_add(c2, z * s2), z.mul_add(c2, -(x * s2))];
        let (x, z) = (knee[0].load(simd), knee[1].load(simd));
        let leg = [x.mul_add(c1, z.mul_add(s1, arm[0])), z.mul_add(c1, arm[1] - x * s1)];
        let (x, z) = (body[0].load(simd) + leg[0], body[1].load(simd) + leg[1]);
        let y = instant.left.load(simd);
        let [roll, pitch, _] = driving.angular_velocity[0];
        let [roll, pitch, yaw] = [all(simd, roll), all(simd, pitch), all(simd, yaw_rate)];
        // As commanded, and how the centres move.
        let in_plan = [all(simd, speed) - yaw * y, yaw.mul_add(x, all(simd, yaw_rate * self.offset))];
        let forth = swings[1].mul_add(arm[1], swings[0].mul_add(leg[1], pitch.mul_add(z, in_plan[0])));
        let down = swings[1].mul_add(arm[0], swings[0].mul_add(leg[0], pitch * x));
        let up = roll.mul_add(y, -down);
        let aside = in_plan[1] - roll * z;
        let steered = zero.below(instant.steers.load(simd));
        let mut doubt = zero.below(zero);
        let to = way([c2 * in_plan[0], in_plan[1]], (zero, one), &mut doubt);
        let found = within(simd, instant.range, angle_of(simd, to.turned), &mut doubt);
        doubt = (doubt | to.rests) & steered;
        let (ss, cs) =
            (steered.select(to.turned.0.flip(found.turned), zero), steered.select(to.turned.1.flip(found.turned), one));
        let along = (forth.mul_add(c2, -(up * s2))).mul_add(cs, aside * ss);
        let across = up.mul_add(c2, forth * s2);
        let turn = (pitch + swings[0] + swings[1]).mul_add(cs, -(roll.mul_add(c2, -(yaw * s2)) * ss));
        let Some(vertical) = middle(zero - across.quotient(c2), instant.wheels) else {
            return false;
        };
        let lifted = all(simd, vertical);
        let velocity = [(-(s2 * cs)).mul_add(lifted, along), c2.mul_add(lifted, across)];
        let rolls = way(velocity, (zero, one), &mut doubt);
        let radius = instant.radius.load(simd);
        let speeds = rolls.length.flip(rolls.sign).quotient(radius) - turn;
        let steepest = all(simd, self.steepest * self.steepest);
        let slope = steepest * in_plan[0].mul_add(in_plan[0], in_plan[1] * in_plan[1]);
        let [_, across] = velocity;
        let lifts = all(simd, driving.lift.speed).below(across.abs()) & slope.below(across * across);
        if largest > LARGEST_TURN || (doubt | !finite(simd, speeds)).any() {
            return false;
        }
        let drives = self.drives;
        let wheels = instant.wheels.min(MAX_WHEELS);
        drives.vertical[0] = vertical;
        drives.speeds[..wheels].copy_from_slice(&Column::of(speeds).0[..wheels]);
        let angles = Column::of(angle_of(simd, rolls.turned));
        drives.contact_angles[..wheels].copy_from_slice(&angles.0[..wheels]);
        let (angles, lifts) = (Column::of(found.angle), Column::of(lifts.select(one, zero)));
        for wheel in 0..wheels {
            drives.lifted[wheel] = lifts.0[wheel] > 0.0;
            if let Some(joint) = instant.joints[wheel] {
                drives.steering[joint] = angles.0[wheel];
            }
        }
        true
    }
}

/// The median of the first lanes; none where one of them is not finite.
#[inline(always)]
fn middle<S: Vector>(lanes: Lanes<S>, count: usize) -> Option<f64> {
    let mut values = Column::of(lanes).0;
    let values = &mut values[..count.min(MOST)];
    let mut sum = 0.0;
    for k in 0..values.len() {
        sum += values[k];
        // The smallest to the front, so far as it takes.
        for i in k + 1..values.len() {
            let (a, b) = (values[k], values[i]);
            (values[k], values[i]) = if b < a { (b, a) } else { (a, b) };
        }
    }
    let half = values.len() / 2;
    let median = match values.len() % 2 {
        1 => values[half],
        _ => 0.5 * (values[half.checked_sub(1)?] + values[half]),
    };
    sum.is_finite().then_some(median)
}
