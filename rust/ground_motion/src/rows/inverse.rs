//! Wheels for desired motions, for many rows.

use super::prepared::Prepared;
use super::run::{BodyPoses, InLanes, MotionScratch, SolveRows, run_rows, take};
use crate::lanes::columns::{Span, is_number};
use crate::lanes::pose_lanes::PoseLanes;
use crate::lanes::settled_poses::SettledPoses;
use crate::motion::{Command, View};
use crate::rates::constants::PLAN;
use crate::rates::contact_rows::COLUMNS;
use crate::rates::contact_rows::{Contacts, Row, angle_on_plane, rim_side, velocity_rows};
use crate::rates::least_squares::DenseLeastSquares;
use crate::rates::suspension_rates::{KnownRate, SuspensionRates};
use crate::steering::joint_angle::{JointAngle, JointAngles, check, of_wheel, values};
use crate::steering::search::{SteeringInput, steer};
use crate::steering::side_slip::WheelAxes;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_terrain::suspension::kinematics::LinkVelocity;
use six_wheel_terrain::suspension::lanes::{Turned, Vectors, all, from_turned};
use six_wheel_terrain::suspension::{Chain, MAX_FREE, MAX_WHEELS};

/// Commands of the wheels, row after row, and the motion of the rover that follows from them.
#[derive(Debug)]
pub struct Commands<'a> {
    /// Angles of the steering joints [rad].
    pub steering: &'a mut [f64],
    /// Speeds of the wheels [rad/s].
    pub speeds: &'a mut [f64],
    /// Twists of the body [m/s, rad/s].
    pub twists: &'a mut [[f64; 6]],
    /// Rates of the free angles [rad/s].
    pub joint_rates: &'a mut [f64],
    /// Scales of the desired motions, 1 unless a wheel would have been too fast.
    pub scales: &'a mut [f64],
}

/// Wheels for a desired motion on this ground, for steering angles that are given or, by default, those at which the
/// touching points roll where they go. Of desired speeds and yaw rates `[m/s, rad/s]` there is one per row, or one for all.
///
/// The motion is that of the settled pose's own contacts. Steering moves a contact; it is taken to move on the plane
/// that the wheel stands on, so the command is exact where the ground is plane or the pose was settled at
/// the very angles that come out. Fails at the first row at which a wheel would steer past its range.
#[allow(clippy::too_many_arguments)] // each is a thing of its own
pub fn inverse_rows(
    chain: &Chain,
    prepared: &Prepared,
    poses: &SettledPoses<'_>,
    command: &Command,
    desired: &[[f64; 2]],
    steering: Option<&[f64]>,
    commands: Commands<'_>,
    workers: Workers,
) -> Result<(), Error> {
    let (wheels, free, steered) = (chain.wheels().len(), chain.joints().len(), chain.steering().len());
    let Commands { steering: mut angles, mut speeds, mut twists, mut joint_rates, mut scales } = commands;
    run_rows(chain, prepared, workers, scales.len(), |rows| InverseRange {
        poses,
        command,
        desired,
        steering,
        commands: Commands {
            steering: take(&mut angles, rows * steered),
            speeds: take(&mut speeds, rows * wheels),
            twists: take(&mut twists, rows),
            joint_rates: take(&mut joint_rates, rows * free),
            scales: take(&mut scales, rows),
        },
    })
}

/// Rows that one thread takes.
struct InverseRange<'a> {
    poses: &'a SettledPoses<'a>,
    command: &'a Command,
    desired: &'a [[f64; 2]],
    steering: Option<&'a [f64]>,
    commands: Commands<'a>,
}

/// The wheels where they stand.
struct StandingWheels<S: Vector> {
    /// Rotations about the steering axes; None for wheels that point straight ahead.
    directions: [Option<Turned<S>>; MAX_WHEELS],
    /// Centres [m].
    centres: [Vectors<S>; MAX_WHEELS],
}

impl SolveRows for InLanes<'_, InverseRange<'_>> {
    #[inline(always)]
    fn solve_rows<S: Vector>(
        &mut self,
        simd: S,
        [span, given]: [Span; 2],
        links: &mut BodyPoses<'_, S>,
        scratch: &mut MotionScratch<S>,
    ) -> Result<(), Error> {
        let chain = self.chain;
        let MotionScratch { gather, equations, contacts, poses } = scratch;
        poses.read(simd, chain, self.range.poses, given, gather);
        let poses = &*poses;
        self.place(simd, links, poses.joints);
        let standing = self.write_normal_rows(simd, poses, links, contacts);
        let (rates, determined) = self.rates(simd, given, poses, contacts, equations);
        let mut total = all(simd, 0.0);
        for rate in rates {
            total = total + rate;
        }
        let known = determined & is_number(total) & !poses.touching.none;
        let [vx, vy, vz, wx, wy, wz, joints @ ..] = rates;
        links.set_rates(&joints);
        let body = LinkVelocity { linear: [vx, vy, vz], angular: [wx, wy, wz] };
        let axes = self.wheel_axes(simd, poses, (links, &body), &standing);
        let angles = self.steering_angles(simd, given, poses, &axes, known);
        check(simd, chain, given, &angles, &poses.touching.wheels, known)?;
        let (speeds, scale) = self.rolling_speeds(simd, poses, &axes, &angles);
        self.write(span, &values(simd, &angles), &speeds, &rates, known.select(scale, all(simd, f64::NAN)));
        Ok(())
    }
}

