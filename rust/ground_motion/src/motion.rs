//! Motion of one settled pose, and the settings of motions.

use pulp::Scalar;

use super::contact::{Contacts, rest_offset};
use crate::lanes::pose_lanes::Touching;
use crate::rates::constants::{MotionConstants, PLAN};
use crate::rates::contact_rows::COLUMNS;
use crate::rates::contact_rows::{Contact as LaneContact, Contacts as LaneContacts};
use crate::rates::fit::{FitInput, fit};
use crate::rates::least_squares::DenseLeastSquares;
use crate::rates::point_rows::Row;
use crate::rates::suspension_rates::{KnownRate, KnownRates, SuspensionRates};
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::Mask;
use six_wheel_numerics::simd::level::run_scalar;
use six_wheel_terrain::suspension::lanes::all;
use six_wheel_terrain::suspension::{Chain, MAX_FREE, MAX_WHEELS};

/// Measurements of wheels, joints and body.
#[derive(Clone, Copy, Debug, Default)]
pub struct Readings<'a> {
    /// Speed of every wheel against its link [rad/s]; NaN where it was not measured.
    pub speeds: &'a [f64],
    /// Rates of the steering angles [rad/s].
    pub steering_rates: Option<&'a [f64]>,
    /// Rates of the free angles [rad/s]; NaN where one was not measured.
    pub joint_rates: Option<&'a [f64]>,
    /// Angular velocity of the body in its axes [rad/s]; NaN where it was not measured.
    pub angular_velocity: Option<&'a [f64]>,
    /// Weight of every wheel, or two weights per wheel: those of its rolling and of its side slip.
    pub weights: Option<&'a [f64]>,
}

impl Readings<'_> {
    /// Rates that are known; NaN for the unknown ones.
    pub(crate) fn known(&self, contacts: &Contacts) -> Row {
        let mut known = [f64::NAN; COLUMNS];
        for (k, rate) in self.angular_velocity.into_iter().flatten().enumerate() {
            known[3 + k] = *rate;
        }
        for (k, rate) in self.joint_rates.into_iter().flatten().enumerate() {
            known[6 + k] = *rate;
        }
        for (k, stopped) in contacts.stopped.into_iter().enumerate() {
            if stopped || k >= contacts.joints {
                known[6 + k] = 0.0;
            }
        }
        known
    }
}

/// Motion of the body that fits the readings best.
#[derive(Clone, Copy, Debug)]
pub struct BodyMotion {
    /// Twist of the body's origin, in its axes [m/s, rad/s].
    pub twist: [f64; 6],
    /// Rates of the free angles [rad/s].
    pub joint_rates: [f64; MAX_FREE],
    /// Velocity of every touching point along the normal, along the tangent and to the left [m/s]; NaN in the air.
    pub residual: [[f64; 3]; MAX_WHEELS],
}

/// Frame of a commanded speed and yaw rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// Along the body's x axis and about its z axis.
    Body,
    /// In the horizontal plane: along the heading, and about the vertical.
    Plan,
}

/// Settings by which desired motions become commands.
#[derive(Clone, Copy, Debug)]
pub struct Command {
    /// Frame of speeds and yaw rates.
    pub view: View,
    /// Distance behind the origin of the point that moves straight ahead [m]: [`rest_offset`].
    pub offset: f64,
    /// Largest speed of a wheel [rad/s]: beyond it all speeds are scaled down by one factor.
    pub wheel_speed: f64,
}

impl Command {
    /// In the body's axes, without a limit.
    pub fn new(chain: &Chain) -> Self {
        Self { view: View::Body, offset: rest_offset(chain), wheel_speed: f64::INFINITY }
    }

    /// Speeds and yaw rates `(vx, omega)` [m/s, rad/s] of planar twists. Fails unless `vy` is 0 or `offset omega`, the
    /// sideways velocity of the origin when the point at `offset` behind it moves straight ahead.
    pub fn of_twists(&self, twists: &[[f64; 3]]) -> Result<Vec<[f64; 2]>, Error> {
        let rule = "be a twist (vx, 0, omega), as the steered wheels follow the unsteered ones, or (speed, yaw rate)";
        let speeds = twists.iter().enumerate().map(|(row, [vx, vy, omega])| {
            let is_left = *vy == 0.0 || (vy - self.offset * omega).abs() <= 1e-9 * (1.0 + vy.abs());
            let refused = || Error::value("command", rule, format!("vy = {vy:?} m/s")).at_row(row);
            is_left.then_some([*vx, *omega]).ok_or_else(refused)
        });
        speeds.collect()
    }
}

/// Rates as a function of the planar ones: `offset + spread . plan`.
pub(crate) struct SuspensionJacobian {
    pub spread: [[f64; 3]; COLUMNS],
    pub offset: Row,
}

impl Contacts {
    /// Twist and joint rates from the wheels: the planar motion by weighted least squares over the contacts.
    pub fn forward(&self, readings: &Readings<'_>, radii: &[f64; MAX_WHEELS]) -> BodyMotion {
        run_scalar(one_motion, (self, readings, radii))
    }

