//! Traction of one row, for rockers and bogies: the lanes of a register are the wheels.
//!
//! Places and motions of links and wheels are those of rows in lanes ([`PlanarLink`], [`CentreVelocity`]), so
//! that a row has the same bits alone and in a batch.

use pulp::Scalar;

use super::wheel_command::{CentreVelocity, LiftLimits, median};
use crate::driving::{Drives, Driving, Turns};
use crate::lanes::columns::{angle_of, polar};
use crate::steering::joint_angle::JointAngle;
use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::Kernel;
use six_wheel_numerics::simd::polynomials::direction;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_terrain::suspension::kinematics::{Hinge, LinkPose, LinkVelocity, PlanarLink};
use six_wheel_terrain::suspension::lanes::{Column, LARGEST_TURN, MOST, Vectors, all};
use six_wheel_terrain::suspension::{Chain, Differential, MAX_FREE, MAX_WHEELS, Turning};

/// Angles that turn links: the free angles, and the angle of the right side of the differential.
const ANGLES: usize = MAX_FREE + 1;

/// Constants of a suspension in which at most two links, both turning about y, lie between body and wheel (rocker and
/// bogie). One lane per wheel; lanes without a wheel repeat the first.
#[derive(Clone, Debug)]
pub(crate) struct TwoLinkChain {
    wheels: usize,
    /// The free angle on the left side of a differential, and the differential.
    across: (usize, Differential),
    /// Factors of each angle in the angle of the first link against the body, and in that of the second against the
    /// first.
    links: [[Column; ANGLES]; 2],
    /// Origin of the first link in the body, of the second in the first, and the wheel's centre in the second [m].
    origins: [[Column; 3]; 3],
    /// One over the radius [1/m].
    inverse_radius: Column,
    /// 1 where a wheel is steered.
    steers: Column,
    joints: [Option<usize>; MAX_WHEELS],
    range: SteeringRange,
}

impl TwoLinkChain {
    /// None for other chains, and where steering joints differ or have several wheels, or some beside their axes.
    pub fn new(chain: &Chain) -> Option<Self> {
        let range = chain.steering().first().copied().unwrap_or_default();
        let (zero, wheels) = (Column::ZERO, chain.wheels().len());
        let mut two_link = Self {
            wheels,
            across: (0, Differential::Gear),
            links: [[zero; ANGLES]; 2],
            origins: [[zero; 3]; 3],
            inverse_radius: zero,
            steers: zero,
            joints: [None; MAX_WHEELS],
            range,
        };
        for link in chain.parts() {
            if let Turning::Across(joint, differential) = link.turning {
                two_link.across = (joint, differential);
            }
        }
        // A bar's right angle is a nonlinear function of the left one, which this kernel does not compute.
        if two_link.across.1 != Differential::Gear {
            return None;
        }
        for lane in 0..MOST {
            let wheel = if lane < wheels { lane } else { 0 };
            let mount = chain.mount(wheel);
            if mount.movers.len() > 2 || mount.is_offset() {
                return None;
            }
            if let Some(joint) = mount.steering.filter(|_| lane == wheel) {
                if two_link.joints.contains(&Some(joint)) {
                    return None;
                }
                two_link.joints[lane] = Some(joint);
            }
            two_link.steers.0[lane] = f64::from(u8::from(mount.steering.is_some()));
            two_link.inverse_radius.0[lane] = 1.0 / chain.wheels()[wheel].radius;
            two_link.put(2, lane, mount.centre);
            for (k, &(part, joint)) in mount.movers.iter().rev().enumerate() {
                let link = &chain.parts()[part];
                let angle = match link.turning {
                    Turning::Across(..) if joint != two_link.across.0 => return None,
                    Turning::Across(..) => MAX_FREE,
                    _ => joint,
                };
                if chain.main_axis(part) != Some(1) {
                    return None;
                }
                two_link.links[k][angle].0[lane] = 1.0;
                two_link.put(k, lane, link.origin.into());
            }
        }
        let same = chain.steering().iter().all(|other| *other == range);
        same.then_some(two_link)
    }

