//! Slip of the wheels at known motions, for many rows.

use super::prepared::Prepared;
use super::run::{BodyPoses, InLanes, MotionScratch, SolveRows, run_rows, take};
use crate::lanes::columns::{Span, angle_of, is_number, polar};
use crate::lanes::settled_poses::SettledPoses;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_terrain::suspension::kinematics::LinkVelocity;
use six_wheel_terrain::suspension::lanes::{all, cross, dot};
use six_wheel_terrain::suspension::{Chain, MAX_FREE, MAX_WHEELS};

/// Known motions, row after row.
#[derive(Clone, Copy, Debug)]
pub struct SlipInput<'a> {
    /// Speed of every wheel against its link [rad/s].
    pub speeds: &'a [f64],
    /// Twists of the body [m/s, rad/s].
    pub twists: &'a [[f64; 6]],
    /// Rates of the free angles [rad/s].
    pub joint_rates: &'a [f64],
}

/// Slip of the wheels, row after row; NaN in the air.
#[derive(Debug)]
pub struct Slips<'a> {
    /// `1 - v . T / (r q)`: 0 rolling, 1 turning on the spot, negative braking; NaN where the wheel does not turn.
    pub ratios: &'a mut [f64],
    /// Angle whose tangent is the touching point's velocity to the left over the velocity of the centre along the rim
    /// [rad].
    pub angles: &'a mut [f64],
}

/// The slip of every wheel in every row. A row does not fail.
pub fn slip_rows(
    chain: &Chain,
    prepared: &Prepared,
    poses: &SettledPoses<'_>,
    input: &SlipInput<'_>,
    slips: Slips<'_>,
    workers: Workers,
) -> Result<(), Error> {
    let wheels = chain.wheels().len();
    let Slips { mut ratios, mut angles } = slips;
    run_rows(chain, prepared, workers, input.twists.len(), |rows| SlipRange {
        poses,
        input,
        slips: Slips { ratios: take(&mut ratios, rows * wheels), angles: take(&mut angles, rows * wheels) },
    })
}

/// Rows that one thread takes.
struct SlipRange<'a> {
    poses: &'a SettledPoses<'a>,
    input: &'a SlipInput<'a>,
    slips: Slips<'a>,
}

impl SolveRows for InLanes<'_, SlipRange<'_>> {
    #[inline(always)]
    fn solve_rows<S: Vector>(
        &mut self,
        simd: S,
        [span, given]: [Span; 2],
        links: &mut BodyPoses<'_, S>,
        scratch: &mut MotionScratch<S>,
    ) -> Result<(), Error> {
        let wheels = self.motion.wheels.min(MAX_WHEELS);
        let MotionScratch { gather, poses, .. } = scratch;
        poses.read(simd, self.chain, self.range.poses, given, gather);
        self.place(simd, links, poses.joints);
        let SlipInput { speeds, twists, joint_rates } = *self.range.input;
        let speeds = given.read::<S, MAX_WHEELS>(simd, speeds, wheels);
        let [vx, vy, vz, wx, wy, wz] = given.read::<S, 6>(simd, twists.as_flattened(), 6);
        let rates = given.read::<S, MAX_FREE>(simd, joint_rates, self.motion.joints);
        let body = LinkVelocity { linear: [vx, vy, vz], angular: [wx, wy, wz] };
        links.set_rates(&rates);
        let (zero, one, nan) = (all(simd, 0.0), all(simd, 1.0), all(simd, f64::NAN));
        let (mut ratios, mut angles) = ([nan; MAX_WHEELS], [nan; MAX_WHEELS]);
        // NaN where a differential does not reach.
        let mut reach = zero;
        for wheel in 0..wheels {
            let link = links.wheel_link(wheel);
            let turned = self.settled_direction(simd, poses, wheel);
            let (centre, touch) = self.contact(links, wheel, turned, poses.at[wheel]);
            let slide = link.velocity(&body, touch.point);
            let (sin, cos) = turned.unwrap_or((zero, one));
            let axle = link.rotated([-sin, cos, zero]);
            let ahead = dot(link.velocity(&body, centre), touch.tangent);
            let aside = dot(slide, cross(poses.normals[wheel], touch.tangent));
            // The rim turns with the encoder and with the link.
            let rim = all(simd, self.motion.radii[wheel]) * (speeds[wheel] + dot(link.angular_velocity(&body), axle));
            let touches = zero.lt(poses.touching.wheels[wheel]);
            let turns = touches & zero.lt(rim.abs());
            ratios[wheel] = turns.select(one - (ahead / rim), nan);
            angles[wheel] = touches.select(angle_of(simd, polar([ahead, aside]).turned), nan);
            reach = reach + centre[0];
        }
        for wheel in 0..wheels {
            ratios[wheel] = is_number(reach).select(ratios[wheel], nan);
            angles[wheel] = is_number(reach).select(angles[wheel], nan);
        }
        span.write(simd, &ratios, wheels, self.range.slips.ratios);
        span.write(simd, &angles, wheels, self.range.slips.angles);
        Ok(())
    }
}
