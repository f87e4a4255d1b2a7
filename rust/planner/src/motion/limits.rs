//! Constants of a rover and its limits for a planner's rollouts, computed once.
//!
//! Motions are expressed in the components that fixed wheels allow: the speed along their rolling direction and the yaw
//! rate, or all three of the twist where no wheel is fixed.

use std::f64::consts::FRAC_PI_2;

use nalgebra::Vector3;

use super::steered_joint::{SteeredJoint, window};
use crate::numbers::squares::{Form, ROUNDING, needed, pairs, product, square};
use six_wheel_control::controller::Limits;
use six_wheel_kinematics::geometry::Direction;
use six_wheel_kinematics::rover::{Mount, Rover};
use six_wheel_kinematics::wheels::Pivot;
use six_wheel_numerics::error::{Error, short};
use six_wheel_numerics::simd::vec3::inner_product;

/// Ranges whose ends are this near to a quarter turn are unrestricted [rad].
const WHOLE: f64 = 1e-9;
/// Relative excess over a range up to which a direction counts as at its end.
pub(super) const AT_AN_END: f64 = 1e-9;

/// A gap between the possible directions of a rover of two components: its ends, and the projections onto them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DirectionGap {
    /// Motions at both ends.
    pub ends: [[f64; 2]; 2],
    /// Row of each end, whose product with a motion is the factor of the end in the motion's projection onto it.
    pub shares: [[f64; 2]; 2],
    /// One over the length of each end [s/m].
    pub per_length: [f64; 2],
}

/// Reason why a rover cannot move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImmobileReason {
    /// No motion lets all its wheels roll.
    Rover,
    /// A steered wheel has no angle within the steering limit.
    SteeringLimit,
}

/// The rover within its limits, as numbers.
#[derive(Clone, Debug, Default)]
pub(crate) struct RoverLimits {
    /// Number of components.
    pub free: usize,
    /// Body twist from components, row after row.
    pub body: Vec<[f64; 3]>,
    /// Angle of the components' axes against the body's [rad], and the sideways velocity of the origin per yaw rate
    /// [m].
    pub heading: f64,
    pub sideways: f64,
    /// Lengths [m, or 1 for speeds] whose products with the components are speeds [m/s].
    pub lengths: Vec<f64>,
    /// Mean over the pivots of their squared speed [m²/s²].
    pub metric: Form,
    pub joints: Vec<SteeredJoint>,
    pub gaps: Vec<DirectionGap>,
    /// A motion well inside every range, if no wheel is fixed.
    pub inside: Option<Vec<f64>>,
    /// Forms that are 1 at a limit of the motion itself, and of its change in a second when it grows and shrinks.
    pub scaling: Vec<Form>,
    pub speeding: Vec<Form>,
    pub slowing: Vec<Form>,
    /// Squared speeds at which fixed wheels slide [m²/s²].
    pub slips: Vec<Form>,
    pub limits: Limits,
    pub stuck: Option<ImmobileReason>,
}

impl RoverLimits {
    pub fn new(rover: &Rover, limits: Limits) -> Result<Self, Error> {
        for wheel in rover.wheels() {
            if wheel.steering().is_some() && wheel.trail != 0.0 {
                let rule = "have no steered wheel with trail (its angle depends on more than the motion)";
                let got = format!("trail {} of wheel {:?}", short(wheel.trail), wheel.name);
                return Err(Error::value("rover", rule, got));
            }
        }
        let mut bounds = Self::components(rover, limits);
        bounds.wheels(rover);
        bounds.directions(rover);
        for forms in [&mut bounds.scaling, &mut bounds.speeding, &mut bounds.slowing, &mut bounds.slips] {
            *forms = needed(std::mem::take(forms), bounds.free);
        }
        Ok(bounds)
    }

