//! Twist and joint rates from the wheels, for many rows: the planar motion by weighted least squares over the contacts.

use super::prepared::Prepared;
use super::run::{BodyPoses, InLanes, MotionScratch, SolveRows, run_rows, take};
use crate::lanes::columns::{Span, direction_of, is_number};
use crate::lanes::pose_lanes::PoseLanes;
use crate::lanes::settled_poses::SettledPoses;
use crate::rates::constants::MotionConstants;
use crate::rates::contact_rows::COLUMNS;
use crate::rates::contact_rows::{Contacts, angle_on_plane, rim_side, steering_velocity, velocity_rows};
use crate::rates::fit::{FitInput, FittedMotion, fit};
use crate::rates::suspension_rates::{KnownRate, KnownRates};
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_terrain::suspension::lanes::{Turned, all, cross, from_turned};
use six_wheel_terrain::suspension::{Chain, MAX_FREE, MAX_WHEELS};

/// Measurements, row after row: see [`Readings`].
#[derive(Clone, Copy, Debug)]
pub struct ReadingRows<'a> {
    /// Steering angles, where they are not those of the settled pose [rad].
    pub steering: Option<&'a [f64]>,
    /// Speeds of the wheels [rad/s].
    pub speeds: &'a [f64],
    /// Rates of the steering angles [rad/s].
    pub steering_rates: Option<&'a [f64]>,
    /// Rates of the free angles [rad/s].
    pub joint_rates: Option<&'a [f64]>,
    /// Angular velocity of the body in its axes [rad/s].
    pub angular_velocity: Option<&'a [f64]>,
    /// Weight of every wheel, or two weights per wheel (rolling, side slip); the same in all rows.
    pub weights: Option<&'a [f64]>,
}

/// Motions of bodies, row after row: see [`BodyMotion`](super::super::BodyMotion).
#[derive(Debug)]
pub struct BodyMotions<'a> {
    /// Twists of the body [m/s, rad/s].
    pub twists: &'a mut [[f64; 6]],
    /// Rates of the free angles [rad/s].
    pub joint_rates: &'a mut [f64],
    /// Velocity of every touching point along the normal, the tangent and to the left [m/s]; NaN in the air.
    pub residuals: &'a mut [f64],
}

/// The motion of every row; NaN where the wheels do not determine it. A row does not fail.
pub fn forward_rows(
    chain: &Chain,
    prepared: &Prepared,
    poses: &SettledPoses<'_>,
    readings: &ReadingRows<'_>,
    motions: BodyMotions<'_>,
    workers: Workers,
) -> Result<(), Error> {
    let (wheels, free) = (chain.wheels().len(), chain.joints().len());
    let BodyMotions { mut twists, mut joint_rates, mut residuals } = motions;
    run_rows(chain, prepared, workers, twists.len(), |rows| ForwardRange {
        poses,
        readings,
        motions: BodyMotions {
            twists: take(&mut twists, rows),
            joint_rates: take(&mut joint_rates, rows * free),
            residuals: take(&mut residuals, rows * wheels * 3),
        },
    })
}

/// Rows that one thread takes.
struct ForwardRange<'a> {
    poses: &'a SettledPoses<'a>,
    readings: &'a ReadingRows<'a>,
    motions: BodyMotions<'a>,
}

impl SolveRows for InLanes<'_, ForwardRange<'_>> {
    #[inline(always)]
    fn solve_rows<S: Vector>(
        &mut self,
        simd: S,
        [span, given]: [Span; 2],
        links: &mut BodyPoses<'_, S>,
        scratch: &mut MotionScratch<S>,
    ) -> Result<(), Error> {
        let found = match self.measures() {
            true => self.fit::<S, 4>(simd, given, links, scratch),
            false => self.fit::<S, 3>(simd, given, links, scratch),
        };
        self.write(simd, span, &found);
        Ok(())
    }
}

/// Directions of the steering joints where they are read, `to`, and where the pose has settled, `from`.
struct SteeringDirections<S: Vector> {
    to: [Option<Turned<S>>; MAX_WHEELS],
    from: [Option<Turned<S>>; MAX_WHEELS],
    moved: Mask<S>,
    any_moved: bool,
}

#[inline_always]
impl InLanes<'_, ForwardRange<'_>> {
    /// `RIGHT` is the number of right-hand sides of the suspension's equations: 4, or 3 where only wheel speeds are
    /// measured.
    fn fit<S: Vector, const RIGHT: usize>(
        &self,
        simd: S,
        given: Span,
        links: &mut BodyPoses<'_, S>,
        scratch: &mut MotionScratch<S>,
    ) -> FittedMotion<S> {
        let MotionScratch { gather, equations, contacts, poses } = scratch;
        poses.read(simd, self.chain, self.range.poses, given, gather);
        let poses = &*poses;
        self.place(simd, links, poses.joints);
        self.write_contacts(simd, given, poses, links, contacts);
        let readings = self.range.readings;
        let input = FitInput {
            contacts,
            touching: &poses.touching,
            known: self.known_rates(simd, given, poses),
            speeds: given.read(simd, readings.speeds, self.motion.wheels),
            weights: readings.weights,
        };
        fit::<S, RIGHT>(simd, self.motion, &input, equations)
    }