    /// The rates of the suspension that follow the ground, given known ones (NaN for those that are not) and rates of the
    /// wheels' own steering.
    pub(crate) fn suspension(&self, known: &Row, swivels: &[f64; MAX_WHEELS]) -> SuspensionJacobian {
        run_scalar(one_suspension, (self, known, swivels))
    }

    /// The contacts in one lane, their own steering at these rates.
    #[inline(always)]
    fn in_lanes(&self, swivels: &[f64; MAX_WHEELS]) -> (LaneContacts<Scalar>, Touching<Scalar>) {
        let mut contacts = [LaneContact::zero(Scalar); MAX_WHEELS];
        let (touches, none) = (self.touching().count(), all(Scalar, 0.0));
        let mut touching = Touching {
            wheels: [none; MAX_WHEELS],
            all: touches == self.count,
            none: Mask::splat(Scalar, touches == 0),
        };
        for (wheel, (lanes, contact)) in contacts.iter_mut().zip(&self.wheels[..self.count]).enumerate() {
            for i in 0..3 {
                for (cell, part) in lanes.rows[i].iter_mut().zip(contact.rows[i]) {
                    *cell = all(Scalar, part);
                }
                lanes.swivel[i] = all(Scalar, contact.swivel[i] * swivels[wheel]);
            }
            touching.wheels[wheel] = all(Scalar, f64::from(contact.touching));
        }
        (contacts, touching)
    }
}

/// Rates that are known, or not.
#[inline(always)]
fn known_rates(known: &Row) -> KnownRates<Scalar> {
    let mut rates = [KnownRate::Unknown; COLUMNS];
    for (rate, known) in rates.iter_mut().zip(known) {
        if !known.is_nan() {
            *rate = KnownRate::Known(all(Scalar, *known));
        }
    }
    rates
}

/// See [`Contacts::forward`].
#[inline(always)]
fn one_motion((contacts, readings, radii): (&Contacts, &Readings<'_>, &[f64; MAX_WHEELS])) -> BodyMotion {
    let mut swivels = [0.0; MAX_WHEELS];
    if let Some(rates) = readings.steering_rates {
        for (swivel, contact) in swivels.iter_mut().zip(&contacts.wheels[..contacts.count]) {
            if let Some(joint) = contact.steering {
                *swivel = rates[joint];
            }
        }
    }
    let (lanes, touching) = contacts.in_lanes(&swivels);
    let mut speeds = [all(Scalar, f64::NAN); MAX_WHEELS];
    for (lane, speed) in speeds.iter_mut().zip(readings.speeds) {
        *lane = all(Scalar, *speed);
    }
    let known = known_rates(&readings.known(contacts));
    let input = FitInput { contacts: &lanes, touching: &touching, known, speeds, weights: readings.weights };
    let constants = MotionConstants::dense(contacts.count, contacts.joints, *radii);
    let found = fit::<Scalar, 4>(Scalar, &constants, &input, &mut DenseLeastSquares::new(Scalar));
    let mut moving =
        BodyMotion { twist: [0.0; 6], joint_rates: [0.0; MAX_FREE], residual: [[f64::NAN; 3]; MAX_WHEELS] };
    let rates = moving.twist.iter_mut().chain(&mut moving.joint_rates).zip(found.rates);
    let residuals = moving.residual.as_flattened_mut().iter_mut().zip(found.residuals);
    for (value, lane) in rates.chain(residuals) {
        *value = lane.last(Scalar);
    }
    moving
}

/// See [`Contacts::suspension`].
#[inline(always)]
fn one_suspension((contacts, known, swivels): (&Contacts, &Row, &[f64; MAX_WHEELS])) -> SuspensionJacobian {
    let (lanes, touching) = contacts.in_lanes(swivels);
    let constants = MotionConstants::dense(contacts.count, contacts.joints, [1.0; MAX_WHEELS]);
    let (known, mut equations) = (known_rates(known), DenseLeastSquares::new(Scalar));
    let found = SuspensionRates::new::<4>(Scalar, &constants, &touching, &known, &lanes, &mut equations);
    let is_determined = found.determined.any();
    let offset = found.offset.map(|rate| rate.last(Scalar));
    let mut jacobian = SuspensionJacobian { spread: [[0.0; 3]; COLUMNS], offset };
    for (k, column) in PLAN.into_iter().enumerate() {
        jacobian.spread[column][k] = found.free[k].last(Scalar);
    }
    for (column, spread) in found.unknown.iter().zip(found.spread).take(found.count) {
        for (value, lane) in jacobian.spread[*column].iter_mut().zip(spread) {
            *value = if is_determined { lane.last(Scalar) } else { f64::NAN };
        }
        if !is_determined {
            jacobian.offset[*column] = f64::NAN;
        }
    }
    jacobian
}