    /// The components, and the constants that follow from them alone.
    fn components(rover: &Rover, limits: Limits) -> Self {
        let (mut heading, mut sideways) = (0.0, 0.0);
        let body = match rover.banks.first() {
            None => vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            Some(bank) => {
                let row = if bank.row.y < 0.0 { -bank.row } else { bank.row };
                heading = (-row.x).atan2(row.y);
                sideways = -row.z;
                let Direction { sin, cos } = Direction { sin: -row.x, cos: row.y };
                vec![[cos, sin, 0.0], [-sin * sideways, cos * sideways, 1.0]]
            }
        };
        let free = body.len();
        let mut bounds = Self {
            free,
            heading,
            sideways,
            lengths: if free == 2 { vec![1.0, rover.size] } else { vec![1.0, 1.0, rover.size] },
            body,
            limits,
            ..Self::default()
        };
        let metric = |(i, j): (usize, usize)| {
            let [a, b] = [i, j].map(|k| Vector3::from(bounds.body[k]));
            let twice = if i == j { 1.0 } else { 2.0 };
            twice * a.dot(&(rover.metric * b))
        };
        bounds.metric = pairs(free).map(metric).collect();
        let [vx, vy, yaw] = [0, 1, 2].map(|k| bounds.row([f64::from(k == 0), f64::from(k == 1), f64::from(k == 2)]));
        let linear = |limit: f64| product(&[&vx, &vy], 1.0 / (limit * limit));
        let turning = |limit: f64| product(&[&yaw], 1.0 / (limit * limit));
        let both = |linear_limit: f64, angular: f64| {
            let linear = linear_limit.is_finite().then(|| linear(linear_limit));
            linear.into_iter().chain(angular.is_finite().then(|| turning(angular))).collect()
        };
        bounds.scaling = both(limits.speed, limits.yaw_rate);
        bounds.speeding = both(limits.acceleration, limits.angular_acceleration);
        bounds.slowing = both(limits.deceleration, limits.angular_deceleration);
        bounds
    }

    /// A row of a twist as a row of components.
    pub(super) fn row(&self, row: [f64; 3]) -> Vec<f64> {
        self.body.iter().map(|part| inner_product(part, &row)).collect()
    }

    /// Adds the joints and limits of every wheel.
    fn wheels(&mut self, rover: &Rover) {
        let limits = self.limits;
        for (wheel, mount) in rover.wheels().iter().zip(&rover.mounts) {
            let pivot = |a: f64, b: f64| [a, b, wheel.x * b - wheel.y * a];
            let rim = match *mount {
                Mount::Fixed(rows) => {
                    if wheel.pivot == Pivot::Fixed && wheel.roller_angle.is_none() {
                        // The wheel's own row: that of its mount is the mean over parallel wheels.
                        let own = wheel.rows(Direction::from(wheel.heading)).side_slip;
                        let slip = self.row(own.into());
                        if slip.iter().any(|part| part.abs() > ROUNDING) {
                            self.slips.push(product(&[&slip], 1.0));
                        }
                    }
                    product(&[&self.row(rows.rolling.into())], 1.0)
                }
                Mount::Steered(..) | Mount::Castor(_) => {
                    let rows = [self.row(pivot(1.0, 0.0)), self.row(pivot(0.0, 1.0))];
                    let mut form = product(&[&rows[0], &rows[1]], 1.0);
                    // (|u| + b |omega|)² is at most this, and is this when turning about the origin.
                    let (offset, arm) = (wheel.scrub.abs() + wheel.trail.abs(), wheel.x.hypot(wheel.y));
                    if offset > 0.0 {
                        let share = if arm > 0.0 { offset / arm } else { 1.0 };
                        let yaw = self.row([0.0, 0.0, 1.0]);
                        let turning = product(&[&yaw], offset * offset * (1.0 + 1.0 / share));
                        for (part, turning) in form.iter_mut().zip(turning) {
                            *part = *part * (1.0 + share) + turning;
                        }
                    }
                    form
                }
            };
            let limited = |limit: f64| {
                let limit = limit * wheel.radius;
                limit.is_finite().then(|| rim.iter().map(|part| part / (limit * limit)).collect::<Form>())
            };
            self.scaling.extend(limited(limits.wheel_speed));
            self.speeding.extend(limited(limits.wheel_acceleration));
            self.slowing.extend(limited(limits.wheel_acceleration));
            let Mount::Steered(range, _) = *mount else {
                continue;
            };
            let Some((middle, half)) = window(range, limits.steering_limit) else {
                self.stuck = Some(ImmobileReason::SteeringLimit);
                continue;
            };
            let Direction { sin, cos } = Direction::from(wheel.heading + middle);
            self.joints.push(SteeredJoint {
                along: self.row(pivot(cos, sin)),
                across: self.row(pivot(-sin, cos)),
                middle,
                half,
            });
        }
    }

