//! The displacement over one step in space, from the readings of wheels, joints and an IMU.
//!
//! The motion is that of [`crate::Contacts::forward`] at the contacts in the middle of the step, with the changes of wheels
//! and joints over the whole step in place of their rates, as if these were constant. Steering is treated as in the
//! plane.

use nalgebra::Vector6;

use super::noise::{displacement_errors, fuse_yaw_increment};
use super::readings::{StepReadings, TiltPair, WheelMotion};
use super::site::{ContactSource, Place};
use super::spread::StepNoise;
use crate::{COLUMNS, ClimbInput, Readings, Row, SiteContacts, Unmapped};
use six_wheel_kinematics::geometry::sinc;
use six_wheel_numerics::error::{Error, ErrorKind, HUGE, numbers};
use six_wheel_terrain::suspension::{Chain, MAX_FREE, MAX_WHEELS};

/// Rounds of the fixed point of turn, contacts and displacement.
const ROUNDS: usize = 12;

/// Change of displacement [m] and turn [rad] below which the rounds end.
const FOUND: f64 = 1e-14;

/// Result of a step.
pub(crate) struct Step {
    /// `log(start⁻¹ end)`
    pub tangent: Vector6<f64>,
    /// Change of the yaw, where the tilt at both ends was measured [rad]; else None.
    pub yaw: Option<f64>,
    pub noise: StepNoise,
    /// Distance that every contact slid along its rim and to the left [m].
    pub slid: [[f64; 2]; MAX_WHEELS],
    /// True if one slid further than the noise explains.
    pub slips: bool,
    /// Climb of every wheel against the plane of all, as a sine.
    pub slopes: [f64; MAX_WHEELS],
}

/// The displacement over one step.
pub(crate) fn displace(step: &StepReadings<'_>, site: &ContactSource<'_>) -> Result<Step, Error> {
    let huge = || {
        let rule = "be small enough for a finite pose and covariance";
        let count = step.chain.wheels().len();
        Error::value("wheel_angles", rule, numbers(&step.turned[..count]))
    };
    let mut read = step.turned.iter().chain(&step.after.angles);
    if !read.all(|value| value.abs() < HUGE || value.is_nan()) {
        return Err(huge());
    }
    let tilt = TiltPair::of(step);
    let motion = wheel_motion(step, site, tilt.as_ref())?;
    let mut noise = StepNoise::none();
    let slips = displacement_errors(step, &motion, tilt.as_ref(), &mut noise);
    let mut tangent = Vector6::from(motion.twist);
    let mut yaw = motion.yaw;
    if let Some(change) = fuse_yaw_increment(step, &motion, tilt.as_ref(), &mut noise) {
        tangent += change;
        if let Some(tilt) = &tilt {
            yaw += (tangent[5] - tilt.turn(yaw).z) / tilt.up.z;
        }
    }
    if let Some(tilt) = &tilt {
        let turn = tilt.turn(yaw);
        tangent.fixed_rows_mut::<3>(3).copy_from(&turn);
    }
    let finite = tangent.iter().all(|part| part.abs() < HUGE)
        && noise.own.iter().all(|part| part.abs() < HUGE)
        && tangent.iter().all(|part| (part / step.dt).is_finite());
    if !finite {
        return Err(huge());
    }
    Ok(Step { tangent, yaw: tilt.map(|_| yaw), noise, slid: motion.slid, slips, slopes: motion.slopes })
}

/// Readings of a step for the motion on the ground: changes over the whole of it, angles in its middle.
struct MeanReadings {
    /// Rotations of the wheels, times the chord of their steering [rad].
    speeds: [f64; MAX_WHEELS],
    /// Steering angles in the middle [rad].
    angles: [f64; MAX_WHEELS],
    /// Changes of the steering angles, times their chord [rad].
    swivels: [f64; MAX_WHEELS],
    /// Free angles in the middle [rad].
    joints: [f64; MAX_FREE],
    /// Changes of the free angles [rad].
    turned: [f64; MAX_FREE],
    wheels: usize,
    steered: usize,
    free: usize,
}

impl MeanReadings {
    /// The pivot of a wheel that steers by `d` during the step moves along an arc in body axes, whose chord is
    /// `sin(d/2) / (d/2)` of the distance that the wheel rolled, as in the plane.
    fn of(step: &StepReadings<'_>) -> Self {
        let chain = step.chain;
        let mut input = Self {
            speeds: *step.turned,
            angles: [0.0; MAX_WHEELS],
            swivels: [0.0; MAX_WHEELS],
            joints: [0.0; MAX_FREE],
            turned: [0.0; MAX_FREE],
            wheels: chain.wheels().len(),
            steered: chain.steering().len(),
            free: chain.joints().len(),
        };
        let mut chords = [1.0; MAX_WHEELS];
        for (joint, share) in chords.iter_mut().enumerate().take(input.steered) {
            let (first, last) = (step.before.angles[joint], step.after.angles[joint]);
            *share = sinc((last - first) / 2.0);
            input.swivels[joint] = (last - first) * *share;
            input.angles[joint] = f64::midpoint(first, last);
        }
        for joint in 0..input.free {
            let (first, last) = (step.before.joints[joint], step.after.joints[joint]);
            input.turned[joint] = last - first;
            input.joints[joint] = f64::midpoint(first, last);
        }
        for (wheel, speed) in input.speeds[..input.wheels].iter_mut().enumerate() {
            if let Some(joint) = chain.steering_joint(wheel) {
                *speed *= chords[joint];
            }
        }
        input
    }

