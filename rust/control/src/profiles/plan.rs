//! The plan of a transition with one centre of rotation: chords, alignments of wheels before them, and stops.

use nalgebra::Vector3;

use super::Profile;
use super::chord::{Chord, ChordFeasibility, is_driven, solved};
use super::constraints::{IcrLimits, constraints};
use super::limits::{AxisState, Bounds, Synchronise};
use super::optimal::time_optimal;
use super::phase::{Action, Motion, Phase};
use super::timing::{Smoothness, TimeParametrization};
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::Rover;
use six_wheel_numerics::error::{Error, ErrorKind, number, numbers};

/// Angles that differ by less are the same [rad].
const SAME_ANGLE: f64 = 1e-12;

/// Offsets of a detour's corner from the middle of the chord, as shares of the larger twist.
const DETOURS: [f64; 6] = [0.3, -0.3, 0.7, -0.7, 1.4, -1.4];

/// A detour is tried where the chord takes longer than this factor times the time that its wheels need at rest.
const LONG: f64 = 1.5;

/// Phases planned so far, the steering angles at their end [rad], and their duration [s].
#[derive(Clone, Default)]
pub(super) struct PhaseList {
    pub phases: Vec<Phase>,
    pub angles: Vec<f64>,
    pub duration: f64,
}

impl PhaseList {
    fn push(&mut self, action: Action, reason: impl Into<String>, duration: f64, motion: Motion) {
        self.phases.push(Phase { action, reason: reason.into(), start: self.duration, duration, motion });
        self.duration += duration;
    }
}

/// Plans the phases of a transition of this rover under these limits.
pub(super) struct TransitionPlanner<'a> {
    pub rover: &'a Rover,
    pub limits: &'a IcrLimits,
}