#[inline_always]
impl InLanes<'_, InverseRange<'_>> {
    /// Writes the velocities of the contacts along the normals by the rates, at the angles of the settled poses.
    fn write_normal_rows<S: Vector>(
        &self,
        simd: S,
        poses: &PoseLanes<S>,
        links: &BodyPoses<'_, S>,
        contacts: &mut Contacts<S>,
    ) -> StandingWheels<S> {
        let zero = all(simd, 0.0);
        let mut standing = StandingWheels { directions: [None; MAX_WHEELS], centres: [[zero; 3]; MAX_WHEELS] };
        for (wheel, contact) in contacts.iter_mut().enumerate().take(self.motion.wheels) {
            let direction = self.settled_direction(simd, poses, wheel);
            let (centre, touch) = self.contact(links, wheel, direction, poses.at[wheel]);
            let [normal, ..] = contact.rows.each_mut();
            velocity_rows(links.movers(wheel), touch.point, [poses.normals[wheel]], std::array::from_mut(normal));
            (standing.directions[wheel], standing.centres[wheel]) = (direction, centre);
        }
        standing
    }

    /// Twist and joint rates of the desired motion, and the lanes in which the ground determines them.
    fn rates<S: Vector>(
        &self,
        simd: S,
        given: Span,
        poses: &PoseLanes<S>,
        contacts: &Contacts<S>,
        equations: &mut DenseLeastSquares<S>,
    ) -> (Row<S>, Mask<S>) {
        let (range, motion, touching) = (&self.range, self.motion, &poses.touching);
        let (speed, yaw_rate) = match range.desired {
            [[speed, yaw_rate]] => (all(simd, *speed), all(simd, *yaw_rate)),
            desired => {
                let [speed, yaw_rate] = given.read::<S, 2>(simd, desired.as_flattened(), 2);
                (speed, yaw_rate)
            }
        };
        let plan = [speed, yaw_rate * all(simd, range.command.offset), yaw_rate];
        let mut known = [KnownRate::Unknown; COLUMNS];
        for k in 0..MAX_FREE {
            if k >= motion.joints {
                known[6 + k] = KnownRate::Known(all(simd, 0.0));
            } else if poses.any_stopped {
                known[6 + k] = KnownRate::KnownWhere(poses.stopped[k], all(simd, 0.0));
            }
        }
        match range.command.view {
            View::Body => {
                for (column, rate) in PLAN.into_iter().zip(plan) {
                    known[column] = KnownRate::Known(rate);
                }
                let found = SuspensionRates::new::<1>(simd, motion, touching, &known, contacts, equations);
                (found.offset, found.determined)
            }
            View::Plan => {
                let found = SuspensionRates::new::<3>(simd, motion, touching, &known, contacts, equations);
                let (plan, determined) = seen_from_above(simd, poses, &found, plan, equations);
                (found.rates(plan), found.determined & determined)
            }
        }
    }

