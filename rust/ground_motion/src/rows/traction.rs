//! Wheel speeds over rough ground without a map of it, for many rows.
//!
//! The rates of body and suspension give the velocity of every wheel's centre up to the vertical speed of the body,
//! which is not measured. The centre of a wheel on the ground moves along the tangent of the rim at the contact, so the
//! direction of its velocity is the contact angle and the length its rolling speed.
//!
//! (O. Toupet, J. Biesiadecki, A. Rankin, A. Steffy, G. Meirion-Griffith, D. Levine, M. Schadegg, M. Maimone,
//! Terrain-adaptive wheel speed control on the Curiosity Mars rover, JFR 37(5), 2020; here the rotation of the link
//! that carries the wheel is subtracted, since its encoder measures against the link.)

use super::prepared::Prepared;
use super::run::{BodyPoses, InLanes, MotionScratch, SolveRows, run_rows, take};
use super::two_link_chain::OneRow;
use super::wheel_command::{CentreVelocity, LiftLimits, fitted_vertical_speed, median_closing_speed};
use crate::driving::{Drives, Driving, Turns};
use crate::lanes::columns::{Span, angle_of, direction_of, polar, wrap_far};
use crate::steering::joint_angle::{JointAngle, JointAngles, check, of_wheel, values};
use crate::steering::search::{SteeringInput, steer};
use crate::steering::side_slip::WheelAxes;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_terrain::suspension::kinematics::{LinkVelocity, PlanarLink};
use six_wheel_terrain::suspension::lanes::{Vectors, all};
use six_wheel_terrain::suspension::{Chain, MAX_FREE, MAX_WHEELS};

/// Wheels for commanded speeds and yaw rates, from the rates of body and joints alone. Fails at the first row at which a
/// wheel would steer past its range.
pub fn traction_rows(
    chain: &Chain,
    prepared: &Prepared,
    driving: &Driving<'_>,
    mut drives: Drives<'_>,
    workers: Workers,
) -> Result<(), Error> {
    let workers = workers.here();
    let lift = LiftLimits::new(driving.lift);
    let rows = drives.vertical.len();
    let two_link = prepared.lanes.as_ref().and_then(|lanes| lanes.two_link.as_ref());
    if let (1, Some(chain)) = (rows, two_link) {
        let row = OneRow { chain, offset: prepared.offset, lift, driving, drives: &mut drives };
        if workers.level.run_any(row) {
            return Ok(());
        }
    }
    let (wheels, steered) = (chain.wheels().len(), chain.steering().len());
    let Drives { mut steering, mut speeds, mut contact_angles, mut lifted, mut vertical } = drives;
    run_rows(chain, prepared, workers, rows, |rows| TractionRange {
        offset: prepared.offset,
        driving,
        lift,
        drives: Drives {
            steering: take(&mut steering, rows * steered),
            speeds: take(&mut speeds, rows * wheels),
            contact_angles: take(&mut contact_angles, rows * wheels),
            lifted: take(&mut lifted, rows * wheels),
            vertical: take(&mut vertical, rows),
        },
    })
}

/// Rows that one thread takes.
struct TractionRange<'a> {
    /// Distance of the point that moves straight ahead behind the origin [m].
    offset: f64,
    driving: &'a Driving<'a>,
    lift: LiftLimits,
    drives: Drives<'a>,
}

/// A wheel at its link.
#[derive(Clone, Copy)]
struct PlacedWheel<'a, S: Vector> {
    link: &'a PlanarLink<S>,
    /// Centre of the wheel straight ahead; of the steered wheel after [`InLanes::centre_velocities`] [m].
    centre: Vectors<S>,
}

/// Commanded velocities of the body, and rates of the body and the free angles.
struct DesiredRates<S: Vector> {
    body: LinkVelocity<S>,
    joints: [Lanes<S>; MAX_FREE],
}

impl<S: Vector> DesiredRates<S> {
    /// The velocity of a point of the body as commanded [m/s].
    #[inline(always)]
    fn in_plan(&self, point: Vectors<S>) -> [Lanes<S>; 2] {
        let LinkVelocity { linear: [speed, sideways, _], angular: [_, _, turn] } = self.body;
        [speed - turn * point[1], turn.mul_add(point[0], sideways)]
    }
}

