//! Traction of one row, for rockers and bogies: the lanes of a register are the wheels.
//!
//! Operations and their order are those of rows in lanes ([`super::traction`] and `Placing` of the chain), so that a row
//! has the same bits alone and in a batch.

use super::wheel_command::{CentreVelocity, LiftLimits};
use crate::driving::{Drives, Driving, Turns};
use crate::lanes::columns::{angle_of, polar};
use crate::steering::joint_angle::JointAngle;
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::Kernel;
use six_wheel_numerics::simd::polynomials::direction;
use six_wheel_numerics::simd::vec3::cross;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_terrain::suspension::lanes::{ChainConstants, Column, LARGEST_TURN, MOST, all};
use six_wheel_terrain::suspension::{Chain, Differential, MAX_FREE, MAX_WHEELS};

/// Angles that turn limbs: the free ones, and the right-hand side of the differential.
const ANGLES: usize = MAX_FREE + 1;

/// Constants of a suspension in which at most two links, both turning about y, lie between body and wheel (rocker and
/// bogie). One lane per wheel; lanes without a wheel repeat the first.
#[derive(Clone, Debug)]
pub(crate) struct TwoLinkChain {
    wheels: usize,
    /// The free angle that goes through a differential.
    across: (usize, Differential),
    /// Factors of each angle in that of the limb at the body, and in that of the limb it carries against it.
    limbs: [[Column; ANGLES]; 2],
    /// Origin of the first limb ahead and upwards, of the second in the first, and the wheel in the second [m].
    origins: [[Column; 2]; 3],
    /// To the left [m].
    left: Column,
    /// One over the radius [1/m].
    inverse_radius: Column,
    /// 1 where a wheel is steered.
    steers: Column,
    joints: [Option<usize>; MAX_WHEELS],
    range: SteeringRange,
}

impl TwoLinkChain {
    /// None for other chains, and where steering joints differ or have several wheels, or some beside their axes.
    pub fn new(chain: &Chain, plan: &ChainConstants) -> Option<Self> {
        let range = chain.steering().first().copied().unwrap_or_default();
        let zero = Column::ZERO;
        let mut two_link = Self {
            wheels: plan.wheels(),
            across: (0, Differential::Gear),
            limbs: [[zero; ANGLES]; 2],
            origins: [[zero; 2]; 3],
            left: zero,
            inverse_radius: zero,
            steers: zero,
            joints: [None; MAX_WHEELS],
            range,
        };
        // The angle beyond a bar has its sine and cosine from elsewhere.
        if plan.parts.iter().any(|part| part.across.is_some_and(|across| across != Differential::Gear)) {
            return None;
        }
        if let Some((joint, across)) = plan.parts.iter().find_map(|part| Some((part.joint, part.across?))) {
            two_link.across = (joint, across);
        }
        for lane in 0..MOST {
            let place = if lane < plan.wheels() { lane } else { 0 };
            let wheel = &plan.wheels[place];
            let [ahead, left, up] = wheel.offset;
            if wheel.movers.len() > 2 || [ahead, left] != [0.0; 2] {
                return None;
            }
            if let Some(joint) = wheel.steering.filter(|_| lane == place) {
                if two_link.joints.contains(&Some(joint)) {
                    return None;
                }
                two_link.joints[lane] = Some(joint);
            }
            two_link.steers.0[lane] = f64::from(u8::from(wheel.steering.is_some()));
            two_link.inverse_radius.0[lane] = 1.0 / wheel.radius;
            two_link.origins[2][0].0[lane] = wheel.pivot[0];
            two_link.origins[2][1].0[lane] = wheel.pivot[2] + up;
            for (k, part) in wheel.movers.iter().rev().map(|&part| &plan.parts[part]).enumerate() {
                let angle = if part.across.is_some() { MAX_FREE } else { part.joint };
                if part.plane != 0 || part.across.is_some_and(|by| (part.joint, by) != two_link.across) {
                    return None;
                }
                two_link.limbs[k][angle].0[lane] = 1.0;
                two_link.left.0[lane] += part.origin[1];
                two_link.origins[k][0].0[lane] = part.origin[0];
                two_link.origins[k][1].0[lane] = part.origin[2];
            }
            two_link.left.0[lane] += wheel.pivot[1];
        }
        let same = chain.steering().iter().all(|other| *other == range);
        same.then_some(two_link)
    }
}