    /// Sets an origin in a lane [m].
    fn put(&mut self, origin: usize, lane: usize, place: [f64; 3]) {
        for (column, value) in self.origins[origin].iter_mut().zip(place) {
            column.0[lane] = value;
        }
    }
}

/// One row. Its kernel returns false and writes nothing where the row needs the kernel of many rows: if wheels rest, a
/// joint has no angle, speeds were measured or a result is not finite.
pub(crate) struct OneRow<'a, 'b> {
    pub chain: &'a TwoLinkChain,
    pub offset: f64,
    pub lift: LiftLimits,
    pub driving: &'a Driving<'a>,
    pub drives: &'a mut Drives<'b>,
}

/// Free angles and the right side of the differential [rad], their rates [rad/s], and the commanded speed [m/s] and yaw
/// rate [rad/s].
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

/// Register `k` of each of three columns.
#[inline(always)]
fn registers<S: Vector>(simd: S, [x, y, z]: &[Column; 3], k: usize) -> Vectors<S> {
    [register(simd, x, k), register(simd, y, k), register(simd, z, k)]
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
        let mut sum = 0.0;
        let mut speeds = [all(Scalar, 0.0); MAX_WHEELS];
        for (speed, closing) in speeds.iter_mut().zip(&closing[..wheels]) {
            sum += closing;
            *speed = all(Scalar, *closing);
        }
        if !sum.is_finite() {
            return false;
        }
        let vertical = median(Scalar, speeds, wheels).last(Scalar);
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
    /// The numbers of the row; None where it needs the kernel of many rows.
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

    /// Positions and velocities of the wheels of register `k` by both links, then the steering angle along the
    /// commanded velocity of the centre in plan.
    fn wheel_lanes<S: Vector>(&self, simd: S, input: &RowInput, k: usize) -> WheelLanes<S> {
        let chain = self.chain;
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        let [roll, pitch, _] = self.driving.angular_velocity[0];
        let [roll, pitch, yaw] = [all(simd, roll), all(simd, pitch), all(simd, input.yaw_rate)];
        let [speed, sideways] = [all(simd, input.speed), all(simd, input.yaw_rate) * all(simd, self.offset)];
        let mut pose = PlanarLink::frame(simd);
        let body = LinkVelocity { linear: [speed, sideways, zero], angular: [roll, pitch, yaw] };
        for (shares, origin) in chain.links.iter().zip(&chain.origins) {
            let (mut angle, mut rate) = (zero, zero);
            for (share, (turn, swing)) in shares.iter().zip(input.angles.iter().zip(input.rates)) {
                let share = register(simd, share, k);
                angle = share.mul_add(all(simd, *turn), angle);
                rate = share.mul_add(all(simd, swing), rate);
            }
            let hinge = Hinge {
                origin: registers(simd, origin, k),
                axis: [0.0, 1.0, 0.0],
                main_axis: Some(1),
                turned: direction(simd, angle),
                slope: None,
            };
            let mut link = PlanarLink::frame(simd);
            pose.carry(&hinge, &mut link);
            pose.carry_rate(rate, &mut link);
            pose = link;
        }
        let centre = pose.point(registers(simd, &chain.origins[2], k));
        // As commanded in plan.
        let in_plan = [speed - yaw * centre[1], yaw.mul_add(centre[0], sideways)];
        let steered = zero.lt(register(simd, &chain.steers, k));
        let [ahead, aside, _] = pose.in_own_axes([in_plan[0], in_plan[1], zero]);
        let to = polar([zero + ahead, zero + aside]);
        let steering = JointAngle::in_range(simd, chain.range, angle_of(simd, to.turned), to.turned);
        let turned = (steered.select(steering.turned.0, zero), steered.select(steering.turned.1, one));
        let inverse_radius = register(simd, &chain.inverse_radius, k);
        WheelLanes {
            centre: CentreVelocity::new(&body, &pose, centre, turned, inverse_radius),
            in_plan,
            steering,
            refused: (steered & (to.is_zero | steering.failed())).select(one, zero),
        }
    }
}