impl SolveRows for InLanes<'_, TractionRange<'_>> {
    #[inline(always)]
    fn solve_rows<S: Vector>(
        &mut self,
        simd: S,
        [span, given]: [Span; 2],
        links: &mut BodyPoses<'_, S>,
        _: &mut MotionScratch<S>,
    ) -> Result<(), Error> {
        let (range, wheels) = (&self.range, self.motion.wheels.min(MAX_WHEELS));
        let (zero, nan) = (all(simd, 0.0), all(simd, f64::NAN));
        let joints = given.read::<S, MAX_FREE>(simd, range.driving.joints, self.motion.joints);
        let desired = self.desired_rates(simd, given);
        self.place(simd, links, wrap_far(simd, joints));
        links.set_rates(&desired.joints);
        let links = &*links;
        let mut placed = [PlacedWheel { link: links.wheel_link(0), centre: [zero; 3] }; MAX_WHEELS];
        for (wheel, placed) in placed[..wheels].iter_mut().enumerate() {
            *placed = PlacedWheel { link: links.wheel_link(wheel), centre: links.centre(simd, wheel) };
        }
        let placed = &mut placed[..wheels];
        let reach = links.reaches;
        let angles = self.steering_angles(simd, given, placed, &desired, reach);
        check(simd, self.chain, given, &angles, &[zero; MAX_WHEELS], reach)?;
        let centres = self.centre_velocities(simd, links, &desired.body, placed, &angles);
        let centres = &centres[..wheels];
        let mut vertical = median_closing_speed(simd, centres);
        if let Some(measured) = range.driving.wheel_speeds {
            let measured = given.read::<S, MAX_WHEELS>(simd, measured, wheels);
            vertical = fitted_vertical_speed(simd, self.motion, centres, &measured, vertical);
        }
        let (mut speeds, mut contact_angles) = ([zero; MAX_WHEELS], [zero; MAX_WHEELS]);
        let mut lifted = zero;
        for (wheel, centre) in centres.iter().enumerate() {
            let in_plan = desired.in_plan(placed[wheel].centre);
            let command = centre.command(simd, vertical, in_plan, range.lift);
            (speeds[wheel], contact_angles[wheel]) = (command.speed, command.contact_angle);
            lifted = lifted + command.lifted.select(all(simd, f64::from(1_u32 << wheel)), zero);
        }
        let mut steering = values(simd, &angles);
        for angle in &mut steering {
            *angle = reach.select(*angle, nan);
        }
        let (steered, drives) = (self.chain.steering().len(), &mut self.range.drives);
        span.write(simd, &steering, steered, drives.steering);
        span.write(simd, &speeds, wheels, drives.speeds);
        span.write(simd, &contact_angles, wheels, drives.contact_angles);
        span.write(simd, &[vertical], 1, drives.vertical);
        span.flags(lifted, wheels, drives.lifted);
        Ok(())
    }
}

#[inline_always]
impl InLanes<'_, TractionRange<'_>> {
    fn desired_rates<S: Vector>(&self, simd: S, given: Span) -> DesiredRates<S> {
        let driving = self.range.driving;
        let speed = given.one(simd, driving.speed);
        let yaw_rate = match driving.turning {
            Turns::Curvature(curvature) => speed * given.one(simd, curvature),
            Turns::YawRate(yaw_rate) => given.one(simd, yaw_rate),
        };
        let measured = driving.angular_velocity.as_flattened();
        let [roll_rate, pitch_rate, _] = given.read::<S, 3>(simd, measured, 3);
        let sideways = yaw_rate * all(simd, self.range.offset);
        DesiredRates {
            body: LinkVelocity {
                linear: [speed, sideways, all(simd, 0.0)],
                angular: [roll_rate, pitch_rate, yaw_rate],
            },
            joints: given.read::<S, MAX_FREE>(simd, driving.joint_rates, self.motion.joints),
        }
    }