    /// Largest excess of a motion over a range, as a share of its size; 0 or less if it is within all.
    pub(super) fn beyond(&self, motion: &[f64]) -> f64 {
        let size = square(&self.metric, motion).max(0.0).sqrt();
        let over = |joint: &SteeredJoint| {
            let (sin, cos) = joint.half.sin_cos();
            inner_product(&joint.across, motion).abs() * cos - inner_product(&joint.along, motion).abs() * sin
        };
        self.narrow_joints().map(over).fold(f64::NEG_INFINITY, f64::max) / size
    }

    /// Joints that turn less than a quarter turn to either side.
    pub(super) fn narrow_joints(&self) -> impl Iterator<Item = &SteeredJoint> {
        self.joints.iter().filter(|joint| joint.half < FRAC_PI_2 - WHOLE)
    }

    /// Of the axes and diagonals of the components, the motion farthest inside every range.
    pub(super) fn find_inside(&mut self) {
        if self.narrow_joints().next().is_none() {
            return;
        }
        let parts = [1.0, 0.0, -1.0];
        let mut best = (0.0, None);
        for a in parts {
            for b in parts {
                for c in parts {
                    let motion = vec![a, b, c / self.lengths[2]];
                    let size = square(&self.metric, &motion).max(0.0).sqrt();
                    if size == 0.0 {
                        continue;
                    }
                    let motion: Vec<f64> = motion.iter().map(|part| part / size).collect();
                    let beyond = self.beyond(&motion);
                    if beyond < best.0 - AT_AN_END {
                        best = (beyond, Some(motion));
                    }
                }
            }
        }
        self.inside = best.1;
        if self.inside.is_none() {
            self.stuck = Some(ImmobileReason::Rover);
        }
    }

    /// The components of a body twist; parts that no component represents are left out.
    pub fn motion(&self, twist: [f64; 3]) -> [f64; 3] {
        if self.free == 3 {
            return twist;
        }
        let (sin, cos) = self.heading.sin_cos();
        [cos * twist[0] + sin * twist[1], twist[2], 0.0]
    }

    /// A bound of the speed of the pivots of a twist [m/s].
    pub fn size_of(&self, twist: &[f64; 3]) -> f64 {
        let parts = self.motion(*twist).into_iter().zip(&self.lengths);
        parts.map(|(part, length)| part.abs() * length).sum()
    }

    /// A bound of the yaw rate of executed motions, for controls of this size [m/s] [rad/s].
    pub fn turns_at_most(&self, size: f64) -> f64 {
        // The largest yaw rate at this size is that of a pure rotation about the centre.
        let fastest = 2.0 * size / self.lengths[self.free - 1];
        fastest.min(self.limits.yaw_rate)
    }

    /// The body twist of components.
    pub fn twist(&self, motion: &[f64]) -> [f64; 3] {
        let mut twist = [0.0; 3];
        for (part, column) in motion.iter().zip(&self.body) {
            for (sum, along) in twist.iter_mut().zip(column) {
                *sum += part * along;
            }
        }
        twist
    }
}