    /// The wheels in their own axes where they stand, as their links move.
    fn wheel_axes<S: Vector>(
        &self,
        simd: S,
        poses: &PoseLanes<S>,
        (links, body): (&BodyPoses<'_, S>, &LinkVelocity<S>),
        standing: &StandingWheels<S>,
    ) -> [WheelAxes<S>; MAX_WHEELS] {
        let straight = (all(simd, 0.0), all(simd, 1.0));
        let mut axes = [WheelAxes::at_rest(simd); MAX_WHEELS];
        for (wheel, axes) in axes.iter_mut().enumerate().take(self.motion.wheels) {
            let link = links.wheel_link(wheel);
            let turned = standing.directions[wheel].unwrap_or(straight);
            let normal = from_turned(turned, link.in_own_axes(poses.normals[wheel]));
            *axes = WheelAxes {
                normal,
                velocity: from_turned(turned, link.in_own_axes(link.velocity(body, standing.centres[wheel]))),
                turn: from_turned(turned, link.in_own_axes(link.angular_velocity(body))),
                side: rim_side([normal[0], normal[2]], poses.at[wheel]),
                offset: self.chain.mount(wheel).offset,
                radius: self.motion.radii[wheel],
            };
        }
        axes
    }

    /// Angles of the steering joints, those that are given or those at which wheels roll.
    fn steering_angles<S: Vector>(
        &self,
        simd: S,
        given: Span,
        poses: &PoseLanes<S>,
        axes: &[WheelAxes<S>; MAX_WHEELS],
        known: Mask<S>,
    ) -> JointAngles<S> {
        let ranges = self.chain.steering();
        if let Some(angles) = self.range.steering {
            let angles = given.read::<S, MAX_WHEELS>(simd, angles, ranges.len());
            let mut joints = [None; MAX_WHEELS];
            for (k, joint) in joints.iter_mut().enumerate().take(ranges.len()) {
                *joint = Some(JointAngle::given(simd, angles[k], poses.steering[k]));
            }
            return joints;
        }
        let input = SteeringInput {
            chain: self.chain,
            ranges,
            axes: &axes[..self.motion.wheels.min(MAX_WHEELS)],
            from: &poses.steering,
            held: &poses.steering,
            touching: &poses.touching.wheels,
            known,
        };
        steer(simd, &input)
    }

    /// Speeds of the wheels at these steering angles [rad/s], and the scale at which none is too fast.
    fn rolling_speeds<S: Vector>(
        &self,
        simd: S,
        poses: &PoseLanes<S>,
        axes: &[WheelAxes<S>; MAX_WHEELS],
        angles: &JointAngles<S>,
    ) -> ([Lanes<S>; MAX_WHEELS], Lanes<S>) {
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        let mut moved = Mask::splat(simd, false);
        for (angle, present) in angles.iter().zip(poses.steering) {
            if let Some(angle) = angle {
                moved = moved | !(angle.angle - present).abs().le(zero);
            }
        }
        let (mut speeds, mut fastest) = ([zero; MAX_WHEELS], zero);
        for (wheel, axes) in axes.iter().enumerate().take(self.motion.wheels) {
            let mut to = (zero, one);
            if let Some(angle) = of_wheel(self.chain, angles, wheel) {
                to = angle.turned;
            }
            let (sin, cos) = poses.at[wheel];
            let plane = angle_on_plane(axes.normal_in_plane(to), axes.side);
            let at = (moved.select(plane.0, sin), moved.select(plane.1, cos));
            speeds[wheel] = axes.rolling_speed(simd, to, at);
            fastest = is_number(speeds[wheel]).select(speeds[wheel].abs(), zero).max(fastest);
        }
        let limit = all(simd, self.range.command.wheel_speed);
        (speeds, limit.lt(fastest).select(limit / fastest, one))
    }

    fn write<S: Vector>(
        &mut self,
        span: Span,
        angles: &[Lanes<S>; MAX_WHEELS],
        speeds: &[Lanes<S>; MAX_WHEELS],
        rates: &Row<S>,
        scale: Lanes<S>,
    ) {
        let chain = self.chain;
        let simd = scale.simd();
        // NaN where nothing is known.
        let nothing = !scale.le(scale);
        let (mut steers, mut turns) = (*angles, *speeds);
        for k in 0..MAX_WHEELS {
            steers[k] = nothing.select(scale, angles[k]);
            turns[k] = speeds[k] * scale;
        }
        let mut rates = *rates;
        for rate in &mut rates {
            *rate = *rate * scale;
        }
        let [vx, vy, vz, wx, wy, wz, joints @ ..] = rates;
        let commands = &mut self.range.commands;
        span.write(simd, &steers, chain.steering().len(), commands.steering);
        span.write(simd, &turns, chain.wheels().len(), commands.speeds);
        span.write(simd, &[vx, vy, vz, wx, wy, wz], 6, commands.twists.as_flattened_mut());
        span.write(simd, &joints, chain.joints().len(), commands.joint_rates);
        span.write(simd, &[scale], 1, commands.scales);
    }
}

/// The planar rates of the body whose motion in the horizontal plane is the desired one, and the lanes in which there
/// are any: see [`View::Plan`]. The yaw rate is the angular velocity about the vertical, without the pitch rate, whose
/// axis is horizontal.
#[inline(always)]
fn seen_from_above<S: Vector>(
    simd: S,
    poses: &PoseLanes<S>,
    suspension: &SuspensionRates<S>,
    desired: [Lanes<S>; 3],
    equations: &mut DenseLeastSquares<S>,
) -> ([Lanes<S>; 3], Mask<S>) {
    let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
    let ((sr, cr), (sp, cp)) = (poses.roll, poses.pitch);
    let level = [[cp, sp * sr, sp * cr], [zero, cr, -sr]];
    let inverse = one / cp;
    let turning = [sr * inverse, cr * inverse];
    // Of vx, vy, vz, wy and wz, by the planar motion.
    let mut spread = [[zero; 3]; COLUMNS];
    for (k, column) in PLAN.into_iter().enumerate() {
        spread[column][k] = one;
    }
    for (column, row) in suspension.unknown.iter().zip(&suspension.spread).take(suspension.count) {
        spread[*column] = *row;
    }
    let mut system = [[zero; 3]; 3];
    for k in 0..3 {
        for (cells, row) in system.iter_mut().zip(&level) {
            for c in 0..3 {
                cells[k] = row[c].mul_add(spread[c][k], cells[k]);
            }
        }
        system[2][k] = turning[0].mul_add(spread[4][k], turning[1] * spread[5][k]);
    }
    equations.clear();
    for (cells, value) in system.iter().zip(desired) {
        let row = equations.add(0b111);
        row[..3].copy_from_slice(cells);
        row[3] = value;
    }
    let (solution, determined) = equations.solve::<1>(simd, 3);
    ([solution[0][0], solution[1][0], solution[2][0]], determined)
}