/// One row. Its kernel returns false, and writes nothing, where the row is for the lanes of many: if wheels rest, a joint
/// has no angle, speeds were measured or a result is not finite.
pub(crate) struct OneRow<'a, 'b> {
    pub chain: &'a TwoLinkChain,
    pub offset: f64,
    pub lift: LiftLimits,
    pub driving: &'a Driving<'a>,
    pub drives: &'a mut Drives<'b>,
}

/// Free angles and the right-hand side of the differential [rad], their rates [rad/s], and the commanded speed and yaw rate.
struct RowInput {
    angles: [f64; ANGLES],
    rates: [f64; ANGLES],
    speed: f64,
    yaw_rate: f64,
}

/// Wheels of one register.
#[derive(Clone, Copy)]
struct WheelLanes<S: Vector> {
    centre: CentreVelocity<S>,
    /// Commanded velocity of the centre in plan [m/s].
    in_plan: [Lanes<S>; 2],
    steering: JointAngle<S>,
    /// 1 where a steered wheel rests or has no angle, else 0.
    refused: Lanes<S>,
}

/// Register `k` of a column.
#[inline(always)]
fn register<S: Vector>(simd: S, column: &Column, k: usize) -> Lanes<S> {
    Lanes::load(simd, S::as_simd_f64s(&column.0).0, k)
}

impl Kernel for OneRow<'_, '_> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> bool {
        let Some(input) = self.input() else {
            return false;
        };
        let wheels = self.chain.wheels.min(MAX_WHEELS);
        let registers = wheels.div_ceil(S::F64_LANES);
        let first = self.wheel_lanes(simd, &input, 0);
        let (mut closing, mut refused) = ([0.0; MOST], first.refused);
        for k in 0..registers {
            let lanes = if k == 0 { first } else { self.wheel_lanes(simd, &input, k) };
            lanes.centre.closing_speed(simd).store(S::as_mut_simd_f64s(&mut closing).0, k);
            refused = refused.max(lanes.refused);
        }
        let Some(vertical) = median(&mut closing[..wheels]) else {
            return false;
        };
        let zero = all(simd, 0.0);
        let mut numbers = [[0.0; MOST]; 4];
        for k in 0..registers {
            let lanes = if k == 0 { first } else { self.wheel_lanes(simd, &input, k) };
            let command = lanes.centre.command(simd, all(simd, vertical), lanes.in_plan, self.lift);
            let lifted = command.lifted.select(all(simd, 1.0), zero);
            let results = [command.speed, command.contact_angle, lifted, lanes.steering.angle];
            for (numbers, result) in numbers.iter_mut().zip(results) {
                result.store(S::as_mut_simd_f64s(numbers).0, k);
            }
        }
        let [speeds, contact_angles, lifted, steering] = numbers;
        let is_finite = speeds[..wheels].iter().all(|speed| speed.is_finite());
        if !is_finite || zero.lt(refused).any() {
            return false;
        }
        let drives = self.drives;
        drives.vertical[0] = vertical;
        drives.speeds[..wheels].copy_from_slice(&speeds[..wheels]);
        drives.contact_angles[..wheels].copy_from_slice(&contact_angles[..wheels]);
        for wheel in 0..wheels {
            drives.lifted[wheel] = lifted[wheel] > 0.0;
            if let Some(joint) = self.chain.joints[wheel] {
                drives.steering[joint] = steering[wheel];
            }
        }
        true
    }
}

#[inline_always]
impl OneRow<'_, '_> {
    /// The numbers of the row; None where it is for the lanes of many.
    fn input(&self) -> Option<RowInput> {
        let driving = self.driving;
        if driving.wheel_speeds.is_some() {
            return None;
        }
        let &[speed] = driving.speed else {
            return None;
        };
        let yaw_rate = match driving.turning {
            Turns::Curvature(curvature) => speed * curvature[0],
            Turns::YawRate(yaw_rate) => yaw_rate[0],
        };
        let mut input = RowInput { angles: [0.0; ANGLES], rates: [0.0; ANGLES], speed, yaw_rate };
        for (k, (angle, rate)) in driving.joints.iter().zip(driving.joint_rates).enumerate().take(MAX_FREE) {
            if angle.abs() > LARGEST_TURN {
                return None;
            }
            (input.angles[k], input.rates[k]) = (*angle, *rate);
        }
        let (joint, across) = self.chain.across;
        let [right, slope] = across.right(input.angles[joint % MAX_FREE])?;
        (input.angles[MAX_FREE], input.rates[MAX_FREE]) = (right, slope * input.rates[joint % MAX_FREE]);
        Some(input)
    }