    /// Angles of the steering joints, each along the mean velocity in plan of the centres of its wheels, forwards or backwards.
    /// Joints whose wheels rest keep their angle.
    fn steering_angles<S: Vector>(
        &self,
        simd: S,
        given: Span,
        wheels: &[PlacedWheel<'_, S>],
        desired: &DesiredRates<S>,
        known: Mask<S>,
    ) -> JointAngles<S> {
        let zero = all(simd, 0.0);
        let ranges = self.chain.steering();
        let mut velocities = [[zero; 2]; MAX_WHEELS];
        let mut is_centred = true;
        for (wheel, PlacedWheel { link, centre }) in wheels.iter().enumerate() {
            let Some(joint) = self.chain.steering_joint(wheel) else {
                continue;
            };
            is_centred &= self.motion.is_centred(joint);
            let [x, y] = desired.in_plan(*centre);
            let [ahead, aside, _] = link.in_own_axes([x, y, zero]);
            let velocity = &mut velocities[joint % MAX_WHEELS];
            *velocity = [velocity[0] + ahead, velocity[1] + aside];
        }
        if !is_centred {
            return self.offset_steering_angles(simd, given, wheels, desired, known);
        }
        let mut angles = [None; MAX_WHEELS];
        for (joint, (angle, range)) in angles.iter_mut().zip(ranges).enumerate() {
            let to = polar(velocities[joint]);
            let (mut turned, mut asked) = (to.turned, angle_of(simd, to.turned));
            if to.is_zero.any() {
                let held = self.held_angles(simd, given)[joint];
                let (sin, cos) = direction_of(simd, held);
                turned = (to.is_zero.select(sin, turned.0), to.is_zero.select(cos, turned.1));
                asked = to.is_zero.select(held, asked);
            }
            *angle = Some(JointAngle::in_range(simd, *range, asked, turned));
        }
        angles
    }

    /// Angles of the steering joints of wheels beside their axes, whose centres move with the angles: roots of the
    /// sideways velocity.
    fn offset_steering_angles<S: Vector>(
        &self,
        simd: S,
        given: Span,
        wheels: &[PlacedWheel<'_, S>],
        desired: &DesiredRates<S>,
        known: Mask<S>,
    ) -> JointAngles<S> {
        let zero = all(simd, 0.0);
        let turn = [zero, zero, desired.body.angular[2]];
        let mut axes = [WheelAxes::at_rest(simd); MAX_WHEELS];
        for (wheel, (axes, PlacedWheel { link, centre })) in axes.iter_mut().zip(wheels).enumerate() {
            let [x, y] = desired.in_plan(*centre);
            axes.velocity = link.in_own_axes([x, y, zero]);
            axes.turn = link.in_own_axes(turn);
            axes.offset = self.chain.mount(wheel).offset;
            // The sideways velocity is that of the centre: the rim adds nothing to it.
            axes.radius = 0.0;
        }
        let input = SteeringInput {
            chain: self.chain,
            ranges: self.chain.steering(),
            axes: &axes[..wheels.len()],
            from: &[zero; MAX_WHEELS],
            held: &self.held_angles(simd, given),
            touching: &[zero; MAX_WHEELS],
            known,
        };
        steer(simd, &input)
    }

    /// Present angles of the steering joints, 0 by default [rad].
    fn held_angles<S: Vector>(&self, simd: S, given: Span) -> [Lanes<S>; MAX_WHEELS] {
        match self.range.driving.steering {
            Some(angles) => given.read(simd, angles, self.chain.steering().len()),
            None => [all(simd, 0.0); MAX_WHEELS],
        }
    }

    /// Velocities of the wheels' centres at these steering angles; moves `wheels` there.
    fn centre_velocities<S: Vector>(
        &self,
        simd: S,
        links: &BodyPoses<'_, S>,
        body: &LinkVelocity<S>,
        wheels: &mut [PlacedWheel<'_, S>],
        angles: &JointAngles<S>,
    ) -> [CentreVelocity<S>; MAX_WHEELS] {
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        let none = CentreVelocity { along: zero, across: zero, vertical: [zero; 2], turn: zero, inverse_radius: one };
        let mut centres = [none; MAX_WHEELS];
        for (wheel, (velocity, PlacedWheel { link, centre })) in centres.iter_mut().zip(wheels).enumerate() {
            let mut to = (zero, one);
            if let Some(angle) = of_wheel(self.chain, angles, wheel) {
                to = angle.turned;
                *centre = links.steered_centre(simd, wheel, to, *centre);
            }
            let inverse_radius = all(simd, 1.0 / self.motion.radii[wheel]);
            *velocity = CentreVelocity::new(body, link, *centre, to, inverse_radius);
        }
        centres
    }
}