    fn joints(&self) -> &[f64] {
        &self.joints[..self.free]
    }

    fn readings<'a>(&'a self, body: Option<&'a [f64; 3]>) -> Readings<'a> {
        Readings {
            speeds: &self.speeds[..self.wheels],
            steering_rates: Some(&self.swivels[..self.steered]),
            joint_rates: Some(&self.turned[..self.free]),
            angular_velocity: body.map(|body| &body[..]),
            weights: None,
        }
    }

    /// Constants of the contacts at a site.
    fn stand<'a>(&self, chain: &'a Chain, site: &ContactSource<'_>) -> Result<SiteConstants<'a>, Error> {
        let constants = match site {
            ContactSource::Unmapped => {
                let steering = &self.angles[..self.steered];
                Unmapped::new(chain, self.joints(), steering).map(SiteConstants::Unmapped)
            }
            ContactSource::Ground(place) => place.contacts(chain).map(|contacts| {
                SiteConstants::Ground(SiteContacts {
                    contacts: contacts.sharing_sides(),
                    at: place.stand.wheels.map(|contact| contact.at),
                    slopes: [0.0; MAX_WHEELS],
                })
            }),
        };
        constants.ok_or_else(|| {
            let rule = "be within reach of the differential, with wheels that stand in no line";
            Error::value("joints", rule, numbers(self.joints()))
        })
    }

    /// The contacts there, sides shared, as far as the motion is known.
    fn contacts(&self, step: &StepReadings<'_>, constants: &SiteConstants<'_>, motion: Option<&Row>) -> SiteContacts {
        match constants {
            SiteConstants::Unmapped(unmapped) => {
                let climb = ClimbInput {
                    motion,
                    turned: &self.speeds[..self.wheels],
                    slopes: step.slopes,
                    deviation: step.centre_deviation,
                };
                let found = unmapped.contacts(step.chain, &climb);
                SiteContacts { contacts: found.contacts.sharing_sides(), ..found }
            }
            SiteConstants::Ground(found) => *found,
        }
    }
}

/// The part of a site's contacts that is known before the motion.
#[allow(clippy::large_enum_variant)] // one per step, on the stack
enum SiteConstants<'a> {
    Unmapped(Unmapped<'a>),
    Ground(SiteContacts),
}

/// Displacement of the first half of a step from a settled start, in axes of its body.
pub(crate) fn half_displacement(step: &StepReadings<'_>, start: &Place) -> Option<Vector6<f64>> {
    let input = MeanReadings::of(step);
    let constants = input.stand(step.chain, &ContactSource::Ground(start)).ok()?;
    let found = input.contacts(step, &constants, None);
    let half = Vector6::from(found.contacts.forward(&input.readings(None), step.radii).twist) * 0.5;
    half.iter().all(|part| part.is_finite()).then_some(half)
}

/// Steering angles in the middle of a step.
pub(crate) fn middle_angles(step: &StepReadings<'_>) -> [f64; MAX_WHEELS] {
    MeanReadings::of(step).angles
}

/// The motion by the wheels. With measured tilt the change of yaw is that for which the body's rotation about its z
/// axis is the one that fits the wheels; without a map the contact angles follow from the directions of the wheels'
/// motion.
fn wheel_motion(
    step: &StepReadings<'_>,
    site: &ContactSource<'_>,
    tilt: Option<&TiltPair>,
) -> Result<WheelMotion, Error> {
    let input = MeanReadings::of(step);
    let constants = input.stand(step.chain, site)?;
    let mut yaw = tilt.and_then(|tilt| tilt.yaw).unwrap_or(0.0);
    let mut rates: Option<Row> = None;
    let mut round = 0;
    loop {
        let turn = tilt.map(|tilt| tilt.turn(yaw));
        let SiteContacts { contacts, at, slopes } = input.contacts(step, &constants, rates.as_ref());
        let body = turn.map(|turn| [turn.x, turn.y, f64::NAN]);
        let readings = input.readings(body.as_ref());
        let fitted = contacts.forward(&readings, step.radii);
        if fitted.twist.iter().any(|rate| rate.is_nan()) {
            let rule = "determine the motion, with attitude and joints";
            let value = numbers(&step.turned[..input.wheels]);
            return Err(Error::value("wheel_angles", rule, value).of_kind(ErrorKind::Underdetermined));
        }
        let mut now = [0.0; COLUMNS];
        now[..6].copy_from_slice(&fitted.twist);
        now[6..].copy_from_slice(&fitted.joint_rates);
        let mut missing: f64 = 0.0;
        if let (Some(TiltPair { up, yaw: None, .. }), Some(turn)) = (tilt, turn) {
            missing = now[5] - turn.z;
            yaw += missing / up.z;
        }
        let apart = |before: &Row| {
            let pairs = before.iter().zip(&now);
            pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()))
        };
        let change = match site {
            ContactSource::Unmapped => rates.as_ref().map_or(f64::INFINITY, apart),
            ContactSource::Ground(_) => 0.0,
        };
        rates = Some(now);
        round += 1;
        if (missing.abs() <= FOUND && change <= FOUND) || round == ROUNDS {
            return Ok(WheelMotion {
                twist: fitted.twist,
                turn,
                yaw,
                response: contacts.response(&readings, step.radii),
                contacts,
                at,
                slopes,
                slid: fitted.residual.map(|[_, along, aside]| [along, aside]),
            });
        }
    }
}