    /// Directions of the steering joints as they are given and where they have settled, None for those straight ahead, and
    /// the lanes in which one differs.
    fn steering<S: Vector>(&self, simd: S, given: Span, poses: &PoseLanes<S>) -> SteeringDirections<S> {
        let steered = self.chain.steering().len().min(MAX_WHEELS);
        let (mut angles, mut steers) = (poses.steering, poses.steers);
        let mut moved = Mask::splat(simd, false);
        if let Some(steering) = self.range.readings.steering {
            angles = given.read::<S, MAX_WHEELS>(simd, steering, steered);
            steers = true;
            for (angle, settled) in angles.iter().zip(poses.steering).take(steered) {
                moved = moved | !(*angle - settled).abs().le(all(simd, 0.0));
            }
        }
        let any_moved = moved.any();
        let (mut to, mut from) = ([None; MAX_WHEELS], [None; MAX_WHEELS]);
        for k in 0..steered {
            if steers {
                to[k] = Some(direction_of(simd, angles[k]));
            }
            if poses.steers && any_moved {
                from[k] = Some(direction_of(simd, poses.steering[k]));
            }
        }
        SteeringDirections { to, from, moved, any_moved }
    }

    /// Writes the contacts' velocities by the rates, at the given steering angles.
    fn write_contacts<S: Vector>(
        &self,
        simd: S,
        given: Span,
        poses: &PoseLanes<S>,
        links: &BodyPoses<'_, S>,
        contacts: &mut Contacts<S>,
    ) {
        let SteeringDirections { to, from, moved, any_moved } = self.steering(simd, given, poses);
        let rates = self.range.readings.steering_rates;
        let rates = rates.map(|rates| given.read::<S, MAX_WHEELS>(simd, rates, self.chain.steering().len()));
        let straight = (all(simd, 0.0), all(simd, 1.0));
        for (wheel, contact) in contacts.iter_mut().enumerate().take(self.motion.wheels.min(MAX_WHEELS)) {
            let joint = self.chain.steering_joint(wheel).map(|joint| joint % MAX_WHEELS);
            let (mut settled, mut turned) = (None, None);
            if let Some(joint) = joint {
                (settled, turned) = (from[joint], to[joint]);
            }
            let (normal, link) = (poses.normals[wheel], links.wheel_link(wheel));
            let mut at = poses.at[wheel];
            if any_moved {
                // The contact moves along the plane, on the side of the rim that touches it.
                let own = link.in_own_axes(normal);
                let [ahead, _, up] = from_turned(settled.unwrap_or(straight), own);
                let side = rim_side([ahead, up], at);
                let [ahead, ..] = from_turned(turned.unwrap_or(straight), own);
                let plane = angle_on_plane([ahead, up], side);
                at = (moved.select(plane.0, at.0), moved.select(plane.1, at.1));
            }
            let (_, touch) = self.contact(links, wheel, turned, at);
            let directions = [normal, touch.tangent, cross(normal, touch.tangent)];
            velocity_rows(links.movers(wheel), touch.point, directions, &mut contact.rows);
            if let (Some(joint), Some(rates)) = (joint, &rates) {
                contact.swivel = steering_velocity(link, links.pivot(simd, wheel), touch.point, directions);
                for part in &mut contact.swivel {
                    *part = *part * rates[joint];
                }
            }
        }
    }

    /// The known rates: those that are measured, and 0 for joints at their stops.
    fn known_rates<S: Vector>(&self, simd: S, given: Span, poses: &PoseLanes<S>) -> KnownRates<S> {
        let zero = all(simd, 0.0);
        let mut known = [KnownRate::Unknown; COLUMNS];
        let free = self.motion.joints.min(MAX_FREE);
        if let Some(turning) = self.range.readings.angular_velocity {
            let turning = given.read::<S, 3>(simd, turning, 3);
            for k in 0..3 {
                known[3 + k] = measured(simd, turning[k]);
            }
        }
        if let Some(rates) = self.range.readings.joint_rates {
            let rates = given.read::<S, MAX_FREE>(simd, rates, free);
            for k in 0..free {
                known[6 + k] = measured(simd, rates[k]);
            }
        }
        for k in free..MAX_FREE {
            known[6 + k] = KnownRate::Known(zero);
        }
        if poses.any_stopped {
            for k in 0..free {
                let stopped = zero.lt(poses.stopped[k]);
                known[6 + k] = match known[6 + k] {
                    KnownRate::Unknown => KnownRate::KnownWhere(poses.stopped[k], zero),
                    KnownRate::Known(rate) => KnownRate::Known(stopped.select(zero, rate)),
                    KnownRate::KnownWhere(here, rate) => {
                        KnownRate::KnownWhere(here.max(poses.stopped[k]), stopped.select(zero, rate))
                    }
                };
            }
        }
        known
    }

    /// True if joints, body or steering rates are measured as well as the wheels.
    fn measures(&self) -> bool {
        let readings = self.range.readings;
        let beside = [readings.joint_rates, readings.angular_velocity, readings.steering_rates];
        beside.iter().any(Option::is_some)
    }

    fn write<S: Vector>(&mut self, simd: S, span: Span, found: &FittedMotion<S>) {
        let MotionConstants { wheels, joints, .. } = *self.motion;
        let [vx, vy, vz, wx, wy, wz, rates @ ..] = found.rates;
        let motions = &mut self.range.motions;
        span.write(simd, &[vx, vy, vz, wx, wy, wz], 6, motions.twists.as_flattened_mut());
        span.write(simd, &rates, joints, motions.joint_rates);
        span.write(simd, &found.residuals, 3 * wheels, motions.residuals);
    }
}

/// A rate that is NaN where it was not measured.
#[inline(always)]
fn measured<S: Vector>(simd: S, rate: Lanes<S>) -> KnownRate<S> {
    let zero = all(simd, 0.0);
    let here = is_number(rate);
    if !here.any() {
        KnownRate::Unknown
    } else {
        // Also where every lane has it: the order of operations of a row must not depend on the measurements of its
        // neighbours.
        let one = all(simd, 1.0);
        KnownRate::KnownWhere(here.select(one, zero), here.select(rate, zero))
    }
}