impl TransitionPlanner<'_> {
    /// Fails if a driven wheel would be too fast.
    pub fn check_speed(&self, argument: &'static str, twist: Twist) -> Result<(), Error> {
        let fastest = self.fastest(twist);
        if fastest <= self.limits.wheel_speed * (1.0 + 1e-12) {
            return Ok(());
        }
        let rule = format!(
            "keep every wheel within wheel_speed, {} rad/s (the fastest would turn at {} rad/s)",
            number(self.limits.wheel_speed),
            number(fastest)
        );
        let value = numbers(&<[f64; 3]>::from(twist));
        Err(Error::value(argument, rule, value).of_kind(ErrorKind::Infeasible))
    }

    /// Speed of the fastest driven wheel [rad/s].
    fn fastest(&self, twist: Twist) -> f64 {
        let [_, speeds] = solved(self.rover, twist, None);
        let driven = (0..speeds.len()).filter(|&i| is_driven(self.rover, i));
        driven.fold(0.0, |most: f64, i| most.max(speeds[i].abs()))
    }

    /// Appends a transition from one twist to another: one chord, two, or a stop.
    pub fn plan(&self, plan: PhaseList, start: Twist, end: Twist) -> Result<PhaseList, Error> {
        let direct = self.drive(plan.clone(), start, end, "on one chord");
        let least = self.least_turning(&plan.angles, end) / self.limits.steering_rate;
        let good = |found: &PhaseList| found.duration - plan.duration <= LONG * least;
        let why = match direct {
            Ok(found) if good(&found) || !self.rover.banks.is_empty() => return Ok(found),
            Ok(found) => {
                let around = self.detour(&plan, start, end);
                let faster = around.filter(|around| around.duration < found.duration);
                return Ok(faster.unwrap_or(found));
            }
            Err(TransitionError::Refused(error)) => return Err(error),
            Err(TransitionError::Closed(why)) => why,
        };
        if let Some(found) = self.detour(&plan, start, end) {
            return Ok(found);
        }
        let closed = |failure| match failure {
            TransitionError::Refused(error) => error,
            // Unreachable: on chords to and from rest no wheel turns.
            TransitionError::Closed(why) => infeasible(end, &why),
        };
        let mut stopped = self.drive(plan, start, Twist::ZERO, &format!("{why} on the way")).map_err(closed)?;
        if let Some(last) = stopped.phases.last_mut() {
            last.action = Action::Stop;
        }
        self.drive(stopped, Twist::ZERO, end, "from rest").map_err(closed)
    }

    /// Largest angle between a present steering angle and that of the end [rad]: a lower bound of the largest turn.
    fn least_turning(&self, angles: &[f64], end: Twist) -> f64 {
        let [aligned, _] = solved(self.rover, end, Some(angles));
        let turns = angles.iter().zip(&aligned).map(|(a, b)| (a - b).abs());
        turns.fold(0.0, f64::max)
    }

    /// Two chords in place of one, for a rover whose centre of rotation may be anywhere; None if no detour is better.
    fn detour(&self, plan: &PhaseList, start: Twist, end: Twist) -> Option<PhaseList> {
        if !self.rover.banks.is_empty() {
            return None;
        }
        let size = Vector3::new(1.0, 1.0, self.rover.size);
        let [a, b] = [start, end].map(|twist| Vector3::from(twist).component_mul(&size));
        let across = a.cross(&b);
        let largest = a.norm().max(b.norm());
        let normal = if across.norm() > 1e-9 * largest * largest {
            across
        } else {
            // Opposite or equal directions: any orthogonal direction.
            let axis = if a.z.abs() < a.xy().norm() { Vector3::z() } else { Vector3::x() };
            (if a.norm() > 0.0 { a } else { b }).cross(&axis)
        };
        let normal = normal.try_normalize(0.0)?;
        let corner = |share: f64| {
            let corner: Twist = ((a + b) / 2.0 + normal * (share * largest)).component_div(&size).into();
            let excess = (self.fastest(corner) / self.limits.wheel_speed).max(1.0);
            Twist::from(Vector3::from(corner) / excess)
        };
        let around = |planner: &TransitionPlanner<'_>, corner: Twist, why: &str| {
            self.rover.check(corner, None).ok()?;
            let half = planner.drive(plan.clone(), start, corner, why).ok()?;
            planner.drive(half, corner, end, why).ok()
        };
        // Corners are compared without the limits of acceleration and jerk, whose parametrization is slow.
        let firm = IcrLimits { steering_acceleration: f64::INFINITY, steering_jerk: f64::INFINITY, ..*self.limits };
        let quick = TransitionPlanner { rover: self.rover, limits: &firm };
        let tried = |corner: Twist, why: String| {
            let duration = around(&quick, corner, &why)?.duration;
            Some((duration, corner, why))
        };
        let beside = DETOURS
            .iter()
            .filter_map(|&share| tried(corner(share), "around what stands in the way of one chord".into()));
        // A corner with the centre of rotation on a pivot: its wheel is at rest there, and is turned to its new
        // direction.
        let over = self.rover.steered().iter().filter_map(|&i| {
            let wheel = &self.rover.wheels()[i];
            let [from, to] = [start, end].map(|twist| twist.at(wheel.x, wheel.y));
            let change = to - from;
            let nearest = -from.dot(&change) / change.norm_squared();
            let omega = start.omega + nearest * (end.omega - start.omega);
            let about = Twist { vx: omega * wheel.y, vy: -omega * wheel.x, omega };
            let name = &wheel.name;
            let why = format!("right over the pivot of {name:?}, past which no wheel turns");
            (nearest > 0.0 && nearest < 1.0).then(|| tried(about, why))?
        });
        let (_, corner, why) = beside.chain(over).min_by(|a, b| a.0.total_cmp(&b.0))?;
        around(self, corner, &why)
    }

    /// Appends one chord, and before it the alignment of the wheels whose pivots rest at its start.
    fn drive(&self, mut plan: PhaseList, start: Twist, end: Twist, why: &str) -> Result<PhaseList, TransitionError> {
        if start == end {
            return self.hold(plan, start, end);
        }
        let chord = match Chord::between(self.rover, start, end, &plan.angles) {
            ChordFeasibility::Open(chord) => chord,
            ChordFeasibility::Closed(why) => return Err(TransitionError::Closed(why.into_owned())),
        };
        let aligned: Vec<f64> = chord.joints.iter().map(|joint| joint.angle).collect();
        let turn = |(a, b): (&f64, &f64)| (a - b).abs() > SAME_ANGLE;
        if plan.angles.iter().zip(&aligned).any(turn) {
            let profile = self.align(&plan.angles, &aligned).map_err(TransitionError::Refused)?;
            let reason = if start == Twist::ZERO {
                "the wheels turn at rest to where the motion begins"
            } else {
                "the pivot under the centre of rotation turns to where its motion begins"
            };
            let motion = Motion::Turning(start, profile.clone());
            plan.push(Action::Align, reason, profile.duration(), motion);
        }
        let smooth = self.smoothness();
        let timing = TimeParametrization::new(&chord, &constraints(self.rover, &chord, self.limits), &smooth)
            .ok_or_else(|| TransitionError::Refused(infeasible(end, "a limit leaves no room to move")))?;
        plan.angles = chord.joints.iter().map(|joint| joint.angle + joint.swept(1.0)).collect();
        plan.push(Action::Drive, why, timing.duration(), Motion::Along(chord, timing));
        Ok(plan)
    }

    /// Appends a phase without a change of the twist.
    fn hold(&self, mut plan: PhaseList, start: Twist, end: Twist) -> Result<PhaseList, TransitionError> {
        if let ChordFeasibility::Open(chord) = Chord::between(self.rover, start, end, &plan.angles) {
            let timing = TimeParametrization::Binding { bounds: Vec::new(), duration: 0.0 };
            plan.push(Action::Drive, "there already", 0.0, Motion::Along(chord, timing));
        }
        Ok(plan)
    }

    fn smoothness(&self) -> Smoothness {
        let limit = |&i: &usize| {
            let wheel = &self.rover.wheels()[i];
            self.limits.acceleration_of(wheel.scrub, wheel.radius)
        };
        Smoothness { accelerations: self.rover.steered().iter().map(limit).collect(), jerk: self.limits.steering_jerk }
    }

    /// Profile of all joints in proportion, from rest to rest, as fast as their limits allow.
    fn align(&self, from: &[f64], to: &[f64]) -> Result<Profile, Error> {
        let smooth = self.smoothness();
        let mut share = Bounds::symmetric(f64::INFINITY, f64::INFINITY, f64::INFINITY);
        for (j, &i) in self.rover.steered().iter().enumerate() {
            let wheel = &self.rover.wheels()[i];
            // A wheel with a scrub radius rolls by its steering rate.
            let rolling = self.limits.wheel_speed * wheel.radius / wheel.scrub.abs();
            let turn = (to[j] - from[j]).abs();
            let rate = self.limits.steering_rate.min(rolling);
            share.velocity = share.velocity.min(rate / turn);
            share.acceleration = share.acceleration.min(smooth.accelerations[j] / turn);
            share.jerk = share.jerk.min(smooth.jerk / turn);
        }
        // A larger acceleration is not reached within the limits of velocity and jerk.
        share.acceleration = share.acceleration.min((share.velocity * share.jerk).sqrt());
        let share = Bounds::symmetric(share.velocity, share.acceleration, share.jerk);
        let whole = [AxisState::resting(&[0.0]), AxisState::resting(&[1.0])];
        let profile = time_optimal(&whole[0], &whole[1], &[share], Synchronise::None, None)?;
        Ok(profile.spread(from, to))
    }
}

/// Reason why a chord cannot be in the plan.
enum TransitionError {
    /// The wheels cannot follow this chord, but may follow another one.
    Closed(String),
    /// No chord is possible.
    Refused(Error),
}

fn infeasible(end: Twist, why: &str) -> Error {
    let rule = format!("be within reach ({why})");
    Error::value("end_twist", rule, numbers(&<[f64; 3]>::from(end))).of_kind(ErrorKind::Infeasible)
}