    /// Positions and velocities of the wheels of register `k`: those of both limbs, then the steering angle at which the
    /// centre goes along the wheel in plan.
    fn wheel_lanes<S: Vector>(&self, simd: S, input: &RowInput, k: usize) -> WheelLanes<S> {
        let chain = self.chain;
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        // Angles and rates of both limbs.
        let (mut turns, mut swings) = ([zero; 2], [zero; 2]);
        for (limb, shares) in chain.limbs.iter().enumerate() {
            for (share, (angle, rate)) in shares.iter().zip(input.angles.iter().zip(input.rates)) {
                let share = register(simd, share, k);
                turns[limb] = share.mul_add(all(simd, *angle), turns[limb]);
                swings[limb] = share.mul_add(all(simd, rate), swings[limb]);
            }
        }
        let (s1, c1) = direction(simd, turns[0]);
        let (s, c) = direction(simd, turns[1]);
        let (s2, c2) = (s1.mul_add(c, c1 * s), c1.mul_add(c, -(s1 * s)));
        let out = |[x, z]: [Lanes<S>; 2], s: Lanes<S>, c: Lanes<S>| [x.mul_add(c, z * s), z.mul_add(c, -(x * s))];
        let [body, knee, wheel] =
            chain.origins.each_ref().map(|at| at.each_ref().map(|column| register(simd, column, k)));
        let to_knee = out(knee, s1, c1);
        let knee = [body[0] + to_knee[0], body[1] + to_knee[1]];
        let to_wheel = out(wheel, s2, c2);
        let (x, z) = (knee[0] + to_wheel[0], knee[1] + to_wheel[1]);
        let y = register(simd, &chain.left, k);
        let [roll, pitch, _] = self.driving.angular_velocity[0];
        let [roll, pitch, yaw] = [all(simd, roll), all(simd, pitch), all(simd, input.yaw_rate)];
        let [speed, sideways] = [all(simd, input.speed), all(simd, input.yaw_rate) * all(simd, self.offset)];
        // As commanded, and how the centres move with the body and both limbs.
        let in_plan = [speed - yaw * y, yaw.mul_add(x, sideways)];
        let swing = swings[0] + swings[1];
        let forth = swings[1].mul_add(knee[1], swings[0] * body[1]);
        let down = swings[1].mul_add(knee[0], swings[0] * body[0]);
        let [forwards, aside, upwards] = cross([roll, pitch, yaw], [x, y, z]);
        let forth = (speed + forwards) + swing.mul_add(z, -forth);
        let aside = sideways + aside;
        let up = (zero + upwards) + (down - swing * x);
        let steered = zero.lt(register(simd, &chain.steers, k));
        let to = polar([zero + c2 * in_plan[0], zero + in_plan[1]]);
        let steering = JointAngle::in_range(simd, chain.range, angle_of(simd, to.turned), to.turned);
        let (ss, cs) = (steered.select(steering.turned.0, zero), steered.select(steering.turned.1, one));
        let along = (forth.mul_add(c2, -(up * s2))).mul_add(cs, aside * ss);
        let across = up.mul_add(c2, forth * s2);
        let turn = (pitch + swing).mul_add(cs, -(roll.mul_add(c2, -(yaw * s2)) * ss));
        let inverse_radius = register(simd, &chain.inverse_radius, k);
        WheelLanes {
            centre: CentreVelocity { along, across, vertical: [-(s2 * cs), c2], turn, inverse_radius },
            in_plan,
            steering,
            refused: (steered & (to.is_zero | steering.failed())).select(one, zero),
        }
    }
}

/// The median of some numbers; None where one of them is not finite.
#[inline(always)]
fn median(values: &mut [f64]) -> Option<f64> {
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
